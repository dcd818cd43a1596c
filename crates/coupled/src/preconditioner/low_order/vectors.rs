//! Unknowns of the temporal modes, cell by cell, `[column][node][component]` in single precision. A complex mode has two columns, its real and
//! its imaginary part.

use super::matrix::NodeBlocks;
use basis::{TemporalModes, is_real};
use faer::c64;
use fem::parallel::{self, Grain};
use fem::{Layout, Share};
use newton_krylov::inner_product;
use std::ops::Range;
use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use tensor::Arch;

/// The largest number of time nodes.
pub(super) const COLUMNS: usize = 16;

/// A vector over own cells and ghosts. Threads never meet here: each writes its own cell, and reads cells that are done.
pub(super) struct Field {
    cells: Vec<RwLock<Vec<f32>>>,
    /// How many of them are own cells.
    own: usize,
}

impl Field {
    pub(super) fn zeros(layout: Layout, share: &Share) -> Self {
        let cells = share.cells().map(|_| RwLock::new(vec![0.0; layout.cell_len()])).collect();
        Field { cells, own: layout.cells }
    }
    pub(super) fn read(&self, cell: usize) -> RwLockReadGuard<'_, Vec<f32>> {
        self.cells[cell].read().unwrap_or_else(PoisonError::into_inner)
    }
    pub(super) fn write(&self, cell: usize) -> RwLockWriteGuard<'_, Vec<f32>> {
        self.cells[cell].write().unwrap_or_else(PoisonError::into_inner)
    }
    /// Receives the numbers of ghosts from their owners.
    pub(super) fn receive_ghosts(&self, share: &Share) {
        let len = self.cells.first().map_or(0, |_| self.read(0).len());
        let get = |cell: usize, out: &mut Vec<f64>| out.extend(self.read(cell).iter().map(|&x| f64::from(x)));
        share.exchange_some(
            |_| true,
            len,
            get,
            |ghost, numbers| {
                self.write(ghost).iter_mut().zip(numbers).for_each(|(x, number)| *x = *number as f32);
            },
        );
    }
    /// Passes every own cell to `change`, in parallel.
    pub(super) fn change(&self, change: impl Fn(usize, &mut [f32]) + Sync) {
        parallel::for_each(self.own, Grain::AtLeast(16), &|cell| change(cell, &mut self.write(cell)));
    }
}

/// The columns of each mode.
pub(super) fn columns(modes: &TemporalModes) -> Vec<Range<usize>> {
    let parts = modes.eigenvalues.iter().map(|lambda| if is_real(*lambda) { 1 } else { 2 });
    let first = |end: &mut usize, parts: usize| {
        *end += parts;
        Some(*end - parts..*end)
    };
    parts.scan(0, first).collect()
}

/// Vectors of one slab in the columns of the modes.
pub(super) struct Space<'a> {
    pub(super) columns: &'a [Range<usize>],
    pub(super) share: &'a Share,
}

impl Space<'_> {
    /// (x_k, y) of every mode, conjugate in x_k: `[k][mode]`.
    pub(super) fn dots(&self, x: &[&Field], y: &Field) -> Vec<Vec<c64>> {
        let of_cell = |cell: usize| -> Vec<c64> {
            let y = y.read(cell);
            let dots = x.iter().map(|x| self.dots_in_cell(&x.read(cell), &y));
            dots.flatten().collect()
        };
        let of_cells = parallel::map(y.own, Grain::AtLeast(16), &of_cell);
        let total = |number: usize, part: fn(&c64) -> f64| {
            let of_cells: Vec<f64> = of_cells.iter().map(|dots| part(&dots[number])).collect();
            inner_product::sum_over_blocks(&of_cells, &self.share.ends, &self.share.sums)
        };
        let dot = |number: usize| c64::new(total(number, |dot| dot.re), total(number, |dot| dot.im));
        let modes = self.columns.len();
        (0..x.len()).map(|k| (k * modes..(k + 1) * modes).map(dot).collect()).collect()
    }

    fn dots_in_cell(&self, x: &[f32], y: &[f32]) -> Vec<c64> {
        let mode = |columns: &Range<usize>| {
            let range = self.range(columns, x.len());
            Arch::new().dispatch(|| dot_of_mode(columns.len() == 2, &x[range.clone()], &y[range]))
        };
        self.columns.iter().map(mode).collect()
    }

    /// y += sum_k factor_k x_k, mode by mode; factors `[k][mode]`.
    pub(super) fn add(&self, factors: &[Vec<c64>], x: &[&Field], y: &Field) {
        y.change(|cell, y| {
            for (factors, x) in factors.iter().zip(x) {
                let x = x.read(cell);
                for (factor, columns) in factors.iter().zip(self.columns) {
                    let (range, factor) = (self.range(columns, x.len()), [factor.re as f32, factor.im as f32]);
                    let y = &mut y[range.clone()];
                    Arch::new().dispatch(|| add_mode(factor, columns.len() == 2, &x[range.clone()], y));
                }
            }
        });
    }

    /// Where some columns of a cell are.
    fn range(&self, columns: &Range<usize>, len: usize) -> Range<usize> {
        let column_len = len / self.columns.last().map_or(1, |columns| columns.end);
        columns.start * column_len..columns.end * column_len
    }
}

