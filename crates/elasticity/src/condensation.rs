//! A direct solver: the mesh is condensed part by part.
//!
//! A node inside a cell is coupled only with the nodes of that cell, so it is eliminated there. The Schur complement couples the nodes
//! of the skeleton. When a cell and its neighbour are joined, the nodes between them can be eliminated too, and so on, along a tree of
//! ever larger parts:
//!
//! ```text
//! S = sum over cells of  K_ss - K_si K_ii^{-1} K_is                                                            (condensation)
//! S d_s = f_s - sum over cells of  K_si K_ii^{-1} f_i
//! d_i = K_ii^{-1} (f_i - K_is d_s)
//! ```
//!
//! It is built from the matrices of the cells, for any law. It is exact up to round-off, without iterations; several right-hand sides
//! share every pass through the factor. A cell of order N stores D (N - 2)^D rows.

mod inner;
mod sweep;

use crate::ElasticityError;
use crate::pool::Pool;
use faer::Mat;
use fem::NodalBatches;
pub(crate) use inner::BatchMatrices;
use inner::{CellUnknowns, InnerFactor};
use sparse::{EliminationTree, Factorisation, Kind, eliminations};
use std::sync::Arc;
use sweep::{CellSweeps, SweepWork};
use tensor::WIDTH;

/// The order of elimination of the free nodes of a mesh, and the size of their factor. Both are known before any
/// matrix.
pub(crate) struct Elimination<const D: usize> {
    unknowns: CellUnknowns,
    /// The tree of the nodes of the skeleton with a free component.
    tree: Arc<EliminationTree>,
    constrained: Vec<[bool; D]>,
}

impl<const D: usize> Elimination<D> {
    /// For cells of the given order and the entries `constrained[C0 node][component]`. `centres` are any points of the cells. The nodes
    /// `kept`, increasing, have a free component and are not eliminated.
    pub(crate) fn new(
        order: usize,
        batches: &NodalBatches<D>,
        constrained: &[[bool; D]],
        centres: &[[f64; D]],
        kept: &[usize],
    ) -> Self {
        let unknowns = CellUnknowns::new(D, order);
        let skeleton = |cell: usize| -> Vec<usize> {
            let nodes = unknowns.skeleton_nodes(D).map(|k| batches.cell_node(cell, k));
            nodes.filter(|&node| constrained[node] != [true; D]).collect()
        };
        let cells: Vec<_> = (0..batches.cells()).map(skeleton).collect();
        let tree = Arc::new(EliminationTree::by_dissection(&cells, centres, constrained.len(), kept));
        Elimination { unknowns, tree, constrained: constrained.to_vec() }
    }

    /// Memory of the factor, including temporarily S of all cells and the matrices of a batch. The number of threads does not count,
    /// because it must not influence the choice of the solver.
    pub(crate) fn bytes(&self, batches: &NodalBatches<D>) -> usize {
        let inner = self.unknowns.factor_length() * batches.count() * WIDTH;
        let schur = self.unknowns.skeleton().pow(2) * batches.cells();
        let matrices = 2 * self.unknowns.count().pow(2) * WIDTH;
        (inner + self.tree.factor_entries(D) + schur + matrices) * size_of::<f64>()
    }

    /// Multiplications of the factorisation.
    pub(crate) fn operations(&self, batches: &NodalBatches<D>) -> f64 {
        let of_cell = eliminations(self.unknowns.count(), self.unknowns.inner());
        of_cell * (batches.count() * WIDTH) as f64 + self.tree.operations(D)
    }

    /// The factor of the sum of the cells' matrices.
    ///
    /// # Errors
    /// [`ElasticityError::NotDefinite`] if too few entries are constrained, or the state of the mesh is unstable.
    pub(crate) fn factor(
        self: &Arc<Self>,
        batches: &NodalBatches<D>,
        matrices: &BatchMatrices<'_>,
    ) -> Result<Condensation<D>, ElasticityError> {
        let (inner, schur) = InnerFactor::new(&self.unknowns, batches, &self.constrained, matrices)?;
        let factors = Factorisation::new(self.tree.clone(), D, Kind::Cholesky, |front| {
            if let Some(cell) = front.front.cell {
                let nodes = self.unknowns.skeleton_nodes(D).map(|k| batches.cell_node(cell, k));
                front.add(nodes.map(|node| self.tree.positions[node]), &schur[cell]);
            }
        })?;
        Ok(Condensation { elimination: self.clone(), inner, factors, work: Pool::new() })
    }
}

