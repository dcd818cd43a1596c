//! The memory of a run, estimated beforehand.

use super::Facts;
use super::measured::TYPICAL_ITERATIONS;
use crate::run::elasticity_plan;
use coupled::preconditioner::padded;
use navier_stokes::Viscosity;

/// What the program takes before a case is large: its code, libraries, and the buffers of the result file.
const PROGRAM: usize = 27_000_000;

/// Vectors as long as the unknowns of a slab, without those of the linear solver: states, residuals and increments of Newton's method,
/// traces of the operator.
const VECTORS: usize = 26;

/// Numbers per entry of a block while it is inverted: real and imaginary part, what neighbours subtract, the complex matrix, its factors,
/// its inverse, and that in parts.
const NUMBERS_TO_INVERT: usize = 11;

/// Bytes of the parts of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Memory {
    /// The Jacobian of the operator of space, from which the preconditioner is made.
    pub(super) jacobian: usize,
    /// The factors of the preconditioner.
    pub(super) factors: usize,
    /// The vectors of Newton's method, and those of the linear solver in a typical step.
    pub(super) vectors: usize,
    /// The vectors of the linear solver, if it takes all iterations that it is allowed.
    pub(super) most_krylov: usize,
    /// The solver of the mesh.
    pub(super) mesh: usize,
}

impl Memory {
    /// Of the case in `facts`.
    pub(super) fn new<const D: usize>(facts: &Facts<'_, D>) -> Self {
        let case = facts.case;
        let (_, flow) = facts.flow_unknowns();
        let vector = 8 * (flow + case.mesh_unknowns().unwrap_or(0));
        let restart = case.solver.krylov_restart.min(case.solver.krylov_iterations);
        let (jacobian, factors) = blocks(facts);
        Memory {
            jacobian,
            factors,
            vectors: vector * (VECTORS + krylov_vectors(restart.min(TYPICAL_ITERATIONS))),
            most_krylov: vector * krylov_vectors(restart),
            mesh: elasticity_plan(case).map_or(0, |plan| plan.bytes),
        }
    }

    /// The largest memory of a run that goes as most do.
    pub(super) fn peak(&self) -> usize {
        PROGRAM + self.jacobian + self.factors + self.vectors + self.mesh
    }
}

/// v_0 ... v_k and z_1 ... z_k after k iterations of FGMRES.
fn krylov_vectors(iterations: usize) -> usize {
    2 * iterations + 1
}

/// The bytes of Jacobian and factors, with b the unknowns of a cell at one time, t the traces of a face:
///
/// ```text
/// Jacobian:  b^2 and (nodes)^2 for a cell; while it is made, t^2 for rows and columns of either side of a facet
/// factors:   b^2 for a cell and time node, 2 t^2 for a facet, in single precision; what inverts a block, for a thread
/// ```
fn blocks<const D: usize>(facts: &Facts<'_, D>) -> (usize, usize) {
    let Some(flow) = &facts.case.flow else { return (0, 0) };
    let (mesh, threads) = (&facts.case.mesh, rayon::current_num_threads());
    let nodes = flow.order.pow(D as u32);
    let (block, _) = facts.flow_unknowns();
    let kinds = if flow.law.gas.viscosity() == Viscosity::Inviscid { 1 } else { 2 };
    let traces = kinds * (D + 2) * nodes / flow.order;
    let (cells, interior, boundary) = (mesh.n_cells(), mesh.interior_facets().len(), mesh.boundary_facets().len());
    let jacobian = cells * (block * block + nodes * nodes) + (4 * interior + boundary) * traces * traces;
    let factors = cells * facts.case.time.order * block * padded(block) + 2 * interior * traces * padded(traces);
    (8 * jacobian, 4 * factors + 8 * threads * NUMBERS_TO_INVERT * block * block)
}
