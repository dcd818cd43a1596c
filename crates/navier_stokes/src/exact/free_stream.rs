//! The uniform state.

use super::ExactState;
use crate::error::InvalidParameter;
use crate::gas::Gas;
use crate::state::Primitive;
use tensor::Transcendental;

/// The same state at every position and time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeStream<const D: usize> {
    gas: Gas,
    state: Primitive<f64, D>,
}

impl<const D: usize> FreeStream<D> {
    /// The uniform `state`.
    ///
    /// # Errors
    /// A density or pressure that is not positive, a velocity that is not finite.
    pub fn new(gas: Gas, state: Primitive<f64, D>) -> Result<Self, InvalidParameter> {
        Ok(FreeStream { gas, state: state.checked()? })
    }

    /// Density, velocity and pressure.
    pub fn primitive(&self) -> Primitive<f64, D> {
        self.state
    }
}

impl<const D: usize, const M: usize> ExactState<D, M> for FreeStream<D> {
    fn state<T: Transcendental>(&self, _x: &[T; D], t: T) -> [T; M] {
        self.state.constant(t).pack(&self.gas)
    }
}
