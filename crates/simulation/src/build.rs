//! From a checked case to the problem of the numerics.

use super::bodies::bodies;
use case::expression::Program;
use case::{
    Analysis, Case, Data, Flow, Jacobian, Motion, Plane, PointData, Preconditioner, Predictor, Source, State,
    Stiffness, Structure, StructureLaw, Support, Vector, constrained,
};
use coupled::{
    BoundaryDisplacement, BoundaryField, Discretisation, Discretised, Equations, FlowMarch, LaggedPreconditioner,
    MeshMotion, MeshMover, Method, StartLayer, StructureMarch, Supports, System,
};
use elasticity::{
    Accuracy, Dynamics, ElasticMesh, ElasticityError, Loads, Material, MaterialProperty, Partition, Pressure, Solid,
    Solver, SolverOnBlocks, Statics, Structure as Body, Traction, WallDistance,
};
use fem::{Orders, Problem, Share, SlabOperator, StateField, VectorField};
use mesh::{BoundaryDistance, Mesh, NodeNumbering};
use navier_stokes::{Boundary, Compiled, Exact, ExactState, Manufactured, NavierStokes, Riemann};
use ranks::{Alone, Sums};
use std::sync::Arc;

/// Tolerance of a solve with K: displacements are then accurate to round-off.
const ELASTIC_TOLERANCE: f64 = 1e-13;

/// The same if K only preconditions, for a nonlinear law.
const PRECONDITIONER_TOLERANCE: f64 = 1e-3;

/// The mover of the mesh of a case on one rank.
///
/// # Errors
/// As [`ElasticMesh::new`].
pub fn mover<const D: usize>(case: &Case<D>) -> Result<MeshMover<D>, ElasticityError> {
    mover_of(case, all_blocks(case))
}

/// All blocks of a case on one rank.
fn all_blocks<const D: usize>(case: &Case<D>) -> Arc<Sums> {
    Arc::new(Sums::new(Arc::new(Alone), case.blocks))
}

/// The solver of the mesh on the blocks of a case.
fn on_blocks<const D: usize>(case: &Case<D>, solver: Solver, sums: Arc<Sums>) -> SolverOnBlocks {
    // The case is checked: there are not more blocks than cells.
    let block_of_cell = mesh::blocks(&case.mesh, case.blocks).unwrap_or_default();
    SolverOnBlocks { solver, partition: Partition { block_of_cell, sums } }
}

/// The mover of the mesh of a case, whose solver shares the blocks of `sums` with other ranks. A collective call.
///
/// # Errors
/// As [`ElasticMesh::new`].
pub fn mover_of<const D: usize>(case: &Case<D>, sums: Arc<Sums>) -> Result<MeshMover<D>, ElasticityError> {
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let motion = match &case.motion {
        None => MeshMotion::Still,
        Some(Motion::Prescribed(displacement)) => MeshMotion::Prescribed(Arc::new(displacement.clone())),
        Some(Motion::Followed) => MeshMotion::Followed,
        Some(Motion::Elastic { poisson_ratio, stiffness, law, solver, tolerance, boundary, slides }) => {
            let constrained = constrained(&case.mesh, &numbering, slides);
            let boundary = boundary_motion(case, &numbering, boundary);
            let modulus = modulus(case, stiffness);
            let stiffness = match stiffness {
                Stiffness::Constant => elasticity::Stiffness::Constant,
                Stiffness::InverseJacobian { power } => elasticity::Stiffness::InverseJacobian { power: *power },
                _ => elasticity::Stiffness::Function(&modulus),
            };
            let material = Material::new(1.0, *poisson_ratio)?.with_law(*law);
            let solver = on_blocks(case, *solver, sums);
            let mesh = ElasticMesh::with_solver(&case.mesh, &numbering, material, stiffness, &constrained, solver)?;
            let solve = if law.is_linear() { ELASTIC_TOLERANCE } else { PRECONDITIONER_TOLERANCE };
            let accuracy = Accuracy { solve, position: *tolerance };
            MeshMotion::Elastic { mesh: Box::new(mesh), boundary, accuracy }
        }
    };
    Ok(MeshMover::new(motion, case.mesh.clone(), numbering, case.time.order))
}

