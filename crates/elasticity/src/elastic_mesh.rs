//! A mesh that moves like an elastic body.

use crate::batches::Batches;
use crate::geometry::{Sampler, nodal_coordinates, node_spacing};
use crate::low_order::LowOrder;
use crate::operator::Operator;
use crate::pool::Pool;
use crate::{Condensation, ElasticityError, Law, Material, Stiffness};
use basis::gauss_lobatto;
use mesh::{Mesh, NodeNumbering};
use newton_krylov::cg;
use newton_krylov::inner_product::{Euclidean, InnerProduct};
use newton_krylov::operator::LinearSystem;
use position::Position;

/// CG iterations after which a solve is given up: ten times what the worst case takes.
const MAX_ITERATIONS: usize = 500;

/// The equilibrium of a mesh: div P(grad d) = 0, with the displacement d prescribed at constrained nodes.
///
/// ```text
/// K_ff d_f + K_fc d_c = f_f          f: free nodes, c: constrained nodes                                       (equilibrium)
/// ```
///
/// With [`Law::Linear`], K depends on the initial mesh, the material and the stiffness alone. It is prepared once, with its
/// preconditioner, and serves every slab and every temporal mode of a run. With the other laws K is the derivative of the forces at the
/// displacement of the slab's bottom, set by [`Self::begin_slab`]. Vectors have the layout `[C0 node][component]`; temporal modes are
/// separate vectors. All other methods take `&self`: several vectors may be treated at the same time.
pub struct ElasticMesh<const D: usize> {
    law: Law,
    operator: Operator<D>,
    /// Where K is taken.
    position: Position,
    /// K condensed and factored, where that is done anew for every slab.
    direct: Option<Condensation<D>>,
    preconditioner: LowOrder<D>,
    constrained: Vec<bool>,
    coordinates: Vec<[f64; D]>,
    diagonal: Vec<f64>,
    spacing: Vec<f64>,
    solves: Pool<SolveWork>,
    vectors: Pool<Vec<f64>>,
}

/// Work space of one solve.
struct SolveWork {
    right_hand_side: Vec<f64>,
    solution: Vec<f64>,
    cg: cg::Workspace,
}

impl<const D: usize> ElasticMesh<D> {
    /// Prepares K of the order of `numbering` on the reference mesh, and factors its preconditioner.
    ///
    /// `constrained[node]` says where the displacement is prescribed, in all components.
    ///
    /// # Errors
    /// A stiffness that is not positive, a sub-cell between Gauss-Lobatto nodes that is inverted, no or too few constrained nodes, or
    /// a `constrained` of the wrong length.
    pub fn new(
        mesh: &Mesh<D>,
        numbering: &NodeNumbering,
        material: Material,
        stiffness: Stiffness<'_, D>,
        constrained: &[bool],
    ) -> Result<Self, ElasticityError> {
        check_constraints(numbering, constrained)?;
        let (order, law, lame) = (numbering.order(), material.law(), material.lame());
        let rule = law.rule(D, order);
        let at_points = Sampler::new(mesh, stiffness, &rule.points);
        let operator = Operator::new(law, lame, order, Batches::new(mesh, numbering), &rule, &at_points)?;
        let at_nodes = Sampler::new(mesh, stiffness, &gauss_lobatto(order).points);
        let preconditioner = LowOrder::new(lame, mesh.n_cells(), numbering, &at_nodes, constrained)?;
        let mut diagonal = vec![0.0; numbering.count * D];
        operator.diagonal(&mut diagonal);
        Ok(ElasticMesh {
            law,
            position: Position::new(law, &operator, stiffness, diagonal.len()),
            direct: None,
            operator,
            preconditioner,
            constrained: constrained.to_vec(),
            coordinates: nodal_coordinates(mesh, numbering),
            diagonal,
            spacing: node_spacing(mesh, numbering),
            solves: Pool::new(),
            vectors: Pool::new(),
        })
    }

