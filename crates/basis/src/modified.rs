//! The hierarchical C0 basis.

use crate::jacobi::jacobi;
use crate::{Matrix, gauss_lobatto};

/// The modified basis of Karniadakis & Sherwin (Spectral/hp Element Methods, chapter 2) on [-1, 1]: the two vertex
/// functions first, then the interior modes,
///
///   psi_0 = (1 - x)/2,   psi_1 = (1 + x)/2,   psi_{2+k} = (1 - x)(1 + x)/4 P_k^{(1,1)}(x),   k = 0..order-3.
///
/// The functions of a lower order are the first ones of a higher order, so neighbours of different order conform.
#[derive(Clone, Debug, PartialEq)]
pub struct ModifiedBasis {
    to_nodal: Matrix,
    from_nodal: Matrix,
}

impl ModifiedBasis {
    /// The basis of `order` functions, degree `order - 1`.
    ///
    /// # Panics
    /// If order < 2.
    pub fn new(order: usize) -> Self {
        let to_nodal = value_matrix(order, &gauss_lobatto(order).points);
        let from_nodal = to_nodal.inverse().expect("the modified functions are linearly independent");
        ModifiedBasis { to_nodal, from_nodal }
    }
    /// The number of functions.
    pub fn order(&self) -> usize {
        self.to_nodal.cols()
    }
    /// psi_p(points_i), `[point][function]`.
    pub fn value_matrix(&self, points: &[f64]) -> Matrix {
        value_matrix(self.order(), points)
    }
    /// From modal coefficients to values at the Gauss-Lobatto nodes, `[node][function]`.
    pub fn to_nodal(&self) -> &Matrix {
        &self.to_nodal
    }
    /// From values at the Gauss-Lobatto nodes to modal coefficients, `[function][node]`.
    pub fn from_nodal(&self) -> &Matrix {
        &self.from_nodal
    }
}

fn value_matrix(order: usize, points: &[f64]) -> Matrix {
    Matrix::from_fn(points.len(), order, |i, p| psi(p, points[i]))
}

fn psi(p: usize, x: f64) -> f64 {
    let (low, high) = ((1.0 - x) / 2.0, (1.0 + x) / 2.0);
    match p {
        0 => low,
        1 => high,
        _ => low * high * jacobi(p - 2, 1.0, 1.0, x),
    }
}

/// The factor of interior mode k when its line is traversed in reverse: psi_{2+k}(-x) = (-1)^k psi_{2+k}(x).
pub fn reversal_sign(k: usize) -> f64 {
    if k.is_multiple_of(2) { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::distance;
    use crate::{Lagrange, equidistant_points};

    #[test]
    fn modal_to_nodal_and_back() {
        for order in 2..=16 {
            let basis = ModifiedBasis::new(order);
            assert!(distance(&basis.from_nodal().product(basis.to_nodal()), &Matrix::identity(order)) < 1e-13);
            assert!(distance(&basis.to_nodal().product(basis.from_nodal()), &Matrix::identity(order)) < 1e-13);
        }
    }

    #[test]
    fn modal_and_nodal_are_the_same_polynomial() {
        let points = equidistant_points(31);
        for order in 2..=16 {
            let basis = ModifiedBasis::new(order);
            let by_nodes = Lagrange::gauss_lobatto(order).value_matrix(&points).product(basis.to_nodal());
            assert!(distance(&by_nodes, &basis.value_matrix(&points)) < 1e-14);
        }
    }

    #[test]
    fn vertex_functions_sum_to_one_and_interior_modes_vanish_at_the_ends() {
        let ends = ModifiedBasis::new(16).value_matrix(&[-1.0, 1.0]);
        assert_eq!((ends[(0, 0)], ends[(1, 0)], ends[(0, 1)], ends[(1, 1)]), (1.0, 0.0, 0.0, 1.0));
        assert!((2..16).all(|p| ends[(0, p)] == 0.0 && ends[(1, p)] == 0.0));
        assert!((psi(0, 0.3) + psi(1, 0.3) - 1.0).abs() < 1e-16);
    }

    #[test]
    fn reversing_the_line_swaps_vertices_and_signs_odd_modes() {
        for x in equidistant_points(9) {
            assert_eq!(psi(0, -x), psi(1, x));
            assert!((0..14).all(|k| (psi(2 + k, -x) - reversal_sign(k) * psi(2 + k, x)).abs() < 1e-15));
        }
    }
}
