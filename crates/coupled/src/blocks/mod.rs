//! The blocks: bodies, the mesh, the flow.

pub mod elastic_body;
mod flow;
mod mesh_motion;
pub mod rigid_body;
mod slab_times;

pub use elastic_body::ElasticBody;
pub(crate) use flow::inadmissible;
pub(crate) use flow::totals_at;
pub use flow::{Counts, FlowBlock, totals};
pub use mesh_motion::MeshBlock;
pub use rigid_body::RigidBody;
pub use slab_times::SlabTimes;
pub(crate) use slab_times::{jump, last_digits};
