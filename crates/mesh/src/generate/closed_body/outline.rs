//! Arc length, centroid and area of a closed curve.

use crate::generate::ClosedCurve;
use basis::{Rule, gauss};
use std::array::from_fn;

/// Points of the Gauss rule in each piece of the spline: more than exact for its area and its centroid.
const POINTS: usize = 12;

/// Steps of Newton's method for a given arc length. Within a piece the speed of the parameter hardly varies.
const STEPS: usize = 10;

/// A closed curve with its integrals.
pub(super) struct Outline<'a> {
    pub(super) curve: &'a ClosedCurve,
    /// The centroid of the area.
    pub(super) centre: [f64; 2],
    /// The largest distance of the curve from the centroid.
    pub(super) reach: f64,
    /// The arc length up to each knot.
    arcs: Vec<f64>,
    rule: Rule,
}

impl<'a> Outline<'a> {
    pub(super) fn new(curve: &'a ClosedCurve) -> Self {
        let mut outline = Outline { curve, centre: [0.0; 2], reach: 0.0, arcs: vec![0.0], rule: gauss(POINTS) };
        outline.measure_arcs();
        outline.centre = outline.area_and_centroid().1;
        let distance = |u: f64| {
            let [x, y] = curve.position(u);
            (x - outline.centre[0]).hypot(y - outline.centre[1])
        };
        let samples = curve
            .knots()
            .windows(2)
            .flat_map(|ends| (0..8).map(|k| ends[0] + 0.125 * f64::from(k) * (ends[1] - ends[0])));
        outline.reach = samples.map(distance).fold(0.0, f64::max);
        outline
    }

    /// The length of the curve.
    pub(super) fn length(&self) -> f64 {
        self.arcs[self.arcs.len() - 1]
    }

    /// The parameters at `cells` + 1 points with equal arc lengths between them.
    pub(super) fn divided(&self, cells: usize) -> Vec<f64> {
        let at = |k: usize| if k == cells { self.curve.length() } else { self.parameter(k as f64 / cells as f64) };
        (0..=cells).map(at).collect()
    }

    /// The parameter at the fraction `share`, in [0, 1), of the arc length.
    pub(super) fn parameter(&self, share: f64) -> f64 {
        let target = share * self.length();
        let knots = self.curve.knots();
        let piece = self.arcs.partition_point(|&arc| arc <= target).clamp(1, knots.len() - 1) - 1;
        let [low, high] = [knots[piece], knots[piece + 1]];
        let part = (target - self.arcs[piece]) / (self.arcs[piece + 1] - self.arcs[piece]);
        let mut u = low + part * (high - low);
        for _ in 0..STEPS {
            let error = self.arcs[piece] + self.integral([low, u], |u| self.speed(u)) - target;
            u = (u - error / self.speed(u)).clamp(low, high);
        }
        u
    }

    /// |dc/du|
    fn speed(&self, u: f64) -> f64 {
        let [x, y] = self.curve.tangent(u);
        x.hypot(y)
    }

    /// int f du between two parameters in one piece.
    fn integral(&self, [low, high]: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let terms = self.rule.points.iter().zip(&self.rule.weights);
        half * terms.map(|(xi, weight)| weight * f(middle + half * xi)).sum::<f64>()
    }

    fn measure_arcs(&mut self) {
        for ends in self.curve.knots().windows(2) {
            let arc = self.arcs[self.arcs.len() - 1] + self.integral([ends[0], ends[1]], |u| self.speed(u));
            self.arcs.push(arc);
        }
    }

    /// The area and the centroid, by Green's theorem, with coordinates from the first point of the curve and the sign of a clockwise curve:
    ///
    /// ```text
    /// A = -1/2 int (x y' - y x') du,     A C = -1/3 int (x, y) (x y' - y x') du
    /// ```
    pub(super) fn area_and_centroid(&self) -> (f64, [f64; 2]) {
        let origin = self.curve.position(0.0);
        let from_origin = |u: f64| -> [f64; 2] { from_fn(|i| self.curve.position(u)[i] - origin[i]) };
        let cross = |u: f64| {
            let ([x, y], [dx, dy]) = (from_origin(u), self.curve.tangent(u));
            x * dy - y * dx
        };
        let whole = |f: &dyn Fn(f64) -> f64| -> f64 {
            self.curve.knots().windows(2).map(|ends| self.integral([ends[0], ends[1]], f)).sum()
        };
        let area = -0.5 * whole(&cross);
        let moments = [0, 1].map(|i| -whole(&|u| from_origin(u)[i] * cross(u)) / 3.0);
        (area, from_fn(|i| origin[i] + moments[i] / area))
    }
}
