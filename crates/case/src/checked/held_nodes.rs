//! Nodes of a structure or a rigid body on other boundaries of the flow, which hold them.

use super::mesh_crate::{Mesh, NodeNumbering};
use super::parts::SolidPart;
use super::{Flow, Motion, RigidBody, Structure, Time};
use crate::checker::{Checked, Checker};
use crate::key::Key;
use coupled::BoundaryField;
use navier_stokes::Boundary;
use std::collections::{BTreeMap, BTreeSet};
use tensor::AXES;

/// A node with a smaller weight hardly follows a body: formulas may not fall to zero.
const SMALL_WEIGHT: f64 = 1e-6;

/// What holds a node, by component: None where it is free.
type Held<const D: usize> = [Option<f64>; D];

/// At the ends of the wall between structure and flow, shared nodes also lie on other boundaries of the flow. A support of the structure
/// must prescribe there what these boundaries prescribe. Otherwise the node would leave its boundary.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    structure: Option<&Structure<D>>,
    motion: Option<&Motion<D>>,
    mesh: &Mesh<D>,
    time: &Time,
) -> Checked<()> {
    let Some((structure, part)) = structure.and_then(|structure| Some((structure, structure.part.as_ref()?))) else {
        return Ok(());
    };
    let shared: BTreeMap<usize, usize> = part.shared.iter().map(|&(solid, node)| (node, solid)).collect();
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let tolerance = 1e-9 * mesh.diameter();
    for t in time.check_times() {
        let supported = supported(structure, part, t);
        for boundary in (0..mesh.boundary_names().len()).filter(|boundary| !part.walls.contains(boundary)) {
            for (node, x) in super::shared_nodes::nodes_on(mesh, &numbering, boundary) {
                let Some(solid) = shared.get(&node) else { continue };
                let (wanted, given) = (held(motion, boundary, node, &x, t), supported.get(solid).copied());
                let given = given.unwrap_or([None; D]);
                let apart = |i: &usize| wanted[*i].is_some_and(|d| given[*i].is_none_or(|g| (g - d).abs() > tolerance));
                if let Some(axis) = (0..D).find(apart) {
                    return Err(refused(checker, mesh, boundary, &x, axis));
                }
            }
        }
    }
    Ok(())
}

/// A rigid body takes the nodes of its walls along, and others where the mesh follows by weights. Nodes of the walls must not leave plane
/// boundaries that share them, and no node may leave a plane of symmetry: the body cannot move across these planes. `moved` are the boundaries
/// that bodies and structures move.
pub(super) fn check_bodies<const D: usize>(
    checker: &Checker<'_>,
    bodies: &[RigidBody<D>],
    moved: &[bool],
    (mesh, flow): (&Mesh<D>, Option<&Flow<D>>),
) -> Checked<()> {
    if bodies.is_empty() {
        return Ok(());
    }
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let nodes_on = |boundary: usize| super::shared_nodes::nodes_on(mesh, &numbering, boundary);
    let is_symmetry =
        |boundary: usize| flow.is_some_and(|flow| matches!(flow.boundary[boundary].condition, Boundary::Symmetry(_)));
    for body in bodies {
        let nodes: BTreeSet<usize> = body.walls.iter().flat_map(|wall| nodes_on(*wall).map(|(node, _)| node)).collect();
        let follows = |node: usize, x: &[f64; D]| match body.weight(x) {
            None => nodes.contains(&node),
            Some(weight) => weight.abs() > SMALL_WEIGHT,
        };
        let at_rest = (0..moved.len()).filter(|boundary| !moved[*boundary]);
        for boundary in at_rest.filter(|&boundary| body.mesh.is_none() || is_symmetry(boundary)) {
            // A boundary that is no plane normal to an axis has no such axes.
            let Ok(normal) = mesh.normal_axes(&numbering, boundary) else { continue };
            for (node, x) in nodes_on(boundary).filter(|(node, x)| follows(*node, x)) {
                let across = |axis: &usize| normal[&node][*axis] && body.moves_along(*axis, &x, 1e-9 * mesh.diameter());
                if let Some(axis) = (0..D).find(across) {
                    return Err(leaves(checker, &body.name, &mesh.boundary_names()[boundary], &x, axis));
                }
            }
        }
    }
    Ok(())
}

fn leaves(checker: &Checker<'_>, body: &str, boundary: &str, x: &[f64], axis: usize) -> Box<crate::CaseError> {
    let axis = AXES[axis];
    let problem = format!(
        "the node at {x:?} on the boundary `{boundary}` would leave its plane, for `{body}` can move along {axis}"
    );
    let accepted = "a body that moves along the planes that share nodes with its walls, and along planes of symmetry in the mesh that follows it";
    checker.combination(&super::bodies::key_of(body), &problem, accepted)
}

fn refused<const D: usize>(
    checker: &Checker<'_>,
    mesh: &Mesh<D>,
    boundary: usize,
    x: &[f64; D],
    axis: usize,
) -> Box<crate::CaseError> {
    let (name, axis) = (&mesh.boundary_names()[boundary], AXES[axis]);
    let problem = format!(
        "at {x:?} boundary `{name}` of the flow holds the mesh along {axis}, and the structure does not, or moves otherwise"
    );
    let accepted = format!("a support of the structure on `{name}` with the motion that the flow has there");
    checker.combination(&Key::new("structure").child("boundary"), &problem, &accepted)
}

/// What the supports of the structure prescribe at its nodes.
fn supported<const D: usize>(structure: &Structure<D>, part: &SolidPart<D>, t: f64) -> BTreeMap<usize, Held<D>> {
    let numbering = NodeNumbering::new(&part.mesh, part.mesh.order());
    let mut nodes: BTreeMap<usize, Held<D>> = BTreeMap::new();
    for (index, support) in structure.boundary.iter().enumerate() {
        for (node, x) in super::shared_nodes::nodes_on(&part.mesh, &numbering, index) {
            let (given, held) = (support.prescribed(&x, t), nodes.entry(node).or_insert([None; D]));
            (0..D).for_each(|i| held[i] = held[i].or(given[i]));
        }
    }
    nodes
}

/// What a boundary of the flow prescribes at a node.
fn held<const D: usize>(motion: Option<&Motion<D>>, boundary: usize, node: usize, x: &[f64; D], t: f64) -> Held<D> {
    let Some(Motion::Elastic { boundary: motions, slides, .. }) = motion else { return [None; D] };
    let components = slides[boundary].as_ref().map_or([true; D], |slide| slide[&node]);
    let d = motions[boundary].as_ref().map_or([0.0; D], |motion| motion.displacement(node, x, t));
    std::array::from_fn(|i| components[i].then_some(d[i]))
}
