//! The times of a slab at which a body meets the flow.

use basis::{Matrix, RadauTime};

/// The times of a slab and its usual length.
#[derive(Clone, Debug)]
pub struct SlabTimes {
    /// The time nodes of a slab.
    pub time: RadauTime,
    /// The quadrature points of the flow in time.
    pub points: Vec<f64>,
    /// The length of most slabs, to which norms refer.
    pub step: f64,
}

impl SlabTimes {
    /// phi_a at the quadrature points, `[point][a]`.
    pub fn test_functions(&self) -> Matrix {
        let values: Vec<f64> = self.points.iter().flat_map(|s| self.time.values(*s)).collect();
        Matrix::new(self.points.len(), self.time.order(), values)
    }
}

/// The parts of the loads `[time point][..]`, one for each of `points` time points; empty parts if there are no loads yet.
pub(super) fn at_each_point<T>(loads: &[T], points: usize) -> impl Iterator<Item = &[T]> {
    loads.chunks_exact((loads.len() / points).max(1))
}

/// Changes of the rates `z`, `[time node][k]`, that act like a last digit of the rates and of the positions `bottom` in a slab of the length
/// `dt`.
pub(crate) fn last_digits(z: &[f64], bottom: &[f64], dt: f64) -> Vec<f64> {
    let digit = |(i, rate): (usize, &f64)| f64::EPSILON * (rate.abs() + bottom[i % bottom.len()].abs() / dt);
    z.iter().enumerate().map(digit).collect()
}

/// z(t_n+) - w_n of the rates `z`, `[time node][k]`, over the rates `bottom`.
pub(crate) fn jump(time: &RadauTime, z: &[f64], bottom: &[f64]) -> Vec<f64> {
    let mut jump: Vec<f64> = bottom.iter().map(|rate| -rate).collect();
    for (phi, z) in time.values(0.0).into_iter().zip(z.chunks_exact(bottom.len())) {
        jump.iter_mut().zip(z).for_each(|(jump, rate)| *jump += phi * rate);
    }
    jump
}
