//! Values of boundary conditions in a slab that failed.

use case::{Case, Flow, NotPositive};
use coupled::{Interval, MeshMover};
use std::array::from_fn;

/// The parts of a slab at whose ends values are taken.
const PARTS: usize = 64;

/// The first value of a boundary condition within `interval` that must be positive and is not. The boundaries are taken where they are at its
/// begin, with the displacement `d`.
pub fn not_positive<const D: usize>(
    (case, flow): (&Case<D>, &Flow<D>),
    mover: &MeshMover<D>,
    d: &[f64],
    interval: Interval,
) -> Option<NotPositive> {
    let Interval { start, end, .. } = interval;
    let times: Vec<f64> = (0..=PARTS).map(|part| start + (end - start) * part as f64 / PARTS as f64).collect();
    let displacement = |cell: usize, k: usize, _: &[f64; D]| {
        let node = mover.numbering.cell(cell)[k];
        from_fn(|i| d[node * D + i])
    };
    flow.not_positive(&case.mesh, displacement, &times)
}
