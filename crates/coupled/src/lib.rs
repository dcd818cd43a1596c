//! Mesh and flow as one nonlinear problem per slab, and the march from slab to slab; also of the mesh or of a structure alone.
//!
//! Slabs of equal length, and a length that follows the jump of the flow. At order 3 in time the jump grows with dt^3, so a jump of 8 times
//! the tolerance asks for half the length, with a margin of 0.9:
//!
//! ```
//! use coupled::{Schedule, State, StepControl};
//!
//! let schedule = Schedule::uniform(2.0, 8);
//! let mut state = State::new(0.0, Vec::new(), Vec::new());
//! let first = schedule.next(&state);
//! assert_eq!((first.start, first.end), (0.0, 0.25));
//!
//! let control = StepControl { tolerance: 1e-4, smallest: 1e-3, largest: 1.0 };
//! assert!(control.rejects(0.25, 8e-4));
//! assert!((control.next(0.25, 8e-4, 3) - 0.9 * 0.125).abs() < 1e-15);
//!
//! let adaptive = Schedule { control: Some(control), ..schedule };
//! assert!(adaptive.repeats(&mut state, first, 8e-4, 3));
//! assert!((adaptive.next(&state).end - 0.1125).abs() < 1e-15);
//! ```

mod balance;
pub mod block;
pub mod blocks;
mod clock;
mod coupled_slab;
mod initial;
mod lagged_preconditioner;
mod march;
mod mesh_march;
mod mesh_mover;
mod motion;
mod observation;
pub mod preconditioner;
mod resolution;
mod reuse_policy;
mod sampled_limit;
mod schedule;
mod slab_error;
mod start_layer;
mod state;
mod steady;
mod structure_march;
mod system;
mod transfer;
pub mod weights;

pub use blocks::{Counts, totals};
pub use clock::{is_before, rounded_time};
pub use coupled_slab::{CoupledSlab, FlowMarch, Jacobian, Predictor, ROUND_OFF, Settings, SlabReport};
pub use initial::interpolate;
pub use lagged_preconditioner::{LaggedPreconditioner, Linearisation, Method, Update};
pub use march::{March, SlabSolver};
pub use mesh_march::{MeshAlone, MeshMarch, MeshReport};
pub use mesh_mover::{MeshMover, MeshQuality, RELATIVE_DETERMINANT};
pub use motion::{BoundaryDisplacement, BoundaryField, MeshMotion};
pub use observation::Observation;
pub use reuse_policy::JacobianReusePolicy;
pub use schedule::{Schedule, StepControl};
pub use slab_error::{MarchError, SlabError, chain};
pub use start_layer::{EasedStart, LayerWall, StartLayer};
pub use state::{Interval, Past, State};
pub use steady::{
    Discretisation, Discretised, Equilibrium, Invariants, NoEquilibrium, Reliability, Search, Settling, Stability,
    Stage, SteadyError, SteadyFlow, find_equilibrium,
};
pub use structure_march::{Equations, Reactions, StructureAlone, StructureMarch, StructureReport, Supports};
pub use system::{ResidualBreakdown, System, krylov_precision};
