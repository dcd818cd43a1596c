//! The basis of a slab.

use crate::{Lagrange, Matrix, Rule, gauss, right_radau};

/// The temporal basis of a slab, s in [0, 1]: the Lagrange polynomials phi_b of the right-Radau nodes s_1 < ... < s_N =
/// 1.
///
/// The last node is the top of the slab. The bottom is not a node, since u jumps there.
#[derive(Clone, Debug, PartialEq)]
pub struct RadauTime {
    basis: Lagrange,
    weights: Vec<f64>,
    collocation: Matrix,
    inverse_collocation: Matrix,
    slab_matrix: Matrix,
}

impl RadauTime {
    /// The basis of `order` nodes, degree `order - 1`.
    ///
    /// # Panics
    /// If order < 1.
    pub fn new(order: usize) -> Self {
        let Rule { points, weights } = right_radau(order).on(0.0, 1.0);
        let basis = Lagrange::new(points);
        let rows: Vec<Vec<f64>> = basis.nodes().iter().map(|&s| integrals(&basis, s)).collect();
        let collocation = Matrix::new(order, order, rows.concat());
        let slab_matrix = slab_matrix(&basis, &weights);
        let inverse_collocation = Matrix::from_fn(order, order, |a, b| slab_matrix[(a, b)] / weights[a]);
        RadauTime { basis, weights, collocation, inverse_collocation, slab_matrix }
    }

    /// The number of nodes N_t.
    pub fn order(&self) -> usize {
        self.weights.len()
    }
    /// The nodes s_a in (0, 1], ascending; the last is 1.
    pub fn nodes(&self) -> &[f64] {
        self.basis.nodes()
    }
    /// The weights omega_a of the right-Radau rule on [0, 1], exact to degree 2 N_t - 2.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The polynomials themselves, for matrices of values and derivatives at many times.
    pub fn lagrange(&self) -> &Lagrange {
        &self.basis
    }
    /// phi_b(s) for every b.
    pub fn values(&self, s: f64) -> Vec<f64> {
        self.basis.values(s)
    }
    /// phi_b'(s) for every b: derivatives with respect to s, not t.
    pub fn derivatives(&self, s: f64) -> Vec<f64> {
        self.basis.derivatives(s)
    }
    /// Phi_b(s) = int_0^s phi_b for every b: the displacement that unit velocity at node b causes, over dt.
    pub fn integrals(&self, s: f64) -> Vec<f64> {
        integrals(&self.basis, s)
    }
    /// phi_b at 1 + `ratio` s, the time s of the next slab, which is `ratio` times as long: the initial guess there.
    pub fn extrapolation(&self, ratio: f64, s: f64) -> Vec<f64> {
        self.values(1.0 + ratio * s)
    }

    /// The Radau-IIA matrix A_ab = int_0^{s_a} phi_b; its last row is the weights.
    pub fn collocation(&self) -> &Matrix {
        &self.collocation
    }
    /// A^{-1}. Radau IIA and discontinuous Galerkin in time with the right-Radau rule are the same method: A^{-1} =
    /// W^{-1} T with W = diag(weights).
    pub fn inverse_collocation(&self) -> &Matrix {
        &self.inverse_collocation
    }
    /// T_ab = phi_a(1) phi_b(1) - int_0^1 phi_a' phi_b: the time derivative of u, tested with phi_a and integrated by
    /// parts. The bottom of the slab is not included: there the test function meets the previous state, -phi_a(0) u_n.
    pub fn slab_matrix(&self) -> &Matrix {
        &self.slab_matrix
    }
}

/// int_0^s phi_b by a Gauss rule exact for the degree N_t - 1 of phi_b.
fn integrals(basis: &Lagrange, s: f64) -> Vec<f64> {
    let order = basis.nodes().len();
    let rule = gauss(order.div_ceil(2)).on(0.0, s);
    let mut sums = vec![0.0; order];
    basis.value_matrix(&rule.points).transpose().apply(&rule.weights, &mut sums);
    sums
}

