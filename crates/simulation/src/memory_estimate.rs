//! The memory of a run, estimated beforehand.

mod mesh;

use crate::averages::Moments;
use crate::bodies;
use crate::error::Failure;
use ::mesh::{Mesh, NodeNumbering};
use case::memory;
use case::{Case, Flow, Motion, Preconditioner, Steady, SteadyBodies};
use coupled::preconditioner::{CoarseLevelUse, LOW_ORDER_VECTORS, coarse_functions_per_direction, padded};
use fem::Orders;
use navier_stokes::Viscosity;
use newton_krylov::fgmres::Precision;

/// Krylov iterations of a typical Newton step.
pub fn typical_iterations<const D: usize>(case: &Case<D>) -> usize {
    if case.preconditioner() == Preconditioner::LowOrder { 16 } else { 8 }
}

/// The memory of the program for a small case: its code, libraries, and the buffers of the result file. It is 28 to 41 MB on the machines
/// where it was measured.
pub const PROGRAM_BYTES: usize = 37_000_000;

/// The number of vectors as long as the unknowns of the flow in a slab, without those of the linear solver and of the operator. They are states,
/// residuals, increments and weights of Newton's method, and the slab before.
const VECTORS: usize = 12;

/// The same for the unknowns of an elastic mesh, in addition to every mesh.
const VECTORS_OF_MESH: usize = 6;

/// The count of numbers in single precision per entry of a block while a thread inverts it: its parts, panels of their rows, and the data for
/// neighbours.
const NUMBERS_TO_INVERT: usize = 11;

/// The count of numbers in factors and work space of the coarse level, relative to b^2 n log2 n for n aggregates of b coarse
/// unknowns. It is 5 to 9 on airfoils and cylinders of 250 to 3600 cells.
const COARSE_FILL: f64 = 8.0;

/// The estimate is accurate to a fifth. A run is refused if it needs this many times the available memory.
const MARGIN: f64 = 1.25;

/// Bytes of the parts of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MemoryEstimate {
    /// The Jacobian of the operator of space, for the preconditioner.
    pub jacobian: usize,
    /// The factors of the preconditioner.
    pub factors: usize,
    /// The vectors of Newton's method, and those of the linear solver in a typical step.
    pub vectors: usize,
    /// The vectors of the linear solver, if it uses all permitted iterations.
    pub most_krylov: usize,
    /// The mesh, by its order, and its solver.
    pub mesh: usize,
    /// The sums of averages over time.
    pub averages: usize,
    /// The memory of the search for the steady flow, if the run begins with it: what ranks share, and a mesh. Its preconditioner is freed
    /// before that of the slabs is allocated.
    pub steady: Option<[usize; 2]>,
}

/// The factor of a structure.
fn structure<const D: usize>(case: &Case<D>) -> usize {
    let Some(structure) = &case.structure else { return 0 };
    let mesh: &Mesh<D> = structure.part.as_ref().map_or(&case.mesh, |part| &part.mesh);
    elasticity::factor_bytes(D, D * NodeNumbering::new(mesh, mesh.order()).count)
}

/// The bytes of a number of a Krylov vector.
fn krylov_bytes<const D: usize>(case: &Case<D>) -> usize {
    let unknowns = case.time.order * bodies::coordinates(case).iter().sum::<usize>();
    match coupled::krylov_precision(matches!(case.motion, Some(Motion::Followed)), unknowns) {
        Precision::Single => 4,
        Precision::Double => 8,
    }
}

impl MemoryEstimate {
    /// Of a run of `case`, whose elastic mesh has the solver of `plan`.
    pub fn new<const D: usize>(case: &Case<D>, plan: Option<&elasticity::Plan>) -> Self {
        let memory = MemoryEstimate::of_flow(case);
        // The solver of a slab is freed when that of the next one is there.
        let is_updated = matches!(&case.motion, Some(Motion::Elastic { law, .. }) if *law != elasticity::Law::Linear);
        let solver = plan.map_or(0, |plan| if is_updated { 2 * plan.bytes } else { plan.bytes });
        MemoryEstimate { mesh: memory.mesh + solver + structure(case), ..memory }
    }

    /// The same without the solver of the mesh, whose plan takes long.
    fn of_flow<const D: usize>(case: &Case<D>) -> Self {
        let flow = case.flow_unknowns();
        let mesh = case.mesh_unknowns().unwrap_or(0);
        let vector = krylov_bytes(case) * (flow + mesh);
        let restart = case.solver.krylov_restart.min(case.solver.krylov_iterations);
        let newton = 8 * (flow * VECTORS + operator_vectors(case) + mesh * VECTORS_OF_MESH);
        let vectors = newton + vector * krylov_vectors(restart.min(typical_iterations(case)));
        let time_order = case.time.order;
        let (jacobian, factors_of_slab) = match case.preconditioner() {
            Preconditioner::Blocks => (jacobian(case), factors(case, time_order) + coarse_level_of_slabs(case)),
            Preconditioner::Lines => lines(case, time_order),
            Preconditioner::LowOrder => node_blocks(case, time_order),
        };
        let of_mesh = mesh::bytes(case) + geometry(case);
        let steady = |steady: Steady| {
            let search = vectors / time_order + steady_preconditioner(case);
            // Slabs with one time node, on a mesh of their own.
            let equilibrium = vectors / time_order + jacobian + factors_of_slab / time_order;
            match steady.bodies {
                SteadyBodies::Equilibrium if equilibrium + of_mesh > search => [equilibrium, of_mesh],
                _ => [search, 0],
            }
        };
        MemoryEstimate {
            jacobian,
            factors: factors_of_slab,
            vectors,
            steady: case.solver.steady.map(steady),
            most_krylov: vector * krylov_vectors(restart),
            mesh: of_mesh,
            averages: averages_bytes(case),
        }
    }

