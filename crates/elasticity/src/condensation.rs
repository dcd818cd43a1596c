//! A direct solver: the mesh is condensed part by part, until nothing is left.
//!
//! A node inside a cell is coupled with the nodes of that cell alone, so it is eliminated there. What is left couples the nodes of the
//! skeleton; a cell and its neighbour together need no node between them any more; and so on, along a tree of ever larger parts:
//!
//! ```text
//! S = sum over cells of  K_ss - K_si K_ii^{-1} K_is                                                            (condensation)
//! S d_s = f_s - sum over cells of  K_si K_ii^{-1} f_i
//! d_i = K_ii^{-1} (f_i - K_is d_s)
//! ```
//!
//! It is made of the matrices of the cells, whatever law they come from. Exact up to round-off, without iterations; several right-hand
//! sides share every pass through the factor. A cell of order N stores D (N - 2)^D rows.

mod dissection;
mod fronts;
mod inner;
mod sweep;

use crate::ElasticityError;
use crate::batches::Batches;
use crate::pool::Pool;
use dissection::Dissection;
use faer::MatMut;
use fronts::{Contribution, Fronts};
use inner::{CellUnknowns, InnerFactor};
use std::sync::Arc;
use sweep::SweepWork;
use tensor::{Pack, WIDTH};

/// In which order the free nodes of a mesh are eliminated, and what their factor will need: known before any matrix is.
pub(crate) struct Elimination<const D: usize> {
    unknowns: CellUnknowns,
    dissection: Dissection,
    /// The numbers, in the order of elimination, of free skeleton nodes.
    numbers: Vec<Option<usize>>,
    constrained: Vec<bool>,
    /// Rows of the largest boundary of a part.
    largest_boundary: usize,
}

impl<const D: usize> Elimination<D> {
    /// For cells of the given order and the constrained nodes `constrained[C0 node]`. `centres` lie anywhere in the cells.
    pub(crate) fn new(order: usize, batches: &Batches<D>, constrained: &[bool], centres: &[[f64; D]]) -> Self {
        let unknowns = CellUnknowns::new(D, order);
        let skeleton = |cell: usize| -> Vec<usize> {
            let nodes = unknowns.skeleton_nodes(D).map(|k| batches.cell_node(cell, k));
            nodes.filter(|&node| !constrained[node]).collect()
        };
        let cells: Vec<_> = (0..batches.cells()).map(skeleton).collect();
        let dissection = Dissection::new(&cells, centres, constrained.len());
        let mut numbers = vec![None; constrained.len()];
        dissection.order.iter().enumerate().for_each(|(number, &node)| numbers[node] = Some(number));
        let largest_boundary = dissection.parts.iter().map(|part| part.boundary.len() * D).max().unwrap_or(0);
        Elimination { unknowns, dissection, numbers, constrained: constrained.to_vec(), largest_boundary }
    }

    /// Memory of the factor, and on the way to it of S of all cells and of the matrices of a batch. Threads do not count: they must not
    /// decide which solver is taken.
    pub(crate) fn bytes(&self, batches: &Batches<D>) -> usize {
        let inner = self.unknowns.factor_length() * batches.count() * WIDTH;
        let schur = self.unknowns.skeleton().pow(2) * batches.cells();
        let matrices = 2 * self.unknowns.count().pow(2) * WIDTH;
        (inner + self.dissection.factor_entries(D) + schur + matrices) * size_of::<f64>()
    }

    /// Multiplications of the factorisation.
    pub(crate) fn operations(&self, batches: &Batches<D>) -> f64 {
        let cells = eliminations(self.unknowns.count(), self.unknowns.inner()) * (batches.count() * WIDTH) as f64;
        let parts = self
            .dissection
            .parts
            .iter()
            .map(|part| eliminations((part.eliminated.len() + part.boundary.len()) * D, part.eliminated.len() * D));
        cells + parts.sum::<f64>()
    }

    /// The factor of the sum of the cells' matrices: `matrices(batch)` are those of a batch, `[column][row]`, both of them
    /// `[component][node]`.
    ///
    /// # Errors
    /// [`ElasticityError::NotDefinite`] if too few nodes are constrained, or the state of the mesh is unstable.
    pub(crate) fn factor(
        self: &Arc<Self>,
        batches: &Batches<D>,
        matrices: impl Fn(usize) -> Vec<Pack> + Sync,
    ) -> Result<Condensation<D>, ElasticityError> {
        let (inner, schur) = InnerFactor::new(&self.unknowns, batches, &self.constrained, matrices)?;
        let number = |cell: usize, k: usize| self.numbers[batches.cell_node(cell, k)];
        let fronts = Fronts::new(&self.dissection, |cell| Contribution {
            nodes: self.unknowns.skeleton_nodes(D).map(|k| number(cell, k)).collect(),
            matrix: &schur[cell],
        })?;
        Ok(Condensation { elimination: self.clone(), inner, fronts, work: Pool::new() })
    }
}

