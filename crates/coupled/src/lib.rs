//! Mesh and flow as one nonlinear problem per slab, and the march from slab to slab.

mod initial;
mod march;
mod mesh_march;
mod mesh_mover;
mod motion;
pub mod preconditioner;
mod sampled_limit;
mod slab_problem;
mod state;
pub mod weights;

pub use initial::interpolate;
pub use march::{Jacobian, March, MarchError, Predictor, ROUND_OFF, Settings, SlabError, SlabReport, chain};
pub use mesh_march::{MeshMarch, MeshReport};
pub use mesh_mover::{MeshMover, MeshQuality};
pub use motion::{BoundaryField, BoundaryMotion, MeshMotion};
pub use slab_problem::{Counts, Frozen, SlabProblem};
pub use state::{Interval, Past, State};
