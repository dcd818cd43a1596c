//! From a checked case to the problem of the numerics.

mod driven_bodies;
mod mesh_motion;
mod no_slip_walls;
mod structure;

pub use driven_bodies::nodes_of_driven_bodies;
pub use mesh_motion::{PrescribedNode, elasticity_plan, mover, mover_of, mover_without_flow, prescribed_nodes};
pub use structure::{StructureAtStart, solid, structure_at_start, structure_march, supported};

use super::bodies::bodies;
use super::fallback::split_form;
use case::{BoundaryData, Case, Flow, Jacobian, Preconditioner, Predictor, Source};
use coupled::{
    Discretisation, Discretised, FlowMarch, LaggedPreconditioner, MeshMotion, MeshMover, Method, Schedule, System,
};
use elasticity::ElasticityError;
use fem::{Orders, Problem, Share, SlabOperator, StateField};
use mesh::NodeNumbering;
use navier_stokes::{Boundary, Compiled, Exact, Manufactured, NavierStokes, Outflow, Riemann};
use no_slip_walls::{contradicts, layer_at, no_slip_walls};
use std::sync::Arc;

/// The march of a case with a flow, at its start.
///
/// # Errors
/// As [`elasticity::ElasticMesh::new`].
pub fn march<const D: usize, const M: usize>(case: &Case<D>, flow: &Flow<D>) -> Result<FlowMarch<D, M>, ElasticityError>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    march_of(case, flow, mover(case)?, Share::whole(&case.mesh))
}

/// The march of a case with a flow, at its start, on a mesh with this `motion` in place of that of the case.
///
/// # Errors
/// As [`march`].
pub fn march_with_motion<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    motion: MeshMotion<D>,
) -> Result<FlowMarch<D, M>, ElasticityError>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let mover = MeshMover::new(motion, case.mesh.clone(), numbering, case.time.order);
    march_of(case, flow, mover, Share::whole(&case.mesh))
}

/// The flow of a case on the cells of `share`, on the mesh at rest at the start.
pub fn operator<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    mover: &MeshMover<D>,
    share: Share,
) -> SlabOperator<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let orders = Orders { flow: flow.order, mesh: case.mesh.order(), time: case.time.order };
    let mut operator =
        SlabOperator::of_share(problem(flow), &case.mesh, &mover.numbering, orders, flow.quadrature, share);
    operator.set_displacement(&mover.displacement_at_start(case.time.start));
    operator
}

/// The march on the cells of `share`.
///
/// # Errors
/// As [`elasticity::ElasticMesh::new`].
pub fn march_of<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    mover: MeshMover<D>,
    share: Share,
) -> Result<FlowMarch<D, M>, ElasticityError>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let operator = operator(case, flow, &mover, share);
    let u = initial(case, flow, &operator, &mover);
    let system = system(case, flow, mover, operator)?;
    let mut march = FlowMarch::new(system, u, settings(case));
    // A given thickness stays, and a run that continues another one has its boundary layers.
    if case.solver.start_layer.is_none() && case.solver.steady.is_none() && case.restart.is_none() {
        let mover = march.solver.system.mover();
        let walls = no_slip_walls(case, flow, mover);
        if contradicts::<D, M>(&walls, flow, mover, case.time.start) {
            march.solver.start_layer = layer_at(&walls);
        }
    }
    Ok(march)
}

/// In a longer slab, in time units of the flow, Newton's method may fail in a flow that the mesh resolves.
const LONG_SLAB: f64 = 0.2;

/// The longest slab at which a run goes on in a split form at once if an unresolved flow cannot be solved. Shocks are not resolved on purpose:
/// their artificial viscosity may do with shorter slabs.
pub fn gives_way<const D: usize>(case: &Case<D>, flow: &Flow<D>) -> Option<f64> {
    let may = split_form(case, flow).is_some() && flow.law.shock_capturing.is_none();
    may.then(|| LONG_SLAB * flow.time_unit())
}

/// The system of a slab: the flow of `operator`, the mesh, and what the flow moves.
fn system<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    mover: MeshMover<D>,
    mut operator: SlabOperator<D, M>,
) -> Result<System<D, M>, ElasticityError> {
    let bodies = bodies(case, flow, &mover.numbering, &mut operator)?;
    let mut system = System::with_bodies(operator, mover, bodies);
    system.flow.preconditioner.method = method(case.preconditioner());
    system.kinetic_scale = 2.0 * flow.law.reference.dynamic_pressure();
    system.volume_scale = flow.time_length.powi(D as i32);
    Ok(system)
}

