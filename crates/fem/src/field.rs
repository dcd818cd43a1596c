//! Prescribed functions of position and time.

use tensor::Dual;

/// A state of `M` components prescribed at points: initial values, exact solutions, boundary values, sources.
///
/// It is evaluated point by point in plain numbers, and with the derivative along a motion of the point. So the
/// Jacobian with respect to the mesh is exact even if prescribed values vary in space.
pub trait StateField<const D: usize, const M: usize>: Send + Sync {
    /// The state at `x` and time `t`.
    fn value(&self, x: &[f64; D], t: f64) -> [f64; M];
    /// The state and its derivative along the derivative of `x`.
    fn dual(&self, x: &[Dual<f64>; D], t: f64) -> [Dual<f64>; M];
}

/// A vector prescribed at points of the reference mesh: the displacement of a boundary or of the whole domain.
pub trait VectorField<const D: usize>: Send + Sync {
    /// The vector at reference position `x` and time `t`.
    fn value(&self, x: &[f64; D], t: f64) -> [f64; D];
    /// The time derivative of the vector at reference position `x` and time `t`, exact.
    fn rate(&self, x: &[f64; D], t: f64) -> [f64; D];
}
