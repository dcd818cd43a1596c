//! From a checked case to the problem of the numerics.

use crate::case::{Case, Flow, Jacobian, Motion, Predictor, State, Stiffness, Structure, Support, Vector};
use coupled::{BoundaryMotion, March, MeshMotion, MeshMover, SlabProblem, StructureMarch};
use elasticity::{Accuracy, Dynamics, ElasticMesh, ElasticityError, Loads, Material, Structure as Body, Traction};
use fem::{Orders, Problem, SlabOperator, StateField, VectorField};
use mesh::NodeNumbering;
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};
use std::sync::Arc;

/// Tolerance of a solve with K: displacements are then good to round-off.
const ELASTIC_TOLERANCE: f64 = 1e-13;

/// The same where K only preconditions, because the law is not linear.
const PRECONDITIONER_TOLERANCE: f64 = 1e-3;

/// The mover of the mesh of a case.
///
/// # Errors
/// As [`ElasticMesh::new`].
pub fn mover<const D: usize>(case: &Case<D>) -> Result<MeshMover<D>, ElasticityError> {
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let motion = match &case.motion {
        None => MeshMotion::Still,
        Some(Motion::Prescribed(displacement)) => MeshMotion::Prescribed(Arc::new(displacement.clone())),
        Some(Motion::Elastic { poisson_ratio, stiffness, law, tolerance, boundary }) => {
            let (constrained, boundary) = constraints(case, &numbering, boundary);
            let function = |x: &[f64; D]| match stiffness {
                Stiffness::Expression(modulus) => modulus.evaluate(x, 0.0),
                _ => 1.0,
            };
            let stiffness = match stiffness {
                Stiffness::Constant => elasticity::Stiffness::Constant,
                Stiffness::InverseJacobian { power } => elasticity::Stiffness::InverseJacobian { power: *power },
                Stiffness::Expression(_) => elasticity::Stiffness::Function(&function),
            };
            let material = Material::new(1.0, *poisson_ratio)?.with_law(*law);
            let mesh = ElasticMesh::new(&case.mesh, &numbering, material, stiffness, &constrained)?;
            let solve = if law.is_linear() { ELASTIC_TOLERANCE } else { PRECONDITIONER_TOLERANCE };
            let accuracy = Accuracy { solve, position: *tolerance };
            MeshMotion::Elastic { mesh: Box::new(mesh), boundary, accuracy }
        }
    };
    Ok(MeshMover::new(motion, case.mesh.clone(), numbering, case.time.order))
}

/// Which nodes are constrained, and how they move. A node on several boundaries moves with the first of them that moves.
fn constraints<const D: usize>(
    case: &Case<D>,
    numbering: &NodeNumbering,
    boundary: &[Option<Vector<D>>],
) -> (Vec<bool>, BoundaryMotion<D>) {
    let mut constrained = vec![false; numbering.count];
    let mut field_of_node = vec![None; numbering.count];
    let mut fields: Vec<Arc<dyn VectorField<D>>> = Vec::new();
    for (index, displacement) in boundary.iter().enumerate() {
        let nodes = numbering.on_boundary(&case.mesh, index);
        nodes.iter().for_each(|&node| constrained[node] = true);
        let Some(displacement) = displacement else { continue };
        for node in nodes {
            field_of_node[node].get_or_insert(fields.len());
        }
        fields.push(Arc::new(displacement.clone()));
    }
    (constrained, BoundaryMotion { fields, field_of_node })
}

/// The march of a case with a flow, at its start.
///
/// # Errors
/// As [`ElasticMesh::new`].
pub fn march<const D: usize, const M: usize>(case: &Case<D>, flow: &Flow<D>) -> Result<March<D, M>, ElasticityError>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let mover = mover(case)?;
    let orders = Orders { flow: flow.order, mesh: case.mesh.order(), time: case.time.order };
    let mut operator = SlabOperator::new(problem(flow), &case.mesh, mover.numbering.clone(), orders, flow.quadrature);
    operator.mesh.set_bottom(Some(&mover.displacement_at_start(case.time.start)));
    let u = coupled::interpolate(&operator, &Exact(flow.initial.clone()), case.time.start);
    Ok(March::new(SlabProblem::new(operator, mover), u, settings(case)))
}

