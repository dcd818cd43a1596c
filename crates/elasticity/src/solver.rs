//! The choice of the solver of K, and its cost.

use crate::condensation::{Condensation, Elimination};
use crate::geometry::nodal_coordinates;
use crate::low_order::LowOrderInverse;
use crate::substructures::{Cuts, SolverOnBlocks, Substructures};
use fem::NodalBatches;
use mesh::{CellMap, Mesh, NodeNumbering};
use std::sync::Arc;

/// The solver of K_ff d_f = b_f.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Solver {
    /// Chosen by the size of the mesh, see [`Plan`].
    #[default]
    Automatic,
    /// Elimination of the nodes along a tree of parts of the mesh, without iterations.
    Direct,
    /// Conjugate gradients, preconditioned by a factored low-order refinement.
    ConjugateGradients,
    /// Conjugate gradients, preconditioned by algebraic multigrid on the low-order refinement.
    Multigrid,
    /// Conjugate gradients, preconditioned by balancing domain decomposition by constraints: every block of the mesh is factored alone.
    Bddc,
}

/// The solver of a mesh, known before anything is computed.
///
/// The automatic choice is **direct up to 10^11 multiplications and 2^31 bytes, multigrid beyond**. The factorisation is done once in
/// a run; after that a solve costs two passes through the factor. In two dimensions the limit allows millions of unknowns, in three
/// about 10^5. On several blocks of a mesh in two dimensions the direct solver factors them one by one, so that ranks share the work. In three
/// dimensions only BDDC is shared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// The solver, never automatic.
    pub solver: Solver,
    /// Its memory. For a direct solver it is counted, including temporary memory; otherwise it is estimated from the number
    /// of unknowns.
    pub bytes: usize,
}

/// A mesh is factored up to this many multiplications.
const MAX_OPERATIONS: f64 = 1e11;
/// A mesh is factored up to this many bytes.
const MAX_BYTES: usize = 2 << 30;

impl Plan {
    /// The plan for a mesh with displacements of the order of `numbering`, prescribed at `constrained[C0 node][component]`, if
    /// `solver` is requested.
    pub fn new<const D: usize>(
        mesh: &Mesh<D>,
        numbering: &NodeNumbering,
        constrained: &[[bool; D]],
        solver: impl Into<SolverOnBlocks>,
    ) -> Self {
        Self::prepare(mesh, numbering, &NodalBatches::new(numbering), constrained, &solver.into()).0
    }

    /// The same with what the solver needs of the mesh.
    pub(crate) fn prepare<const D: usize>(
        mesh: &Mesh<D>,
        numbering: &NodeNumbering,
        batches: &NodalBatches<D>,
        constrained: &[[bool; D]],
        solver: &SolverOnBlocks,
    ) -> (Self, Prepared<D>) {
        let SolverOnBlocks { solver, partition } = solver;
        let unknowns = constrained.as_flattened().iter().filter(|constrained| !**constrained).count();
        let iterative = |solver| (Plan { solver, bytes: low_order_bytes(D, unknowns, solver) }, Prepared::Nothing);
        let centres = centres(mesh);
        let cuts = || Cuts::new(partition, numbering, constrained, &centres, &nodal_coordinates(mesh, numbering));
        match solver {
            Solver::ConjugateGradients | Solver::Multigrid => return iterative(*solver),
            Solver::Bddc => {
                let cuts = cuts();
                return (Plan { solver: Solver::Bddc, bytes: cuts.bytes() }, Prepared::Cuts(Arc::new(cuts)));
            }
            Solver::Automatic | Solver::Direct => {}
        }
        let elimination = Elimination::new(numbering.order(), batches, constrained, &centres, &[]);
        let bytes = elimination.bytes(batches);
        let is_small = elimination.operations(batches) <= MAX_OPERATIONS && bytes <= MAX_BYTES;
        if *solver != Solver::Direct && !is_small {
            return iterative(Solver::Multigrid);
        }
        let plan = Plan { solver: Solver::Direct, bytes };
        // In space the cuts between blocks are longer than those of a dissection, and cost four times its memory.
        if partition.is_cut() && D == 2 {
            (plan, Prepared::Cuts(Arc::new(cuts())))
        } else {
            (plan, Prepared::Elimination(Arc::new(elimination)))
        }
    }
}

/// The memory of the factor of a structure with so many `unknowns`, estimated, with what its making needs. In three dimensions a compact body of
/// 12,000 to 55,000 unknowns had between 0.8 and 1.2 times as much, a thin plate 0.6 times.
pub fn factor_bytes(dimension: usize, unknowns: usize) -> usize {
    3 * low_order_bytes(dimension, unknowns, Solver::ConjugateGradients) / 2
}

/// What a solver takes from the mesh alone, without a matrix.
pub(crate) enum Prepared<const D: usize> {
    Nothing,
    Elimination(Arc<Elimination<D>>),
    Cuts(Arc<Cuts<D>>),
}

