//! Small dense matrices.

use faer::Mat;
use faer::linalg::solvers::DenseSolveCore;
use std::ops::Index;

/// A small dense matrix, `matrix[(row, column)]`, stored row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    rows: usize,
    cols: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// The matrix of `rows` x `cols` with `values` row by row.
    ///
    /// # Panics
    /// If the number of values is not `rows * cols`.
    pub fn new(rows: usize, cols: usize, values: Vec<f64>) -> Self {
        assert_eq!(values.len(), rows * cols, "a {rows} x {cols} matrix has {} values", rows * cols);
        Matrix { rows, cols, values }
    }
    /// The matrix with entries `entry(row, column)`.
    pub fn from_fn(rows: usize, cols: usize, mut entry: impl FnMut(usize, usize) -> f64) -> Self {
        let values = (0..rows * cols).map(|k| entry(k / cols, k % cols)).collect();
        Matrix { rows, cols, values }
    }
    /// The `n` x `n` identity.
    pub fn identity(n: usize) -> Self {
        Matrix::from_fn(n, n, |i, j| if i == j { 1.0 } else { 0.0 })
    }

    /// Number of rows.
    #[inline]
    pub fn rows(&self) -> usize {
        self.rows
    }
    /// Number of columns.
    #[inline]
    pub fn cols(&self) -> usize {
        self.cols
    }
    /// Row `i`, of length [`cols`](Self::cols).
    #[inline]
    pub fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.cols..][..self.cols]
    }
    /// All entries, row by row.
    #[inline]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The transposed matrix.
    pub fn transpose(&self) -> Matrix {
        Matrix::from_fn(self.cols, self.rows, |i, j| self[(j, i)])
    }

    /// self * right.
    ///
    /// # Panics
    /// If `right` has not as many rows as `self` has columns.
    pub fn product(&self, right: &Matrix) -> Matrix {
        assert_eq!(self.cols, right.rows, "the inner sizes of a matrix product agree");
        Matrix::from_fn(self.rows, right.cols, |i, j| (0..self.cols).map(|k| self[(i, k)] * right[(k, j)]).sum())
    }

    /// y = self * x, with `x` of length [`cols`](Self::cols) and `y` of length [`rows`](Self::rows).
    pub fn apply(&self, x: &[f64], y: &mut [f64]) {
        debug_assert_eq!((x.len(), y.len()), (self.cols, self.rows));
        for (i, y_i) in y.iter_mut().enumerate() {
            *y_i = self.row(i).iter().zip(x).map(|(a, x)| a * x).sum();
        }
    }

    /// The inverse by LU with partial pivoting; `None` if the matrix is singular (a pivot vanishes or the inverse
    /// overflows).
    ///
    /// # Panics
    /// If the matrix is not square.
    pub fn inverse(&self) -> Option<Matrix> {
        assert_eq!(self.rows, self.cols, "only a square matrix has an inverse");
        let n = self.rows;
        let inverse = Mat::from_fn(n, n, |i, j| self[(i, j)]).partial_piv_lu().inverse();
        let inverse = Matrix::from_fn(n, n, |i, j| inverse[(i, j)]);
        inverse.values.iter().all(|entry| entry.is_finite()).then_some(inverse)
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;
    #[inline]
    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        debug_assert!(column < self.cols);
        &self.values[row * self.cols + column]
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::testing::distance;

    fn sample(rows: usize, cols: usize) -> Matrix {
        Matrix::from_fn(rows, cols, |i, j| ((3 * i + 5 * j) as f64).sin())
    }

    #[test]
    fn entries_are_stored_row_by_row() {
        let a = Matrix::new(2, 3, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!((a[(0, 2)], a[(1, 0)]), (3.0, 4.0));
        assert_eq!(a.row(1), [4.0, 5.0, 6.0]);
        assert_eq!(a.transpose().values(), [1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
    }

    #[test]
    fn product_acts_as_one_factor_after_the_other() {
        let (a, b, x) = (sample(3, 4), sample(4, 2), [0.3, -1.2]);
        let (mut bx, mut abx, mut product_x) = ([0.0; 4], [0.0; 3], [0.0; 3]);
        b.apply(&x, &mut bx);
        a.apply(&bx, &mut abx);
        a.product(&b).apply(&x, &mut product_x);
        assert!((0..3).all(|i| (abx[i] - product_x[i]).abs() < 1e-15));
    }

    #[test]
    fn inverse_needs_pivoting_and_sees_singularity() {
        let a = Matrix::new(2, 2, vec![0.0, 2.0, 1.0, 1.0]);
        assert!(distance(&a.product(&a.inverse().unwrap()), &Matrix::identity(2)) < 1e-15);
        assert_eq!(Matrix::new(2, 2, vec![1.0, 2.0, 2.0, 4.0]).inverse(), None);
    }
}
