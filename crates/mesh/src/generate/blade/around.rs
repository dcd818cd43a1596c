//! The O-block around a blade.

use super::shear::Shear;
use super::{BladeCells, BladeMesh, ClosedCurve, Point};
use std::array::from_fn;

/// The O-block: s counts cells clockwise from corner FL to FU, RU, RL, and back to FL.
pub(super) struct Around<'a> {
    profile: &'a ClosedCurve,
    layer: f64,
    /// s of FL, FU, RU, RL, FL.
    pub(super) corners: [usize; 5],
    /// Parameters of the curve at s = 0, 1, .., increasing.
    parameters: Vec<f64>,
}

impl<'a> Around<'a> {
    pub(super) fn new(mesh: &'a BladeMesh, shear: &Shear) -> Self {
        let (profile, BladeCells { side, end, .. }) = (&mesh.profile, mesh.cells);
        let length = profile.length();
        // A corner is the point of the edge that is farthest outwards along a diagonal of (x, Y).
        let corner = |[dx, dy]: Point| {
            farthest(length, |u| {
                let [x, y] = shear.straightened(offset(profile, u, mesh.layer));
                dx * x + dy * y
            })
        };
        let first = corner([-1.0, -1.0]);
        let after = |u: f64| first + (u - first).rem_euclid(length);
        let [second, third, fourth] = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]].map(|diagonal| after(corner(diagonal)));
        let ends = [first, second, third, fourth, first + length];
        let mut parameters = vec![first];
        for (k, cells) in [end, side, end, side].into_iter().enumerate() {
            parameters.extend(distributed(profile, TURN * mesh.layer, ends[k], ends[k + 1], cells).into_iter().skip(1));
        }
        let corners = [0, end, end + side, 2 * end + side, 2 * (end + side)];
        Around { profile, layer: mesh.layer, corners, parameters }
    }

    /// The point at distance `height` from the blade. Between the ends of a cell the parameter of the curve is linear in
    /// s, so that the cell is as smooth as the curve.
    pub(super) fn position(&self, s: f64, height: f64) -> Point {
        let cell = (s as usize).min(self.corners[4] - 1);
        let (fraction, ends) = (s - cell as f64, [self.parameters[cell], self.parameters[cell + 1]]);
        let u = (1.0 - fraction) * ends[0] + fraction * ends[1];
        offset(self.profile, u, height)
    }

    /// The point of the outer edge at the fraction `share` of the way from corner `from` to corner `to`.
    pub(super) fn edge(&self, from: usize, to: usize, share: f64) -> Point {
        let [from, to] = [from, to].map(|corner| self.corners[corner] as f64);
        self.position((1.0 - share) * from + share * to, self.layer)
    }
}

/// The strength of the refinement where the profile turns, see [`distributed`].
const TURN: f64 = 3.0;

/// The point at distance `height` from the profile.
fn offset(profile: &ClosedCurve, u: f64, height: f64) -> Point {
    let (x, normal) = (profile.position(u), profile.normal(u));
    from_fn(|i| x[i] + height * normal[i])
}

/// The place in [0, period) where the periodic function f is largest.
fn farthest(period: f64, f: impl Fn(f64) -> f64) -> f64 {
    let step = period / 4000.0;
    let samples = (0..4000).map(|k| step * f64::from(k));
    let best = samples.max_by(|&u, &v| f(u).total_cmp(&f(v))).unwrap_or(0.0);
    // f rises on one side and falls on the other.
    let (mut low, mut high) = (best - step, best + step);
    for _ in 0..60 {
        let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if f(left) < f(right) { low = left } else { high = right }
    }
    (0.5 * (low + high)).rem_euclid(period)
}

/// `cells` + 1 parameters from `from` to `to`, in equal steps of int sqrt(|x'|^2 + (c theta')^2) du, where theta is the
/// angle of the tangent. On curved parts cells are shorter, in the ratio in which an edge at the distance c is longer.
fn distributed(profile: &ClosedCurve, c: f64, from: f64, to: f64, cells: usize) -> Vec<f64> {
    let density = |u: f64| {
        let (t, b) = (profile.tangent(u), profile.bend(u));
        let square = t[0] * t[0] + t[1] * t[1];
        (square + (c * (t[0] * b[1] - t[1] * b[0]) / square).powi(2)).sqrt()
    };
    let steps = 200 * cells;
    let width = (to - from) / steps as f64;
    let mut sums = vec![0.0];
    for k in 0..steps {
        sums.push(sums[k] + width * density(from + (k as f64 + 0.5) * width));
    }
    let parameter = |share: f64| {
        let sum = share * sums[steps];
        let k = sums.partition_point(|&before| before <= sum).clamp(1, steps) - 1;
        from + width * (k as f64 + (sum - sums[k]) / (sums[k + 1] - sums[k]))
    };
    (0..=cells).map(|i| if i == cells { to } else { parameter(i as f64 / cells as f64) }).collect()
}
