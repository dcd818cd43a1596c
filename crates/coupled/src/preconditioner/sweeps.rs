//! The two sweeps, over all modes at once.

use super::bf16_blocks::{self, MultiplyBf16};
use super::couplings::Step;
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
        // Ghosts matter for later stages on the way forward, and for earlier ones on the way back.
        let (stages, last) = (&self.ordering.stages, self.ordering.stages.len() - 1);
        for (number, stage) in stages.iter().enumerate() {
            let Stage { own, .. } = stage;
            let needs = |k: usize| {
                let neighbours = self.couplings.earlier(own.start + k).iter().map(|step| step.neighbour);
                neighbours.filter_map(|neighbour| neighbour.checked_sub(own.start))
            };
            dependency_schedule(own.len(), self.ordering.widest_level(), needs, |k| self.eliminate(own.start + k));
            if number < last {
                self.exchange(stage);
            }
        }
        for (number, stage) in stages.iter().enumerate().rev() {
            let Stage { own, .. } = stage;
            let needs = |k: usize| {
                let neighbours = self.couplings.later(own.end - 1 - k).iter().map(|step| step.neighbour);
                neighbours.filter(|neighbour| *neighbour < own.end).map(|neighbour| own.end - 1 - neighbour)
            };
            dependency_schedule(own.len(), self.ordering.widest_level(), needs, |k| self.substitute(own.end - 1 - k));
            if number > 0 {
                self.exchange(stage);
            }
        }
    }

    /// Sends the results of own cells of a stage to the ranks where they are ghosts, and receives those of ghosts.
    fn exchange(&self, stage: &Stage) {
        let positions = &self.ordering.positions;
        let len = self.modes.forward.rows() * padded(self.jacobian.block);
        let is_in_stage = |cell: usize| (stage.own.start..stage.ghosts.end).contains(&positions[cell]);
        let send = |cell: usize, out: &mut Vec<f64>| singles::pack(&self.swept[positions[cell]].read().result, out);
        self.share.exchange_some(is_in_stage, singles::packed(len), send, |ghost, message| {
            singles::unpack(message, &mut self.swept[positions[ghost]].write().result);
        });
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
                let neighbour = self.swept[step.neighbour].read();
                for (x, taken) in neighbour.result.chunks_exact(rows).zip(taken.chunks_exact_mut(t)) {
                    self.faces[step.other_face].take(x, taken);
                }
                sent.fill(0.0);
                let matrix = self.couplings.block(step);
                self.arch.dispatch(MultiplyBf16 { matrix, columns, half, x: taken, y: sent });
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
