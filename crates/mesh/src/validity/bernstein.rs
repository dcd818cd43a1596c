//! Polynomials on a box in Chebyshev form, and their range by Bernstein coefficients.
//!
//! Bernstein coefficients of degree p bound a polynomial. But computing them from values amplifies round-off by about
//! 2^p per direction, far too much for det J in three dimensions of order 8 (p = 20). Chebyshev coefficients are well
//! conditioned, and those of high degree are small. So only the modes up to degree q = [`BERNSTEIN_DEGREE`] per
//! direction are converted to Bernstein coefficients. The rest is bounded by the sum of its moduli, because |T_k| <= 1:
//!
//! ```text
//! f = sum_{k <= q} c_k T_k + tail,   |tail| <= sum_{k > q} |c_k|,
//! min_i b_i - |tail| <= f <= max_i b_i + |tail|                                                            (range)
//! ```
//!
//! Round-off enters twice. The given values have errors of at most `error`, so their interpolant has an error of L
//! `error` with the Lebesgue constant L. This is an error of f itself, which is not amplified later. And the sums for
//! b_i have errors of a few units in the last place of sum_k |c_k| max_i |b_i(T_k)|, where the large factors meet the
//! small coefficients.

use crate::lattice::Lattice;
use basis::Matrix;
use std::f64::consts::PI;

/// q of (range). The largest Bernstein coefficient of T_8 is 184, that of T_20 is 7e5.
pub(super) const BERNSTEIN_DEGREE: usize = 8;

/// The data of one direction for a polynomial of degree p.
#[derive(Clone, Debug)]
pub(super) struct Direction {
    /// The Chebyshev-Lobatto points x_j = -cos(pi j / p); the midpoint for p = 0.
    pub(super) points: Vec<f64>,
    /// Values at the points to Chebyshev coefficients.
    to_chebyshev: Matrix,
    /// Coefficients on [-1, 1] to those on its lower and its upper half, each stretched to [-1, 1].
    halves: [Matrix; 2],
    /// Chebyshev coefficients to the Bernstein coefficients, of degree min(p, q), of the part up to that degree.
    to_bernstein: Matrix,
    /// Rows of weights w_k of the coefficients, for sums of their moduli: 1,
    one: Matrix,
    /// 1 for k <= q, else 0,
    kept: Matrix,
    /// max_i |b_i(T_k)| for k <= q, else 0,
    largest: Matrix,
    /// and k (k-1).
    curvature: Matrix,
}

/// The map from values to coefficients of two kinds, see [`Direction::mixed`].
#[derive(Clone, Debug)]
pub(super) struct Mixed {
    pub(super) matrix: Matrix,
    /// The largest sum of moduli that contributes to a coefficient, for values of size 1.
    pub(super) norm: f64,
}

/// Relative error of a sum of products along one axis after the other, in units of the sum of the moduli.
const SUM_ERROR: f64 = 64.0 * f64::EPSILON;

impl Direction {
    pub(super) fn new(degree: usize) -> Self {
        let p = degree as f64;
        let points: Vec<f64> = match degree {
            0 => vec![0.0],
            _ => (0..=degree).map(|j| -(PI * j as f64 / p).cos()).collect(),
        };
        let to_chebyshev = Matrix::from_fn(degree + 1, degree + 1, |k, j| interpolation_weight(degree, k, j));
        let halves = [-1.0, 1.0].map(|side| {
            let modes: Vec<Vec<f64>> = points.iter().map(|x| chebyshev(degree, 0.5 * (x + side))).collect();
            to_chebyshev.product(&Matrix::from_fn(degree + 1, degree + 1, |j, k| modes[j][k]))
        });
        let q = degree.min(BERNSTEIN_DEGREE);
        let coefficient = |i: usize, k: usize| if k <= q { bernstein_coefficient(q, i, k) } else { 0.0 };
        let row = |weight: &dyn Fn(usize) -> f64| Matrix::from_fn(1, degree + 1, |_, k| weight(k));
        Direction {
            points,
            to_chebyshev,
            halves,
            to_bernstein: Matrix::from_fn(q + 1, degree + 1, coefficient),
            one: row(&|_| 1.0),
            kept: row(&|k| if k <= q { 1.0 } else { 0.0 }),
            largest: row(&|k| (0..=q).map(|i| coefficient(i, k).abs()).fold(0.0, f64::max)),
            curvature: row(&|k| (k * k.saturating_sub(1)) as f64),
        }
    }

