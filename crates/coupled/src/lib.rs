//! Mesh and flow as one nonlinear problem per slab, and the march from slab to slab; also of the mesh or of a structure alone.

mod balance;
mod initial;
mod lagged_preconditioner;
mod march;
mod mesh_march;
mod mesh_mover;
mod motion;
mod observation;
pub mod preconditioner;
mod reuse_policy;
mod sampled_limit;
mod schedule;
mod slab_problem;
mod state;
mod steady;
mod structure_march;
mod transfer;
pub mod weights;

pub use initial::interpolate;
pub use lagged_preconditioner::{LaggedPreconditioner, Linearisation, Method, Update};
pub use march::{Jacobian, March, MarchError, Predictor, ROUND_OFF, Settings, SlabError, SlabReport, chain};
pub use mesh_march::{MeshMarch, MeshReport};
pub use mesh_mover::{MeshMover, MeshQuality};
pub use motion::{BoundaryField, BoundaryMotion, MeshMotion};
pub use observation::Observation;
pub use reuse_policy::JacobianReusePolicy;
pub use schedule::{Schedule, StepControl};
pub use slab_problem::{Counts, ResidualBreakdown, SlabProblem};
pub use state::{Interval, Past, State};
pub use steady::{
    Discretisation, Discretised, Reliability, Search, Settling, Stability, Stage, SteadyError, SteadyFlow, solve_steady,
};
pub use structure_march::{Equations, StructureMarch, StructureReport, Supports};
