//! The two sweeps, over all modes at once.

use super::bf16_blocks::{self, MultiplyBf16};
use super::couplings::Step;
use super::cuts::{Crossing, Cuts, Exchange};
use super::factor::lock;
use super::ilu::{BlockIlu, Scratch};
use super::ordering::Stage;
use super::panel::padded;
use super::singles;
use fem::Stored;
use sparse::dependency_schedule;
use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

/// What the sweeps keep of a cell, `[column][padded row]`.
pub(super) struct Swept {
    /// The right-hand side c.
    pub(super) right_side: Vec<f32>,
    /// z, and then x.
    pub(super) result: Vec<f32>,
}

/// [`Swept`] of one cell. Threads never meet here: each writes its own cell, and reads cells that are done.
pub(super) struct Shared(RwLock<Swept>);

impl Shared {
    /// Room for `len` numbers.
    pub(super) fn new(len: usize) -> Self {
        Shared(RwLock::new(Swept { right_side: vec![0.0; len], result: vec![0.0; len] }))
    }
    pub(super) fn get(&mut self) -> &mut Swept {
        self.0.get_mut().unwrap_or_else(PoisonError::into_inner)
    }
    pub(super) fn read(&self) -> RwLockReadGuard<'_, Swept> {
        self.0.read().unwrap_or_else(PoisonError::into_inner)
    }
    fn write(&self) -> RwLockWriteGuard<'_, Swept> {
        self.0.write().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Stored> BlockIlu<T> {
    /// The forward sweep, position by position, and the backward sweep, from the last position to the first.
    pub(super) fn sweep(&self) {
        if let [_] = self.ordering.stages[..] {
            return self.sweep_at_once();
        }
        let (stages, Cuts { forward, backward, .. }) = (&self.ordering.stages, &self.cuts);
        for (stage, exchange) in stages.iter().zip(forward) {
            let Stage { own, .. } = stage;
            let needs = |k: usize| {
                let neighbours = self.couplings.earlier(own.start + k).iter().map(|step| step.neighbour);
                neighbours.filter_map(|neighbour| neighbour.checked_sub(own.start))
            };
            dependency_schedule(own.len(), self.ordering.widest_level(), needs, |k| self.eliminate(own.start + k));
            self.exchange(exchange);
        }
        for (stage, exchange) in stages.iter().zip(backward).rev() {
            let Stage { own, .. } = stage;
            let needs = |k: usize| {
                let neighbours = self.couplings.later(own.end - 1 - k).iter().map(|step| step.neighbour);
                neighbours.filter(|neighbour| *neighbour < own.end).map(|neighbour| own.end - 1 - neighbour)
            };
            dependency_schedule(own.len(), self.ordering.widest_level(), needs, |k| self.substitute(own.end - 1 - k));
            self.exchange(exchange);
        }
    }

    /// Sends the traces of results at cuts, and receives those of ghosts.
    fn exchange(&self, exchange: &Exchange) {
        let (t, columns) = (self.jacobian.traces.len(), self.modes.forward.rows());
        let pack = |crossing: &Crossing, out: &mut Vec<f64>| {
            let mut traces = vec![0.0; columns * t];
            self.take(self.ordering.positions[crossing.own], crossing.own_face, &mut traces);
            singles::pack(&traces, out);
        };
        exchange.run(&self.share, singles::packed(columns * t), pack, |crossing, message| {
            let mut traces = vec![0.0; columns * t];
            singles::unpack(message, &mut traces);
            let mut received = lock(&self.received[crossing.coupling]);
            let padded = received.chunks_exact_mut(self.couplings.rows());
            padded.zip(traces.chunks_exact(t)).for_each(|(padded, traces)| padded[..t].copy_from_slice(traces));
        });
    }

    /// The traces of the result at `position` on a face of its cell, one column after the other in chunks of equal length.
    fn take(&self, position: usize, face: usize, traces: &mut [f32]) {
        let swept = self.swept[position].read();
        let (rows, stride) = (padded(self.jacobian.block), traces.len() / self.modes.forward.rows());
        for (x, traces) in swept.result.chunks_exact(rows).zip(traces.chunks_exact_mut(stride)) {
            self.faces[face].take(x, traces);
        }
    }

    /// Both sweeps, where one block has all cells: the backward sweep begins before the forward one has ended.
    fn sweep_at_once(&self) {
        let cells = self.swept.len();
        // Number k is position k of the forward sweep, or position 2 `cells` - 1 - k of the backward sweep.
        let number_back = |position: usize| 2 * cells - 1 - position;
        let needs = |k: usize| {
            let forward = k < cells;
            let steps = if forward { self.couplings.earlier(k) } else { self.couplings.later(number_back(k)) };
            let neighbours = steps.iter().map(|step| step.neighbour);
            let own = (!forward).then(|| number_back(k));
            neighbours.map(move |neighbour| if forward { neighbour } else { number_back(neighbour) }).chain(own)
        };
        dependency_schedule(2 * cells, self.ordering.widest_level(), needs, |k| {
            if k < cells { self.eliminate(k) } else { self.substitute(number_back(k)) }
        });
    }

    /// z_i = D_i^{-1} (c_i - sum_{k before i} dt A_ik z_k).
    fn eliminate(&self, position: usize) {
        let mut here = self.swept[position].write();
        let Swept { right_side, result } = &mut *here;
        self.subtract(self.couplings.earlier(position), right_side);
        result.fill(0.0);
        self.add_inverse(position, right_side, result);
    }

    /// x_i = z_i - D_i^{-1} sum_{k after i} dt A_ik x_k.
    fn substitute(&self, position: usize) {
        let steps = self.couplings.later(position);
        if !steps.is_empty() {
            let mut here = self.swept[position].write();
            let Swept { right_side, result } = &mut *here;
            right_side.fill(0.0);
            self.subtract(steps, right_side);
            self.add_inverse(position, right_side, result);
        }
    }

    /// c -= sum dt A_ik x_k over the neighbours k of `steps`.
    fn subtract(&self, steps: &[Step], c: &mut [f32]) {
        let rows = padded(self.jacobian.block);
        let (t, columns) = (self.couplings.rows(), self.modes.forward.rows());
        let half = self.jacobian.traces.len().div_ceil(2);
        self.scratch.with(|Scratch { taken, sent, .. }| {
            for step in steps {
                if self.ordering.cells[step.neighbour] < self.layout.cells {
                    self.take(step.neighbour, step.other_face, taken);
                } else {
                    taken.copy_from_slice(&lock(&self.received[self.couplings.number(step)]));
                }
                sent.fill(0.0);
                for matrix in self.couplings.block(step) {
                    self.arch.dispatch(MultiplyBf16 { matrix, columns, half, x: taken, y: sent });
                }
                for (sent, c) in sent.chunks_exact(t).zip(c.chunks_exact_mut(rows)) {
                    self.faces[step.face].subtract(self.dt as f32, sent, c);
                }
            }
        });
    }

    /// x += D^{-1} c, term by term.
    fn add_inverse(&self, position: usize, c: &[f32], x: &mut [f32]) {
        self.inverses(position).for_each(|term| self.add_term(term, c, x));
    }

    /// x += D^{-1} c with the `stored` term of D^{-1}, mode by mode.
    fn add_term(&self, mut stored: &[u32], c: &[f32], x: &mut [f32]) {
        let rows = padded(self.jacobian.block);
        let mut first = 0;
        for shape in self.shapes() {
            let (matrix, rest) = stored.split_at(bf16_blocks::panels(shape).len());
            let range = first * rows..(first + shape.parts) * rows;
            let (c, y) = (&c[range.clone()], &mut x[range]);
            if shape.parts == 1 {
                let half = shape.n.div_ceil(2);
                self.arch.dispatch(MultiplyBf16 { matrix, columns: 1, half, x: c, y });
            } else {
                self.scratch.with(|Scratch { turned, .. }| {
                    turn(c, turned);
                    self.arch.dispatch(MultiplyBf16 { matrix, columns: 2, half: rows, x: turned, y });
                });
            }
            first += shape.parts;
            stored = rest;
        }
    }
}

/// The columns (re, -im) and (im, re) of the vector (re, im).
fn turn(vector: &[f32], turned: &mut [f32]) {
    let rows = vector.len() / 2;
    let (first, second) = turned.split_at_mut(2 * rows);
    first.copy_from_slice(vector);
    first[rows..].iter_mut().for_each(|im| *im = -*im);
    second[..rows].copy_from_slice(&vector[rows..]);
    second[rows..].copy_from_slice(&vector[..rows]);
}