    /// q + 1, the number of Bernstein coefficients.
    pub(super) fn kept(&self) -> usize {
        self.to_bernstein.rows()
    }

    /// The map from given values to coefficients, on the whole axis or, with `side` 0 or 1, on its lower or upper half.
    /// First come the Bernstein coefficients, then the Chebyshev coefficients beyond degree q.
    pub(super) fn mixed(&self, side: Option<usize>) -> Mixed {
        let n = self.points.len();
        let halved = side.map_or(Matrix::identity(n), |side| self.halves[side].clone());
        let kept = |i: usize, k: usize| if k == i { 1.0 } else { 0.0 };
        let form = |i, k| if i < self.kept() { self.to_bernstein[(i, k)] } else { kept(i, k) };
        let steps = [&self.to_chebyshev, &halved, &Matrix::from_fn(n, n, form)];
        let product = |steps: [&Matrix; 3]| steps[2].product(steps[1]).product(steps[0]);
        let moduli = steps.map(|m| Matrix::from_fn(n, n, |i, j| m[(i, j)].abs()));
        let sums = product(moduli.each_ref());
        let norm = (0..n).map(|i| sums.row(i).iter().sum::<f64>()).fold(0.0, f64::max);
        Mixed { matrix: product(steps), norm }
    }

    /// A bound of the Lebesgue constant of the points, max_x sum_j |l_j(x)|.
    pub(super) fn lebesgue_constant(&self) -> f64 {
        1.0 + 2.0 / PI * (self.points.len() as f64).ln()
    }
}

/// c_k = (2/p) sum_j'' f_j T_k(x_j), halved for k = 0 and k = p; '' halves the first and last term.
fn interpolation_weight(p: usize, k: usize, j: usize) -> f64 {
    if p == 0 {
        return 1.0;
    }
    let half_at_ends = |i: usize| if i == 0 || i == p { 0.5 } else { 1.0 };
    // T_k(-cos t) = cos(k (pi - t))
    let t_k = (PI * (k * (p - j) % (2 * p)) as f64 / p as f64).cos();
    2.0 / p as f64 * half_at_ends(j) * half_at_ends(k) * t_k
}

/// T_0(x) .. T_degree(x)
fn chebyshev(degree: usize, x: f64) -> Vec<f64> {
    let mut t = vec![1.0, x];
    for k in 2..=degree {
        t.push(2.0 * x * t[k - 1] - t[k - 2]);
    }
    t.truncate(degree + 1);
    t
}

/// Bernstein coefficient i of degree q of T_k. The coefficients of degree k are (-1)^{k-j} C(2k, 2j) / C(k, j); C(k, j)
/// C(q-k, i-j) / C(q, i) raises them to degree q. All terms are integers until the last division.
fn bernstein_coefficient(q: usize, i: usize, k: usize) -> f64 {
    let term = |j: usize| {
        let sign = if (k - j).is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * binomial(2 * k, 2 * j) * binomial(q - k, i - j)
    };
    (0..=k.min(i)).filter(|j| i - j <= q - k).map(term).sum::<f64>() / binomial(q, i)
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64)
}

/// A polynomial on [-1, 1]^m by its Chebyshev coefficients, one axis per direction.
#[derive(Clone, Debug)]
pub(super) struct Polynomial {
    coefficients: Lattice,
    /// Bounds |computed f - exact f| on the box.
    error: f64,
}

