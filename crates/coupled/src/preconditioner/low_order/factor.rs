//! The diagonal blocks of (node ilu).
//!
//! D_i is a small difference of large blocks where cells are much thinner than viscous layers, and free at both ends: a thin span. What
//! rounding takes from an earlier D_j^-1 then is as large as D_i if
//!
//! ```text
//! g = max_i sum_kl |D^-1_ik| |F_kl|,    F_i = sum_(j before i) dt^2 A_ij D_j^(-1) A_ji                              (node growth)
//! ```
//!
//! is large. There D^-1 is stored as the sum of two or three numbers in bfloat16 instead of one.

use super::matrix::{BEYOND, NodeBlocks};
use super::stencil::Step;
use super::sweeps::{add_column, load, load_terms};
use super::vectors::columns;
use super::walk::Walk;
use crate::preconditioner::bf16_blocks::terms;
use crate::preconditioner::modal::largest;
use basis::TemporalModes;
use faer::c64;
use half::bf16;
use sparse::dependency_schedule;
use std::ops::Range;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{PoisonError, RwLock, RwLockReadGuard};
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};

/// The largest (node growth) at which D^-1 is stored in one term, whose rounding is 0.004.
const LARGE_GROWTH: f64 = 100.0;

/// D_i^-1 of all modes.
pub(super) struct Factor {
    /// Of every cell, `[node][mode][part][term][column][row]`: the real part, and of a complex mode the imaginary part.
    inverses: Vec<RwLock<Vec<bf16>>>,
    /// How many numbers each entry is the sum of.
    pub(super) terms: usize,
    /// The columns of each mode.
    pub(super) columns: Vec<Range<usize>>,
    /// lambda of each mode, damped.
    pub(super) shifts: Vec<c64>,
    /// The slab length over that of the blocks.
    pub(super) ratio: f64,
}

impl Factor {
    /// Without blocks.
    pub(super) fn empty(cells: usize, modes: &TemporalModes) -> Self {
        let inverses = (0..cells).map(|_| RwLock::new(Vec::new())).collect();
        Factor { inverses, terms: 1, columns: columns(modes), shifts: Vec::new(), ratio: 1.0 }
    }

