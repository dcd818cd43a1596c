//! Between time nodes and temporal modes, cell by cell.

use basis::TemporalModes;
use fem::{Layout, Share};

/// The largest entry of `r` on all ranks: what vectors are divided by to keep single precision from underflow. A collective call.
pub(super) fn largest(share: &Share, r: &[f64]) -> f64 {
    share.sums.largest(r.iter().fold(0.0, |m: f64, x| m.max(x.abs())))
}

/// Column `column` of (Q^{-1} W^{-1} (x) I) r in `cell`, times `scale`, which keeps single precision from underflow.
pub(super) fn split(
    modes: &TemporalModes,
    layout: Layout,
    cell: usize,
    column: usize,
    scale: f64,
    r: &[f64],
    c: &mut [f32],
) {
    c.fill(0.0);
    for a in 0..layout.time_order {
        let weight = modes.forward[(column, a)] * scale;
        c.iter_mut().zip(&r[layout.cell_at(cell, a)]).for_each(|(c, r)| *c += (weight * r) as f32);
    }
}

/// Adds what column `column` has in (Q (x) I) c, times `scale`, to `z`, the unknowns of a cell.
pub(super) fn join(modes: &TemporalModes, column: usize, scale: f64, c: &[f32], z: &mut [f64]) {
    let block = z.len() / modes.backward.rows();
    for (a, z) in z.chunks_exact_mut(block).enumerate() {
        let weight = modes.backward[(a, column)] * scale;
        z.iter_mut().zip(c).for_each(|(z, c)| *z += weight * f64::from(*c));
    }
}
