//! Numbers at points by formulas: data of boundary conditions and of sources.

use crate::expression::Program;
use crate::vector::Vector;
use fem::StateField;
use tensor::{Dual, Transcendental};

/// A number, a vector and a number by formulas in position and time, [first, vector (D), last]. Conditions and sources say what they mean.
#[derive(Clone, Debug, PartialEq)]
pub struct PointData<const D: usize> {
    /// A pressure, a mass or the strength of a sponge.
    pub first: Program,
    /// A direction, a velocity, a momentum or an acceleration.
    pub vector: Vector<D>,
    /// A temperature or an energy.
    pub last: Program,
}

impl<const D: usize> PointData<D> {
    /// The numbers at `x` and `t`.
    pub fn evaluate<T: Transcendental, const M: usize>(&self, x: &[T; D], t: T) -> [T; M] {
        let vector = self.vector.evaluate(x, t);
        let mut data = [self.first.evaluate(x, t); M];
        data[1..1 + D].copy_from_slice(&vector);
        data[1 + D] = self.last.evaluate(x, t);
        data
    }

    /// The numbers, if they are the same at all points and times.
    pub fn as_constants(&self) -> Option<(f64, [f64; D], f64)> {
        Some((self.first.as_constant()?, self.vector.as_constant()?, self.last.as_constant()?))
    }
}

impl<const D: usize, const M: usize> StateField<D, M> for PointData<D> {
    fn value(&self, x: &[f64; D], t: f64) -> [f64; M] {
        self.evaluate(x, t)
    }
    fn dual(&self, x: &[Dual<f64>; D], t: f64) -> [Dual<f64>; M] {
        self.evaluate(x, Dual::from(t))
    }
}
