//! A smooth closed curve through points.

use super::growth::Check;
use crate::MeshError;
use std::array::from_fn;

/// The periodic cubic spline through given points, with the length of the polygon as its parameter u in [0,
/// `length()`). Position, first and second derivative are continuous. It runs clockwise, with the outside on its left.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedCurve {
    /// u of the points, followed by u of the first point after one period.
    knots: Vec<f64>,
    points: Vec<[f64; 2]>,
    /// Second derivatives at the points.
    bends: Vec<[f64; 2]>,
}

impl ClosedCurve {
    /// The curve through `points`, at least 5, in clockwise or counter-clockwise order; the first may be repeated at
    /// the end, up to round-off of a file.
    pub fn through(points: &[[f64; 2]]) -> Result<Self, MeshError> {
        let mut points = points[..points.len() - usize::from(is_repeated(points))].to_vec();
        let check = Check { mesh: "closed curve" };
        check.that(points.len() >= 5, "the number of points", points.len() as f64, "at least 5")?;
        // Counter-clockwise: the area is positive.
        if signed_area(&points) > 0.0 {
            points.reverse();
        }
        let mut knots = vec![0.0];
        for i in 0..points.len() {
            let (from, to) = (points[i], points[(i + 1) % points.len()]);
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            check.positive("the distance of two points that follow each other", length)?;
            knots.push(knots[i] + length);
        }
        check_distances(&points, &knots)?;
        let corner = sharpest_corner(&points);
        check.that(corner == 0.0, CORNER, corner, SMOOTH)?;
        let bends = bends(&knots, &points);
        let bends = check_bends(bends, check)?;
        Ok(ClosedCurve { knots, points, bends })
    }

    /// u of the points, followed by u of the first point after one period.
    pub(super) fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The period of the parameter u, close to the length of the curve.
    pub fn length(&self) -> f64 {
        self.knots[self.points.len()]
    }

    /// The point with parameter u.
    pub fn position(&self, u: f64) -> [f64; 2] {
        let Piece { h, a, b, ends, bends } = self.piece(u);
        let weight = |x: f64| h * h / 6.0 * (x * x * x - x);
        from_fn(|i| a * ends[0][i] + b * ends[1][i] + weight(a) * bends[0][i] + weight(b) * bends[1][i])
    }

    /// Its derivative with respect to u.
    pub fn tangent(&self, u: f64) -> [f64; 2] {
        let Piece { h, a, b, ends, bends } = self.piece(u);
        let weight = |x: f64| h / 6.0 * (3.0 * x * x - 1.0);
        from_fn(|i| (ends[1][i] - ends[0][i]) / h - weight(a) * bends[0][i] + weight(b) * bends[1][i])
    }

    /// Its second derivative with respect to u.
    pub fn bend(&self, u: f64) -> [f64; 2] {
        let Piece { a, b, bends, .. } = self.piece(u);
        from_fn(|i| a * bends[0][i] + b * bends[1][i])
    }

    /// The unit normal, outwards: left of the tangent.
    pub fn normal(&self, u: f64) -> [f64; 2] {
        let [x, y] = self.tangent(u);
        let length = x.hypot(y);
        [-y / length, x / length]
    }

    /// The cubic at u.
    fn piece(&self, u: f64) -> Piece {
        let n = self.points.len();
        let u = u.rem_euclid(self.length());
        let i = (self.knots.partition_point(|&knot| knot <= u) - 1).min(n - 1);
        let j = (i + 1) % n;
        let h = self.knots[i + 1] - self.knots[i];
        let b = (u - self.knots[i]) / h;
        Piece { h, a: 1.0 - b, b, ends: [self.points[i], self.points[j]], bends: [self.bends[i], self.bends[j]] }
    }
}

/// x = a x_0 + b x_1 + h^2/6 ((a^3 - a) x_0'' + (b^3 - b) x_1''), b from 0 to 1 = a + b.
struct Piece {
    h: f64,
    a: f64,
    b: f64,
    ends: [[f64; 2]; 2],
    bends: [[f64; 2]; 2],
}

/// A corner, for messages.
const CORNER: &str = "the turn at a point whose neighbours lie on nearly straight parts, in degrees,";
const SMOOTH: &str =
    "no such point: a spline bulges beside a corner; round it by several points, or bring a file of Gmsh";

