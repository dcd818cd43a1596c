//! The block ILU(0) of lambda M + dt A for all shifts lambda.
//!
//! ```text
//! D_i = lambda M_i + dt A_ii - sum_{k before i} dt^2 A_ik D_k^{-1} A_ki                                             (d-ilu)
//! ```
//!
//! Cells of a quadrilateral or hexahedral mesh that are neighbours share no third neighbour, so that only the diagonal
//! changes; around an irregular vertex the fill is dropped. Where two cells share two facets, each facet is taken alone. All is done in single
//! precision; D^{-1} is stored in [`bf16_blocks`]. Rounding it by a part eps changes D^{-1} D by up to eps g,
//!
//! ```text
//! g = max_i sum_jk |(D^{-1})_ij| |D_jk| u_k / u_i                                                                 (growth)
//! ```
//!
//! with the scales u of the unknowns. Thin viscous cells, free at both ends of the short axis, are stiff across and soft along it: g is large.

use super::bf16_blocks;
use super::blocks::{Link, coupling_block};
use super::cuts::{Crossing, Cuts, Exchange};
use super::face_traces::FaceTraces;
use super::inverse::{Shape, invert};
use super::ordering::{Ordering, Stage};
use super::panel::padded;
use super::singles;
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par, c64};
use fem::{PerThread, Share, SpaceJacobian, Stored};
use sparse::dependency_schedule;
use std::sync::atomic::{AtomicU32, Ordering as Atomic};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tensor::Arch;

/// What the factors are made of.
pub struct Elimination<'a, T> {
    /// A and M.
    pub jacobian: &'a SpaceJacobian<T>,
    /// The neighbours of every cell.
    pub links: &'a [Vec<Link>],
    /// The order of elimination.
    pub ordering: &'a Ordering,
    /// The cells of this rank.
    pub share: &'a Share,
    /// The couplings to other ranks.
    pub cuts: &'a Cuts,
    /// The traces on every face.
    pub faces: &'a [FaceTraces],
    /// The length of the slab.
    pub dt: f64,
    /// The shifts lambda.
    pub shifts: &'a [c64],
    /// The scale of every unknown of a cell.
    pub scales: &'a [f32],
    /// How many numbers in bfloat16 the entries of D^{-1} are the sums of.
    pub terms: usize,
    /// The largest (growth) so far.
    pub growth: AtomicU32,
}

/// What the elimination of a cell subtracts from D of a later one: a matrix in the traces of one of its faces.
struct Update {
    /// Where it comes in the order of updates: the stage of the eliminated cell; whether it is in another block; its position there, or the
    /// number of the coupling. This order is the same on any number of ranks.
    from: (usize, bool, usize),
    /// The position of the later cell.
    position: usize,
    /// The coupling of the two.
    coupling: usize,
    mode: usize,
    face: usize,
    /// Column-major parts.
    parts: Vec<Vec<f32>>,
}

/// What is to be subtracted from D at every position.
type Updates = Vec<Mutex<Vec<Update>>>;