/// The solver that the mesh of a case will have, if its interior is elastic.
pub fn elasticity_plan<const D: usize>(case: &Case<D>) -> Option<elasticity::Plan> {
    let Some(Motion::Elastic { solver, slides, .. }) = &case.motion else { return None };
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let constrained = constrained(&case.mesh, &numbering, slides);
    let solver = on_blocks(case, *solver, all_blocks(case));
    Some(elasticity::Plan::new(&case.mesh, &numbering, &constrained, solver))
}

/// A C0 node with a prescribed motion, its position at rest, and its motion.
pub type PrescribedNode<const D: usize> = (usize, [f64; D], Arc<dyn BoundaryField<D>>);

/// The C0 nodes of a case with a prescribed motion: those of boundaries that move, or all.
pub fn prescribed_nodes<const D: usize>(case: &Case<D>) -> Vec<PrescribedNode<D>> {
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let motion: BoundaryDisplacement<D> = match &case.motion {
        None | Some(Motion::Followed) => return Vec::new(),
        Some(Motion::Elastic { boundary, .. }) => boundary_motion(case, &numbering, boundary),
        Some(Motion::Prescribed(displacement)) => {
            let fields = vec![Arc::new(displacement.clone()) as Arc<dyn BoundaryField<D>>];
            BoundaryDisplacement { fields, field_of_node: vec![Some(0); numbering.count] }
        }
    };
    let positions = MeshMover::new(MeshMotion::Still, case.mesh.clone(), numbering, 1).positions().to_vec();
    let node =
        |(node, x): (usize, [f64; D])| motion.field_of_node[node].map(|field| (node, x, motion.fields[field].clone()));
    positions.into_iter().enumerate().filter_map(node).collect()
}

/// Young's modulus as a function of the position at rest.
type Modulus<'a, const D: usize> = Box<dyn Fn(&[f64; D]) -> f64 + Sync + 'a>;

/// Young's modulus, 1 if it is no function of the position.
fn modulus<'a, const D: usize>(case: &Case<D>, stiffness: &'a Stiffness) -> Modulus<'a, D> {
    match stiffness {
        Stiffness::Expression(modulus) => Box::new(|x| modulus.evaluate(x, 0.0)),
        Stiffness::WallDistance { amplitude, distance, inner, outer } => {
            let [inner, outer] = [inner, outer].map(|boundaries| BoundaryDistance::new(&case.mesh, boundaries));
            let law = WallDistance { amplitude: *amplitude, distance: *distance, inner, outer };
            Box::new(move |x| law.modulus(x))
        }
        _ => Box::new(|_| 1.0),
    }
}

/// The motion of the nodes on boundaries. Nodes that a structure moves have none.
fn boundary_motion<const D: usize>(
    case: &Case<D>,
    numbering: &NodeNumbering,
    boundary: &[Option<case::BoundaryMotion<D>>],
) -> BoundaryDisplacement<D> {
    let field = |motion: &case::BoundaryMotion<D>| Arc::new(motion.clone()) as Arc<dyn BoundaryField<D>>;
    let fields = boundary.iter().flatten().map(field).collect();
    let mut field_of_node = moved_by(&case.mesh, numbering, boundary);
    let part = case.structure.as_ref().and_then(|structure| structure.part.as_ref());
    part.iter().flat_map(|part| &part.shared).for_each(|&(_, node)| field_of_node[node] = None);
    BoundaryDisplacement { fields, field_of_node }
}

