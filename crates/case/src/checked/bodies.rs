//! Rigid bodies that the flow moves.

mod freedoms;

use super::flow::Flow;
use super::inertia;
use super::mesh_crate::{Mesh, NodeNumbering};
use super::shared_nodes::periodic_copies_apart;
use super::time::Time;
use super::vector_of_time::vector_of_time;
use crate::checker::{Checked, Checker};
use crate::error::collected;
use crate::expression::Program;
use crate::key::Key;
use crate::raw;
use crate::vector::Vector;
use coupled::blocks::rigid_body::{Freedom as Direction, Stops};
use std::collections::{BTreeMap, BTreeSet};

/// A rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBody<const D: usize> {
    /// Its name.
    pub name: String,
    /// The boundaries that are its walls.
    pub walls: Vec<usize>,
    /// Its mass.
    pub mass: f64,
    /// Its tensor of inertia about the centre of mass.
    pub inertia: [[f64; 3]; 3],
    /// The point about which it rotates.
    pub pivot: [f64; D],
    /// The centre of mass.
    pub centre_of_mass: [f64; D],
    /// The outer force.
    pub force: Option<Vector<D>>,
    /// Its coordinates: translations, then rotations.
    pub freedoms: Vec<Freedom>,
    /// How the mesh follows; None: as an elastic body.
    pub mesh: Option<FollowingMesh>,
}

impl<const D: usize> RigidBody<D> {
    /// Whether it has a rotation among its coordinates.
    pub fn rotates(&self) -> bool {
        self.freedoms.iter().any(|freedom| freedom.direction.rotates())
    }
}

/// A translation or rotation.
#[derive(Clone, Debug, PartialEq)]
pub struct Freedom {
    /// Its key: "x", "y", "z", "rotation", "rotation_x", "rotation_y" or "rotation_z".
    pub name: &'static str,
    /// How it moves the body.
    pub direction: Direction,
    /// Force per displacement.
    pub spring: f64,
    /// Force per cube of the displacement.
    pub cubic_spring: f64,
    /// Where the springs are at rest.
    pub rest: f64,
    /// Force per rate.
    pub damping: f64,
    /// The rate at the start.
    pub rate: f64,
    /// Springs outside of a range.
    pub stops: Option<Stops>,
    /// The prescribed displacement or angle.
    pub motion: Option<Program>,
    /// When it is released.
    pub release: Option<f64>,
}

impl Freedom {
    /// Its size: the diameter of the `mesh`, or one radian.
    pub fn size<const D: usize>(&self, mesh: &Mesh<D>) -> f64 {
        size_of(&self.direction, mesh)
    }
}

/// The size of a coordinate along `direction`: the diameter of the `mesh`, or one radian.
fn size_of<const D: usize>(direction: &Direction, mesh: &Mesh<D>) -> f64 {
    if direction.rotates() { 1.0 } else { mesh.diameter() }
}

/// How the mesh follows.
#[derive(Clone, Debug, PartialEq)]
pub enum FollowingMesh {
    /// By the distance from the pivot.
    Between {
        /// The weight is one up to here.
        inner: f64,
        /// The weight is zero from here on.
        outer: f64,
    },
    /// By a formula in the position at rest.
    Weight(Program),
}

impl<const D: usize> RigidBody<D> {
    /// The weight of the mesh at `x`, where the mesh follows by weights.
    pub fn weight(&self, x: &[f64; D]) -> Option<f64> {
        Some(match self.mesh.as_ref()? {
            FollowingMesh::Weight(formula) => formula.evaluate(x, 0.0),
            FollowingMesh::Between { inner, outer } => 1.0 - smooth_step((self.distance(x) - inner) / (outer - inner)),
        })
    }