    /// The blocks of a cell.
    pub(super) fn read(&self, cell: usize) -> RwLockReadGuard<'_, Vec<bf16>> {
        self.inverses[cell].read().unwrap_or_else(PoisonError::into_inner)
    }

    /// Those of a node among the blocks of its cell.
    #[inline(always)]
    pub(super) fn of_node<'a, const M: usize>(&self, inverses: &'a [bf16], node: usize) -> &'a [bf16] {
        &inverses[node * self.parts() * self.terms * M * M..]
    }

    /// Blocks of a node, which are as many as columns.
    fn parts(&self) -> usize {
        self.columns.last().map_or(0, |columns| columns.end)
    }

    /// Factors the modes for slabs `ratio` times as long as that of the blocks. A collective call.
    pub(super) fn compute<const D: usize, const M: usize, const W: usize>(
        &mut self,
        matrix: &NodeBlocks<D, M>,
        walk: &Walk,
        ratio: f64,
        shifts: Vec<c64>,
    ) {
        (self.ratio, self.shifts) = (ratio, shifts);
        // The growth depends on the terms a little, so it is that of one term. A resumed run does not know how many there were.
        self.terms = 1;
        let growth = self.compute_in_terms::<D, M, W>(matrix, walk);
        self.terms = terms(growth / LARGE_GROWTH);
        tracing::debug!(growth, terms = self.terms, "blocks of the preconditioner of low order");
        if self.terms > 1 {
            self.compute_in_terms::<D, M, W>(matrix, walk);
        }
    }

    /// The same in as many terms as it has. Returns (node growth) on all ranks.
    fn compute_in_terms<const D: usize, const M: usize, const W: usize>(
        &self,
        matrix: &NodeBlocks<D, M>,
        walk: &Walk,
    ) -> f64 {
        let growth = AtomicU32::new(0);
        let (cells, ordering) = (matrix.layout.cells, &walk.ordering);
        let earlier = |cell: usize| {
            let others = (0..2 * D).filter_map(move |face| matrix.cell_in_block(cell, face));
            others.filter(move |&other| walk.is_before(other, cell))
        };
        let needs = |k: usize| earlier(ordering.cells[k]).map(|other| ordering.positions[other]);
        dependency_schedule(cells, ordering.widest_level(), needs, |k| {
            let cell = ordering.cells[k];
            let mut inverses = self.inverses[cell].write().unwrap_or_else(PoisonError::into_inner);
            inverses.clear();
            inverses.resize(matrix.layout.nodes * self.parts() * self.terms * M * M + BEYOND, bf16::ZERO);
            let of_cell = Arch::new().dispatch(EliminateCell::<D, M, W> {
                factor: self,
                matrix,
                walk,
                cell,
                inverses: &mut inverses,
            });
            // Numbers that are not negative are in the order of their bits.
            growth.fetch_max(of_cell.to_bits(), Relaxed);
        });
        largest(&matrix.share, &[f64::from(f32::from_bits(growth.into_inner()))])
    }

    /// D_i^-1 of one node; those of earlier nodes are there. Returns its part of (node growth).
    #[inline(always)]
    fn eliminate<const D: usize, const M: usize, const W: usize>(
        &self,
        matrix: &NodeBlocks<D, M>,
        walk: &Walk,
        (cell, node): (usize, usize),
        inverses: &mut [bf16],
    ) -> f32 {
        let fill = self.fill::<D, M, W>(matrix, walk, (cell, node), inverses);
        let (mut rest, mut most) = (&mut inverses[node * self.parts() * self.terms * M * M..], 0.0_f32);
        for (shift, columns) in self.shifts.iter().zip(&self.columns) {
            let fill = &fill[columns.clone()];
            let d = inverse(self.diagonal::<M, W>(matrix.diagonal(cell, node), *shift, fill));
            most = most.max((self.ratio * self.ratio) as f32 * growth(&d, fill));
            let (stored, others) = rest.split_at_mut(columns.len() * self.terms * M * M);
            store(d.as_flattened(), self.terms, stored);
            rest = others;
        }
        most
    }

    /// sum_(j before i) A_ij D_j^-1 A_ji, `[part][column][row]`.
    #[inline(always)]
    fn fill<const D: usize, const M: usize, const W: usize>(
        &self,
        matrix: &NodeBlocks<D, M>,
        walk: &Walk,
        (cell, node): (usize, usize),
        inverses: &[bf16],
    ) -> Vec<[[f32; W]; M]> {
        let (nodes, mut sums) = (matrix.layout.nodes, vec![[[0.0; W]; M]; self.parts()]);
        for (face, step) in matrix.stencil.of(node).iter().enumerate() {
            let coupling = matrix.coupling(cell, node, face);
            match *step {
                Step::Inside(j) if walk.is_earlier_inside(cell, face) => {
                    let back = matrix.coupling(cell, j as usize, face ^ 1);
                    add_fill::<M, W>(coupling, (self.of_node::<M>(inverses, j as usize), self.terms), back, &mut sums);
                }
                Step::Across(i) => {
                    let earlier = matrix.cell_in_block(cell, face).filter(|other| walk.is_before(*other, cell));
                    if let Some(other) = earlier {
                        let j = matrix.across(cell, face)[i as usize] as usize % nodes;
                        let back = matrix.coupling(other, j, matrix.face_across(cell, face));
                        add_fill::<M, W>(
                            coupling,
                            (self.of_node::<M>(&self.read(other), j), self.terms),
                            back,
                            &mut sums,
                        );
                    }
                }
                Step::Inside(_) => {}
            }
        }
        sums
    }

    /// D_i = lambda + dt A_ii - dt^2 times the fill, which has one part or two.
    #[inline(always)]
    fn diagonal<const M: usize, const W: usize>(
        &self,
        block: &[f32],
        shift: c64,
        fill: &[[[f32; W]; M]],
    ) -> [[c64; M]; M] {
        let (ratio, mut d) = (self.ratio, [[c64::ZERO; M]; M]);
        for (j, i) in (0..M).flat_map(|j| (0..M).map(move |i| (j, i))) {
            let part = |part: usize| fill.get(part).map_or(0.0, |fill| ratio * ratio * f64::from(fill[j][i]));
            d[j][i] = c64::new(ratio * f64::from(block[j * M + i]) - part(0), -part(1));
            d[j][i] += if i == j { shift } else { c64::ZERO };
        }
        d
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        (0..self.inverses.len()).map(|cell| size_of_val(&self.read(cell)[..])).sum()
    }
}