/// For every C0 node the moving boundary that moves it: the first one that contains it.
fn moved_by<T, const D: usize>(
    mesh: &Mesh<D>,
    numbering: &NodeNumbering,
    boundary: &[Option<T>],
) -> Vec<Option<usize>> {
    let mut moved_by = vec![None; numbering.count];
    let moving = boundary.iter().enumerate().filter(|(_, motion)| motion.is_some());
    for (field, (index, _)) in moving.enumerate() {
        for node in numbering.on_boundary(mesh, index) {
            moved_by[node].get_or_insert(field);
        }
    }
    moved_by
}

/// The march of a case with a flow, at its start.
///
/// # Errors
/// As [`ElasticMesh::new`].
pub fn march<const D: usize, const M: usize>(case: &Case<D>, flow: &Flow<D>) -> Result<FlowMarch<D, M>, ElasticityError>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
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
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
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
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let orders = Orders { flow: flow.order, mesh: case.mesh.order(), time: case.time.order };
    let mut operator =
        SlabOperator::of_share(problem(flow), &case.mesh, &mover.numbering, orders, flow.quadrature, share);
    operator.set_displacement(&mover.displacement_at_start(case.time.start));
    operator
}

/// An operator on all cells of a case for what is measured of the flow, on the mesh at rest at the start.
pub fn measuring_operator<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    mover: &MeshMover<D>,
) -> SlabOperator<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let orders = Orders { flow: flow.order, mesh: case.mesh.order(), time: case.time.order };
    let numbering = mover.numbering.clone();
    let mut operator = SlabOperator::for_measuring(problem(flow), &case.mesh, numbering, orders, flow.quadrature);
    operator.set_displacement(&mover.displacement_at_start(case.time.start));
    operator
}

/// The march on the cells of `share`.
///
/// # Errors
/// As [`ElasticMesh::new`].
pub fn march_of<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    mover: MeshMover<D>,
    share: Share,
) -> Result<FlowMarch<D, M>, ElasticityError>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let operator = operator(case, flow, &mover, share);
    let u = initial(case, flow, &operator, &mover);
    let system = system(case, flow, mover, operator)?;
    let mut march = FlowMarch::new(system, u, settings(case));
    // A given thickness stays, and a run that continues another one has its boundary layers.
    if case.solver.start_layer.is_none() && case.solver.steady.is_none() && case.restart.is_none() {
        march.solver.start_layer = start_layer(flow);
    }
    Ok(march)
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
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
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
    Ok(())
}

/// The flow at the start of a case, on the cells of `operator`.
pub fn initial<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    operator: &SlabOperator<D, M>,
    mover: &MeshMover<D>,
) -> Vec<f64>
where
    Exact<State<D>>: StateField<D, M>,
{
    let start = case.time.start;
    let mut u = coupled::interpolate(operator, &Exact(flow.initial.clone()), start);
    if let Some(thickness) = case.solver.start_layer.filter(|thickness| *thickness > 0.0) {
        start_layer(flow).apply(operator, (mover, start), thickness, &mut u);
    }
    u
}

/// The layer at the walls to which gas sticks.
fn start_layer<const D: usize>(flow: &Flow<D>) -> StartLayer {
    let sticks = |wall: &&case::Wall<D>| {
        matches!(flow.boundary[wall.boundary].condition, Boundary::AdiabaticWall(_) | Boundary::IsothermalWall(_))
    };
    StartLayer::new(flow.walls.iter().filter(sticks).map(|wall| wall.boundary).collect())
}

fn method(preconditioner: Preconditioner) -> Method {
    match preconditioner {
        Preconditioner::Blocks => Method::BlockIlu,
        Preconditioner::Lines => Method::LineAdi,
        Preconditioner::LowOrder => Method::LowOrder,
    }
}

