//! A mesh that moves like an elastic body.

mod position;
mod solve;
#[cfg(test)]
mod tests;

use crate::geometry::{StiffnessSampler, nodal_coordinates, node_spacing};
use crate::low_order::{Inertia, LowOrderInverse, LowOrderTerms};
use crate::operator::Operator;
use crate::pool::Pool;
use crate::solver::{Inverse, Plan, Prepared, Solver};
use crate::substructures::{SolverOnBlocks, Substructures};
use crate::{ElasticityError, Law, Material, Stiffness};
use basis::gauss_lobatto;
use fem::NodalBatches;
use mesh::{Mesh, NodeNumbering};
use position::Position;
use solve::SolveWork;
use tensor::WIDTH;

/// The equilibrium of a mesh: div P(grad d) = 0, with the displacement d prescribed at constrained entries.
///
/// ```text
/// K_ff d_f + K_fc d_c = f_f          f: free entries, c: constrained entries                                   (equilibrium)
/// ```
///
/// An entry is one component of one C0 node. With [`Law::Linear`], K depends only on the initial mesh, the material and the stiffness. It
/// is prepared once, with its preconditioner, for all slabs and temporal modes of a run. With the other laws K is the derivative of the
/// forces at the displacement of the slab's bottom, set by [`Self::begin_slab`]. Vectors have the layout `[C0 node][component]`; temporal
/// modes are separate vectors. All other methods take `&self`, so that several vectors may be treated at the same time.
pub struct ElasticMesh<const D: usize> {
    law: Law,
    operator: Operator<D>,
    /// The state of the mesh at which K is evaluated.
    position: Position<D>,
    inverse: Inverse<D>,
    /// The relative error after one pass of a direct solver.
    pass_error: f64,
    constrained: Vec<[bool; D]>,
    coordinates: Vec<[f64; D]>,
    diagonal: Vec<f64>,
    spacing: Vec<f64>,
    solves: Pool<SolveWork>,
    vectors: Pool<Vec<f64>>,
}

impl<const D: usize> ElasticMesh<D> {
    /// Prepares K of the order of `numbering` on the reference mesh, and the solver that suits its size.
    ///
    /// `constrained[node][component]` tells whether a component of the displacement of a node is prescribed.
    ///
    /// # Errors
    /// As [`Self::with_solver`].
    pub fn new(
        mesh: &Mesh<D>,
        numbering: &NodeNumbering,
        material: Material,
        stiffness: Stiffness<'_, D>,
        constrained: &[[bool; D]],
    ) -> Result<Self, ElasticityError> {
        Self::with_solver(mesh, numbering, material, stiffness, constrained, Solver::Automatic)
    }

    /// The same with the given solver. On several blocks this and all solutions are collective calls.
    ///
    /// # Errors
    /// A stiffness that is not positive, no or too few constrained entries, or a `constrained` of the wrong length. If the solver
    /// needs the low-order refinement: a sub-cell between Gauss-Lobatto nodes that is inverted.
    pub fn with_solver(
        mesh: &Mesh<D>,
        numbering: &NodeNumbering,
        material: Material,
        stiffness: Stiffness<'_, D>,
        constrained: &[[bool; D]],
        solver: impl Into<SolverOnBlocks>,
    ) -> Result<Self, ElasticityError> {
        Self::on_blocks(mesh, numbering, material, stiffness, constrained, &solver.into())
    }

    fn on_blocks(
        mesh: &Mesh<D>,
        numbering: &NodeNumbering,
        material: Material,
        stiffness: Stiffness<'_, D>,
        constrained: &[[bool; D]],
        solver: &SolverOnBlocks,
    ) -> Result<Self, ElasticityError> {
        check_constraints(numbering, constrained)?;
        let (order, law, lame) = (numbering.order(), material.law(), material.lame());
        let at_points = StiffnessSampler::new(mesh, stiffness, law.rule(D, order));
        let operator = Operator::new(law, lame, order, NodalBatches::new(numbering), &at_points)?;
        let mut position = Position::new(law, &operator, stiffness, numbering.count * D);
        let coordinates = nodal_coordinates(mesh, numbering);
        let batches = operator.batches();
        let (plan, prepared) = Plan::prepare(mesh, numbering, batches, constrained, solver);
        let low_order = |position: &mut Position<D>| {
            let at_nodes = StiffnessSampler::new(mesh, stiffness, gauss_lobatto(order));
            let multigrid = (plan.solver == Solver::Multigrid).then_some(&coordinates[..]);
            let (inertia, samples) = (Inertia::none(), |cell| at_nodes.cell(cell));
            let terms = LowOrderTerms { lame, inertia, numbering, samples: &samples, fixed: constrained };
            let low_order = LowOrderInverse::new(&terms, multigrid)?;
            position.keep_nodes(law, numbering, &at_nodes).map(|()| low_order)
        };
        let matrices = |batch| operator.cell_matrices(position.bottom(), batch);
        let inverse = match prepared {
            Prepared::Elimination(elimination) => Inverse::Direct(Box::new(elimination.factor(batches, &matrices)?)),
            Prepared::Cuts(cuts) => {
                let is_direct = plan.solver == Solver::Direct;
                Inverse::Substructures(Box::new(Substructures::new(cuts, is_direct, &matrices)?))
            }
            Prepared::Nothing => Inverse::LowOrder(Box::new(low_order(&mut position)?)),
        };
        let mut diagonal = vec![0.0; numbering.count * D];
        operator.diagonal(&mut diagonal);
        let spacing = node_spacing(mesh, numbering);
        let mut mesh = ElasticMesh {
            law,
            operator,
            position,
            inverse,
            pass_error: 0.0,
            constrained: constrained.to_vec(),
            coordinates,
            diagonal,
            spacing,
            solves: Pool::new(),
            vectors: Pool::new(),
        };
        if mesh.inverse.is_exact() {
            mesh.pass_error = mesh.measure_pass_error();
        }
        Ok(mesh)
    }

