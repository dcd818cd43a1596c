//! The values that a condition takes: numbers, or data at every point.

use crate::state::scaled;
use fem::BoundaryPoint;
use tensor::{Real, norm};

/// A pressure, a vector and a temperature. Each condition takes a part of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Values<T, const D: usize> {
    /// The total or the static pressure.
    pub(super) pressure: T,
    /// A direction, a velocity or a mass flux.
    pub(super) vector: [T; D],
    /// The total or the static temperature.
    pub(super) temperature: T,
}

/// Where the values of a condition come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Given<const D: usize> {
    /// The same values at all points and times.
    Uniform(Values<f64, D>),
    /// The data of each point.
    AtPoints,
}

impl<const D: usize> Given<D> {
    /// The values at a point.
    #[inline(always)]
    pub(super) fn values<G: Real, const M: usize>(&self, at: &BoundaryPoint<'_, G, D, M>) -> Values<G, D> {
        match self {
            Given::Uniform(values) => values.constant(at.normal[0]),
            Given::AtPoints => Values::of_data(at.data),
        }
    }

    /// `vector` of unit length. A vector of numbers has it already.
    #[inline(always)]
    pub(super) fn unit<G: Real>(&self, vector: &[G; D]) -> [G; D] {
        match self {
            Given::Uniform(_) => *vector,
            Given::AtPoints => scaled(vector, norm(vector).recip()),
        }
    }

    /// The values, if they are the same at all points.
    pub(super) fn uniform(&self) -> Option<Values<f64, D>> {
        match self {
            Given::Uniform(values) => Some(*values),
            Given::AtPoints => None,
        }
    }

    /// Whether the values are data of points.
    #[inline(always)]
    pub(super) fn is_at_points(&self) -> bool {
        matches!(self, Given::AtPoints)
    }
}

impl<T: Real, const D: usize> Values<T, D> {
    /// `data` = [pressure, vector (D), temperature].
    #[inline(always)]
    pub(super) fn of_data<const M: usize>(data: &[T; M]) -> Self {
        const { assert!(M == D + 2, "data are a pressure, a vector of D components and a temperature") };
        let mut vector = [data[0]; D];
        vector.copy_from_slice(&data[1..1 + D]);
        Values { pressure: data[0], vector, temperature: data[1 + D] }
    }
}

impl<const D: usize> Values<f64, D> {
    /// The same constants in the number type of `like`.
    #[inline(always)]
    fn constant<G: Real>(&self, like: G) -> Values<G, D> {
        let mut vector = [like; D];
        for i in 0..D {
            vector[i] = like.constant(self.vector[i]);
        }
        Values { pressure: like.constant(self.pressure), vector, temperature: like.constant(self.temperature) }
    }
}