/// A discretisation of the flow of a case on the mesh at rest with the displacement `d`, and the initial state there.
pub fn steady<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    d: &[f64],
    discretisation: Discretisation,
) -> Discretised<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let Discretisation { order, time_order, dissipative } = discretisation;
    let riemann = if dissipative { Riemann::LaxFriedrichs } else { flow.law.riemann };
    let flow = &Flow { law: NavierStokes { riemann, ..flow.law }, ..flow.clone() };
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let orders = Orders { flow: order, mesh: case.mesh.order(), time: time_order };
    let mut operator = SlabOperator::new(problem(flow), &case.mesh, numbering.clone(), orders, flow.quadrature);
    operator.set_displacement(d);
    let initial = coupled::interpolate(&operator, &Exact(flow.initial.clone()), case.time.start);
    let mover = MeshMover::new(MeshMotion::Still, case.mesh.clone(), numbering, time_order);
    let mut problem = System::new(operator, mover);
    problem.flow.preconditioner.method = method(case.preconditioner());
    (problem, initial)
}

/// The march of a structure, at its start.
///
/// # Errors
/// As [`Body::new`], [`Dynamics::new`], [`Statics::new`] and [`StructureMarch::new`].
pub fn structure_march<const D: usize>(
    case: &Case<D>,
    structure: &Structure<D>,
) -> Result<StructureMarch<D>, ElasticityError> {
    let StructureAtStart { body, loads, supports, displacement, velocity } = structure_at_start(case, structure)?;
    let order = case.time.order;
    let equations = match structure.analysis {
        Analysis::Dynamic => Equations::Dynamic(Box::new(Dynamics::new(body, loads, order, case.time.step)?)),
        Analysis::Static => Equations::Static(Box::new(Statics::new(body, loads, order)?)),
    };
    let halvings = case.solver.slab_halvings as u32;
    StructureMarch::new(equations, supports, displacement, velocity, case.time.schedule(), halvings)
}

/// A structure, what acts on it, and its motion at the start, `[C0 node][component]`.
pub struct StructureAtStart<const D: usize> {
    /// Mesh, material, fixed entries.
    pub body: Body<D>,
    /// The loads of the case.
    pub loads: Loads<D>,
    /// The motion of fixed entries.
    pub supports: Supports<D>,
    /// d at the start.
    pub displacement: Vec<f64>,
    /// Its rate.
    pub velocity: Vec<f64>,
}

/// The structure of a case at its start.
///
/// # Errors
/// As [`Body::new`].
pub fn structure_at_start<const D: usize>(
    case: &Case<D>,
    structure: &Structure<D>,
) -> Result<StructureAtStart<D>, ElasticityError> {
    let mesh = structure.mesh(&case.mesh);
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let (fixed, supports) = supports(mesh, &numbering, &structure.boundary);
    // Equilibria do not depend on a density.
    let density = structure.density.unwrap_or(1.0);
    let case::Damping { mass, stiffness } = structure.damping;
    let body = Body::new(mesh.clone(), numbering, solid(structure), density, fixed)?;
    let body = body.with_damping(elasticity::Damping { mass, stiffness });
    let start = |field: &Option<Vector<D>>| -> Vec<f64> {
        let value = |x: &[f64; D]| field.as_ref().map_or([0.0; D], |field| field.evaluate(x, case.time.start));
        body.coordinates().iter().flat_map(value).collect()
    };
    let (displacement, velocity) = (start(&structure.displacement), start(&structure.velocity));
    Ok(StructureAtStart { body, loads: loads(structure), supports, displacement, velocity })
}

/// The material of a structure.
pub fn solid<const D: usize>(structure: &Structure<D>) -> Solid<D> {
    let quantity = |formula: &Program| match formula.as_constant() {
        Some(value) => MaterialProperty::Constant(value),
        None => {
            let formula = formula.clone();
            MaterialProperty::Field(Arc::new(move |x: &[f64; D]| formula.evaluate(x, 0.0)))
        }
    };
    let plane = match structure.plane {
        Plane::Strain => elasticity::Plane::Strain,
        Plane::Stress => elasticity::Plane::Stress,
    };
    Solid {
        young: quantity(&structure.young_modulus),
        poisson: quantity(&structure.poisson_ratio),
        plane,
        law: match structure.law {
            StructureLaw::Linear => elasticity::Law::Linear,
            StructureLaw::StVenantKirchhoff => elasticity::Law::StVenantKirchhoff,
            StructureLaw::NeoHookean => elasticity::Law::NeoHookean,
        },
    }
}

