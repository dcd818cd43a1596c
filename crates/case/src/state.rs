//! A state prescribed by name or by formulas.

use super::vector::Vector;
use crate::expression::Program;
use navier_stokes::exact::{Couette, FreeStream, Vortex, Waves};
use navier_stokes::{ExactState, Gas, Primitive};
use tensor::Transcendental;

/// A state as a function of position and time: initial values, boundary values, the exact solution.
#[derive(Clone, Debug, PartialEq)]
pub enum State<const D: usize> {
    /// A uniform state.
    Uniform(FreeStream<D>),
    /// An isentropic vortex.
    Vortex(Vortex<D>),
    /// Couette flow.
    Couette(Couette<D>),
    /// Waves, for manufactured solutions.
    Waves(Waves<D>),
    /// Formulas.
    Expression(Box<Formulas<D>>),
}

/// Density, velocity and pressure as formulas in position and time.
#[derive(Clone, Debug, PartialEq)]
pub struct Formulas<const D: usize> {
    /// The gas, which turns them into a conserved state.
    pub gas: Gas,
    /// The density.
    pub density: Program,
    /// The velocity.
    pub velocity: Vector<D>,
    /// The pressure.
    pub pressure: Program,
}

impl<const D: usize> Formulas<D> {
    /// Density, velocity and pressure at `x` and `t`.
    pub fn primitive<T: Transcendental>(&self, x: &[T; D], t: T) -> Primitive<T, D> {
        Primitive {
            density: self.density.evaluate(x, t),
            velocity: self.velocity.evaluate(x, t),
            pressure: self.pressure.evaluate(x, t),
        }
    }
}

impl<const D: usize, const M: usize> ExactState<D, M> for State<D> {
    fn state<T: Transcendental>(&self, x: &[T; D], t: T) -> [T; M] {
        match self {
            State::Uniform(state) => state.state(x, t),
            State::Vortex(state) => state.state(x, t),
            State::Couette(state) => state.state(x, t),
            State::Waves(state) => state.state(x, t),
            State::Expression(formulas) => formulas.primitive(x, t).pack(&formulas.gas),
        }
    }
}
