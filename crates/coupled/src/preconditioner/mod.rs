//! The preconditioner of the flow in a slab.
//!
//! ```text
//! dR/dU  ~  T (x) M + dt W (x) A  =  (W Q (x) I) ( L (x) M + dt I (x) A ) (Q^{-1} (x) I),     W^{-1} T = Q L Q^{-1}      (decoupled)
//! ```
//!
//! with ONE Jacobian A and mass matrix M of the operator of space, taken in the middle of a slab. The temporal modes
//! separate into systems (lambda M + dt A) x = c, one for each real eigenvalue and one for each complex pair. Each is
//! replaced by its block ILU(0), and all of them are swept at once. Steady flows have one real mode, and a coarse level for it.

mod bf16_blocks;
mod blocks;
mod coarse;
mod couplings;
mod face_traces;
mod factor;
mod ilu;
mod inverse;
mod lines;
mod low_order;
mod modal;
mod ordering;
mod panel;
mod sweeps;

pub use coarse::{CoarseLevel, functions_per_direction as coarse_functions_per_direction};
pub use ilu::FlowPreconditioner;
pub use lines::LinePreconditioner;
pub use low_order::{LowOrderPreconditioner, VECTORS as LOW_ORDER_VECTORS, low_order};
pub use ordering::{Ordering, Stage};
pub use panel::padded;