/// The measured memory of the preconditioners. It is proportional to the unknowns, except for a factor in three dimensions, which
/// grows like n^(4/3).
fn low_order_bytes(dimension: usize, unknowns: usize, solver: Solver) -> usize {
    let n = unknowns as f64;
    let per_unknown = match (solver, dimension) {
        (Solver::Multigrid, 2) => 350.0,
        (Solver::Multigrid, _) => 850.0,
        (_, 2) => 820.0,
        _ => 16_000.0 * (n / 1e5).cbrt(),
    };
    (per_unknown * n) as usize
}

/// The centres of the cells.
fn centres<const D: usize>(mesh: &Mesh<D>) -> Vec<[f64; D]> {
    let middle = CellMap::on_grid(mesh.order(), &[0.0]);
    (0..mesh.n_cells()).map(|cell| middle.positions(mesh.cell_coordinates(cell))[0]).collect()
}

/// The prepared K_ff^{-1}, exact or approximate.
pub(crate) enum Inverse<const D: usize> {
    Direct(Box<Condensation<D>>),
    Substructures(Box<Substructures<D>>),
    LowOrder(Box<LowOrderInverse<D>>),
}

impl<const D: usize> Inverse<D> {
    /// Whether it is exact up to round-off.
    pub(crate) fn is_exact(&self) -> bool {
        match self {
            Inverse::Direct(_) => true,
            Inverse::Substructures(substructures) => substructures.is_direct(),
            Inverse::LowOrder(_) => false,
        }
    }

    /// x = P^{-1} x for right-hand sides one after the other, `[right-hand side][C0 node][component]`, that vanish at constrained entries.
    pub(crate) fn solve(&self, batches: &NodalBatches<D>, x: &mut [f64]) {
        match self {
            Inverse::Direct(condensation) => condensation.solve(batches, x),
            Inverse::Substructures(substructures) => substructures.solve(x),
            Inverse::LowOrder(low_order) => {
                for x in x.chunks_exact_mut(batches.nodal_length()) {
                    let r = x.to_vec();
                    low_order.apply(&r, x);
                }
            }
        }
    }

    /// Memory of the factors or the hierarchy on this rank.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Inverse::Direct(condensation) => condensation.bytes(),
            Inverse::Substructures(substructures) => substructures.bytes(),
            Inverse::LowOrder(low_order) => low_order.bytes(),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::Stiffness;
    use crate::testing::{boundary_nodes, clamped_with, unit_box};

    fn plan<const D: usize>(mesh: &Mesh<D>, solver: Solver) -> Plan {
        let numbering = NodeNumbering::new(mesh, mesh.order());
        Plan::new(mesh, &numbering, &boundary_nodes(mesh, &numbering), solver)
    }

    #[test]
    fn plane_meshes_and_small_ones_in_space_are_factored_and_large_ones_in_space_are_not() {
        let chosen = |plan: Plan| plan.solver;
        assert_eq!(chosen(plan(&unit_box([75, 75], 4, 0.0), Solver::Automatic)), Solver::Direct);
        assert_eq!(chosen(plan(&unit_box([15, 15], 16, 0.0), Solver::Automatic)), Solver::Direct);
        assert_eq!(chosen(plan(&unit_box([6, 6, 6], 4, 0.0), Solver::Automatic)), Solver::Direct);
        assert_eq!(chosen(plan(&unit_box([16, 16, 16], 4, 0.0), Solver::Automatic)), Solver::Multigrid);
        assert_eq!(chosen(plan(&unit_box([2, 2, 2], 16, 0.0), Solver::Automatic)), Solver::Multigrid);
        for asked in [Solver::Direct, Solver::ConjugateGradients, Solver::Multigrid] {
            assert_eq!(chosen(plan(&unit_box([2, 2, 2], 3, 0.0), asked)), asked);
        }
    }

    /// The estimates hold to a factor of about two; the count covers all stored data.
    fn assert_memory<const D: usize>(mesh: &Mesh<D>) {
        for solver in [Solver::Direct, Solver::ConjugateGradients, Solver::Multigrid] {
            let found = clamped_with(mesh, mesh.order(), Stiffness::Constant, solver).solver_bytes() as f64;
            let ratio = plan(mesh, solver).bytes as f64 / found;
            assert!(ratio > 0.5 && ratio < 2.5, "{solver:?}: {ratio:.2} of {found} bytes");
            assert!(solver != Solver::Direct || ratio >= 1.0);
        }
    }

    #[test]
    fn planned_memory_is_what_is_used() {
        assert_memory(&unit_box([40, 40], 4, 0.0));
        assert_memory(&unit_box([12, 12], 8, 0.0));
        assert_memory(&unit_box([6, 6, 6], 4, 0.0));
    }
}
