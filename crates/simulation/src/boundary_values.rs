//! Values of formulas in a slab that failed.

use case::{Case, Flow, NoValue, NotPositive};
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
    flow.not_positive(&case.mesh, displacement(mover, d), &times(interval))
}

/// The first formula of a source or a boundary that has no value within `interval`, where the mesh is at its begin.
pub fn without_value<const D: usize>(
    (case, flow): (&Case<D>, &Flow<D>),
    mover: &MeshMover<D>,
    d: &[f64],
    interval: Interval,
) -> Option<NoValue> {
    flow.without_value(&case.mesh, displacement(mover, d), &times(interval))
}

fn times(Interval { start, end, .. }: Interval) -> Vec<f64> {
    (0..=PARTS).map(|part| start + (end - start) * part as f64 / PARTS as f64).collect()
}

/// The displacement `d` of (cell, node of the cell, position at rest).
fn displacement<'a, const D: usize>(
    mover: &'a MeshMover<D>,
    d: &'a [f64],
) -> impl Fn(usize, usize, &[f64; D]) -> [f64; D] + 'a {
    |cell, k, _| {
        let node = mover.numbering.cell(cell)[k];
        from_fn(|i| d[node * D + i])
    }
}
