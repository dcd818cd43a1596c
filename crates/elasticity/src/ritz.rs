//! The method of Rayleigh and Ritz.
//!
//! ```text
//! K x = lambda M x                                                                                             (pencil)
//! ```
//!
//! The best approximations of the lowest eigenvectors in the span of some vectors are the eigenvectors of X.KX, where X is a basis of the
//! span with X.MX = I.

use crate::ElasticityError;
use faer::{Mat, Side};
use newton_krylov::inner_product::{Euclidean, InnerProduct};

/// The product with a symmetric matrix.
type Product<'a> = &'a dyn Fn(&[f64], &mut [f64]);

/// (pencil): K and M, which is definite.
pub(crate) struct Pencil<'a> {
    pub(crate) k: Product<'a>,
    pub(crate) m: Product<'a>,
}

impl Pencil<'_> {
    /// Replaces the vectors `x` by the best approximations of eigenvectors in their span, with x_i . M x_j = delta_ij. Returns their
    /// eigenvalues in increasing order.
    pub(crate) fn ritz(&self, x: &mut Vec<Vec<f64>>) -> Result<Vec<f64>, ElasticityError> {
        self.orthonormalise(x);
        let eigen =
            self.stiffness(x).self_adjoint_eigen(Side::Lower).map_err(|cause| ElasticityError::NotDefinite {
                // The only failure is an entry that is not a number.
                cause: format!("{cause:?}"),
            })?;
        let turned = |j: usize| {
            let mut y = vec![0.0; x[0].len()];
            x.iter().enumerate().for_each(|(k, x)| add_scaled(eigen.U()[(k, j)], x, &mut y));
            y
        };
        let values = (0..x.len()).map(|j| eigen.S().column_vector()[j]).collect();
        *x = (0..x.len()).map(turned).collect();
        Ok(values)
    }

    /// Makes x_i . M x_j = delta_ij by Gram-Schmidt, twice, because the vectors may be nearly parallel.
    fn orthonormalise(&self, x: &mut [Vec<f64>]) {
        let mut inertia = vec![0.0; x[0].len()];
        for j in 0..x.len() {
            let (before, rest) = x.split_at_mut(j);
            let x_j = &mut rest[0];
            for _ in 0..2 {
                (self.m)(x_j, &mut inertia);
                let products: Vec<f64> = before.iter().map(|x_i| Euclidean.dot(x_i, &inertia)).collect();
                before.iter().zip(products).for_each(|(x_i, product)| add_scaled(-product, x_i, x_j));
                (self.m)(x_j, &mut inertia);
                let norm = Euclidean.dot(x_j, &inertia).sqrt();
                x_j.iter_mut().for_each(|x| *x /= norm);
            }
        }
    }

    /// x_i . K x_j
    fn stiffness(&self, x: &[Vec<f64>]) -> Mat<f64> {
        let mut forces = vec![0.0; x[0].len()];
        let mut products = Mat::zeros(x.len(), x.len());
        for j in 0..x.len() {
            (self.k)(&x[j], &mut forces);
            (0..x.len()).for_each(|i| products[(i, j)] = Euclidean.dot(&x[i], &forces));
        }
        products
    }
}

/// y := y + c x
pub(crate) fn add_scaled(c: f64, x: &[f64], y: &mut [f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += c * x);
}
