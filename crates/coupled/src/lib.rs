//! Mesh and flow as one nonlinear problem per slab, and the march from slab to slab.

mod initial;
mod march;
mod motion;
pub mod preconditioner;
mod slab_problem;
mod state;
pub mod weights;

pub use initial::interpolate;
pub use march::{Jacobian, March, MarchError, MeshQuality, Predictor, Settings, SlabError, SlabReport, chain};
pub use motion::{BoundaryMotion, MeshMotion};
pub use slab_problem::{Counts, SlabProblem};
pub use state::{Interval, Past, State};