/// Replaces the discretisation of `march` by that of `flow`, which differs in quadrature and volume flux alone. The state stays.
///
/// # Errors
/// As [`march`].
pub fn discretise_anew<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    march: &mut FlowMarch<D, M>,
) -> Result<(), ElasticityError>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let former = &mut march.solver.system;
    // First, so that there are never two.
    former.flow.preconditioner = LaggedPreconditioner::default();
    let share = Share::clone(&former.flow.operator.share);
    let still = MeshMover::new(MeshMotion::Still, case.mesh.clone(), former.mover().numbering.clone(), case.time.order);
    // The motion of the mesh stays, with what its solver has factored.
    let mover = std::mem::replace(&mut former.mesh.mover, still);
    let operator = operator(case, flow, &mover, share);
    march.solver.system = system(case, flow, mover, operator)?;
    march.solver.gives_way = gives_way(case, flow);
    Ok(())
}

/// The flow at the start of a case, on the cells of `operator`.
pub fn initial<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    operator: &SlabOperator<D, M>,
    mover: &MeshMover<D>,
) -> Vec<f64> {
    let start = case.time.start;
    let mut u = coupled::interpolate(operator, &Exact(flow.initial.clone()), start);
    if let Some(thickness) = case.solver.start_layer.filter(|thickness| *thickness > 0.0) {
        layer_at(&no_slip_walls(case, flow, mover)).apply(operator, mover, thickness, &mut u);
    }
    u
}

fn method(preconditioner: Preconditioner) -> Method {
    match preconditioner {
        Preconditioner::Blocks => Method::BlockIlu,
        Preconditioner::Lines => Method::LineAdi,
        Preconditioner::LowOrder => Method::LowOrder,
    }
}

/// A discretisation of the flow of a case on the cells of `share`, on the mesh at rest with the displacement `d`, and the initial state there.
pub fn steady<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    (share, d): (&Share, &[f64]),
    discretisation: Discretisation,
) -> Discretised<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let Discretisation { order, time_order, dissipative } = discretisation;
    let riemann = if dissipative { Riemann::LaxFriedrichs } else { flow.law.riemann };
    let boundary = flow.boundary.iter().map(at_its_pressure).collect();
    let flow = &Flow { law: NavierStokes { riemann, ..flow.law }, boundary, ..flow.clone() };
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let orders = Orders { flow: order, mesh: case.mesh.order(), time: time_order };
    let mut operator =
        SlabOperator::of_share(problem(flow), &case.mesh, &numbering, orders, flow.quadrature, share.clone());
    operator.set_displacement(d);
    let initial = coupled::interpolate(&operator, &Exact(flow.initial.clone()), case.time.start);
    let mover = MeshMover::new(MeshMotion::Still, case.mesh.clone(), numbering, time_order);
    let mut problem = System::new(operator, mover);
    problem.flow.preconditioner.method = method(case.preconditioner());
    (problem, initial)
}

/// An outflow whose velocity outside follows the gas has its pressure in a steady flow.
fn at_its_pressure<const D: usize>(data: &BoundaryData<D>) -> BoundaryData<D> {
    let condition = if data.control.is_some() { Boundary::Outflow(Outflow::at_points()) } else { data.condition };
    BoundaryData { condition, ..data.clone() }
}

fn problem<const D: usize, const M: usize>(flow: &Flow<D>) -> Problem<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let data = flow.boundary.iter().map(BoundaryData::field).collect();
    let conditions = flow.boundary.iter().map(|boundary| boundary.condition).collect();
    Problem { kernels: flow.law.kernels(conditions), data, source: source(flow) }
}

/// The source of a flow.
fn source<const D: usize, const M: usize>(flow: &Flow<D>) -> Option<Arc<dyn StateField<D, M>>> {
    let source = flow.source.as_ref()?;
    if let Some(formulas) = source.formulas() {
        return Some(Arc::new(formulas.clone()));
    }
    let exact = flow.exact.clone().filter(|_| *source == Source::Manufactured)?;
    Some(Arc::new(Manufactured { law: flow.law, exact }))
}

/// The times when drives of bodies end.
fn releases<const D: usize>(case: &Case<D>) -> Vec<f64> {
    case.bodies.iter().flat_map(|body| &body.freedoms).filter_map(|freedom| freedom.release).collect()
}

fn settings<const D: usize>(case: &Case<D>) -> coupled::Settings {
    let (time, solver) = (&case.time, &case.solver);
    coupled::Settings {
        schedule: Schedule { begins: releases(case), ..time.schedule() },
        newton: solver.newton(),
        predictor: match solver.predictor {
            Predictor::Elastic => coupled::Predictor::Elastic,
            Predictor::Extrapolate => coupled::Predictor::Extrapolated,
            Predictor::Constant => coupled::Predictor::Constant,
        },
        jacobian: match solver.jacobian {
            Jacobian::Exact => coupled::Jacobian::Exact,
            Jacobian::FiniteDifference => coupled::Jacobian::FiniteDifference,
        },
        max_halvings: solver.slab_halvings as u32,
    }
}
