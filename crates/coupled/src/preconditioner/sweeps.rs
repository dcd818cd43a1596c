//! The two sweeps, over all modes at once.

use super::couplings::Step;
use super::halves::{COLUMNS, MultiplyHalves, of_real, panels};
use super::ilu::{FlowPreconditioner, Scratch};
use super::panel::padded;
use super::wavefront::wavefront;
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

impl FlowPreconditioner {
    /// The forward sweep, position by position, and the backward sweep, from the last position to the first.
    pub(super) fn sweep(&self) {
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
        wavefront(2 * cells, self.ordering.widest_level(), needs, |k| {
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
        let (t, traces) = (self.couplings.rows(), self.jacobian.traces.len());
        self.scratch.with(|Scratch { taken, sent, .. }| {
            for step in steps {
                let neighbour = self.swept[step.neighbour].read();
                for (x, taken) in neighbour.result.chunks_exact(rows).zip(taken.chunks_exact_mut(t)) {
                    self.faces[step.other_face].take(x, taken);
                }
                sent.fill(0.0);
                let matrix = self.couplings.block(step);
                for (x, y) in taken.chunks(COLUMNS * t).zip(sent.chunks_mut(COLUMNS * t)) {
                    let columns = x.len() / t;
                    let x = std::array::from_fn::<_, COLUMNS, _>(|c| of_real(&x[c.min(columns - 1) * t..], traces));
                    self.arch.dispatch(MultiplyHalves { matrix, x: &x[..columns], y });
                }
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
            let (matrix, rest) = stored.split_at(panels(shape).len());
            let range = first * rows..(first + shape.parts) * rows;
            let (c, y) = (&c[range.clone()], &mut x[range]);
            if shape.parts == 1 {
                self.arch.dispatch(MultiplyHalves { matrix, x: &[of_real(c, shape.n)], y });
            } else {
                let (re, im) = c.split_at(rows);
                self.scratch.with(|Scratch { minus, .. }| {
                    minus.iter_mut().zip(im).for_each(|(minus, im)| *minus = -im);
                    self.arch.dispatch(MultiplyHalves { matrix, x: &[[re, minus], [im, re]], y });
                });
            }
            first += shape.parts;
            stored = rest;
        }
    }
}
