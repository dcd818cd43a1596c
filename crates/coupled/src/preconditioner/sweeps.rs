//! The two sweeps, over all modes at once.

use super::couplings::Step;
use super::ilu::{FlowPreconditioner, Scratch};
use super::panel::{Multiply, MultiplyComplex, padded};
use rayon::prelude::*;

impl FlowPreconditioner {
    /// z_i = D_i^{-1} (c_i - sum_{k before i} dt A_ik z_k), level by level.
    pub(super) fn forward_sweep(&mut self) {
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
                self.subtract(self.couplings.earlier(position), done, 0, c);
                z.fill(0.0);
                self.add_inverse(position, c, z);
            });
            start = end;
        }
        (self.panel, self.result) = (panel, result);
    }

    /// x_i = z_i - D_i^{-1} sum_{k after i} dt A_ik x_k, from the last level to the first.
    pub(super) fn backward_sweep(&mut self) {
        let (len, grain) = (self.panel_len(), self.cells_per_task());
        let (mut panel, mut result) = (std::mem::take(&mut self.panel), std::mem::take(&mut self.result));
        for (level, &end) in self.ordering.level_ends.iter().enumerate().rev() {
            let start = if level == 0 { 0 } else { self.ordering.level_ends[level - 1] };
            let (before, done) = result.split_at_mut(end * len);
            let rows =
                before[start * len..].par_chunks_exact_mut(len).zip(panel[start * len..].par_chunks_exact_mut(len));
            rows.enumerate().with_min_len(grain).for_each(|(i, (x, c))| {
                let steps = self.couplings.later(start + i);
                if !steps.is_empty() {
                    c.fill(0.0);
                    self.subtract(steps, done, end, c);
                    self.add_inverse(start + i, c, x);
                }
            });
        }
        (self.panel, self.result) = (panel, result);
    }

    /// c -= sum dt A_ik x_k over the neighbours k of `steps`; `done` holds x from position `first` on.
    fn subtract(&self, steps: &[Step], done: &[f32], first: usize, c: &mut [f32]) {
        let (rows, columns, len) = (padded(self.jacobian.block), self.modes.forward.rows(), self.panel_len());
        let t = self.couplings.rows();
        self.scratch.with(|Scratch { taken, sent }| {
            for step in steps {
                let x = &done[(step.neighbour - first) * len..][..len];
                for (x, taken) in x.chunks_exact(rows).zip(taken.chunks_exact_mut(t)) {
                    self.faces[step.other_face].take(x, taken);
                }
                sent.fill(0.0);
                self.arch.dispatch(Multiply {
                    matrix: self.couplings.block(step),
                    rows: t,
                    columns,
                    x: taken,
                    y: sent,
                });
                for (sent, c) in sent.chunks_exact(t).zip(c.chunks_exact_mut(rows)) {
                    self.faces[step.face].subtract(self.dt as f32, sent, c);
                }
            }
        });
    }

    /// x += D^{-1} c, mode by mode.
    fn add_inverse(&self, position: usize, c: &[f32], x: &mut [f32]) {
        let rows = padded(self.jacobian.block);
        let (mut first, mut stored) = (0, self.inverses(position));
        for shape in self.shapes() {
            let (matrix, rest) = stored.split_at(shape.len());
            let range = first * rows..(first + shape.parts) * rows;
            let (x, y) = (&c[range.clone()], &mut x[range]);
            if shape.parts == 1 {
                self.arch.dispatch(Multiply { matrix, rows, columns: 1, x, y });
            } else {
                self.arch.dispatch(MultiplyComplex { matrix, x, y });
            }
            first += shape.parts;
            stored = rest;
        }
    }
}