    /// Whether the body can move its point at `x` along an axis. A point that is at most `tolerance` from the axis of a rotation stays.
    pub(super) fn moves_along(&self, axis: usize, x: &[f64; D], tolerance: f64) -> bool {
        self.freedoms.iter().any(|freedom| match freedom.direction {
            Direction::Translation(along) => along[axis] != 0.0,
            Direction::Rotation(about) => {
                let arm: [f64; 3] = std::array::from_fn(|i| if i < D { x[i] - self.pivot[i] } else { 0.0 });
                let along: f64 = (0..3).map(|i| about[i] * arm[i]).sum();
                let square: f64 = (0..3).map(|i| (arm[i] - along * about[i]).powi(2)).sum();
                about[axis].abs() < 1.0 && square.sqrt() > tolerance
            }
        })
    }

    /// The distance of `x` from the pivot.
    fn distance(&self, x: &[f64; D]) -> f64 {
        (0..D).map(|d| (x[d] - self.pivot[d]).powi(2)).sum::<f64>().sqrt()
    }
}

/// The problem of a `weight` that is not one at `x` on a wall of `body`, and what is accepted.
fn not_one_on_a_wall<const D: usize>(body: &RigidBody<D>, x: &[f64; D], weight: f64) -> (String, String) {
    let (problem, accepted) =
        (format!("the weight at {x:?} on a wall of the body is {weight}"), "a weight of one on the walls of the body");
    let Some(FollowingMesh::Between { inner, .. }) = body.mesh else { return (problem, accepted.to_owned()) };
    let (distance, pivot) = (body.distance(x), body.pivot);
    (
        format!("{problem}: it is {distance:.6} away from the pivot {pivot:?}, and `inner` is {inner}"),
        format!("{accepted}: a larger `inner`, or `bodies.{}.pivot` where the body is", body.name),
    )
}

/// 6 s^5 - 15 s^4 + 10 s^3 between 0 and 1: two derivatives vanish at both ends.
fn smooth_step(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * s * (s * (6.0 * s - 15.0) + 10.0)
}

/// What the check of a body needs to know.
struct Given<'a, const D: usize> {
    checker: &'a Checker<'a>,
    mesh: &'a Mesh<D>,
    has_flow: bool,
    /// The flow; None also if it has an error.
    flow: Option<&'a Flow<D>>,
    time: &'a Time,
}

/// Checks `[bodies]`, whether there is a flow, and the flow if it has no error.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: &BTreeMap<String, raw::Body>,
    mesh: &Mesh<D>,
    (has_flow, flow): (bool, Option<&Flow<D>>),
    time: &Time,
) -> Checked<Vec<RigidBody<D>>> {
    let given = Given { checker, mesh, has_flow, flow, time };
    let bodies = collected(raw.iter().map(|(name, body)| given.body(name, body)))?;
    for (number, body) in bodies.iter().enumerate() {
        let shared = bodies[..number].iter().find(|other| other.walls.iter().any(|wall| body.walls.contains(wall)));
        if let Some(other) = shared {
            let problem = format!("a wall of `{}` belongs to `{}` too", body.name, other.name);
            return Err(checker.combination(&key_of(&body.name), &problem, "each wall in one body"));
        }
        if body.mesh.is_some() != bodies[0].mesh.is_some() {
            let problem = "the mesh follows one body by weights and another one as an elastic body";
            return Err(checker.combination(&key_of(&body.name), problem, "`mesh` in all bodies, or in none"));
        }
    }
    if bodies.len() > 1 {
        bodies.iter().try_for_each(|body| given.check_weight_on_others(body, &bodies))?;
    }
    Ok(bodies)
}

/// The key of the body `name`.
pub(super) fn key_of(name: &str) -> Key {
    Key::new("bodies").child(name)
}