    /// The length of a vector: D times the number of C0 nodes.
    pub fn length(&self) -> usize {
        self.diagonal.len()
    }
    /// The reference position of every C0 node; for a node on a periodic boundary, one of its positions.
    pub fn coordinates(&self) -> &[[f64; D]] {
        &self.coordinates
    }
    /// For every entry of a vector, whether its displacement is prescribed.
    pub fn constrained(&self) -> &[bool] {
        self.constrained.as_flattened()
    }
    /// Multiplications of one application of K, except those of the law at points.
    pub fn multiplications(&self) -> usize {
        self.operator.multiplications()
    }
    /// The count of numbers that one application of K reads besides the vectors: geometry and stiffness at the points of all cells.
    pub fn metric_length(&self) -> usize {
        self.operator.metric().len() * WIDTH
    }
    /// Memory of the factors or the hierarchy that the solver has prepared on this rank.
    pub fn solver_bytes(&self) -> usize {
        self.inverse.bytes()
    }
    /// The law.
    pub fn law(&self) -> Law {
        self.law
    }
    /// diag K of the initial mesh at rest: the scale of the forces at every node, and the weight of a pseudo-time term.
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }
    /// Weights of the residual in a slab of `time_order` nodes. They make its norm an error of position relative to the node spacing h:
    /// |R|^2 = (1 / n) sum (R_i / (K_ii h_i))^2.
    pub fn position_weights(&self, time_order: usize) -> Vec<f64> {
        let count = (self.length() * time_order) as f64;
        let weight = |i: usize| 1.0 / ((self.diagonal[i] * self.spacing[i / D]).powi(2) * count);
        (0..time_order).flat_map(|_| (0..self.length()).map(weight)).collect()
    }

    /// out = K d at all entries, constrained or not. Nothing is allocated after a first call.
    pub fn apply(&self, d: &[f64], out: &mut [f64]) {
        debug_assert_eq!((d.len(), out.len()), (self.length(), self.length()));
        self.operator.product(self.position.bottom(), d, out);
    }

    /// out_f = K_ff d_f, out_c = 0, for a `d` that vanishes at constrained entries.
    pub fn apply_free(&self, d: &[f64], out: &mut [f64]) {
        self.apply(d, out);
        self.at_constrained(out, |_| 0.0);
    }

    /// Sets the free entries.
    fn at_free(&self, vector: &mut [f64], value: impl Fn(usize) -> f64) {
        self.set(false, vector, value);
    }

    /// Sets the constrained entries.
    pub(crate) fn at_constrained(&self, vector: &mut [f64], value: impl Fn(usize) -> f64) {
        self.set(true, vector, value);
    }

    /// Adds to the constrained entries.
    pub(crate) fn add_at_constrained(&self, vector: &mut [f64], value: impl Fn(usize) -> f64) {
        for (i, _) in self.constrained().iter().enumerate().filter(|(_, constrained)| **constrained) {
            vector[i] += value(i);
        }
    }

    fn set(&self, constrained: bool, vector: &mut [f64], value: impl Fn(usize) -> f64) {
        for (i, _) in self.constrained().iter().enumerate().filter(|(_, c)| **c == constrained) {
            vector[i] = value(i);
        }
    }

    /// Lends a vector with arbitrary entries.
    pub(crate) fn with_vector<R>(&self, work: impl FnOnce(&mut [f64]) -> R) -> R {
        let mut vector = self.vectors.take(|| vec![0.0; self.length()]);
        let result = work(&mut vector);
        self.vectors.give(vector);
        result
    }
}

fn check_constraints<const D: usize>(
    numbering: &NodeNumbering,
    constrained: &[[bool; D]],
) -> Result<(), ElasticityError> {
    if constrained.len() != numbering.count {
        let (found, expected) = (constrained.len(), numbering.count);
        return Err(ElasticityError::Length { array: "the list of constrained nodes", found, expected });
    }
    match (0..D).find(|&axis| constrained.iter().all(|components| !components[axis])) {
        Some(axis) => Err(ElasticityError::Unconstrained { axis }),
        None => Ok(()),
    }
}
