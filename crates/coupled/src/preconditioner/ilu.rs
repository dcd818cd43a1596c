//! The sweeps of the factored modes, all at once.

use super::blocks::{Link, links};
use super::face_traces::FaceTraces;
use super::factor::{factorise, stored_len};
use super::ordering::{Ordering, minimum_discarded_fill};
use super::panel::{Multiply, padded};
use basis::{TemporalModes, is_real};
use fem::{Layout, Pool, SpaceJacobian};
use rayon::prelude::*;
use tensor::Arch;

/// Bytes of factors that a task of a sweep reads at least: levels are short, and to share their cells out costs something too.
const GRAIN: usize = 1 << 16;

/// Block ILU(0) of every temporal mode of a slab.
///
/// Off-diagonal blocks are the same for all modes and kept in traces; everything is stored in single precision: the
/// iteration that uses it works in double, and loses nothing.
pub struct FlowPreconditioner {
    layout: Layout,
    modes: TemporalModes,
    jacobian: SpaceJacobian,
    links: Vec<Vec<Link>>,
    ordering: Ordering,
    /// Couplings in single precision, `[minus_plus, plus_minus]`, column-major with padded columns.
    couplings: Vec<[Vec<f32>; 2]>,
    inverses: Vec<Vec<f32>>,
    /// How traces are taken and sent back, for every face of a cell.
    faces: Vec<FaceTraces>,
    dt: f64,
    arch: Arch,
    scratch: Pool<Scratch>,
    /// Right-hand sides and results, `[position][column][padded row]`.
    panel: Vec<f32>,
    result: Vec<f32>,
}

impl FlowPreconditioner {
    /// Factors the modes of a slab of length `dt` around `jacobian`, damped by `damping` = dt / dtau. The order of
    /// elimination is found anew unless one is given.
    pub fn new(
        layout: Layout,
        modes: TemporalModes,
        jacobian: SpaceJacobian,
        dt: f64,
        damping: f64,
        ordering: Option<Ordering>,
    ) -> Self {
        let links = links(&jacobian, layout.cells);
        let ordering = ordering.unwrap_or_else(|| minimum_discarded_fill(&jacobian, &links, dt, modes.mean_shift()));
        let t = jacobian.traces.len();
        let couplings =
            (jacobian.couplings.par_iter()).map(|c| [single(&c.minus_plus, t), single(&c.plus_minus, t)]).collect();
        let (columns, rows) = (modes.forward.rows(), padded(jacobian.block));
        let faces = links.iter().flatten().map(|link| link.face + 1).max().unwrap_or(0);
        let size = layout.cells * columns * rows;
        let room = || vec![0.0; columns * padded(t)];
        let mut preconditioner = FlowPreconditioner {
            layout,
            modes,
            links,
            ordering,
            couplings,
            inverses: Vec::new(),
            faces: (0..faces).map(|face| FaceTraces::new(&jacobian.traces, face)).collect(),
            dt,
            arch: Arch::new(),
            scratch: Pool::new(|| Scratch { taken: room(), sent: room(), turned: vec![0.0; 2 * rows] }),
            panel: vec![0.0; size],
            result: vec![0.0; size],
            jacobian,
        };
        preconditioner.refactor(dt, damping);
        preconditioner
    }

    /// Factors anew for another slab length or damping, around the same Jacobian.
    pub fn refactor(&mut self, dt: f64, damping: f64) {
        self.dt = dt;
        let factor = |lambda: &faer::c64| factorise(&self.jacobian, &self.links, &self.ordering, dt, lambda + damping);
        self.inverses = self.modes.eigenvalues.iter().map(factor).collect();
    }

    /// The order of elimination.
    pub fn ordering(&self) -> &Ordering {
        &self.ordering
    }

    /// The Jacobian that the modes are made of.
    pub(super) fn jacobian(&self) -> &SpaceJacobian {
        &self.jacobian
    }

    /// The couplings of every cell.
    pub(super) fn links(&self) -> &[Vec<Link>] {
        &self.links
    }