/// Multiplications that eliminate `count` of `rows` rows of a symmetric matrix, one after the other.
fn eliminations(rows: usize, count: usize) -> f64 {
    (rows - count..rows).map(|left| 0.5 * (left as f64).powi(2)).sum()
}

/// The factored K_ff.
pub(crate) struct Condensation<const D: usize> {
    elimination: Arc<Elimination<D>>,
    inner: InnerFactor,
    fronts: Fronts<D>,
    work: Pool<SolveWork>,
}

/// Work space of one solve with several right-hand sides.
struct SolveWork {
    sweep: SweepWork,
    /// What a sweep returns, `[right-hand side][C0 node][component]`.
    swept: Vec<f64>,
    /// `[right-hand side][number][component]`
    skeleton: Vec<f64>,
    /// `[right-hand side][largest boundary]`
    boundary: Vec<f64>,
}

impl<const D: usize> Condensation<D> {
    /// The order of elimination, for the factor of another K of the same mesh.
    pub(crate) fn elimination(&self) -> &Arc<Elimination<D>> {
        &self.elimination
    }

    /// x = K_ff^{-1} x for right-hand sides one after the other, `[right-hand side][C0 node][component]`, that vanish at constrained nodes.
    /// After a first call with as many right-hand sides nothing is allocated.
    pub(crate) fn solve(&self, batches: &Batches<D>, x: &mut [f64]) {
        let Elimination { unknowns, dissection, largest_boundary, .. } = &*self.elimination;
        let (length, rows) = (self.elimination.numbers.len() * D, dissection.order.len() * D);
        let count = x.len() / length;
        let mut work = self.work.take(|| SolveWork::new(batches));
        let SolveWork { sweep, swept, skeleton, boundary } = &mut work;
        swept.resize(x.len(), 0.0);
        skeleton.resize(count * rows, 0.0);
        boundary.resize(count * largest_boundary, 0.0);
        self.inner.forward(unknowns, batches, x, swept, sweep);
        for (x, swept, skeleton) in by_side(x, swept, skeleton, count) {
            self.on_skeleton(|i, k| skeleton[k] = x[i] + swept[i]);
        }
        let columns = MatMut::from_column_major_slice_mut(skeleton, rows, count);
        self.fronts.solve(dissection, columns, MatMut::from_column_major_slice_mut(boundary, *largest_boundary, count));
        for (_, swept, skeleton) in by_side(x, swept, skeleton, count) {
            self.on_skeleton(|i, k| swept[i] = skeleton[k]);
            self.hold(swept);
        }
        self.inner.backward(unknowns, batches, swept, x, sweep);
        for (x, _, skeleton) in by_side(x, swept, skeleton, count) {
            self.on_skeleton(|i, k| x[i] = skeleton[k]);
        }
        self.work.give(work);
    }

    /// Memory of the factor.
    pub(crate) fn bytes(&self) -> usize {
        self.inner.bytes() + self.fronts.bytes()
    }

    /// d_c = 0.
    fn hold(&self, d: &mut [f64]) {
        let nodes = self.elimination.constrained.iter().zip(d.chunks_exact_mut(D));
        nodes.filter(|(constrained, _)| **constrained).for_each(|(_, d)| d.fill(0.0));
    }

    /// Visits the entries of the skeleton: their places in a vector of all nodes, and in the order of elimination.
    fn on_skeleton(&self, mut visit: impl FnMut(usize, usize)) {
        for (number, node) in self.elimination.dissection.order.iter().enumerate() {
            (0..D).for_each(|i| visit(node * D + i, number * D + i));
        }
    }
}

/// The parts of three vectors that belong to each of `count` right-hand sides.
fn by_side<'a>(
    x: &'a mut [f64],
    swept: &'a mut [f64],
    skeleton: &'a mut [f64],
    count: usize,
) -> impl Iterator<Item = (&'a mut [f64], &'a mut [f64], &'a mut [f64])> {
    let (length, rows) = (x.len() / count, skeleton.len() / count);
    let vectors = x.chunks_exact_mut(length).zip(swept.chunks_exact_mut(length));
    // By hand: where all nodes of the skeleton are constrained there are no rows, which chunks would take for no right-hand sides.
    let mut rest = skeleton;
    vectors.map(move |(x, swept)| {
        let (skeleton, others) = std::mem::take(&mut rest).split_at_mut(rows);
        rest = others;
        (x, swept, skeleton)
    })
}

impl SolveWork {
    fn new<const D: usize>(batches: &Batches<D>) -> Self {
        let (swept, skeleton, boundary) = (Vec::new(), Vec::new(), Vec::new());
        SolveWork { sweep: SweepWork::new(batches), swept, skeleton, boundary }
    }
}