impl<T: Stored> Elimination<'_, T> {
    /// The blocks D of a mode.
    pub fn shape(block: usize, shift: c64) -> Shape {
        Shape::shifted(block, shift)
    }

    /// D_i^{-1} of all modes in [`bf16_blocks`], own cell by own cell in the order of positions.
    pub fn factorise(&self, inverses: &mut [u32]) {
        let len = inverses.len() / self.share.own.len();
        let stored: Vec<Mutex<&mut [u32]>> = inverses.chunks_exact_mut(len).map(Mutex::new).collect();
        let updates: Updates = self.links.iter().map(|_| Mutex::default()).collect();
        for (stage, exchange) in self.ordering.stages.iter().zip(&self.cuts.forward) {
            self.factorise_stage(stage, &stored, &updates);
            self.exchange(exchange, &updates);
        }
    }

    fn factorise_stage(&self, stage: &Stage, stored: &[Mutex<&mut [u32]>], updates: &Updates) {
        let scratch = PerThread::new(Vec::new);
        let Stage { own, .. } = stage;
        let needs = |k: usize| {
            let links = self.links[self.ordering.cells[own.start + k]].iter();
            let others =
                links.map(|link| self.ordering.positions[link.cell]).filter(move |other| *other < own.start + k);
            others.filter_map(|other| other.checked_sub(own.start))
        };
        dependency_schedule(own.len(), self.ordering.widest_level(), needs, |k| {
            let position = own.start + k;
            let mut mine = std::mem::take(&mut *lock(&updates[position]));
            // Threads deliver the updates in an undefined order.
            mine.sort_by_key(|update| update.from);
            let stored = &stored[self.ordering.among_own(position)];
            let new = scratch.with(|block| self.cell(position, &mine, block, &mut lock(stored)));
            new.into_iter().for_each(|update| lock(&updates[update.position]).push(update));
        });
    }

    /// Stores the inverses of the cell at `position`; returns what it subtracts from later ones.
    fn cell(&self, position: usize, updates: &[Update], block: &mut Vec<f32>, stored: &mut [u32]) -> Vec<Update> {
        let (mut new, mut at) = (Vec::new(), 0);
        for (mode, &shift) in self.shifts.iter().enumerate() {
            let shape = Self::shape(self.jacobian.block, shift);
            self.diagonal(position, shift, block);
            for update in updates.iter().filter(|update| update.mode == mode) {
                for (part, update_part) in update.parts.iter().enumerate() {
                    let d = &mut block[part * padded(shape.n)..];
                    self.faces[update.face].subtract_lifted(update_part, shape.n, shape.stride(), d);
                }
            }
            let sizes = row_sums(shape, block, self.scales);
            invert(Arch::new(), shape, block);
            self.note_growth(&row_sums(shape, block, &sizes));
            self.fill(position, mode, shape, block, &mut new);
            let len = bf16_blocks::panels(shape).len();
            let terms = stored.chunks_exact_mut(stored.len() / self.terms);
            bf16_blocks::store_in_terms(shape, block, terms.map(|term| &mut term[at..at + len]));
            at += len;
        }
        new
    }

    /// (growth)
    fn note_growth(&self, grown: &[f32]) {
        // The bits of positive numbers are in the order of the numbers, and those of NaN above.
        let bits = grown.iter().zip(self.scales).map(|(grown, scale)| (grown / scale).abs().to_bits());
        self.growth.fetch_max(bits.max().unwrap_or(0), Atomic::Relaxed);
    }

    /// lambda M + dt A_ii of the cell at `position`.
    fn diagonal(&self, position: usize, shift: c64, block: &mut Vec<f32>) {
        let shape = Self::shape(self.jacobian.block, shift);
        let (n, nodes, cell) = (shape.n, self.jacobian.traces.nodes, self.ordering.cells[position]);
        let (rows, stride) = (padded(n), shape.stride());
        block.clear();
        block.resize(shape.len(), 0.0);
        let (a, mass) = (self.jacobian.block_of(cell).chunks_exact(n), self.jacobian.mass_of(cell));
        for (j, (column, a)) in block.chunks_exact_mut(stride).zip(a).enumerate() {
            column.iter_mut().zip(a).for_each(|(column, a)| *column = (self.dt * (*a).into()) as f32);
            let (component, m) = (j / nodes * nodes, &mass[j % nodes * nodes..][..nodes]);
            for (part, lambda) in [shift.re, shift.im].into_iter().take(shape.parts).enumerate() {
                let d = &mut column[part * rows + component..][..nodes];
                d.iter_mut().zip(m).for_each(|(d, m)| *d += (lambda * (*m).into()) as f32);
            }
        }
    }

    /// dt^2 A_jk D_k^{-1} A_kj for the later neighbours j of the cell k at `position`.
    fn fill(&self, position: usize, mode: usize, shape: Shape, inverse: &[f32], new: &mut Vec<Update>) {
        let links = &self.links[self.ordering.cells[position]];
        for link in links.iter().filter(|link| self.ordering.positions[link.cell] > position) {
            let there = single(coupling_block(self.jacobian, *link));
            let back = single(coupling_block(self.jacobian, Link { side: 1 - link.side, ..*link }));
            let part = |part: usize| {
                let inverse = &inverse[part * padded(shape.n)..];
                let inner = self.faces[link.face].of_matrix(inverse, shape.n, shape.stride());
                product([&back, &inner, &there], self.jacobian.traces.len(), self.dt as f32)
            };
            new.push(Update {
                from: self.from(position, link),
                coupling: link.coupling,
                position: self.ordering.positions[link.cell],
                mode,
                face: link.other_face,
                parts: (0..shape.parts).map(part).collect(),
            });
        }
    }

    /// The place of an update from the cell at `position` along `link`, see [`Update`].
    fn from(&self, position: usize, link: &Link) -> (usize, bool, usize) {
        let blocks = &self.share.blocks.of_cell;
        let crosses = blocks[self.ordering.cells[position]] != blocks[link.cell];
        (self.ordering.stage(position), crosses, if crosses { link.coupling } else { position })
    }

    /// Sends the updates for ghosts to the ranks that own these, and receives those for own cells.
    fn exchange(&self, exchange: &Exchange, updates: &Updates) {
        let pack = |crossing: &Crossing, out: &mut Vec<f64>| self.pack(crossing, updates, out);
        exchange.run(self.share, self.numbers_of_updates(), pack, |crossing, numbers| {
            let received = self.unpack(crossing, numbers);
            lock(&updates[self.ordering.positions[crossing.own]]).extend(received);
        });
    }

    /// Numbers of the updates of all modes across a facet.
    fn numbers_of_updates(&self) -> usize {
        let parts: usize = self.shifts.iter().map(|&shift| Self::shape(self.jacobian.block, shift).parts).sum();
        parts * singles::packed(self.jacobian.traces.len().pow(2))
    }

    /// The updates of a ghost, mode by mode.
    fn pack(&self, crossing: &Crossing, updates: &Updates, out: &mut Vec<f64>) {
        let updates = lock(&updates[self.ordering.positions[crossing.ghost]]);
        for mode in 0..self.shifts.len() {
            let update = updates.iter().filter(|update| (update.coupling, update.mode) == (crossing.coupling, mode));
            update.flat_map(|update| &update.parts).for_each(|part| singles::pack(part, out));
        }
    }

    /// The updates behind [`Self::pack`], for an own cell.
    fn unpack(&self, crossing: &Crossing, numbers: &[f64]) -> Vec<Update> {
        let Crossing { coupling, own, own_face, ghost, .. } = *crossing;
        let from = (self.ordering.stage(self.ordering.positions[ghost]), true, coupling);
        let position = self.ordering.positions[own];
        let len = self.jacobian.traces.len().pow(2);
        let mut parts = numbers.chunks_exact(singles::packed(len)).map(|packed| {
            let mut part = vec![0.0; len];
            singles::unpack(packed, &mut part);
            part
        });
        let update = |(mode, &shift): (usize, &c64)| {
            let parts = parts.by_ref().take(Self::shape(self.jacobian.block, shift).parts).collect();
            Update { from, position, coupling, mode, face: own_face, parts }
        };
        self.shifts.iter().enumerate().map(update).collect()
    }
}