/// A corner turns by more than this, in degrees, and by this many times more than its two neighbours.
const LEAST_TURN: f64 = 60.0;
const SHARPER: f64 = 10.0;

/// The turn of the polygon at its sharpest corner, in degrees; zero without a corner.
fn sharpest_corner(points: &[[f64; 2]]) -> f64 {
    let n = points.len();
    let edge = |i: usize| -> [f64; 2] { from_fn(|axis| points[(i + 1) % n][axis] - points[i % n][axis]) };
    let turn = |i: usize| {
        let ([a, b], [c, d]) = (edge(i + n - 1), edge(i));
        (a * d - b * c).atan2(a * c + b * d).abs().to_degrees()
    };
    let is_corner = |i: &usize| {
        let beside = turn(i + n - 1).max(turn(i + 1));
        turn(*i) > LEAST_TURN && turn(*i) > SHARPER * beside
    };
    (0..n).filter(is_corner).map(turn).max_by(f64::total_cmp).unwrap_or(0.0)
}

/// The second derivatives that make the first ones continuous, with h_i from point i to the next:
///
/// ```text
/// h_{i-1} x_{i-1}'' + 2 (h_{i-1} + h_i) x_i'' + h_i x_{i+1}'' = 6 (x_{i+1} - x_i) / h_i - 6 (x_i - x_{i-1}) / h_{i-1}
/// ```
fn bends(knots: &[f64], points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let n = points.len();
    let h = |i: usize| knots[i % n + 1] - knots[i % n];
    let slope = |i: usize, axis: usize| (points[(i + 1) % n][axis] - points[i % n][axis]) / h(i);
    let system = Cyclic {
        lower: (0..n).map(|i| h(i + n - 1)).collect(),
        diagonal: (0..n).map(|i| 2.0 * (h(i + n - 1) + h(i))).collect(),
        upper: (0..n).map(h).collect(),
    };
    let [x, y] = from_fn(|axis| {
        let right: Vec<f64> = (0..n).map(|i| 6.0 * (slope(i, axis) - slope(i + n - 1, axis))).collect();
        system.solve(&right)
    });
    x.into_iter().zip(y).map(|(x, y)| [x, y]).collect()
}

/// A tridiagonal matrix A with two entries more: row i has `lower[i]`, `diagonal[i]` and `upper[i]` in columns i - 1, i and i + 1 modulo n.
struct Cyclic {
    lower: Vec<f64>,
    diagonal: Vec<f64>,
    upper: Vec<f64>,
}

impl Cyclic {
    /// The solution of A x = b, with a tridiagonal T (Sherman and Morrison):
    ///
    /// ```text
    /// x = y - q (v . y) / (1 + v . q),   T y = b,   T q = u,   A = T + u v^T
    /// ```
    fn solve(&self, b: &[f64]) -> Vec<f64> {
        let (n, scale) = (b.len(), -self.diagonal[0]);
        let (first, last) = (self.lower[0], self.upper[n - 1]);
        let mut diagonal = self.diagonal.clone();
        (diagonal[0], diagonal[n - 1]) = (diagonal[0] - scale, diagonal[n - 1] - first * last / scale);
        let mut u = vec![0.0; n];
        (u[0], u[n - 1]) = (scale, last);
        let [y, q] = [b, &u].map(|right| self.tridiagonal(&diagonal, right));
        let along = |x: &[f64]| x[0] + first / scale * x[n - 1];
        let factor = along(&y) / (1.0 + along(&q));
        y.iter().zip(&q).map(|(y, q)| y - factor * q).collect()
    }

    /// The solution of T x = b for the T with this `diagonal`, by elimination (Thomas).
    fn tridiagonal(&self, diagonal: &[f64], b: &[f64]) -> Vec<f64> {
        let (n, mut x) = (b.len(), b.to_vec());
        let mut ratios = vec![0.0; n];
        for i in 0..n {
            let (below, before) = if i == 0 { (0.0, 0) } else { (self.lower[i], i - 1) };
            let pivot = diagonal[i] - below * ratios[before];
            x[i] = (x[i] - below * x[before]) / pivot;
            ratios[i] = self.upper[i] / pivot;
        }
        for i in (0..n - 1).rev() {
            x[i] -= ratios[i] * x[i + 1];
        }
        x
    }
}

