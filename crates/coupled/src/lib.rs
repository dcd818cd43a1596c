//! Mesh and flow as one nonlinear problem per slab, and the march from slab to slab.

mod motion;
pub mod preconditioner;
mod slab_problem;
pub mod weights;

pub use motion::{BoundaryMotion, MeshMotion};
pub use slab_problem::{Counts, SlabProblem};