/// dt^2 times the product of three matrices of `t` rows, the inner one row-major; column-major. Compiled here once, and not for every kind of
/// numbers that is stored.
fn product([back, inner, there]: [&[f32]; 3], t: usize, dt: f32) -> Vec<f32> {
    let [back, there] = [back, there].map(|matrix| MatRef::from_column_major_slice(matrix, t, t));
    let inner = MatRef::from_row_major_slice(inner, t, t);
    let (mut half, mut product) = (vec![0.0; t * t], vec![0.0; t * t]);
    // One dt after the other: the square of that of a steady flow would leave the range of the numbers.
    let mut half = MatMut::from_column_major_slice_mut(&mut half, t, t);
    matmul(half.as_mut(), Accum::Replace, back, inner, dt, Par::Seq);
    let target = MatMut::from_column_major_slice_mut(&mut product, t, t);
    matmul(target, Accum::Replace, half.as_ref(), there, dt, Par::Seq);
    product
}

/// sum_j |A_ij| x_j
fn row_sums(shape: Shape, block: &[f32], x: &[f32]) -> Vec<f32> {
    let mut sums = vec![0.0; shape.n];
    for (column, x) in block.chunks_exact(shape.stride()).zip(x) {
        for part in column.chunks_exact(padded(shape.n)) {
            sums.iter_mut().zip(part).for_each(|(sum, a)| *sum += a.abs() * x);
        }
    }
    sums
}

/// What is behind a lock, also after a panic elsewhere.
pub fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

fn single<T: Stored>(matrix: &[T]) -> Vec<f32> {
    matrix.iter().map(|&a| a.into() as f32).collect()
}
