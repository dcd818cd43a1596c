//! The motion of the mesh of a case.

use super::driven_bodies::{MeshOfDrivenBodies, driven_bodies};
use case::{Case, Motion, Stiffness, constrained};
use coupled::{BoundaryDisplacement, BoundaryField, MeshMotion, MeshMover};
use elasticity::{Accuracy, ElasticMesh, ElasticityError, Material, Partition, Solver, SolverOnBlocks, WallDistance};
use mesh::{BoundaryDistance, Mesh, NodeNumbering};
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

/// The mover of the mesh without the flow: driven bodies move, and what the flow moves rests.
///
/// # Errors
/// As [`ElasticMesh::new`].
pub fn mover_without_flow<const D: usize>(case: &Case<D>) -> Result<MeshMover<D>, ElasticityError> {
    let mut mover = mover(case)?;
    match &mut mover.motion {
        motion @ MeshMotion::Followed => *motion = MeshMotion::Prescribed(Arc::new(MeshOfDrivenBodies::new(case))),
        MeshMotion::Elastic { boundary, .. } => {
            for (field, nodes) in driven_bodies(case, &mover.numbering) {
                nodes.into_iter().for_each(|node| boundary.field_of_node[node] = Some(boundary.fields.len()));
                boundary.fields.push(field);
            }
        }
        MeshMotion::Still | MeshMotion::Prescribed(_) => {}
    }
    Ok(mover)
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
pub(super) fn moved_by<T, const D: usize>(
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