/// The matrix is diagonally dominant, so only overflow makes it singular.
fn check_bends(bends: Vec<[f64; 2]>, check: Check) -> Result<Vec<[f64; 2]>, MeshError> {
    let finite = Some(bends).filter(|bends| bends.iter().flatten().all(|x| x.is_finite()));
    finite.ok_or(MeshError::Parameter {
        mesh: check.mesh,
        quantity: "the curvature",
        value: f64::NAN,
        accepted: "points whose distances are of comparable size",
    })
}

/// Whether the last point is the first one.
fn is_repeated(points: &[[f64; 2]]) -> bool {
    let [first, .., last] = points else { return false };
    let from_first = |x: &[f64; 2]| (x[0] - first[0]).hypot(x[1] - first[1]);
    from_first(last) <= SAME * points.iter().map(from_first).fold(0.0, f64::max)
}

/// The first and the last point are the same up to this part of the extent.
const SAME: f64 = 1e-9;

/// A point that is this much closer to one neighbour than to the other is that neighbour with an error: the spline between them wiggles.
const CLOSE: f64 = 0.01;

/// Points that follow each other must not be nearly the same.
fn check_distances(points: &[[f64; 2]], knots: &[f64]) -> Result<(), MeshError> {
    let n = points.len();
    let distance = |i: usize| knots[i % n + 1] - knots[i % n];
    let is_close = |&i: &usize| distance(i) <= CLOSE * distance(i + n - 1).min(distance(i + 1));
    match (0..n).find(is_close) {
        Some(i) => {
            let (first, second) = (points[i], points[(i + 1) % n]);
            let distance = (second[0] - first[0]).hypot(second[1] - first[1]);
            Err(MeshError::ClosePoints { first, second, distance })
        }
        None => Ok(()),
    }
}

/// The area that a polygon encloses, positive if its points run counter-clockwise. The last point is joined to the first.
pub fn signed_area(points: &[[f64; 2]]) -> f64 {
    let [first, ..] = points else { return 0.0 };
    // About the first point: far from the origin no digits are lost.
    let from_first = |x: &[f64; 2]| [x[0] - first[0], x[1] - first[1]];
    let triangle = |pair: &[[f64; 2]]| {
        let [a, b] = [from_first(&pair[0]), from_first(&pair[1])];
        0.5 * (a[0] * b[1] - a[1] * b[0])
    };
    points.windows(2).map(triangle).sum()
}