/// The problem of the steady flow of a case, on the mesh at rest.
pub fn steady<const D: usize, const M: usize>(case: &Case<D>, flow: &Flow<D>) -> SlabProblem<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let orders = Orders { flow: flow.order, mesh: case.mesh.order(), time: 1 };
    let operator = SlabOperator::new(problem(flow), &case.mesh, numbering.clone(), orders, flow.quadrature);
    SlabProblem::new(operator, MeshMover::new(MeshMotion::Still, case.mesh.clone(), numbering, 1))
}

/// The march of a structure, at its start.
///
/// # Errors
/// As [`Body::new`] and [`Dynamics::new`].
pub fn structure_march<const D: usize>(
    case: &Case<D>,
    structure: &Structure<D>,
) -> Result<StructureMarch<D>, ElasticityError> {
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let (fixed, supports) = supports(case, &numbering, &structure.boundary);
    let material = Material::new(structure.young_modulus, structure.poisson_ratio)?;
    let body = Body::new(case.mesh.clone(), numbering, material, structure.density, fixed)?;
    let start = |field: &Option<Vector<D>>| -> Vec<f64> {
        let value = |x: &[f64; D]| field.as_ref().map_or([0.0; D], |field| field.evaluate(x, case.time.start));
        body.coordinates().iter().flat_map(value).collect()
    };
    let (d, v) = (start(&structure.displacement), start(&structure.velocity));
    let dynamics = Dynamics::new(body, loads(structure), case.time.order, case.time.step)?;
    Ok(StructureMarch::new(dynamics, supports, d, v, case.time.schedule()))
}

/// Which components of which nodes are prescribed, and how they move. A node on several boundaries moves with the first of them that
/// moves.
fn supports<const D: usize>(
    case: &Case<D>,
    numbering: &NodeNumbering,
    boundary: &[Support<D>],
) -> (Vec<[bool; D]>, BoundaryMotion<D>) {
    let mut fixed = vec![[false; D]; numbering.count];
    let moved = |support: &Support<D>| if let Support::Moved(g) = support { Some(g.clone()) } else { None };
    let (_, motion) = constraints(case, numbering, &boundary.iter().map(moved).collect::<Vec<_>>());
    for (index, support) in boundary.iter().enumerate() {
        for node in numbering.on_boundary(&case.mesh, index) {
            (0..D).for_each(|i| fixed[node][i] |= support.fixes()[i]);
        }
    }
    (fixed, motion)
}

fn loads<const D: usize>(structure: &Structure<D>) -> Loads<D> {
    let body_force = structure.body_force.clone().map(|b| Box::new(move |x: &[f64; D], t: f64| b.evaluate(x, t)) as _);
    let traction = |(index, support): (usize, &Support<D>)| -> Option<(usize, Traction<D>)> {
        match support.clone() {
            Support::Traction(q) => Some((index, Box::new(move |point, t| q.evaluate(&point.position, t)))),
            Support::Pressure(p) => {
                // A pressure pushes against the outward normal.
                Some((index, Box::new(move |point, t| point.normal.map(|n| -p.evaluate(&point.position, t) * n))))
            }
            _ => None,
        }
    };
    Loads { body_force, tractions: structure.boundary.iter().enumerate().filter_map(traction).collect() }
}

fn problem<const D: usize, const M: usize>(flow: &Flow<D>) -> Problem<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let field = |state: &State<D>| Arc::new(Exact(state.clone())) as Arc<dyn StateField<D, M>>;
    let data = flow.boundary.iter().map(|boundary| boundary.state.as_ref().map(field)).collect();
    let conditions = flow.boundary.iter().map(|boundary| boundary.condition).collect();
    let manufactured = flow.exact.clone().filter(|_| flow.manufactured);
    let source = |exact| Arc::new(Manufactured { law: flow.law, exact }) as Arc<dyn StateField<D, M>>;
    Problem { kernels: flow.law.kernels(conditions), data, source: manufactured.map(source) }
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