/// Bernstein coefficients b_i with |f - sum_i b_i B_i| <= `margin` on the box.
pub(super) struct Enclosure {
    pub(super) bernstein: Lattice,
    pub(super) margin: f64,
}

impl Polynomial {
    /// The polynomial with given values at the grid of the directions' points; `error` bounds the absolute error of the
    /// values.
    pub(super) fn interpolate(directions: &[Direction], values: Lattice, error: f64) -> Self {
        let coefficients = values.apply_each(|axis| &directions[axis].to_chebyshev);
        let lebesgue: f64 = directions.iter().map(Direction::lebesgue_constant).product();
        Polynomial { coefficients, error: error * lebesgue }
    }

    /// The bound of |computed f - exact f|.
    pub(super) fn error(&self) -> f64 {
        self.error
    }

    /// The polynomial on the lower (`side` 0) or upper half of the box along `axis`.
    pub(super) fn half(&self, directions: &[Direction], axis: usize, side: usize) -> Self {
        let coefficients = self.coefficients.apply(axis, &directions[axis].halves[side]);
        let moduli: f64 = coefficients.values.iter().map(|c| c.abs()).sum();
        Polynomial { coefficients, error: self.error + SUM_ERROR * moduli }
    }

    /// (range)
    pub(super) fn enclose(&self, directions: &[Direction]) -> Enclosure {
        let bernstein = self.coefficients.apply_each(|axis| &directions[axis].to_bernstein);
        let moduli = self.moduli();
        let sum = |row: fn(&Direction) -> &Matrix| moduli.apply_each(|axis| row(&directions[axis])).values[0];
        let all = sum(|direction| &direction.one);
        let tail = all - sum(|direction| &direction.kept);
        let sums = all + sum(|direction| &direction.largest);
        Enclosure { bernstein, margin: tail + self.error + SUM_ERROR * sums }
    }

    /// The curvature of f along each axis, sum_k |c_k| k_a (k_a - 1): a multilinear f is enclosed exactly.
    pub(super) fn curvature(&self, directions: &[Direction]) -> Vec<f64> {
        let moduli = self.moduli();
        let along = |a: usize| {
            let weights = |axis: usize| if axis == a { &directions[axis].curvature } else { &directions[axis].one };
            moduli.apply_each(weights).values[0]
        };
        (0..directions.len()).map(along).collect()
    }

    fn moduli(&self) -> Lattice {
        let c = &self.coefficients;
        Lattice::new(c.shape.clone(), c.values.iter().map(|c| c.abs()).collect())
    }