/// phi_a' phi_b has degree 2 N_t - 3, so the right-Radau rule is exact: int_0^1 phi_a' phi_b = w_b phi_a'(s_b).
fn slab_matrix(basis: &Lagrange, weights: &[f64]) -> Matrix {
    let order = weights.len();
    let derivative = basis.derivative_matrix(basis.nodes());
    let top = |a: usize, b: usize| if a == order - 1 && b == order - 1 { 1.0 } else { 0.0 };
    Matrix::from_fn(order, order, |a, b| top(a, b) - weights[b] * derivative[(b, a)])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::testing::distance;

    const ORDERS: std::ops::RangeInclusive<usize> = 1..=16;

    fn power(s: f64, k: usize) -> f64 {
        s.powi(k as i32)
    }

    /// sum_b coefficients_b f(s_b)
    fn sum(coefficients: &[f64], time: &RadauTime, f: impl Fn(f64) -> f64) -> f64 {
        coefficients.iter().zip(time.nodes()).map(|(c, &s)| c * f(s)).sum()
    }

    #[test]
    fn radau_iia_conditions() {
        for order in ORDERS {
            let time = RadauTime::new(order);
            let (s, a) = (time.nodes(), time.collocation());
            for k in 1..2 * order {
                // B(2 N_t - 1): sum_b w_b s_b^{k-1} = 1/k
                assert!((sum(time.weights(), &time, |s| power(s, k - 1)) - 1.0 / k as f64).abs() < 1e-14);
            }
            for (k, i) in (1..=order).flat_map(|k| (0..order).map(move |i| (k, i))) {
                // C(N_t): sum_b A_ab s_b^{k-1} = s_a^k / k
                assert!((sum(a.row(i), &time, |s| power(s, k - 1)) - power(s[i], k) / k as f64).abs() < 1e-14);
            }
            // stiffly accurate: the last stage is the top of the slab
            let top = distance(
                &Matrix::new(1, order, a.row(order - 1).to_vec()),
                &Matrix::new(1, order, time.weights().to_vec()),
            );
            assert!(s[order - 1] == 1.0 && top < 1e-14);
        }
    }

    #[test]
    fn two_stages_are_those_of_the_textbook() {
        let time = RadauTime::new(2);
        let textbook = Matrix::new(2, 2, vec![5.0 / 12.0, -1.0 / 12.0, 3.0 / 4.0, 1.0 / 4.0]);
        assert!(distance(time.collocation(), &textbook) < 1e-15);
        assert!((time.nodes()[0] - 1.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn galerkin_in_time_is_collocation() {
        for order in ORDERS {
            let time = RadauTime::new(order);
            let identity = time.collocation().product(time.inverse_collocation());
            assert!(distance(&identity, &Matrix::identity(order)) < 1e-12, "order {order}");
        }
    }

    #[test]
    fn slab_matrix_is_the_integral_it_stands_for() {
        for order in ORDERS {
            let time = RadauTime::new(order);
            let rule = gauss(order).on(0.0, 1.0);
            let integral = |a: usize, b: usize| -> f64 {
                let term = |(&s, w): (&f64, &f64)| w * time.derivatives(s)[a] * time.values(s)[b];
                rule.points.iter().zip(&rule.weights).map(term).sum()
            };
            let top = time.values(1.0);
            let exact = Matrix::from_fn(order, order, |a, b| top[a] * top[b] - integral(a, b));
            assert!(distance(time.slab_matrix(), &exact) < 1e-12);
        }
    }

    /// A constant state from slab to slab: sum_b T_ab = phi_a(0), the weight of the previous state.
    #[test]
    fn slab_matrix_keeps_constants() {
        for order in ORDERS {
            let time = RadauTime::new(order);
            let bottom = time.values(0.0);
            assert!((0..order).all(|a| (time.slab_matrix().row(a).iter().sum::<f64>() - bottom[a]).abs() < 1e-12));
        }
    }

    #[test]
    fn eigenvalues_on_the_unit_slab() {
        let root = 2.0_f64.sqrt();
        let expected: [&[(f64, f64)]; 3] = [
            &[(1.0, 0.0)],
            &[(2.0, -root), (2.0, root)],
            &[(2.6810828, -3.0504302), (2.6810828, 3.0504302), (3.6378344, 0.0)],
        ];
        for (order, expected) in (1..).zip(expected) {
            let matrix = RadauTime::new(order).inverse_collocation().clone();
            let eigenvalues = faer::Mat::from_fn(order, order, |i, j| matrix[(i, j)]).eigenvalues().unwrap();
            for &(re, im) in expected {
                assert!(
                    eigenvalues.iter().any(|z| (z.re - re).abs() < 1e-6 && (z.im - im).abs() < 1e-6),
                    "{eigenvalues:?}"
                );
            }
        }
    }

    #[test]
    fn integrals_differentiate_to_values_and_values_to_derivatives() {
        let h = 1e-5;
        for order in 1..=6 {
            let time = RadauTime::new(order);
            assert_eq!(time.integrals(0.0), vec![0.0; order]);
            for s in [0.1, 0.55, 1.0] {
                for b in 0..order {
                    let slope = |f: &dyn Fn(f64) -> Vec<f64>| (f(s + h)[b] - f(s - h)[b]) / (2.0 * h);
                    assert!((slope(&|s| time.integrals(s)) - time.values(s)[b]).abs() < 1e-7);
                    assert!((slope(&|s| time.values(s)) - time.derivatives(s)[b]).abs() < 1e-6);
                }
            }
        }
    }

    #[test]
    fn extrapolation_continues_a_polynomial() {
        for order in 1..=5 {
            let time = RadauTime::new(order);
            let u = |s: f64| power(1.0 - 0.5 * s, order - 1);
            let next = sum(&time.extrapolation(0.5, 0.7), &time, u);
            assert!((next - u(1.35)).abs() < 1e-13);
        }
    }
}