/// The inner product of one mode, conjugate in x. A complex mode has a real and an imaginary half.
#[inline(always)]
fn dot_of_mode(is_complex: bool, x: &[f32], y: &[f32]) -> c64 {
    if !is_complex {
        return c64::new(real_dot(x, y), 0.0);
    }
    let ((x_re, x_im), (y_re, y_im)) = (x.split_at(x.len() / 2), y.split_at(x.len() / 2));
    c64::new(real_dot(x_re, y_re) + real_dot(x_im, y_im), real_dot(x_re, y_im) - real_dot(x_im, y_re))
}

/// The sum of products, in eight sums that are added at the end.
#[inline(always)]
fn real_dot(x: &[f32], y: &[f32]) -> f64 {
    let mut sums = [0.0; 8];
    let ((x, x_rest), (y, y_rest)) = (x.as_chunks::<8>(), y.as_chunks::<8>());
    for (x, y) in x.iter().zip(y) {
        for i in 0..8 {
            sums[i] += f64::from(x[i]) * f64::from(y[i]);
        }
    }
    let rest: f64 = x_rest.iter().zip(y_rest).map(|(x, y)| f64::from(*x) * f64::from(*y)).sum();
    sums.iter().sum::<f64>() + rest
}

/// y += (re + i im) x for one mode. A complex mode has a real and an imaginary half.
#[inline(always)]
pub(super) fn add_mode([re, im]: [f32; 2], is_complex: bool, x: &[f32], y: &mut [f32]) {
    if !is_complex {
        return y.iter_mut().zip(x).for_each(|(y, x)| *y += re * x);
    }
    let ((x_re, x_im), (y_re, y_im)) = (x.split_at(x.len() / 2), y.split_at_mut(x.len() / 2));
    for ((y, x_re), x_im) in y_re.iter_mut().zip(x_re).zip(x_im) {
        *y += re * x_re - im * x_im;
    }
    for ((y, x_re), x_im) in y_im.iter_mut().zip(x_re).zip(x_im) {
        *y += im * x_re + re * x_im;
    }
}

/// Between vectors of the flow and scaled unknowns of the modes.
pub(super) struct Modes<'a, const D: usize, const M: usize> {
    pub(super) modes: &'a TemporalModes,
    pub(super) matrix: &'a NodeBlocks<D, M>,
}

impl<const D: usize, const M: usize> Modes<'_, D, M> {
    /// c = (Q^-1 W^-1 (x) M^(-1/2) S^-1) r, times `scale`.
    pub(super) fn split(&self, r: &[f64], scale: f64, c: &Field) {
        let (layout, matrix) = (self.matrix.layout, self.matrix);
        c.change(|cell, c| {
            for (column, c) in c.chunks_exact_mut(layout.nodes * M).enumerate() {
                let weights = (0..layout.time_order).map(|a| self.modes.forward[(column, a)] * scale);
                let mut sums = vec![0.0; layout.nodes];
                for m in 0..M {
                    sums.fill(0.0);
                    for (a, weight) in weights.clone().enumerate() {
                        let start = layout.index(cell, a, m, 0);
                        sums.iter_mut().zip(&r[start..]).for_each(|(sum, r)| *sum += weight * r);
                    }
                    for (node, (c, sum)) in c.chunks_exact_mut(M).zip(&sums).enumerate() {
                        c[m] = (sum * matrix.scale(cell, node, m)) as f32;
                    }
                }
            }
        });
    }

    /// z = (Q (x) M^(-1/2) S) c, times `scale`.
    pub(super) fn join(&self, c: &Field, scale: f64, z: &mut [f64]) {
        let (layout, matrix) = (self.matrix.layout, self.matrix);
        parallel::for_each_chunk(z, layout.cell_len(), Grain::AtLeast(16), &|cell, z| {
            let c = c.read(cell);
            z.fill(0.0);
            for (number, z) in z.chunks_exact_mut(layout.nodes).enumerate() {
                let (a, m) = (number / M, number % M);
                for (column, c) in c.chunks_exact(layout.nodes * M).enumerate() {
                    let weight = self.modes.backward[(a, column)] * scale;
                    let of_component = c.chunks_exact(M).map(|c| f64::from(c[m]));
                    z.iter_mut().zip(of_component).for_each(|(z, c)| *z += weight * c);
                }
                z.iter_mut().enumerate().for_each(|(node, z)| *z *= matrix.unknown(cell, node, m));
            }
        });
    }
}