/// The factored K_ff.
pub(crate) struct Condensation<const D: usize> {
    elimination: Arc<Elimination<D>>,
    inner: InnerFactor,
    factors: Factorisation<f64>,
    work: Pool<Eliminated>,
}

/// A solve with several right-hand sides, half done.
#[derive(Default)]
pub(crate) struct Eliminated {
    sweep: SweepWork,
    /// The result of a sweep, `[right-hand side][C0 node][component]`.
    pub(crate) swept: Vec<f64>,
    /// Work space of the factors of the skeleton.
    fronts: Vec<f64>,
}

impl<const D: usize> Condensation<D> {
    /// The order of elimination, for the factor of another K of the same mesh.
    pub(crate) fn elimination(&self) -> &Arc<Elimination<D>> {
        &self.elimination
    }

    /// x = K_ff^{-1} x for right-hand sides one after the other, `[right-hand side][C0 node][component]`, that vanish at constrained
    /// entries. After a first call with as many right-hand sides nothing is allocated.
    pub(crate) fn solve(&self, batches: &NodalBatches<D>, x: &mut [f64]) {
        let eliminated = self.eliminate(batches, x);
        self.substitute(batches, eliminated, x);
    }

    /// The first half of [`Self::solve`]. At nodes that are kept, `swept` is then x less what the elimination of all others leaves there.
    pub(crate) fn eliminate(&self, batches: &NodalBatches<D>, x: &[f64]) -> Eliminated {
        let mut eliminated = self.work.take(|| Eliminated::new(batches));
        let Eliminated { sweep, swept, fronts } = &mut eliminated;
        swept.resize(x.len(), 0.0);
        self.sweeps(batches).forward(x, swept, sweep);
        self.on_skeleton(x, swept, |x, swept| *swept += x);
        self.factors.eliminate(swept, self.sides(x), fronts);
        eliminated
    }

    /// The second half of [`Self::solve`], with the solution in `swept` at nodes that are kept.
    pub(crate) fn substitute(&self, batches: &NodalBatches<D>, mut eliminated: Eliminated, x: &mut [f64]) {
        let Eliminated { sweep, swept, fronts } = &mut eliminated;
        self.factors.substitute(swept, self.sides(x), fronts);
        self.hold(swept);
        self.sweeps(batches).backward(swept, x, sweep);
        self.on_skeleton(swept, x, |swept, x| *x = swept);
        self.work.give(eliminated);
    }

    /// The Schur complement of the nodes that are kept, `[node][component]`; only its lower triangle is set. It can be taken once.
    pub(crate) fn take_complement(&mut self) -> Mat<f64> {
        self.factors.take_complement()
    }

    fn sweeps<'a>(&'a self, batches: &'a NodalBatches<D>) -> CellSweeps<'a, D> {
        CellSweeps { factor: &self.inner, unknowns: &self.elimination.unknowns, batches }
    }

    /// The number of right-hand sides.
    fn sides(&self, x: &[f64]) -> usize {
        x.len() / (self.elimination.constrained.len() * D)
    }

    /// Memory of the factor.
    pub(crate) fn bytes(&self) -> usize {
        self.inner.bytes() + self.factors.bytes()
    }

    /// d_c = 0 in every right-hand side.
    fn hold(&self, d: &mut [f64]) {
        let entries = self.elimination.constrained.as_flattened().iter().cycle().zip(d);
        entries.filter(|(constrained, _)| **constrained).for_each(|(_, d)| *d = 0.0);
    }

    /// Changes the entries of the skeleton in `to`, given the entries in `from`, for every right-hand side.
    fn on_skeleton(&self, from: &[f64], to: &mut [f64], mut change: impl FnMut(f64, &mut f64)) {
        let length = self.elimination.constrained.len() * D;
        for (from, to) in from.chunks_exact(length).zip(to.chunks_exact_mut(length)) {
            for k in self.elimination.tree.nodes.iter().flat_map(|node| node * D..(node + 1) * D) {
                change(from[k], &mut to[k]);
            }
        }
    }
}

impl Eliminated {
    fn new<const D: usize>(batches: &NodalBatches<D>) -> Self {
        Eliminated { sweep: SweepWork::new(batches), swept: Vec::new(), fronts: Vec::new() }
    }
}