    /// Of one of several ranks: its part of the flow, and all of the mesh.
    fn of_rank<const D: usize>(case: &Case<D>, ranks: usize) -> Self {
        let whole = MemoryEstimate::of_flow(case);
        if ranks == 1 {
            return whole;
        }
        MemoryEstimate {
            jacobian: whole.jacobian / ranks,
            factors: whole.factors / ranks,
            vectors: whole.vectors / ranks,
            most_krylov: whole.most_krylov / ranks,
            mesh: whole.mesh,
            averages: whole.averages / ranks,
            steady: whole.steady.map(|[flow, mesh]| [flow / ranks, mesh]),
        }
    }

    /// The largest memory of a typical run.
    pub fn peak(&self) -> usize {
        let slab = self.jacobian + self.factors + self.vectors;
        PROGRAM_BYTES + self.averages + self.mesh + slab.max(self.steady.map_or(0, |steady| steady.iter().sum()))
    }
}

/// Refuses a run in which this rank, one of `ranks`, needs more memory than is available, by a margin wider than the error of the estimate.
///
/// # Errors
/// The memory needed, and the memory available.
pub fn require_memory<const D: usize>(case: &Case<D>, ranks: usize) -> Result<(), Failure> {
    let needed = MemoryEstimate::of_rank(case, ranks).peak();
    let Some(_) = memory::shortage((needed as f64 / MARGIN) as u64) else { return Ok(()) };
    let shortage = memory::shortage(needed as u64).unwrap_or_default();
    Err(Failure::bad_input(anyhow::anyhow!(
        "the run does not fit into memory: {shortage}; fewer cells or a lower `flow.order` need less, and so does `solver.preconditioner = \
         \"low_order\"`; `stsolve check` tells the parts"
    )))
}

/// The sums and offsets of averages at all nodes of the flow.
pub(crate) fn averages_bytes<const D: usize>(case: &Case<D>) -> usize {
    let (Some(averages), Some(flow)) = (&case.averages, &case.flow) else { return 0 };
    let (moments, phases) = (Moments::new::<D>(&averages.fields), averages.phases.map_or(1, |phases| phases.count));
    8 * case.mesh.n_cells() * flow.order.pow(D as u32) * (phases * moments.len() + moments.quantities.len())
}

/// Numbers of the operator of the flow: the state, the derivatives of state and direction on faces, and the terms of both sides of facets. A
/// face has 1 / N of the unknowns of its cell. Flows without viscosity have no derivatives, and half of the terms.
fn operator_vectors<const D: usize>(case: &Case<D>) -> usize {
    let Some(flow) = &case.flow else { return 0 };
    let on_faces = if is_viscous(flow) { 4 } else { 1 };
    case.flow_unknowns() * (flow.order + on_faces * 2 * D) / flow.order
}

fn is_viscous<const D: usize>(flow: &case::Flow<D>) -> bool {
    flow.law.shock_capturing.is_some() || flow.law.gas.viscosity() != Viscosity::Inviscid
}

/// The geometry that the flow keeps at its points.
fn geometry<const D: usize>(case: &Case<D>) -> usize {
    let (mesh, Some(flow)) = (&case.mesh, &case.flow) else { return 0 };
    let orders = Orders { flow: flow.order, mesh: mesh.order(), time: case.time.order };
    let viscous = is_viscous(flow);
    let facets = mesh.interior_facets().len() + mesh.boundary_facets().len();
    fem::kept_geometry_bytes(D, orders, flow.quadrature, viscous, [mesh.n_cells(), facets])
}

/// v_0 ... v_k and z_1 ... z_k after k iterations of FGMRES.
fn krylov_vectors(iterations: usize) -> usize {
    2 * iterations + 1
}

/// The sizes of the blocks of a flow.
struct BlockSizes {
    /// Unknowns of a cell at one time.
    cell: usize,
    /// Nodes of a cell.
    nodes: usize,
    /// Traces of a face.
    traces: usize,
}

impl BlockSizes {
    fn new<const D: usize>(flow: &Flow<D>) -> Self {
        let (nodes, kinds) = (flow.order.pow(D as u32), 1 + usize::from(is_viscous(flow)));
        BlockSizes { cell: (D + 2) * nodes, nodes, traces: kinds * (D + 2) * nodes / flow.order }
    }
}

