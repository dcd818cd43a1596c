//! How fast and how far a mesh is moved.

use case::{Case, Flow, Motion, Wall};
use mesh::NodeNumbering;
use simulation::{PrescribedNode, prescribed_nodes};
use std::collections::BTreeSet;

/// Nodes that are looked at, at most.
const NODES: usize = 200;

/// Instants in a slab, and in a run at most.
const INSTANTS: [usize; 2] = [8, 4000];

/// Instants of a run at least, however long its formulas are.
const FEWEST_INSTANTS: usize = 40;

/// Operations of formulas that all of that may take: below a second.
const OPERATIONS: usize = 200_000_000;

/// The part of the time between instants after which the motion at the start is looked at: it may start from rest and be fast by then.
const MOMENT: f64 = 1e-4;

/// Typical sizes of a prescribed motion, the largest over the nodes that it moves.
///
/// A node that oscillates harmonically with the amplitude A and the angular frequency omega has the speed V = omega A at most. So
/// omega = V / A for the node with the largest A is the frequency of a harmonic motion, and a typical one of any other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct MotionScales {
    /// A: half of the extent of the path, in the coordinate in which it is largest.
    pub(super) amplitude: f64,
    /// V, between instants.
    pub(super) speed: f64,
}

impl MotionScales {
    /// Of the motion that `case` prescribes; None if it moves nothing.
    pub(super) fn new<const D: usize>(case: &Case<D>) -> Option<Self> {
        let nodes = prescribed_nodes(case);
        let stride = nodes.len().div_ceil(NODES).max(1);
        let operations =
            case.motion.as_ref().map_or(0, Motion::operations).max(1) * nodes.len().div_ceil(stride).max(1);
        let affordable = (OPERATIONS / operations).max(FEWEST_INSTANTS);
        let instants = INSTANTS[0].saturating_mul(case.time.slabs).clamp(1, INSTANTS[1]).min(affordable);
        let (start, dt) = (case.time.start, (case.time.end - case.time.start) / instants as f64);
        let mut scales = MotionScales::default();
        for (node, x, field) in nodes.iter().step_by(stride) {
            let path = |instant: f64| field.displacement(*node, x, start + instant * dt);
            scales = scales.larger(&MotionScales::of_path(path, instants, dt));
        }
        (scales.amplitude > 0.0).then_some(scales)
    }

    /// Of a path, the displacement as a function of the number of the instant; these are `dt` apart, the last is number `instants`.
    fn of_path<const D: usize>(at: impl Fn(f64) -> [f64; D], instants: usize, dt: f64) -> Self {
        let path: Vec<[f64; D]> = (0..=instants).map(|i| at(i as f64)).collect();
        let extent = |axis: usize| {
            let along = path.iter().map(|d| d[axis]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        };
        MotionScales {
            amplitude: 0.5 * (0..D).map(extent).fold(0.0, f64::max),
            speed: path.windows(2).map(|pair| speed(&pair[0], &pair[1], dt)).fold(0.0, f64::max),
        }
    }

    fn larger(&self, other: &Self) -> Self {
        if other.amplitude > self.amplitude { *other } else { *self }
    }

    /// omega.
    pub(super) fn frequency(&self) -> f64 {
        self.speed / self.amplitude
    }
}

/// The largest speed at the start of a node on a wall of `flow` that is moved as prescribed; None if no wall is.
pub(super) fn walls_at_start<const D: usize>(case: &Case<D>, flow: &Flow<D>) -> Option<f64> {
    let moment = MOMENT * case.time.step / INSTANTS[0] as f64;
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let on_wall = |wall: &Wall<D>| numbering.on_boundary(&case.mesh, wall.boundary);
    let walls: BTreeSet<usize> = flow.walls.iter().flat_map(on_wall).collect();
    let moved = prescribed_nodes(case).into_iter().filter(|(node, ..)| walls.contains(node));
    let start = case.time.start;
    let at_start = |(node, x, field): PrescribedNode<D>| {
        let path = |t: f64| field.displacement(node, &x, t);
        speed(&path(start), &path(start + moment), moment)
    };
    moved.map(at_start).reduce(f64::max)
}

/// The mean speed between two displacements, `dt` apart.
fn speed<const D: usize>(from: &[f64; D], to: &[f64; D], dt: f64) -> f64 {
    tensor::norm::<f64, D>(&std::array::from_fn(|i| (to[i] - from[i]) / dt))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frequency_of_a_harmonic_motion_is_found() {
        let (amplitude, omega, dt) = (0.3, 2.5, 0.01);
        let scales = MotionScales::of_path(|i| [0.1, amplitude * (omega * i * dt).sin()], 599, dt);
        assert!((scales.amplitude / amplitude - 1.0).abs() < 1e-4, "{scales:?}");
        assert!((scales.frequency() / omega - 1.0).abs() < 1e-3, "{scales:?}");
    }
}
