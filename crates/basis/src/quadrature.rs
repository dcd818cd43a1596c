//! Gauss rules.

use crate::jacobi::{jacobi_derivative, jacobi_roots, legendre};

/// A quadrature rule, int f dx ~ sum_q w_q f(x_q), on [-1, 1] unless mapped by [`on`](Rule::on).
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Points, ascending.
    pub points: Vec<f64>,
    /// Weights, all positive.
    pub weights: Vec<f64>,
}

/// The Gauss rule of `n` points, exact to degree 2n - 1: the roots of P_n, w = 2 / ((1 - x^2) P_n'(x)^2).
///
/// # Panics
/// If n < 1.
pub fn gauss(n: usize) -> Rule {
    assert!(n >= 1, "a Gauss rule has at least one point");
    let points = symmetrised(jacobi_roots(n, 0.0, 0.0));
    Rule::with_weights(points, |x| 2.0 / ((1.0 - x * x) * jacobi_derivative(n, 0.0, 0.0, x).powi(2)))
}

/// The Gauss-Lobatto rule of `n` points, exact to degree 2n - 3: both ends and the roots of P'_{n-1} ~ P_{n-2}^{(1,1)},
/// w = 2 / (n (n-1) P_{n-1}(x)^2).
///
/// # Panics
/// If n < 2.
pub fn gauss_lobatto(n: usize) -> Rule {
    assert!(n >= 2, "a Gauss-Lobatto rule has at least the two ends");
    let mut points = vec![-1.0];
    points.extend(symmetrised(jacobi_roots(n - 2, 1.0, 1.0)));
    points.push(1.0);
    Rule::with_weights(points, |x| 2.0 / ((n * (n - 1)) as f64 * legendre(n - 1, x).powi(2)))
}

/// The right-Radau rule of `n` points, exact to degree 2n - 2: the right end and the roots of P_{n-1}^{(1,0)},
/// w = (1 + x) / (n P_{n-1}(x))^2.
///
/// # Panics
/// If n < 1.
pub fn right_radau(n: usize) -> Rule {
    assert!(n >= 1, "a right-Radau rule has at least the right end");
    let mut points = jacobi_roots(n - 1, 1.0, 0.0);
    points.push(1.0);
    Rule::with_weights(points, |x| (1.0 + x) / (n as f64 * legendre(n - 1, x)).powi(2))
}

impl Rule {
    /// The same rule on [`lower`, `upper`].
    pub fn on(&self, lower: f64, upper: f64) -> Rule {
        let half = (upper - lower) / 2.0;
        let points = self.points.iter().map(|x| lower + half * (1.0 + x)).collect();
        let weights = self.weights.iter().map(|w| half * w).collect();
        Rule { points, weights }
    }
    /// The weights of the tensor product of the rule in `dimension` directions, axis 0 fastest.
    pub fn tensor_weights(&self, dimension: usize) -> Vec<f64> {
        (0..dimension).fold(vec![1.0], |product, _| {
            self.weights.iter().flat_map(|w| product.iter().map(move |p| p * w)).collect()
        })
    }
    fn with_weights(points: Vec<f64>, weight: impl Fn(f64) -> f64) -> Rule {
        let weights = points.iter().map(|&x| weight(x)).collect();
        Rule { points, weights }
    }
}

/// Removes the asymmetry of the last bit, so that a mirrored cell has exactly mirrored points.
fn symmetrised(roots: Vec<f64>) -> Vec<f64> {
    let last = roots.len().wrapping_sub(1);
    (0..roots.len()).map(|i| (roots[i] - roots[last - i]) / 2.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The worst error over the integrals of the Legendre polynomials P_0..P_degree, whose values are 2, 0, 0, ...
    fn worst_error(rule: &Rule, degree: usize) -> f64 {
        let integral = |m| -> f64 { rule.points.iter().zip(&rule.weights).map(|(&x, w)| w * legendre(m, x)).sum() };
        (0..=degree).map(|m| (integral(m) - if m == 0 { 2.0 } else { 0.0 }).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn rules_are_exact_to_their_degree_and_no_further() {
        for n in 2..=64 {
            for (rule, degree) in [(gauss(n), 2 * n - 1), (gauss_lobatto(n), 2 * n - 3), (right_radau(n), 2 * n - 2)] {
                assert!(worst_error(&rule, degree) < 3e-14, "{n} points to degree {degree}");
                assert!(worst_error(&rule, degree + 1) > 1e-3, "{n} points to degree {degree} + 1");
            }
        }
        assert_eq!(gauss(1), Rule { points: vec![0.0], weights: vec![2.0] });
        assert_eq!(right_radau(1), Rule { points: vec![1.0], weights: vec![2.0] });
    }

    #[test]
    fn points_ascend_with_positive_weights() {
        for n in 2..=64 {
            for rule in [gauss(n), gauss_lobatto(n), right_radau(n)] {
                assert_eq!((rule.points.len(), rule.weights.len()), (n, n));
                assert!(rule.points.windows(2).all(|pair| pair[0] < pair[1]));
                assert!(rule.weights.iter().all(|&w| w > 0.0));
            }
            assert_eq!(right_radau(n).points[n - 1], 1.0);
        }
    }

    #[test]
    fn symmetric_rules_are_symmetric_to_the_bit() {
        for n in 2..=64 {
            for rule in [gauss(n), gauss_lobatto(n)] {
                for i in 0..n {
                    assert_eq!(rule.points[i], -rule.points[n - 1 - i]);
                    assert_eq!(rule.weights[i], rule.weights[n - 1 - i]);
                }
            }
        }
    }

    #[test]
    fn moved_rules_integrate_on_their_interval() {
        let rule = gauss(4).on(1.0, 3.0);
        let integral: f64 = rule.points.iter().zip(&rule.weights).map(|(x, w)| w * x.powi(6)).sum();
        assert!((integral - (3.0_f64.powi(7) - 1.0) / 7.0).abs() < 1e-12);
    }

    #[test]
    fn textbook_values() {
        assert!((gauss(3).points[2] - 0.6_f64.sqrt()).abs() < 1e-16);
        assert!((gauss(3).weights[1] - 8.0 / 9.0).abs() < 1e-15);
        assert!((gauss_lobatto(4).points[1] + 0.2_f64.sqrt()).abs() < 1e-16);
        assert!((right_radau(3).points[0] + (1.0 + 6.0_f64.sqrt()) / 5.0).abs() < 2e-16);
    }
}