/// The prescribed components of nodes, and their motion.
fn supports<const D: usize>(
    mesh: &Mesh<D>,
    numbering: &NodeNumbering,
    boundary: &[Support<D>],
) -> (Vec<[bool; D]>, Supports<D>) {
    let mut fixed = vec![[false; D]; numbering.count];
    for (index, support) in boundary.iter().enumerate() {
        for node in numbering.on_boundary(mesh, index) {
            (0..D).for_each(|i| fixed[node][i] |= support.fixes()[i]);
        }
    }
    let moved = |support: &Support<D>| if let Support::Moved(g) = support { Some(g.clone()) } else { None };
    let moved: Vec<Option<Vector<D>>> = boundary.iter().map(moved).collect();
    let fields = moved.iter().flatten().map(|g| Arc::new(g.clone()) as Arc<dyn VectorField<D>>).collect();
    (fixed, Supports { fields, field_of_node: moved_by(mesh, numbering, &moved) })
}

fn loads<const D: usize>(structure: &Structure<D>) -> Loads<D> {
    let body_force = structure.body_force.clone().map(|b| Box::new(move |x: &[f64; D], t: f64| b.evaluate(x, t)) as _);
    let traction = |(index, support): (usize, &Support<D>)| -> Option<(usize, Traction<D>)> {
        match support.clone() {
            Support::Traction(q) => Some((index, Box::new(move |point, t| q.evaluate(&point.position, t)))),
            Support::Pressure(p) => {
                // A pressure acts against the outward normal.
                Some((index, Box::new(move |point, t| point.normal.map(|n| -p.evaluate(&point.position, t) * n))))
            }
            _ => None,
        }
    };
    let tractions = structure.boundary.iter().enumerate().filter_map(traction).collect();
    let pressure = |(index, support): (usize, &Support<D>)| -> Option<(usize, Pressure<D>)> {
        let Support::FollowerPressure(p) = support.clone() else { return None };
        Some((index, Box::new(move |x, t| p.evaluate(x, t))))
    };
    let pressures = structure.boundary.iter().enumerate().filter_map(pressure).collect();
    Loads { body_force, tractions, pressures }
}

fn problem<const D: usize, const M: usize>(flow: &Flow<D>) -> Problem<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let field = |data: &Data<D>| match data {
        Data::State(state) => Arc::new(Exact(state.clone())) as Arc<dyn StateField<D, M>>,
        Data::Values(values) => Arc::new(PointData::clone(values)),
    };
    let data = flow.boundary.iter().map(|boundary| boundary.data.as_ref().map(field)).collect();
    let conditions = flow.boundary.iter().map(|boundary| boundary.condition).collect();
    Problem { kernels: flow.law.kernels(conditions), data, source: source(flow) }
}

/// The source of a flow.
fn source<const D: usize, const M: usize>(flow: &Flow<D>) -> Option<Arc<dyn StateField<D, M>>>
where
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let source = flow.source.as_ref()?;
    if let Some(formulas) = source.formulas() {
        return Some(Arc::new(formulas.clone()));
    }
    let exact = flow.exact.clone().filter(|_| *source == Source::Manufactured)?;
    Some(Arc::new(Manufactured { law: flow.law, exact }))
}

fn settings<const D: usize>(case: &Case<D>) -> coupled::Settings {
    let (time, solver) = (&case.time, &case.solver);
    coupled::Settings {
        schedule: time.schedule(),
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
