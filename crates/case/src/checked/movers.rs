//! What moves walls of the mesh: rigid bodies and a structure.

use super::Case;
use super::bodies::RigidBody;
use super::flow::Flow;
use super::mesh_crate::{Mesh, NodeNumbering};
use super::parts::SolidPart;
use super::structure::Structure;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use std::collections::BTreeSet;

/// What a structure is called in errors.
const STRUCTURE: &str = "the structure";

/// The walls that rigid bodies and a structure move.
pub(super) struct Movers {
    /// The name of each in errors, and its walls.
    pub(super) walls: Vec<(String, Vec<usize>)>,
    /// Whether rigid bodies move the whole mesh by weights.
    pub(super) by_weights: bool,
}

impl Movers {
    /// Those of a whole `case`.
    pub(super) fn of<const D: usize>(case: &Case<D>) -> Self {
        Self::unchecked(&case.bodies, case.structure.as_ref().and_then(|structure| structure.part.as_ref()))
    }

    /// The walls of `bodies` and of the `part` of a structure.
    fn unchecked<const D: usize>(bodies: &[RigidBody<D>], part: Option<&SolidPart<D>>) -> Self {
        let of_bodies = bodies.iter().map(|body| (format!("the body `{}`", body.name), body.walls.clone()));
        let of_structure = part.map(|part| (STRUCTURE.to_owned(), part.walls.clone()));
        let by_weights = bodies.iter().any(|body| body.mesh.is_some());
        Movers { walls: of_bodies.chain(of_structure).collect(), by_weights }
    }

    /// The walls of `bodies` and of a `structure` beside the `flow` on `mesh`.
    pub(super) fn new<const D: usize>(
        checker: &Checker<'_>,
        bodies: &[RigidBody<D>],
        structure: Option<&Structure<D>>,
        flow: Option<&Flow<D>>,
        mesh: &Mesh<D>,
    ) -> Checked<Self> {
        let part = structure.and_then(|structure| structure.part.as_ref()).filter(|_| flow.is_some());
        let movers = Self::unchecked(bodies, part);
        if let (Some(part), Some(flow)) = (part, flow) {
            if movers.by_weights {
                let problem = "`bodies` move the whole mesh by weights, and a structure moves its walls";
                return Err(checker.combination(&Key::new("structure"), problem, "bodies without the key `mesh`"));
            }
            check_structure_walls(checker, part, flow, mesh, bodies)?;
        }
        movers.check_apart(checker, mesh)?;
        Ok(movers)
    }

    /// No two of them move the same node.
    fn check_apart<const D: usize>(&self, checker: &Checker<'_>, mesh: &Mesh<D>) -> Checked<()> {
        let numbering = NodeNumbering::new(mesh, mesh.order());
        let nodes = |walls: &[usize]| -> BTreeSet<usize> {
            walls.iter().flat_map(|wall| numbering.on_boundary(mesh, *wall)).collect()
        };
        let nodes: Vec<BTreeSet<usize>> = self.walls.iter().map(|(_, walls)| nodes(walls)).collect();
        for (number, (name, _)) in self.walls.iter().enumerate() {
            let mut before = self.walls[..number].iter().zip(&nodes);
            if let Some(((other, _), _)) = before.find(|(_, other)| !other.is_disjoint(&nodes[number])) {
                let problem = format!("{other} and {name} share nodes of the mesh, and each would move them");
                let key = Key::new(if name == STRUCTURE { "structure" } else { "bodies" });
                return Err(checker.combination(&key, &problem, "walls that do not touch each other"));
            }
        }
        Ok(())
    }

    /// The rigid bodies among them.
    pub(super) fn of_bodies(&self) -> impl Iterator<Item = &(String, Vec<usize>)> {
        self.walls.iter().filter(|(name, _)| name != STRUCTURE)
    }

    /// Whether something moves each of the boundaries of `mesh`.
    pub(super) fn moved<const D: usize>(&self, mesh: &Mesh<D>) -> Vec<bool> {
        let moves = |boundary: usize| self.walls.iter().any(|(_, walls)| walls.contains(&boundary));
        (0..mesh.boundary_names().len()).map(moves).collect()
    }
}

/// The flow presses on the walls of a structure, and no rigid body has one of them.
fn check_structure_walls<const D: usize>(
    checker: &Checker<'_>,
    part: &SolidPart<D>,
    flow: &Flow<D>,
    mesh: &Mesh<D>,
    bodies: &[RigidBody<D>],
) -> Checked<()> {
    if let Some(body) = bodies.iter().find(|body| body.name == "structure") {
        let key = Key::new("bodies").child(&body.name);
        return Err(checker.combination(&key, "results call the structure so", "another name"));
    }
    for &wall in &part.walls {
        let name = &mesh.boundary_names()[wall];
        if !flow.boundary[wall].condition.is_wall() {
            let key = Key::new("flow").child("boundary").child(name);
            return Err(checker.combination(&key, "the structure is no wall of the flow", "the condition of a wall"));
        }
        if let Some(body) = bodies.iter().find(|body| body.walls.contains(&wall)) {
            let problem = format!("the wall `{name}` belongs to the structure");
            let key = Key::new("bodies").child(&body.name);
            return Err(checker.combination(&key, &problem, "other walls"));
        }
    }
    Ok(())
}
