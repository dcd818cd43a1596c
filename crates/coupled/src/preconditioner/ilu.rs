//! The sweeps of the factored modes, all at once.

use super::blocks::{Link, links};
use super::factor::{factorise, stored_len};
use super::ordering::{Ordering, minimum_discarded_fill};
use super::panel::{Multiply, MultiplyComplex, padded};
use basis::{TemporalModes, is_real};
use fem::{Layout, SpaceJacobian};
use rayon::prelude::*;
use tensor::pulp::Arch;

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
    dt: f64,
    arch: Arch,
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
        let size = layout.cells * modes.forward.rows() * padded(jacobian.block);
        let mut preconditioner = FlowPreconditioner {
            layout,
            modes,
            links,
            ordering,
            couplings,
            inverses: Vec::new(),
            dt,
            arch: Arch::new(),
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

    /// Bytes held by factors and couplings.
    pub fn bytes(&self) -> usize {
        let couplings: usize = self.couplings.iter().flatten().map(Vec::len).sum();
        let factors: usize = self.inverses.iter().map(Vec::len).sum();
        4 * (couplings + factors) + 8 * (self.jacobian.diagonal.len() + self.jacobian.mass.len()) + 8 * couplings
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
        let len = self.panel_len();
        let (mut panel, mut result) = (std::mem::take(&mut self.panel), std::mem::take(&mut self.result));
        let mut start = 0;
        for &end in &self.ordering.level_ends {
            let (done, rest) = result.split_at_mut(start * len);
            let rows = rest[..(end - start) * len]
                .par_chunks_exact_mut(len)
                .zip(panel[start * len..].par_chunks_exact_mut(len));
            rows.enumerate().with_min_len(4).for_each(|(i, (z, c))| {
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
        let len = self.panel_len();
        let (mut panel, mut result) = (std::mem::take(&mut self.panel), std::mem::take(&mut self.result));
        for (level, &end) in self.ordering.level_ends.iter().enumerate().rev() {
            let start = if level == 0 { 0 } else { self.ordering.level_ends[level - 1] };
            let (before, done) = result.split_at_mut(end * len);
            let rows =
                before[start * len..].par_chunks_exact_mut(len).zip(panel[start * len..].par_chunks_exact_mut(len));
            rows.enumerate().with_min_len(4).for_each(|(i, (x, c))| {
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
        let (n, traces) = (self.jacobian.block, &self.jacobian.traces);
        let t = padded(traces.len());
        let mut any = false;
        let (mut taken, mut sent) = ([0.0_f32; MAX_TRACES], [0.0_f32; MAX_TRACES]);
        for link in &self.links[self.ordering.cells[position]] {
            let Some(x) = neighbour(self.ordering.positions[link.cell]) else { continue };
            any = true;
            for (x, c) in x.chunks_exact(padded(n)).zip(c.chunks_exact_mut(padded(n))) {
                for (trace, taken) in taken[..traces.len()].iter_mut().enumerate() {
                    let (offset, functional) = traces.functional(link.other_face, trace);
                    *taken = functional.iter().map(|&(node, w)| w as f32 * x[offset + node]).sum();
                }
                sent[..t].fill(0.0);
                let matrix = &self.couplings[link.coupling][link.side];
                self.arch.dispatch(Multiply { matrix, x: &taken[..traces.len()], y: &mut sent[..t] });
                for (trace, sent) in sent[..traces.len()].iter().enumerate() {
                    let (offset, functional) = traces.functional(link.face, trace);
                    functional.iter().for_each(|&(node, w)| c[offset + node] -= self.dt as f32 * w as f32 * sent);
                }
            }
        }
        any
    }

    /// x += D^{-1} c, mode by mode.
    fn add_inverse(&self, position: usize, c: &[f32], x: &mut [f32]) {
        let (n, rows) = (self.jacobian.block, padded(self.jacobian.block));
        let mut column = 0;
        for (lambda, inverses) in self.modes.eigenvalues.iter().zip(&self.inverses) {
            let len = stored_len(n, *lambda);
            let inverse = &inverses[position * len..(position + 1) * len];
            let (c, x) = (&c[column * rows..], &mut x[column * rows..]);
            if is_real(*lambda) {
                self.arch.dispatch(Multiply { matrix: inverse, x: &c[..n], y: &mut x[..rows] });
                column += 1;
            } else {
                let (re, im) = inverse.split_at(rows * n);
                let (x_re, x_im) = (&c[..n], &c[rows..rows + n]);
                let (y_re, y_im) = x[..2 * rows].split_at_mut(rows);
                self.arch.dispatch(MultiplyComplex { re, im, x_re, x_im, y_re, y_im });
                column += 2;
            }
        }
    }
}

/// Traces of a face, at most: two kinds of five components at 16 x 16 nodes.
const MAX_TRACES: usize = 2 * 5 * 256;

/// A row-major square matrix of order `n` in single precision, column-major with padded columns.
fn single(matrix: &[f64], n: usize) -> Vec<f32> {
    let mut stored = vec![0.0; padded(n) * n];
    for (j, column) in stored.chunks_exact_mut(padded(n)).enumerate() {
        (0..n).for_each(|i| column[i] = matrix[i * n + j] as f32);
    }
    stored
}
