//! The preconditioner of the flow in a slab.
//!
//! ```text
//! dR/dU  ~  T (x) M + dt W (x) A  =  (W Q (x) I) ( L (x) M + dt I (x) A ) (Q^{-1} (x) I),     W^{-1} T = Q L Q^{-1}      (decoupled)
//! ```
//!
//! with ONE Jacobian A and mass matrix M of the operator of space, taken in the middle of a slab. The temporal modes
//! separate into systems (lambda M + dt A) x = c, one for each real eigenvalue and one for each complex pair. Each is
//! replaced by its block ILU(0), and all of them are swept at once. Steady flows, which have one real mode, and long slabs of large meshes
//! have a coarse level too.

mod aggregates;
mod bf16_blocks;
mod blocks;
mod coarse;
mod coarse_modes;
mod couplings;
mod cuts;
mod face_traces;
mod factor;
mod ilu;
mod inverse;
mod lines;
mod low_order;
mod modal;
mod ordering;
mod panel;
mod singles;
mod sweeps;
mod two_level;

pub use aggregates::functions_per_direction as coarse_functions_per_direction;
pub use ilu::BlockIlu;
pub use lines::LinePreconditioner;
pub use low_order::{VECTORS as LOW_ORDER_VECTORS, low_order};
pub use ordering::{Ordering, Stage};
pub use panel::padded;
pub use two_level::{CoarseLevelUse, TwoLevel};

use fem::SlabOperator;
use newton_krylov::operator::Preconditioner;

/// The times that scale a temporal mode (lambda + damping) M + dt A.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TimeScales {
    /// The length of the slab.
    pub dt: f64,
    /// dt / dtau: the length of the slab over the step of pseudo-time.
    pub damping: f64,
}

/// The factored modes of a slab. Of the flow they know the Jacobian in the middle of the slab.
pub trait FactoredModes: Preconditioner + Send {
    /// Factors the modes of the same Jacobian for other times.
    fn factor(&mut self, scales: TimeScales);
    /// The order of elimination; [`Ordering::none`] if no cell is eliminated.
    fn ordering(&self) -> Ordering;
    /// Bytes held.
    fn bytes(&self) -> usize;
}

/// A preconditioner of the flow in a slab.
pub trait FlowPreconditioner<const D: usize, const M: usize>: FactoredModes {
    /// The preconditioner of the Jacobian that `flow` has now, in the same order of elimination.
    fn updated(self: Box<Self>, flow: &SlabOperator<D, M>, scales: TimeScales) -> Box<dyn FlowPreconditioner<D, M>>;
}
