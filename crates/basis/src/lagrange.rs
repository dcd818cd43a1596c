//! The nodal basis.

use crate::{Matrix, gauss_lobatto};

/// The Lagrange polynomials of a set of nodes: l_j(x) = prod_{k != j} (x - x_k) / (x_j - x_k), so that l_j(x_i) =
/// delta_ij.
#[derive(Clone, Debug, PartialEq)]
pub struct Lagrange {
    nodes: Vec<f64>,
    /// [`derivative_matrix`](Self::derivative_matrix) at the nodes themselves.
    nodal_derivative: Matrix,
}

impl Lagrange {
    /// The polynomials of `nodes`, which are distinct.
    pub fn new(nodes: Vec<f64>) -> Self {
        let nodal_derivative = nodal_derivative(&nodes);
        Lagrange { nodes, nodal_derivative }
    }
    /// The polynomials of the `order` Gauss-Lobatto nodes.
    ///
    /// # Panics
    /// If order < 2.
    pub fn gauss_lobatto(order: usize) -> Self {
        Lagrange::new(gauss_lobatto(order).points)
    }

    /// The nodes x_j.
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// l_j(x) for every j.
    ///
    /// Computed as products, because these are exact at the nodes, and every l_j has full relative accuracy at every x,
    /// also outside the nodes.
    pub fn values(&self, x: f64) -> Vec<f64> {
        (0..self.nodes.len()).map(|j| self.value(j, x)).collect()
    }
    fn value(&self, j: usize, x: f64) -> f64 {
        let factor = |k: usize| (x - self.nodes[k]) / (self.nodes[j] - self.nodes[k]);
        (0..self.nodes.len()).filter(|&k| k != j).map(factor).product()
    }

    /// l_j'(x) for every j.
    pub fn derivatives(&self, x: f64) -> Vec<f64> {
        self.derivative_matrix(&[x]).values().to_vec()
    }

    /// l_j(points_i), `[point][node]`: interpolation from the nodes to the points.
    pub fn value_matrix(&self, points: &[f64]) -> Matrix {
        Matrix::from_fn(points.len(), self.nodes.len(), |i, j| self.value(j, points[i]))
    }

    /// l_j'(points_i), `[point][node]`: the derivative, a polynomial of lower degree, is interpolated from its values
    /// at the nodes.
    pub fn derivative_matrix(&self, points: &[f64]) -> Matrix {
        self.value_matrix(points).product(&self.nodal_derivative)
    }
}

/// l_j'(x_i) = (b_j / b_i) / (x_i - x_j) for i != j, with the barycentric weights 1/b_j = prod_{k != j} (x_j - x_k).
/// The diagonal is minus the sum of the others, so that a constant has no derivative (Berrut & Trefethen, SIAM Review
/// 46, 2004).
fn nodal_derivative(nodes: &[f64]) -> Matrix {
    let n = nodes.len();
    let others = |j: usize| (0..n).filter(move |&k| k != j);
    let inverse_weight: Vec<f64> = (0..n).map(|j| others(j).map(|k| nodes[j] - nodes[k]).product()).collect();
    let entry = |i: usize, j: usize| inverse_weight[i] / inverse_weight[j] / (nodes[i] - nodes[j]);
    Matrix::from_fn(n, n, |i, j| if i == j { -others(i).map(|k| entry(i, k)).sum::<f64>() } else { entry(i, j) })
}

/// `n` equidistant points on [-1, 1] with both ends, symmetric to the bit: the nodes of output files.
///
/// # Panics
/// If n < 2.
pub fn equidistant_points(n: usize) -> Vec<f64> {
    assert!(n >= 2, "equidistant points include the two ends");
    (0..n).map(|i| (2.0 * i as f64 - (n - 1) as f64) / (n - 1) as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jacobi::{jacobi_derivative, legendre};
    use crate::testing::distance;
    use crate::{gauss, right_radau};

    /// Nodes of every kind in use, for order n.
    fn bases(n: usize) -> [Lagrange; 3] {
        [Lagrange::gauss_lobatto(n), Lagrange::new(gauss(n).points), Lagrange::new(right_radau(n).points)]
    }

    #[test]
    fn values_at_the_nodes_are_the_identity_exactly() {
        for n in 2..=16 {
            for basis in bases(n) {
                assert_eq!(basis.value_matrix(basis.nodes()), Matrix::identity(n));
            }
        }
    }

    #[test]
    fn polynomials_are_reproduced_with_their_derivatives() {
        let points = equidistant_points(23);
        for n in 2..=16 {
            for basis in bases(n) {
                for m in 0..n {
                    let nodal = Matrix::new(n, 1, basis.nodes().iter().map(|&x| legendre(m, x)).collect());
                    let value = Matrix::from_fn(23, 1, |i, _| legendre(m, points[i]));
                    let derivative = Matrix::from_fn(23, 1, |i, _| jacobi_derivative(m, 0.0, 0.0, points[i]));
                    assert!(distance(&basis.value_matrix(&points).product(&nodal), &value) < 1e-14);
                    assert!(distance(&basis.derivative_matrix(&points).product(&nodal), &derivative) < 1e-12);
                }
            }
        }
    }

    #[test]
    fn sum_is_one_and_its_derivative_zero() {
        for n in 2..=16 {
            for basis in bases(n) {
                for x in equidistant_points(50) {
                    assert!((basis.values(x).iter().sum::<f64>() - 1.0).abs() < 1e-14);
                    assert!(basis.derivatives(x).iter().sum::<f64>().abs() < 1e-13 * (n * n) as f64);
                }
            }
        }
    }

    #[test]
    fn extrapolation_is_accurate() {
        let basis = Lagrange::new(right_radau(8).points);
        let cubed: f64 = basis.values(3.0).iter().zip(basis.nodes()).map(|(l, x)| l * x * x * x).sum();
        let growth: f64 = basis.values(3.0).iter().map(|l| l.abs()).sum();
        assert!((cubed - 27.0).abs() < 1e-15 * growth);
    }

    #[test]
    fn equidistant_points_are_symmetric_and_equidistant() {
        assert_eq!(equidistant_points(5), [-1.0, -0.5, 0.0, 0.5, 1.0]);
        let points = equidistant_points(16);
        assert!((0..16).all(|i| points[i] == -points[15 - i]));
    }
}