impl<const D: usize> Given<'_, D> {
    fn body(&self, name: &str, raw: &raw::Body) -> Checked<RigidBody<D>> {
        let (checker, key) = (self.checker, key_of(name));
        if !self.has_flow {
            return Err(checker.combination(&key, "nothing moves a body without a flow", "a section [flow]"));
        }
        let freedoms = self.freedoms(&key, raw)?;
        let point = |name: &str, given: &Option<Vec<f64>>, default: [f64; D]| match given {
            Some(given) => checker.finite_vector(&key.child(name), name, given),
            None => Ok(default),
        };
        let pivot = point("pivot", &raw.pivot, [0.0; D])?;
        let body = RigidBody {
            name: name.to_owned(),
            walls: self.walls(name, &key, raw)?,
            mass: checker.positive(&key.child("mass"), "the mass", checker.number(&key.child("mass"), &raw.mass)?)?,
            inertia: inertia::check::<D>(checker, &key, raw)?,
            pivot,
            centre_of_mass: point("centre_of_mass", &raw.centre_of_mass, pivot)?,
            force: raw.force.as_ref().map(|force| self.force(&key.child("force"), force)).transpose()?,
            freedoms,
            mesh: raw.mesh.as_ref().map(|mesh| self.following(&key.child("mesh"), mesh)).transpose()?,
        };
        self.note_points(&key, raw, &body);
        self.check_weights(&key, &body)?;
        self.check_turns(&key, &body)?;
        Ok(body)
    }

    /// Records the pivot and the centre of mass that a body which turns takes by default.
    fn note_points(&self, key: &Key, raw: &raw::Body, body: &RigidBody<D>) {
        if !body.freedoms.iter().any(|freedom| freedom.direction.rotates()) {
            return;
        }
        let points = [("pivot", &raw.pivot, body.pivot), ("centre_of_mass", &raw.centre_of_mass, body.centre_of_mass)];
        for (name, _, taken) in points.iter().filter(|(_, given, _)| given.is_none()) {
            self.checker.note_default(&key.child(name), &format!("{taken:?}"));
        }
    }

    fn force(&self, key: &Key, raw: &[raw::Formula]) -> Checked<Vector<D>> {
        vector_of_time(self.checker, key, "the force", raw, self.time)
    }

    fn walls(&self, name: &str, key: &Key, raw: &raw::Body) -> Checked<Vec<usize>> {
        let own = [name.to_owned()];
        let (key, names) = match &raw.walls {
            Some(walls) => (key.child("walls"), &walls[..]),
            None if !self.mesh.boundary_names().contains(&own[0]) => {
                let known = self.mesh.boundary_names().join("`, `");
                let accepted = format!("`walls`, a list of boundaries of the mesh, of `{known}`");
                return Err(self.checker.combination(key, "no boundary has the name of the body", &accepted));
            }
            None => (key.clone(), &own[..]),
        };
        let walls = self.checker.boundaries(&key, names, self.mesh.boundary_names())?;
        self.checker.require(&key, "the list", !walls.is_empty(), "the name of a wall, or several")?;
        let is_wall = |wall: &usize| self.flow.is_none_or(|flow| flow.boundary[*wall].condition.is_wall());
        match walls.iter().find(|wall| !is_wall(wall)) {
            Some(wall) => {
                let problem = format!(
                    "boundary `{}` is no wall: the flow does not press on it",
                    self.mesh.boundary_names()[*wall]
                );
                let accepted = "boundaries whose condition is a wall";
                Err(self.checker.combination(&key, &problem, accepted))
            }
            None => Ok(walls),
        }
    }

    fn following(&self, key: &Key, raw: &raw::FollowingMesh) -> Checked<FollowingMesh> {
        match raw {
            raw::FollowingMesh::Between { inner, outer } => {
                let key = key.child("between");
                self.checker.require(&key.child("inner"), "the inner distance", *inner >= 0.0, "a number from 0")?;
                let accepted = "a number above `inner`";
                self.checker.require(
                    &key.child("outer"),
                    "the outer distance",
                    outer > inner && outer.is_finite(),
                    accepted,
                )?;
                Ok(FollowingMesh::Between { inner: *inner, outer: *outer })
            }
            raw::FollowingMesh::Weight(formula) => {
                Ok(FollowingMesh::Weight(self.checker.formula_of_position::<D>(&key.child("weight"), formula)?))
            }
        }
    }

    /// The first node on `walls` where the weight of `body` is not `wanted`: its position and the weight there.
    fn other_weight(
        &self,
        numbering: &NodeNumbering,
        body: &RigidBody<D>,
        walls: &[usize],
        wanted: f64,
    ) -> Option<([f64; D], f64)> {
        let positions = numbering.positions(self.mesh);
        let nodes = walls.iter().flat_map(|wall| numbering.on_boundary(self.mesh, *wall));
        let weights = nodes.map(|node| (positions[node], body.weight(&positions[node]).unwrap_or(f64::NAN)));
        weights.into_iter().find(|(_, weight)| (weight - wanted).abs() > 1e-9)
    }

    /// A body does not move the walls of others.
    fn check_weight_on_others(&self, body: &RigidBody<D>, bodies: &[RigidBody<D>]) -> Checked<()> {
        if body.mesh.is_none() {
            return Ok(());
        }
        let numbering = NodeNumbering::new(self.mesh, self.mesh.order());
        for other in bodies.iter().filter(|other| other.name != body.name) {
            let Some((x, weight)) = self.other_weight(&numbering, body, &other.walls, 0.0) else { continue };
            let problem = format!("the weight is {weight} at {x:?}, on a wall of the body `{}`", other.name);
            let key = key_of(&body.name).child("mesh");
            return Err(self.checker.combination(&key, &problem, "a weight of zero on the walls of other bodies"));
        }
        Ok(())
    }

    /// A rotation moves points that periodicity identifies together only if its axis lies along the period.
    fn check_turns(&self, key: &Key, body: &RigidBody<D>) -> Checked<()> {
        if !body.rotates() {
            return Ok(());
        }
        let numbering = NodeNumbering::new(self.mesh, self.mesh.order());
        let walls: BTreeSet<usize> =
            body.walls.iter().flat_map(|wall| numbering.on_boundary(self.mesh, *wall)).collect();
        for freedom in &body.freedoms {
            let Direction::Rotation(axis) = freedom.direction else { continue };
            let turned = |node: usize, x: &[f64; D]| {
                let arm: [f64; 3] = std::array::from_fn(|d| x.get(d).map_or(0.0, |x| x - body.pivot[d]));
                let weight = if walls.contains(&node) { 1.0 } else { body.weight(x).unwrap_or(0.0) };
                tensor::cross(&axis, &arm).map(|v| weight * v)
            };
            let apart = periodic_copies_apart(self.mesh, &numbering, 1e-9 * self.mesh.diameter(), turned);
            if let Some([x, other]) = apart {
                let problem = format!(
                    "{x:?} and {other:?} are one node of the mesh by periodicity, and this would move them apart"
                );
                let accepted = "a rotation about an axis along the period, or a body away from the periodic sides";
                return Err(self.checker.combination(&key.child(freedom.name), &problem, accepted));
            }
        }
        Ok(())
    }

    /// Weights are one on the walls of the body and finite everywhere.
    fn check_weights(&self, key: &Key, body: &RigidBody<D>) -> Checked<()> {
        if body.mesh.is_none() {
            return Ok(());
        }
        let numbering = NodeNumbering::new(self.mesh, self.mesh.order());
        let key = key.child("mesh");
        let positions = numbering.positions(self.mesh);
        let weight = |x: &[f64; D]| body.weight(x).unwrap_or(f64::NAN);
        if let Some(x) = positions.iter().find(|x| !weight(x).is_finite()) {
            let problem = format!("the weight at {x:?} is {}", weight(x));
            return Err(self.checker.combination(&key, &problem, "a weight that is finite in the whole mesh"));
        }
        if let Some((x, weight)) = self.other_weight(&numbering, body, &body.walls, 1.0) {
            let (problem, accepted) = not_one_on_a_wall(body, &x, weight);
            return Err(self.checker.combination(&key, &problem, &accepted));
        }
        if let Some([x, other]) = periodic_copies_apart(self.mesh, &numbering, 1e-9, |_, x| [weight(x)]) {
            let problem = format!(
                "the weight is {} at {x:?} and {} at {other:?}, the same point by periodicity",
                weight(&x),
                weight(&other)
            );
            return Err(self.checker.combination(&key, &problem, "a weight that is periodic like the mesh"));
        }
        Ok(())
    }
}