    /// The length of a vector: D times the number of C0 nodes.
    pub fn length(&self) -> usize {
        self.diagonal.len()
    }
    /// The reference position of every C0 node; of a node on a periodic boundary, one of its positions.
    pub fn coordinates(&self) -> &[[f64; D]] {
        &self.coordinates
    }
    /// For every C0 node, whether its displacement is prescribed.
    pub fn constrained(&self) -> &[bool] {
        &self.constrained
    }
    /// The law.
    pub fn law(&self) -> Law {
        self.law
    }
    /// diag K of the initial mesh at rest: the scale of the forces at every node, and the weight of a pseudo-time term.
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }
    /// Weights of the residual in a slab of `time_order` nodes, that make its norm an error of position relative to the node spacing h:
    /// |R|^2 = (1 / n) sum (R_i / (K_ii h_i))^2.
    pub fn position_weights(&self, time_order: usize) -> Vec<f64> {
        let count = (self.length() * time_order) as f64;
        let weight = |i: usize| 1.0 / ((self.diagonal[i] * self.spacing[i / D]).powi(2) * count);
        (0..time_order).flat_map(|_| (0..self.length()).map(weight)).collect()
    }
    /// Stored entries of the factor of the preconditioner: its memory, in numbers.
    pub fn factor_entries(&self) -> usize {
        self.preconditioner.factor_entries()
    }

    pub(crate) fn operator(&self) -> &Operator<D> {
        &self.operator
    }

    /// out = K d on all nodes, constrained or not. Nothing is allocated after a first call.
    pub fn apply(&self, d: &[f64], out: &mut [f64]) {
        debug_assert_eq!((d.len(), out.len()), (self.length(), self.length()));
        self.operator.product(self.position.bottom(), d, out);
    }

    /// out_f = K_ff d_f, out_c = 0, for a `d` that vanishes at constrained nodes.
    pub fn apply_free(&self, d: &[f64], out: &mut [f64]) {
        self.apply(d, out);
        self.at_constrained(out, |_| 0.0);
    }

    /// z_f = P^{-1} r_f by one low-order solve, z_c = 0.
    pub fn precondition(&self, r: &[f64], z: &mut [f64]) {
        self.preconditioner.apply(r, z);
    }

    /// Solves (equilibrium) for the forces `f`, whose entries at constrained nodes are ignored, by CG to
    /// |residual| <= `tolerance` |f_f - K_fc d_c|. `d` holds the prescribed displacement at constrained nodes and a guess at the others.
    ///
    /// # Errors
    /// [`ElasticityError::Solver`]; `d` then holds the last iterate.
    pub fn solve(&self, f: &[f64], d: &mut [f64], tolerance: f64) -> Result<cg::Report, ElasticityError> {
        debug_assert_eq!((f.len(), d.len()), (self.length(), self.length()));
        self.solve_equilibrium(Some(f), d, tolerance)
    }

    /// Extends the displacement at constrained nodes to the others: K_ff d_f = -K_fc d_c. `d` holds a guess at free nodes.
    ///
    /// An increment of the boundary position reaches the mesh in this way only. A boundary that moves alone inverts the cells at it.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn extend(&self, d: &mut [f64], tolerance: f64) -> Result<cg::Report, ElasticityError> {
        self.solve_equilibrium(None, d, tolerance)
    }

    fn solve_equilibrium(
        &self,
        f: Option<&[f64]>,
        d: &mut [f64],
        tolerance: f64,
    ) -> Result<cg::Report, ElasticityError> {
        if let Some(direct) = &self.direct {
            let none = f.is_none().then(|| vec![0.0; d.len()]);
            direct.solve(self, f.or(none.as_deref()).unwrap_or(&[]), d);
            return Ok(cg::Report::default());
        }
        let mut work = self.solves.take(|| SolveWork::new(self.length()));
        let SolveWork { right_hand_side, solution, cg } = &mut work;
        self.right_hand_side(f, d, solution, right_hand_side);
        solution.copy_from_slice(d);
        self.at_constrained(solution, |_| 0.0);
        if right_hand_side.iter().all(|&b| b == 0.0) {
            // No tolerance relative to zero can be met from a guess.
            solution.fill(0.0);
        }
        let settings =
            cg::Settings { relative_tolerance: tolerance, max_iterations: MAX_ITERATIONS, ..Default::default() };
        let result = cg::solve(&mut FreeNodes(self), right_hand_side, solution, &settings, cg);
        self.at_free(d, |i| solution[i]);
        self.solves.give(work);
        Ok(result?)
    }

    /// b = f_f - K_fc d_c at free nodes, 0 at the others.
    pub(crate) fn right_hand_side(&self, f: Option<&[f64]>, d: &[f64], boundary: &mut [f64], b: &mut [f64]) {
        boundary.copy_from_slice(d);
        self.at_free(boundary, |_| 0.0);
        self.apply(boundary, b);
        for (i, b) in b.iter_mut().enumerate() {
            *b = f.map_or(0.0, |f| f[i]) - *b;
        }
        self.at_constrained(b, |_| 0.0);
    }

    /// Sets the entries of free nodes.
    fn at_free(&self, vector: &mut [f64], value: impl Fn(usize) -> f64) {
        self.set(false, vector, value);
    }

    /// Sets the entries of constrained nodes.
    pub(crate) fn at_constrained(&self, vector: &mut [f64], value: impl Fn(usize) -> f64) {
        self.set(true, vector, value);
    }

    fn set(&self, constrained: bool, vector: &mut [f64], value: impl Fn(usize) -> f64) {
        for (node, _) in self.constrained.iter().enumerate().filter(|(_, c)| **c == constrained) {
            (node * D..(node + 1) * D).for_each(|i| vector[i] = value(i));
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

fn check_constraints(numbering: &NodeNumbering, constrained: &[bool]) -> Result<(), ElasticityError> {
    if constrained.len() != numbering.count {
        let (found, expected) = (constrained.len(), numbering.count);
        return Err(ElasticityError::Length { array: "the list of constrained nodes", found, expected });
    }
    if constrained.contains(&true) { Ok(()) } else { Err(ElasticityError::Unconstrained) }
}

impl SolveWork {
    fn new(length: usize) -> Self {
        SolveWork { right_hand_side: vec![0.0; length], solution: vec![0.0; length], cg: cg::Workspace::default() }
    }
}

/// K_ff and its preconditioner, on vectors that vanish at constrained nodes.
struct FreeNodes<'a, const D: usize>(&'a ElasticMesh<D>);

impl<const D: usize> LinearSystem for FreeNodes<'_, D> {
    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        self.0.apply_free(x, y);
    }
    fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        self.0.precondition(r, z);
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        &Euclidean
    }
}

mod position;
#[cfg(test)]
mod tests;
