//! From a checked case to the problem of the numerics.

use crate::case::{Case, Flow, Jacobian, Motion, Predictor, State, Stiffness};
use coupled::{BoundaryField, BoundaryMotion, March, MeshMotion, MeshMover, SlabProblem};
use elasticity::{ElasticMesh, ElasticityError, Material, WallDistance};
use fem::{Orders, Problem, SlabOperator, StateField};
use mesh::{BoundaryDistance, NodeNumbering};
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};
use std::sync::Arc;

/// Tolerance of a solve with K: displacements are then good to round-off.
const ELASTIC_TOLERANCE: f64 = 1e-13;

/// The mover of the mesh of a case.
///
/// # Errors
/// As [`ElasticMesh::new`].
pub fn mover<const D: usize>(case: &Case<D>) -> Result<MeshMover<D>, ElasticityError> {
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let motion = match &case.motion {
        None => MeshMotion::Still,
        Some(Motion::Prescribed(displacement)) => MeshMotion::Prescribed(Arc::new(displacement.clone())),
        Some(Motion::Elastic { poisson_ratio, stiffness, boundary }) => {
            let (constrained, boundary) = constraints(case, &numbering, boundary);
            let modulus = modulus(case, stiffness);
            let stiffness = match stiffness {
                Stiffness::Constant => elasticity::Stiffness::Constant,
                Stiffness::InverseJacobian { power } => elasticity::Stiffness::InverseJacobian { power: *power },
                _ => elasticity::Stiffness::Function(&modulus),
            };
            let material = Material::new(1.0, *poisson_ratio)?;
            let mesh = ElasticMesh::new(&case.mesh, &numbering, material, stiffness, &constrained)?;
            MeshMotion::Elastic { mesh: Box::new(mesh), boundary, tolerance: ELASTIC_TOLERANCE }
        }
    };
    Ok(MeshMover::new(motion, case.mesh.clone(), numbering, case.time.order))
}

/// Young's modulus as a function of the position at rest.
type Modulus<'a, const D: usize> = Box<dyn Fn(&[f64; D]) -> f64 + Sync + 'a>;

/// Young's modulus, 1 where it is no function of the position.
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

/// Which nodes are constrained, and how they move. A node on several boundaries moves with the first of them that moves.
fn constraints<const D: usize>(
    case: &Case<D>,
    numbering: &NodeNumbering,
    boundary: &[Option<crate::case::BoundaryMotion<D>>],
) -> (Vec<bool>, BoundaryMotion<D>) {
    let mut constrained = vec![false; numbering.count];
    let mut field_of_node = vec![None; numbering.count];
    let mut fields: Vec<Arc<dyn BoundaryField<D>>> = Vec::new();
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
        start: time.start,
        end: time.end,
        step: time.step,
        slabs: time.slabs,
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