/// Entries of the Jacobian: the square of a cell's unknowns and of its nodes, and twice the square of the traces of a facet. Beside them, entries
/// that only its assembly needs: the square of the traces for each side of a facet.
fn jacobian_entries<const D: usize>(case: &Case<D>) -> (usize, usize) {
    let (mesh, Some(flow)) = (&case.mesh, &case.flow) else { return (0, 0) };
    let BlockSizes { cell, nodes, traces } = BlockSizes::new(flow);
    let (interior, boundary) = (mesh.interior_facets().len(), mesh.boundary_facets().len());
    let kept = mesh.n_cells() * (cell * cell + nodes * nodes) + 2 * interior * traces * traces;
    (kept, (2 * interior + boundary) * traces * traces)
}

/// In single precision, and what its assembly needs in double precision.
fn jacobian<const D: usize>(case: &Case<D>) -> usize {
    let (kept, assembly) = jacobian_entries(case);
    4 * kept + 8 * assembly
}

/// In bfloat16: the square of a cell's unknowns for each time node, and of the traces for either side of a facet. In single precision:
/// the data to invert a block, per thread.
fn factors<const D: usize>(case: &Case<D>, time_order: usize) -> usize {
    let (mesh, Some(flow)) = (&case.mesh, &case.flow) else { return 0 };
    let BlockSizes { cell, traces, .. } = BlockSizes::new(flow);
    let stored =
        mesh.n_cells() * time_order * cell * padded(cell) + 2 * mesh.interior_facets().len() * traces * padded(traces);
    2 * stored + 4 * rayon::current_num_threads() * NUMBERS_TO_INVERT * cell * cell
}

/// For the preconditioner by directions, in single precision. Every axis of a cell has the squares of the unknowns and of the nodes of a
/// line. The former, padded, occurs once for a real mode and four times for a complex pair.
fn lines<const D: usize>(case: &Case<D>, time_order: usize) -> (usize, usize) {
    let (mesh, Some(flow)) = (&case.mesh, &case.flow) else { return (0, 0) };
    let (axes, line) = (D * mesh.n_cells(), (D + 2) * flow.order);
    let matrices = time_order % 2 + 4 * (time_order / 2);
    (4 * axes * (line * line + flow.order * flow.order), 4 * axes * matrices * line * padded(line))
}

/// That of the search for a steady flow, with its coarse level; the Jacobian is in double precision.
fn steady_preconditioner<const D: usize>(case: &Case<D>) -> usize {
    if case.preconditioner() == Preconditioner::LowOrder {
        let (blocks, factors) = node_blocks(case, 1);
        return blocks + factors;
    }
    let (kept, assembly) = jacobian_entries(case);
    8 * (kept + assembly) + factors(case, 1) + coarse_level(case, CoarseLevelUse::Undamped)
}

/// Blocks between nodes in half precision, those of a node itself in single precision, the node's mass and neighbours; the factors, and the
/// vectors of the iteration inside.
fn node_blocks<const D: usize>(case: &Case<D>, time_order: usize) -> (usize, usize) {
    let (mesh, Some(flow)) = (&case.mesh, &case.flow) else { return (0, 0) };
    let (nodes, block) = (mesh.n_cells() * flow.order.pow(D as u32), (D + 2) * (D + 2));
    let neighbours = 4 * 2 * D * nodes / flow.order;
    let jacobian = nodes * (block * (2 * 2 * D + 4) + 8) + neighbours;
    (jacobian, nodes * time_order * (2 * block + 4 * LOW_ORDER_VECTORS * (D + 2)))
}

/// The coarse level of slabs, in single precision. Large meshes have one if slabs take many iterations.
fn coarse_level_of_slabs<const D: usize>(case: &Case<D>) -> usize {
    let Some(flow) = &case.flow else { return 0 };
    let most = CoarseLevelUse::Always.most_aggregates(D + 2, D as u32, flow.order);
    let has_one = case.mesh.n_cells() > most;
    if has_one { coarse_level(case, CoarseLevelUse::Always) } else { 0 }
}

/// The direct solver of the coarse level, and the products of the Jacobian with coarse functions. For a steady flow there is one time
/// node, in double precision.
fn coarse_level<const D: usize>(case: &Case<D>, when: CoarseLevelUse) -> usize {
    let (mesh, Some(flow)) = (&case.mesh, &case.flow) else { return 0 };
    let most = when.most_aggregates(D + 2, D as u32, flow.order);
    let BlockSizes { cell, nodes, traces } = BlockSizes::new(flow);
    let functions = coarse_functions_per_direction(flow.order).pow(D as u32);
    let (block, cells, interior) = ((D + 2) * functions, mesh.n_cells(), mesh.interior_facets().len());
    let products = block * (cells * cell + 2 * interior * traces) + 2 * functions * cells * nodes;
    // Pairs of cells, pairs of these, and so on.
    let halvings = (0..).find(|k| cells >> k <= most).unwrap_or_default();
    let aggregates = (cells >> halvings).max(2) as f64;
    let factors = COARSE_FILL * (block as f64).powi(2) * aggregates * aggregates.log2();
    match when {
        CoarseLevelUse::Undamped => 8 * (products + factors as usize),
        CoarseLevelUse::Always => 4 * (products + case.time.order * factors as usize),
    }
}