    /// Bytes held by factors and couplings.
    pub fn bytes(&self) -> usize {
        let couplings: usize = self.couplings.iter().flatten().map(Vec::len).sum();
        self.swept_bytes() + 8 * (self.jacobian.diagonal.len() + self.jacobian.mass.len()) + 8 * couplings
    }

    /// Bytes that an application reads: factors and couplings in single precision.
    pub fn swept_bytes(&self) -> usize {
        let couplings: usize = self.couplings.iter().flatten().map(Vec::len).sum();
        let factors: usize = self.inverses.iter().map(Vec::len).sum();
        4 * (couplings + factors)
    }

    /// z = P^{-1} r.
    pub fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        let scale = r.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        if scale == 0.0 {
            z.fill(0.0);
            return;
        }
        self.split_into_modes(r, 1.0 / scale);
        self.forward_sweep();
        self.backward_sweep();
        self.join_modes(scale, z);
    }

    /// Cells of a level that a thread takes at least.
    fn cells_per_task(&self) -> usize {
        let factors: usize = self.inverses.iter().map(Vec::len).sum();
        GRAIN.div_ceil(4 * factors / self.layout.cells)
    }

    /// Length of one cell's panel.
    fn panel_len(&self) -> usize {
        self.modes.forward.rows() * padded(self.jacobian.block)
    }

    /// c = (Q^{-1} W^{-1} (x) I) r, scaled so that single precision does not underflow.
    fn split_into_modes(&mut self, r: &[f64], scale: f64) {
        let (n, len) = (self.jacobian.block, self.panel_len());
        let (layout, forward, cells) = (self.layout, &self.modes.forward, &self.ordering.cells);
        self.panel.par_chunks_exact_mut(len).zip(cells).with_min_len(16).for_each(|(panel, &cell)| {
            for (column, panel) in panel.chunks_exact_mut(padded(n)).enumerate() {
                panel.fill(0.0);
                for a in 0..layout.time_order {
                    let weight = forward[(column, a)] * scale;
                    let r = &r[layout.cell_at(cell, a)];
                    panel.iter_mut().zip(r).for_each(|(c, r)| *c += (weight * r) as f32);
                }
            }
        });
    }

    /// z = (Q (x) I) c.
    fn join_modes(&self, scale: f64, z: &mut [f64]) {
        let (n, len) = (self.jacobian.block, self.panel_len());
        let (layout, backward, positions) = (self.layout, &self.modes.backward, &self.ordering.positions);
        z.par_chunks_exact_mut(layout.cell_len()).enumerate().with_min_len(16).for_each(|(cell, z)| {
            let panel = &self.result[positions[cell] * len..(positions[cell] + 1) * len];
            for (a, z) in z.chunks_exact_mut(n).enumerate() {
                z.fill(0.0);
                for (column, panel) in panel.chunks_exact(padded(n)).enumerate() {
                    let weight = backward[(a, column)] * scale;
                    z.iter_mut().zip(panel).for_each(|(z, c)| *z += weight * f64::from(*c));
                }
            }
        });
    }

    /// z_i = D_i^{-1} (c_i - sum_{k before i} dt A_ik z_k), level by level.
    fn forward_sweep(&mut self) {
        let (len, grain) = (self.panel_len(), self.cells_per_task());
        let (mut panel, mut result) = (std::mem::take(&mut self.panel), std::mem::take(&mut self.result));
        let mut start = 0;
        for &end in &self.ordering.level_ends {
            let (done, rest) = result.split_at_mut(start * len);
            let rows = rest[..(end - start) * len]
                .par_chunks_exact_mut(len)
                .zip(panel[start * len..].par_chunks_exact_mut(len));
            rows.enumerate().with_min_len(grain).for_each(|(i, (z, c))| {
                let position = start + i;
                self.subtract(position, |k| (k < position).then(|| &done[k * len..(k + 1) * len]), c);
                z.fill(0.0);
                self.add_inverse(position, c, z);
            });
            start = end;
        }
        (self.panel, self.result) = (panel, result);
    }

    /// x_i = z_i - D_i^{-1} sum_{k after i} dt A_ik x_k, from the last level to the first.
    fn backward_sweep(&mut self) {
        let (len, grain) = (self.panel_len(), self.cells_per_task());
        let (mut panel, mut result) = (std::mem::take(&mut self.panel), std::mem::take(&mut self.result));
        for (level, &end) in self.ordering.level_ends.iter().enumerate().rev() {
            let start = if level == 0 { 0 } else { self.ordering.level_ends[level - 1] };
            let (before, done) = result.split_at_mut(end * len);
            let rows =
                before[start * len..].par_chunks_exact_mut(len).zip(panel[start * len..].par_chunks_exact_mut(len));
            rows.enumerate().with_min_len(grain).for_each(|(i, (x, c))| {
                let position = start + i;
                c.fill(0.0);
                if self.subtract(position, |k| (k >= end).then(|| &done[(k - end) * len..(k - end + 1) * len]), c) {
                    self.add_inverse(position, c, x);
                }
            });
        }
        (self.panel, self.result) = (panel, result);
    }

    /// c -= sum dt A_ik x_k over the neighbours k whose x is given by `neighbour`; whether there was any.
    fn subtract<'a>(&self, position: usize, neighbour: impl Fn(usize) -> Option<&'a [f32]>, c: &mut [f32]) -> bool {
        let (rows, columns) = (padded(self.jacobian.block), self.modes.forward.rows());
        let t = padded(self.jacobian.traces.len());
        let mut any = false;
        self.scratch.with(|Scratch { taken, sent, .. }| {
            for link in &self.links[self.ordering.cells[position]] {
                let Some(x) = neighbour(self.ordering.positions[link.cell]) else { continue };
                any = true;
                for (x, taken) in x.chunks_exact(rows).zip(taken.chunks_exact_mut(t)) {
                    self.faces[link.other_face].take(x, taken);
                }
                sent.fill(0.0);
                let matrix = &self.couplings[link.coupling][link.side];
                self.arch.dispatch(Multiply { matrix, rows: t, columns, x: taken, y: sent });
                for (sent, c) in sent.chunks_exact(t).zip(c.chunks_exact_mut(rows)) {
                    self.faces[link.face].subtract(self.dt as f32, sent, c);
                }
            }
        });
        any
    }

    /// x += D^{-1} c, mode by mode.
    fn add_inverse(&self, position: usize, c: &[f32], x: &mut [f32]) {
        let (n, rows) = (self.jacobian.block, padded(self.jacobian.block));
        let mut first = 0;
        for (lambda, inverses) in self.modes.eigenvalues.iter().zip(&self.inverses) {
            let (len, columns) = (stored_len(n, *lambda), if is_real(*lambda) { 1 } else { 2 });
            let inverse = &inverses[position * len..(position + 1) * len];
            let range = first * rows..(first + columns) * rows;
            let (c, x) = (&c[range.clone()], &mut x[range]);
            self.arch.dispatch(Multiply { matrix: &inverse[..rows * n], rows, columns, x: c, y: x });
            if columns == 2 {
                // i (re + i im) = - im + i re
                self.scratch.with(|Scratch { turned, .. }| {
                    turned[rows..].copy_from_slice(&c[..rows]);
                    turned[..rows].iter_mut().zip(&c[rows..]).for_each(|(turned, im)| *turned = -im);
                    self.arch.dispatch(Multiply { matrix: &inverse[rows * n..], rows, columns, x: turned, y: x });
                });
            }
            first += columns;
        }
    }
}

/// Room for the traces of a panel, `[column][padded trace]`, and for a complex column.
struct Scratch {
    taken: Vec<f32>,
    sent: Vec<f32>,
    turned: Vec<f32>,
}

/// A row-major square matrix of order `n` in single precision, column-major with padded columns.
fn single(matrix: &[f64], n: usize) -> Vec<f32> {
    let mut stored = vec![0.0; padded(n) * n];
    for (j, column) in stored.chunks_exact_mut(padded(n)).enumerate() {
        (0..n).for_each(|i| column[i] = matrix[i * n + j] as f32);
    }
    stored
}