    /// f(x)
    pub(super) fn value(&self, x: &[f64]) -> f64 {
        let shape = &self.coefficients.shape;
        let row = |(n, x): (&usize, &f64)| Matrix::new(1, *n, chebyshev(n - 1, *x));
        let rows: Vec<Matrix> = shape.iter().zip(x).map(row).collect();
        self.coefficients.apply_each(|axis| &rows[axis]).values[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn random_polynomial(directions: &[Direction], random: &mut SplitMix64) -> (Lattice, Polynomial) {
        let shape: Vec<usize> = directions.iter().map(|d| d.points.len()).collect();
        let values = Lattice::new(shape.clone(), (0..shape.iter().product()).map(|_| random.symmetric()).collect());
        (values.clone(), Polynomial::interpolate(directions, values, 1e-15))
    }

    /// sum_i b_i B_i(x)
    fn bernstein_sum(b: &Lattice, x: &[f64]) -> f64 {
        let evaluate = |b: Lattice, axis: usize| {
            let (q, t) = (b.shape[axis] - 1, 0.5 + 0.5 * x[axis]);
            let row = |i: usize| binomial(q, i) * t.powi(i as i32) * (1.0 - t).powi((q - i) as i32);
            b.apply(axis, &Matrix::from_fn(1, q + 1, |_, i| row(i)))
        };
        (0..x.len()).fold(b.clone(), evaluate).values[0]
    }

    #[test]
    fn interpolates_its_values() {
        let directions = [Direction::new(9), Direction::new(0), Direction::new(4)];
        let (values, f) = random_polynomial(&directions, &mut SplitMix64::new(1));
        for (index, &value) in values.values.iter().enumerate() {
            let x: Vec<f64> = values.digits(index).iter().zip(&directions).map(|(&j, d)| d.points[j]).collect();
            assert!((f.value(&x) - value).abs() < 1e-13);
        }
    }

    #[test]
    fn bernstein_form_is_exact_up_to_its_degree_and_within_the_margin_beyond() {
        let mut random = SplitMix64::new(2);
        for (degrees, exact) in [([6, 3, 1], true), ([12, 2, 8], false)] {
            let directions = degrees.map(Direction::new);
            let (_, f) = random_polynomial(&directions, &mut random);
            let enclosure = f.enclose(&directions);
            let mut worst: f64 = 0.0;
            for _ in 0..200 {
                let x: Vec<f64> = (0..3).map(|_| random.symmetric()).collect();
                worst = worst.max((f.value(&x) - bernstein_sum(&enclosure.bernstein, &x)).abs());
            }
            assert!(worst <= enclosure.margin);
            assert_eq!(enclosure.margin < 1e-9, exact, "margin {}", enclosure.margin);
        }
    }

    #[test]
    fn the_margin_covers_errors_of_the_values() {
        let mut random = SplitMix64::new(5);
        let directions = [7, 5].map(Direction::new);
        for _ in 0..50 {
            let (mut values, f) = random_polynomial(&directions, &mut random);
            values.values.iter_mut().for_each(|value| *value += 1e-3 * random.symmetric().signum());
            let enclosure = Polynomial::interpolate(&directions, values, 1e-3).enclose(&directions);
            let x = [random.symmetric(), random.symmetric()];
            assert!((f.value(&x) - bernstein_sum(&enclosure.bernstein, &x)).abs() <= enclosure.margin);
        }
    }

    #[test]
    fn halves_are_the_same_polynomial() {
        let mut random = SplitMix64::new(3);
        let directions = [Direction::new(13), Direction::new(5)];
        let (_, f) = random_polynomial(&directions, &mut random);
        for (axis, side) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let half = f.half(&directions, axis, side);
            let x = [random.symmetric(), random.symmetric()];
            let mut whole = x;
            whole[axis] = 0.5 * (x[axis] + [-1.0, 1.0][side]);
            assert!((half.value(&x) - f.value(&whole)).abs() < 1e-13);
        }
    }

    #[test]
    fn multilinear_polynomials_are_enclosed_exactly_and_are_not_curved() {
        let directions = [Direction::new(3), Direction::new(2)];
        let bilinear = |x: f64, y: f64| 1.0 + 2.0 * x - 0.5 * y + 0.25 * x * y;
        let points = |y: &f64| directions[0].points.iter().map(|x| bilinear(*x, *y)).collect::<Vec<_>>();
        let values = Lattice::new(vec![4, 3], directions[1].points.iter().flat_map(points).collect());
        let f = Polynomial::interpolate(&directions, values, 0.0);
        let lowest = f.enclose(&directions).bernstein.values.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((lowest - bilinear(-1.0, 1.0)).abs() < 1e-14);
        assert!(f.curvature(&directions).iter().all(|c| *c < 1e-14));
    }

    #[test]
    fn coefficients_of_chebyshev_polynomials() {
        // T_2 = 1, -3, 1 in the Bernstein basis of degree 2, T_1 = -1, 0, 1.
        assert_eq!(Direction::new(2).to_bernstein.values(), [1.0, -1.0, 1.0, 1.0, 0.0, -3.0, 1.0, 1.0, 1.0]);
        assert_eq!(bernstein_coefficient(6, 3, 6), -924.0 / 20.0);
    }
}