/// D_i^-1 of the nodes of a cell.
struct EliminateCell<'a, const D: usize, const M: usize, const W: usize> {
    factor: &'a Factor,
    matrix: &'a NodeBlocks<D, M>,
    walk: &'a Walk,
    cell: usize,
    inverses: &'a mut [bf16],
}

impl<const D: usize, const M: usize, const W: usize> WithSimd for EliminateCell<'_, D, M, W> {
    /// Its part of (node growth).
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f32 {
        let mut most = 0.0_f32;
        for &node in self.walk.nodes(self.cell) {
            let place = (self.cell, node as usize);
            most = most.max(self.factor.eliminate::<D, M, W>(self.matrix, self.walk, place, self.inverses));
        }
        most
    }
}

/// Stores the real part of a block and, where there is room for it, the imaginary part.
#[inline(always)]
fn store(block: &[c64], terms: usize, stored: &mut [bf16]) {
    let len = block.len();
    for (number, entry) in block.iter().enumerate() {
        let mut parts = [entry.re, entry.im];
        for (at, stored) in stored[number..].iter_mut().step_by(len).enumerate() {
            let part = &mut parts[at / terms];
            *stored = bf16::from_f64(*part);
            *part -= f64::from(stored.to_f32());
        }
    }
}

/// The largest row of |D^-1| |F|.
#[inline(always)]
fn growth<const M: usize, const W: usize>(inverse: &[[c64; M]; M], fill: &[[[f32; W]; M]]) -> f32 {
    // |F| times ones.
    let mut sums = [0.0_f32; M];
    for column in fill.iter().flatten() {
        (0..M).for_each(|i| sums[i] += column[i].abs());
    }
    let mut rows = [0.0_f32; M];
    for (column, sum) in inverse.iter().zip(sums) {
        (0..M).for_each(|i| rows[i] += (column[i].re.abs() + column[i].im.abs()) as f32 * sum);
    }
    rows.into_iter().fold(0.0, f32::max)
}

/// sums += A_ij D_j^-1 A_ji for every part of D_j^-1.
#[inline(always)]
fn add_fill<const M: usize, const W: usize>(
    coupling: &[bf16],
    (inverse, terms): (&[bf16], usize),
    back: &[bf16],
    sums: &mut [[[f32; W]; M]],
) {
    let (coupling, back) = (load::<M, W>(coupling), load::<M, W>(back));
    for (part, sums) in sums.iter_mut().enumerate() {
        let inverse = load_terms::<M, W>(inverse, terms, part);
        for (back, sum) in back.iter().zip(sums) {
            let mut solved = [0.0; W];
            add_column(&inverse, &back[..M], &mut solved);
            add_column(&coupling, &solved[..M], sum);
        }
    }
}

/// The inverse of a small matrix `[column][row]` by Gauss-Jordan elimination with pivots from the rows below.
#[inline(always)]
fn inverse<const M: usize>(mut a: [[c64; M]; M]) -> [[c64; M]; M] {
    let mut b = [[c64::ZERO; M]; M];
    (0..M).for_each(|i| b[i][i] = c64::ONE);
    for k in 0..M {
        let pivot = (k..M).max_by(|&i, &j| a[k][i].norm().total_cmp(&a[k][j].norm())).unwrap_or(k);
        for column in a.iter_mut().chain(&mut b) {
            column.swap(k, pivot);
        }
        let scale = c64::ONE / a[k][k];
        let mut factors = a[k];
        factors[k] = c64::ZERO;
        for column in a.iter_mut().chain(&mut b) {
            column[k] *= scale;
            let head = column[k];
            column.iter_mut().zip(&factors).for_each(|(entry, factor)| *entry -= *factor * head);
        }
    }
    b
}
