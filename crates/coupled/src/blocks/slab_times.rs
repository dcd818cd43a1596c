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