/// The distance of x from the curve: from the nearest of many samples by Newton's method.
#[cfg(test)]
pub(super) fn distance(curve: &ClosedCurve, x: [f64; 2]) -> f64 {
    let offset = |u: f64| from_fn::<f64, 2, _>(|i| x[i] - curve.position(u)[i]);
    let length = |u: f64| offset(u)[0].hypot(offset(u)[1]);
    let samples = (0..4000).map(|k| f64::from(k) * curve.length() / 4000.0);
    let mut u = samples.min_by(|&u, &v| length(u).total_cmp(&length(v))).unwrap_or(0.0);
    for _ in 0..4 {
        // (x - c(u)) . c'(u) = 0
        let (d, t, b) = (offset(u), curve.tangent(u), curve.bend(u));
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        u += dot(d, t) / (dot(t, t) - dot(d, b));
    }
    length(u)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::f64::consts::TAU;

    fn ellipse(n: usize) -> Vec<[f64; 2]> {
        (0..n).map(|k| TAU * k as f64 / n as f64).map(|angle| [2.0 * angle.cos(), angle.sin()]).collect()
    }

    #[test]
    fn the_curve_passes_through_its_points_and_is_smooth() {
        let curve = ClosedCurve::through(&ellipse(16)).unwrap();
        for (knot, point) in curve.knots.iter().zip(&curve.points) {
            assert_eq!(curve.position(*knot), *point);
            for derivative in [ClosedCurve::position, ClosedCurve::tangent, ClosedCurve::bend] {
                let (before, after) = (derivative(&curve, knot - 1e-9), derivative(&curve, knot + 1e-9));
                assert!((0..2).all(|i| (before[i] - after[i]).abs() < 1e-7), "{before:?} {after:?}");
            }
        }
    }

    /// The inverse of the matrix of its bends had 10^8 entries.
    #[test]
    fn ten_thousand_points_are_not_too_many() {
        let curve = ClosedCurve::through(&ellipse(10_000)).unwrap();
        let off = |u: f64| {
            let [x, y] = curve.position(u);
            (0.25 * x * x + y * y - 1.0).abs()
        };
        assert!((0..1000).map(|k| off(curve.length() * (f64::from(k) + 0.3) / 1000.0)).all(|off| off < 1e-12));
    }

    /// A spline through the points of a square bulges beside its corners; thin ellipses are smooth, even with few points.
    #[test]
    fn corners_are_refused() {
        let side = |k: usize| -1.0 + 0.2 * k as f64;
        let sides = (0..10).map(|k| [side(k), -1.0]).chain((0..10).map(|k| [1.0, side(k)]));
        let square: Vec<[f64; 2]> =
            sides.chain((0..10).map(|k| [-side(k), 1.0])).chain((0..10).map(|k| [-1.0, -side(k)])).collect();
        let message = ClosedCurve::through(&square).unwrap_err().to_string();
        assert!(message.contains("in degrees, is 90"), "{message}");
        let thin: Vec<[f64; 2]> = ellipse(40).into_iter().map(|[x, y]| [x, 0.1 * y]).collect();
        assert!(ClosedCurve::through(&thin).is_ok());
    }

    #[test]
    fn derivatives_are_those_of_the_position() {
        let curve = ClosedCurve::through(&ellipse(9)).unwrap();
        for k in 0..40 {
            let (u, h) = (0.3 + 0.2 * f64::from(k), 1e-6);
            let difference = |f: fn(&ClosedCurve, f64) -> [f64; 2]| -> [f64; 2] {
                from_fn(|i| (f(&curve, u + h)[i] - f(&curve, u - h)[i]) / (2.0 * h))
            };
            let (tangent, bend) = (difference(ClosedCurve::position), difference(ClosedCurve::tangent));
            assert!((0..2).all(|i| (tangent[i] - curve.tangent(u)[i]).abs() < 1e-8));
            assert!((0..2).all(|i| (bend[i] - curve.bend(u)[i]).abs() < 1e-6));
        }
    }

    #[test]
    fn the_error_falls_with_the_fourth_power_of_the_distance() {
        let error = |n: usize| {
            let curve = ClosedCurve::through(&ellipse(n)).unwrap();
            let off = |x: [f64; 2]| ((0.5 * x[0]).hypot(x[1]) - 1.0).abs();
            (0..1000).map(|k| off(curve.position(0.001 * f64::from(k) * curve.length()))).fold(0.0, f64::max)
        };
        let order = (error(40) / error(80)).log2();
        assert!(order > 3.8, "{order}");
    }

    #[test]
    fn it_runs_clockwise_whatever_the_points_do() {
        let mut points = ellipse(12);
        let forwards = ClosedCurve::through(&points).unwrap();
        for error in [0.0, 1e-17, 1e-12] {
            let mut repeated = points.clone();
            repeated.push([points[0][0], points[0][1] - error]);
            assert_eq!(ClosedCurve::through(&repeated).unwrap(), forwards);
        }
        points.reverse();
        for curve in [forwards, ClosedCurve::through(&points).unwrap()] {
            for u in [0.0, 1.0, 2.5, 6.0, -3.0] {
                let (x, normal) = (curve.position(u), curve.normal(u));
                assert!(x[0] * normal[0] + x[1] * normal[1] > 0.9);
            }
        }
    }

    #[test]
    fn impossible_points_are_refused() {
        assert!(ClosedCurve::through(&[]).is_err());
        assert!(ClosedCurve::through(&ellipse(4)).is_err());
        // Points that are the same up to an error made cells that are inverted.
        for error in [1e-17, 1e-9, 1e-4] {
            let mut close = ellipse(9);
            let [x, y] = close[4];
            close.insert(5, [x, y - error]);
            let message = ClosedCurve::through(&close).unwrap_err().to_string();
            assert!(message.contains("distance"), "{message}");
        }
        let mut points = ellipse(6);
        points[3] = points[2];
        assert!(ClosedCurve::through(&points).is_err());
        points[3] = [f64::NAN, 0.0];
        assert!(ClosedCurve::through(&points).is_err());
    }
}
