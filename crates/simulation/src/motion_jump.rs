//! The differences between the motion of a case and the motion of the run that it continues, at the time of the change.

use super::bodies::is_of_body;
use super::build::prescribed_nodes;
use case::{Case, Motion, constrained};
use coupled::{MeshMover, State};
use mesh::NodeNumbering;
use std::collections::BTreeSet;

/// Displacements agree up to this times the size of the mesh and of the displacement. They are prescribed, so only round-off separates
/// them.
const ROUND_OFF: f64 = 1e-12;

/// Velocities agree up to this times the largest one.
const SMALL_JUMP: f64 = 1e-3;

/// Velocities are difference quotients of displacements over this time, in slabs.
pub const MOMENT: f64 = 1e-4;

/// Velocities agree if they move the mesh by less than this times its size in a slab; round-off of the quotients is a hundredth of
/// it.
const AT_REST: f64 = 1e-9;

/// The largest difference of velocities that counts as none, of which the `fastest` is given, for something of this `size` in slabs of length `step`.
pub fn small(fastest: f64, size: f64, step: f64) -> f64 {
    (SMALL_JUMP * fastest).max(AT_REST * size / step)
}

/// The rate of `position` at time `t`, of second order in `moment` from one side of t.
pub fn rate(position: impl Fn(f64) -> f64, t: f64, moment: f64) -> f64 {
    quotient([0.0, 1.0, 2.0].map(|steps| position(t + steps * moment)), moment)
}

/// The rate at the first of three positions, each a `moment` after the one before.
fn quotient([now, next, last]: [f64; 3], moment: f64) -> f64 {
    (4.0 * next - 3.0 * now - last) / (2.0 * moment)
}

/// A node that jumps: two different values of a vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Jump<const D: usize> {
    /// The node at rest.
    pub position: [f64; D],
    /// The value in the earlier run.
    pub there: [f64; D],
    /// The value in the case that continues it.
    pub here: [f64; D],
}

impl<const D: usize> Jump<D> {
    /// The distance of the values.
    pub fn size(&self) -> f64 {
        distance(&self.there, &self.here)
    }
}

/// The largest jump of a displacement, from `state`, the end of the earlier run, to the motion of `case` at that time. `None` if all
/// agree.
pub fn of_position<const D: usize>(case: &Case<D>, mover: &MeshMover<D>, state: &State) -> Option<Jump<D>> {
    let mut prescribed = vec![0.0; mover.field_len()];
    for (node, x, field) in prescribed_nodes(case) {
        prescribed[node * D..][..D].copy_from_slice(&field.displacement(node, &x, state.time));
    }
    leave_free(case, &mover.numbering, &[&case.motion], &state.d, &mut prescribed);
    let size = case.mesh.diameter() + state.d.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
    // Far from the origin formulas in the position have its round-off.
    let farthest = case.mesh.coordinates().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let least = ROUND_OFF * size + 16.0 * f64::EPSILON * farthest;
    let nodes = known_nodes(case, &mover.numbering, &[&case.motion]);
    largest(mover.positions(), nodes, &state.d, &prescribed).filter(|jump| exceeds(jump, least))
}

/// The largest jump of a prescribed velocity at time `t`: from `before`, the case that is continued, to `now`, which has the mesh of
/// `mover`. `None` if all agree.
pub fn of_velocity<const D: usize>(before: &Case<D>, now: &Case<D>, mover: &MeshMover<D>, t: f64) -> Option<Jump<D>> {
    let moment = MOMENT * now.time.step;
    // The one up to t, the other from t on.
    let there = velocities(before, mover.field_len(), t, -moment);
    let mut here = velocities(now, mover.field_len(), t, moment);
    leave_free(now, &mover.numbering, &[&before.motion, &now.motion], &there, &mut here);
    let fastest = there.iter().chain(&here).fold(0.0, |most: f64, v| most.max(v.abs()));
    let least = small(fastest, now.mesh.diameter(), now.time.step);
    let nodes = known_nodes(now, &mover.numbering, &[&before.motion, &now.motion]);
    largest(mover.positions(), nodes, &there, &here).filter(|jump| jump.size() > least)
}

/// Replaces the components of `here` that one of the `motions` leaves free, on boundaries that slide, by those of `there`.
fn leave_free<const D: usize>(
    case: &Case<D>,
    numbering: &NodeNumbering,
    motions: &[&Option<Motion<D>>],
    there: &[f64],
    here: &mut [f64],
) {
    for motion in motions {
        let Some(Motion::Elastic { slides, .. }) = motion else { continue };
        let held = constrained(&case.mesh, numbering, slides);
        let free = held.as_flattened().iter().enumerate().filter(|(_, held)| !**held);
        free.for_each(|(i, _)| here[i] = there[i]);
    }
}

/// The nodes whose displacement all of the `motions` of `case` prescribe: those on boundaries if one of them has an elastic interior, without
/// those that bodies move.
fn known_nodes<const D: usize>(
    case: &Case<D>,
    numbering: &NodeNumbering,
    motions: &[&Option<Motion<D>>],
) -> BTreeSet<usize> {
    if motions.iter().any(|motion| matches!(motion, Some(Motion::Followed))) {
        return BTreeSet::new();
    }
    if motions.iter().all(|motion| !matches!(motion, Some(Motion::Elastic { .. }))) {
        return (0..numbering.count).collect();
    }
    let on = |boundary: usize| numbering.on_boundary(&case.mesh, boundary);
    let (moved, others): (Vec<usize>, Vec<usize>) =
        (0..case.mesh.boundary_names().len()).partition(|boundary| is_of_body(case, *boundary));
    let moved: BTreeSet<usize> = moved.into_iter().flat_map(on).collect();
    others.into_iter().flat_map(on).filter(|node| !moved.contains(node)).collect()
}

/// The prescribed velocities of `case` at time `t`, `[C0 node][component]`, of second order in `moment` from one side of t.
fn velocities<const D: usize>(case: &Case<D>, len: usize, t: f64, moment: f64) -> Vec<f64> {
    let mut velocities = vec![0.0; len];
    for (node, x, field) in prescribed_nodes(case) {
        let [now, next, last] = [0.0, 1.0, 2.0].map(|steps| field.displacement(node, &x, t + steps * moment));
        for i in 0..D {
            velocities[node * D + i] = quotient([now[i], next[i], last[i]], moment);
        }
    }
    velocities
}

/// The node of `nodes` with the largest difference of the fields `there` and `here`, or with a NaN.
fn largest<const D: usize>(
    positions: &[[f64; D]],
    nodes: BTreeSet<usize>,
    there: &[f64],
    here: &[f64],
) -> Option<Jump<D>> {
    let value = |field: &[f64], node: usize| std::array::from_fn(|i| field[node * D + i]);
    let jumps = nodes.into_iter().map(|node| Jump {
        position: positions[node],
        there: value(there, node),
        here: value(here, node),
    });
    jumps.max_by(|a, b| a.size().total_cmp(&b.size()))
}

/// Whether a jump is larger than `least`, or NaN.
fn exceeds<const D: usize>(jump: &Jump<D>, least: f64) -> bool {
    jump.size().is_nan() || jump.size() > least
}

fn distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    tensor::norm::<f64, D>(&std::array::from_fn(|i| a[i] - b[i]))
}
