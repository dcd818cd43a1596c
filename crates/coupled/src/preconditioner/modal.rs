//! Between time nodes and temporal modes, cell by cell.

use basis::TemporalModes;
use fem::{Layout, Share};
use newton_krylov::inner_product;

/// The largest entry of `r` on all ranks: what vectors are divided by to keep single precision from underflow. A collective call.
pub(super) fn largest(share: &Share, r: &[f64]) -> f64 {
    inner_product::largest_size(r, &share.sums)
}

/// The vector (Q^{-1} W^{-1} (x) I) r, divided by `scale`, which keeps single precision from underflow.
pub(super) struct Split<'a> {
    pub(super) modes: &'a TemporalModes,
    pub(super) layout: Layout,
    pub(super) r: &'a [f64],
    pub(super) scale: f64,
}

impl Split<'_> {
    /// Its column `column` in `cell`.
    pub(super) fn take(&self, cell: usize, column: usize, c: &mut [f32]) {
        c.fill(0.0);
        for a in 0..self.layout.time_order {
            let weight = self.modes.forward[(column, a)] * (1.0 / self.scale);
            c.iter_mut().zip(&self.r[self.layout.cell_at(cell, a)]).for_each(|(c, r)| *c += (weight * r) as f32);
        }
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
