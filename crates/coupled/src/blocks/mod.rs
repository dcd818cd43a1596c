//! The blocks: bodies, the mesh, the flow.

mod flow;
mod mesh_motion;
pub mod rigid_body;

pub(crate) use flow::inadmissible;
pub use flow::{Counts, FlowBlock};
pub use mesh_motion::MeshBlock;
pub use rigid_body::RigidBody;
