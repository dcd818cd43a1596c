//! Unknowns of the temporal modes, cell by cell, `[node][column][component]` in single precision. A complex mode has two columns, its real and
//! its imaginary part.

use super::matrix::NodeBlocks;
use basis::{TemporalModes, is_real};
use faer::c64;
use fem::{Layout, Share};
use newton_krylov::inner_product;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

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
        (0..self.own).into_par_iter().with_min_len(16).for_each(|cell| change(cell, &mut self.write(cell)));
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

/// Vectors of one slab: `M` components in `columns` of the modes.
pub(super) struct Space<'a> {
    pub(super) components: usize,
    pub(super) columns: &'a [Range<usize>],
    pub(super) share: &'a Share,
}

impl Space<'_> {
    /// Numbers of a node.
    fn node_len(&self) -> usize {
        self.columns.last().map_or(0, |range| range.end) * self.components
    }

    /// The inner product of every mode, conjugate in x.
    pub(super) fn dots(&self, x: &Field, y: &Field) -> Vec<c64> {
        let of_cell = |cell: usize| -> [c64; COLUMNS] {
            let (x, y, mut sums) = (x.read(cell), y.read(cell), [c64::ZERO; COLUMNS]);
            for (x, y) in x.chunks_exact(self.node_len()).zip(y.chunks_exact(self.node_len())) {
                for (sum, columns) in sums.iter_mut().zip(self.columns) {
                    *sum += self.dot(columns, x, y);
                }
            }
            sums
        };
        let cells: Vec<_> = (0..x.own).into_par_iter().with_min_len(16).map(of_cell).collect();
        let sum = |part: &dyn Fn(&[c64; COLUMNS]) -> f64| {
            let of_cells = cells.iter().map(part).collect::<Vec<_>>();
            inner_product::sum_over_blocks(&of_cells, &self.share.ends, &self.share.sums)
        };
        (0..self.columns.len()).map(|mode| c64::new(sum(&|cell| cell[mode].re), sum(&|cell| cell[mode].im))).collect()
    }

    /// The same at one node for one mode.
    fn dot(&self, columns: &Range<usize>, x: &[f32], y: &[f32]) -> c64 {
        let (len, start) = (self.components, columns.start * self.components);
        let (x, y) = (&x[start..], &y[start..]);
        if columns.len() == 1 {
            return c64::new(real_dot(&x[..len], &y[..len]), 0.0);
        }
        let ([x_re, x_im], [y_re, y_im]) = ([&x[..len], &x[len..2 * len]], [&y[..len], &y[len..2 * len]]);
        c64::new(real_dot(x_re, y_re) + real_dot(x_im, y_im), real_dot(x_re, y_im) - real_dot(x_im, y_re))
    }

    /// y += factor x, mode by mode.
    pub(super) fn add(&self, factors: &[c64], x: &Field, y: &Field) {
        y.change(|cell, y| {
            let x = x.read(cell);
            for (x, y) in x.chunks_exact(self.node_len()).zip(y.chunks_exact_mut(self.node_len())) {
                for (factor, columns) in factors.iter().zip(self.columns) {
                    self.add_mode(*factor, columns, x, y);
                }
            }
        });
    }

    fn add_mode(&self, factor: c64, columns: &Range<usize>, x: &[f32], y: &mut [f32]) {
        let (len, start) = (self.components, columns.start * self.components);
        let (re, im) = (factor.re as f32, factor.im as f32);
        for i in start..start + len {
            if columns.len() == 1 {
                y[i] += re * x[i];
            } else {
                let (x_re, x_im) = (x[i], x[i + len]);
                y[i] += re * x_re - im * x_im;
                y[i + len] += im * x_re + re * x_im;
            }
        }
    }
}

fn real_dot(x: &[f32], y: &[f32]) -> f64 {
    x.iter().zip(y).map(|(x, y)| f64::from(*x) * f64::from(*y)).sum()
}

/// Between vectors of the flow and scaled unknowns of the modes.
pub(super) struct Modes<'a, const D: usize, const M: usize> {
    pub(super) modes: &'a TemporalModes,
    pub(super) matrix: &'a NodeBlocks<D, M>,
}

impl<const D: usize, const M: usize> Modes<'_, D, M> {
    /// c = (Q^-1 W^-1 (x) M^(-1/2) S^-1) r, times `scale`.
    pub(super) fn split(&self, r: &[f64], scale: f64, c: &Field) {
        let (layout, modes) = (self.matrix.layout, self.modes);
        let columns = layout.time_order;
        c.change(|cell, c| {
            for (node, c) in c.chunks_exact_mut(columns * M).enumerate() {
                for (number, c) in c.iter_mut().enumerate() {
                    let (column, m) = (number / M, number % M);
                    let at = |a: usize| modes.forward[(column, a)] * r[layout.index(cell, a, m, node)];
                    let sum: f64 = (0..columns).map(at).sum();
                    *c = (sum * scale * self.matrix.scale(cell, node, m)) as f32;
                }
            }
        });
    }

    /// z = (Q (x) M^(-1/2) S) c, times `scale`.
    pub(super) fn join(&self, c: &Field, scale: f64, z: &mut [f64]) {
        let (layout, modes) = (self.matrix.layout, self.modes);
        let columns = layout.time_order;
        z.par_chunks_exact_mut(layout.cell_len()).enumerate().with_min_len(16).for_each(|(cell, z)| {
            let c = c.read(cell);
            for (number, z) in z.iter_mut().enumerate() {
                let (a, m, node) = (number / layout.time_len(), number / layout.nodes % M, number % layout.nodes);
                let at = |column: usize| modes.backward[(a, column)] * f64::from(c[(node * columns + column) * M + m]);
                let sum: f64 = (0..columns).map(at).sum();
                *z = sum * scale * self.matrix.unknown(cell, node, m);
            }
        });
    }
}
