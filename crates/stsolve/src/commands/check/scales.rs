//! Speed and amplitude of the motion of a mesh.

use super::Facts;
use case::{Case, Flow, Motion};
use mesh::NodeNumbering;
use simulation::PrescribedNode;
use std::collections::BTreeSet;

/// The largest number of nodes examined.
const NODES: usize = 200;

/// The number of times examined in a slab, and the largest number in a run.
const TIMES: [usize; 2] = [8, 4000];

/// The least number of times in a run, for formulas of any length.
const FEWEST_TIMES: usize = 40;

/// The largest number of operations of formulas for all of that, below a second.
const OPERATIONS: usize = 200_000_000;

/// The fraction of the time between examined times after which the motion at the start is examined. The motion may start from rest and
/// be fast by the next examined time.
const MOMENT: f64 = 1e-4;

/// A smaller fraction of the largest speed is rest.
const AT_REST: f64 = 1e-6;

/// Typical sizes of a prescribed motion, the largest over the nodes that it moves.
///
/// A node that oscillates harmonically with the amplitude A and the angular frequency omega has the largest speed V = omega A. So
/// omega = V / A for the node with the largest A is exact for a harmonic motion, and typical of any other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct MotionScales {
    /// A: half of the distance of two positions that are far apart, in whatever direction.
    pub(super) amplitude: f64,
    /// V, between examined times.
    pub(super) speed: f64,
    /// The longest time without motion before a motion.
    pub(super) rest: f64,
}

impl MotionScales {
    /// The scales of the motion that `case` prescribes for `nodes`; None if it moves nothing.
    pub(super) fn new<const D: usize>(case: &Case<D>, nodes: &[PrescribedNode<D>]) -> Option<Self> {
        let stride = nodes.len().div_ceil(NODES).max(1);
        let operations =
            case.motion.as_ref().map_or(0, Motion::operations).max(1) * nodes.len().div_ceil(stride).max(1);
        let affordable = (OPERATIONS / operations).max(FEWEST_TIMES);
        let times = TIMES[0].saturating_mul(case.time.slabs).clamp(1, TIMES[1]).min(affordable);
        let (start, dt) = (case.time.start, (case.time.end - case.time.start) / times as f64);
        let mut scales = MotionScales::default();
        for (node, x, field) in nodes.iter().step_by(stride) {
            let path = |number: f64| field.displacement(*node, x, start + number * dt);
            scales = scales.larger(&MotionScales::of_path(path, times, dt));
        }
        (scales.amplitude > 0.0).then_some(scales)
    }

    /// The scales of a path, the displacement as a function of the number of the time. Times are `dt` apart, the last one is number
    /// `times`.
    fn of_path<const D: usize>(at: impl Fn(f64) -> [f64; D], times: usize, dt: f64) -> Self {
        let path: Vec<[f64; D]> = (0..=times).map(|i| at(i as f64)).collect();
        let speeds: Vec<f64> = path.windows(2).map(|pair| speed(&pair[0], &pair[1], dt)).collect();
        let largest = speeds.iter().copied().fold(0.0, f64::max);
        let moving = speeds.iter().enumerate().filter(|(_, speed)| **speed > AT_REST * largest).map(|(i, _)| i + 1);
        let ends: Vec<usize> = std::iter::once(0).chain(moving).collect();
        let rest = ends.windows(2).map(|pair| pair[1] - pair[0] - 1).max().unwrap_or_default();
        MotionScales { amplitude: 0.5 * extent(&path), speed: largest, rest: rest as f64 * dt }
    }

    fn larger(&self, other: &Self) -> Self {
        if other.amplitude > self.amplitude { *other } else { *self }
    }

    /// omega.
    pub(super) fn frequency(&self) -> f64 {
        self.speed / self.amplitude
    }
}

/// The nodes with a prescribed motion on walls of `flow`.
pub(super) fn on_walls<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Vec<PrescribedNode<D>> {
    let mesh = &facts.case.mesh;
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let walls: BTreeSet<usize> =
        flow.walls.iter().flat_map(|wall| numbering.on_boundary(mesh, wall.boundary)).collect();
    facts.prescribed.iter().filter(|(node, ..)| walls.contains(node)).cloned().collect()
}

/// The largest initial speed of `nodes` of `case` with a prescribed motion; None if there are none.
pub(super) fn speed_at_start<const D: usize>(case: &Case<D>, nodes: &[PrescribedNode<D>]) -> Option<f64> {
    let moment = MOMENT * case.time.step / TIMES[0] as f64;
    let start = case.time.start;
    let at_start = |(node, x, field): &PrescribedNode<D>| {
        let path = |t: f64| field.displacement(*node, x, t);
        speed(&path(start), &path(start + moment), moment)
    };
    nodes.iter().map(at_start).reduce(f64::max)
}

/// The distance of the two ends of a path along a line, or the diameter of a circle: from the position that is farthest from the start to the
/// one that is farthest from there. It does not depend on the axes, and takes no time that grows with the square of the number of positions.
fn extent<const D: usize>(path: &[[f64; D]]) -> f64 {
    let distance = |x: &[f64; D], y: &[f64; D]| tensor::norm::<f64, D>(&std::array::from_fn(|i| x[i] - y[i]));
    let farthest = |from: [f64; D]| path.iter().max_by(|x, y| distance(x, &from).total_cmp(&distance(y, &from)));
    let end = path.first().and_then(|start| farthest(*start));
    end.and_then(|end| farthest(*end).map(|other| distance(end, other))).unwrap_or(0.0)
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
    #[test]
    fn the_longest_rest_is_found() {
        let pulse =
            |i: f64| if (0.5..0.7).contains(&(i * 1e-3)) { (0.1 * i * std::f64::consts::TAU).sin() } else { 0.0 };
        let scales = MotionScales::of_path(|i| [pulse(i), 0.0], 1000, 1e-3);
        assert!((scales.rest - 0.5).abs() < 1e-9, "{scales:?}");
        // A motion that goes on, and one that has ended.
        assert_eq!(MotionScales::of_path(|i| [(0.01 * i).sin(), 0.0], 1000, 1e-3).rest, 0.0);
        assert_eq!(MotionScales::of_path(|i| [(0.01 * i).min(1.0), 0.0], 1000, 1e-3).rest, 0.0);
    }
    /// The amplitude was that along an axis, so that the step advised depended on the axes.
    #[test]
    fn the_amplitude_does_not_depend_on_the_axes() {
        let (amplitude, dt) = (0.3, 0.01);
        for angle in [0.0_f64, 0.3, std::f64::consts::FRAC_PI_4, 2.0] {
            let along = |i: f64| amplitude * (2.5 * i * dt).sin();
            let line = MotionScales::of_path(|i| [along(i) * angle.cos(), along(i) * angle.sin()], 599, dt);
            let at = |i: f64| angle + 2.5 * i * dt;
            let circle = MotionScales::of_path(|i| [amplitude * at(i).cos(), amplitude * at(i).sin()], 599, dt);
            for scales in [line, circle] {
                assert!((scales.amplitude / amplitude - 1.0).abs() < 1e-4, "{angle}: {scales:?}");
                assert!((scales.frequency() / 2.5 - 1.0).abs() < 1e-3, "{angle}: {scales:?}");
            }
        }
    }
}
