//! States that are known as functions of position and time.
//!
//! They are written once for any number type. With dual numbers the same source gives the derivatives for boundary values
//! on a moving mesh and for manufactured sources.

mod couette;
mod free_stream;
mod vortex;
mod waves;

pub use couette::Couette;
pub use free_stream::FreeStream;
pub use vortex::Vortex;
pub use waves::Waves;

use fem::StateField;
use tensor::{Dual, Transcendental};

/// A conserved state of `M` components given at every point `x` and time `t`.
pub trait ExactState<const D: usize, const M: usize>: Send + Sync {
    /// The state at `x` and `t`.
    fn state<T: Transcendental>(&self, x: &[T; D], t: T) -> [T; M];
}

/// An exact state as a field for initial values, boundary values and errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exact<E>(pub E);

impl<const D: usize, const M: usize, E: ExactState<D, M>> StateField<D, M> for Exact<E> {
    fn value(&self, x: &[f64; D], t: f64) -> [f64; M] {
        self.0.state(x, t)
    }
    fn dual(&self, x: &[Dual<f64>; D], t: f64) -> [Dual<f64>; M] {
        self.0.state(x, Dual::from(t))
    }
}
