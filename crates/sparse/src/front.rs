//! The dense work on one front.
//!
//! With the rows that the front eliminates (e) and those of its boundary (b):
//!
//! ```text
//! F_ee = L_ee L_ee^H,      L_be = F_be L_ee^{-H},      F_bb - L_be L_be^H                                     (front-llh)
//! P F_ee = L U,            Z = F_ee^{-1} F_eb,         F_bb - F_be Z                                          (front-lu)
//! ```
//!
//! The last term of a line is the Schur complement, which the front leaves to its parent.

use crate::{Error, Scalar};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as triangular_matmul};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::reborrow::ReborrowMut;
use faer::traits::ext::ComplexFieldExt;
use faer::{Accum, Mat, MatMut, Par, Spec};

/// The bits of faer's kernels depend on the number of threads that share one product, so each product is sequential.
const SEQUENTIAL: Par = Par::Seq;

/// The kind of the factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// (front-llh), for Hermitian positive definite matrices. Only the lower triangle is read.
    Cholesky,
    /// (front-lu), for any regular matrix. Rows are interchanged only within F_ee.
    Lu,
}

/// The stored factors of a front.
pub(crate) enum Factors<T> {
    /// L_ee above L_be.
    Cholesky(Mat<T>),
    Lu {
        /// L and U in place of F_ee, above F_be.
        eliminated: Mat<T>,
        /// P as the order of the rows of F_ee.
        pivots: Vec<usize>,
        z: Mat<T>,
    },
}

impl<T: Scalar> Factors<T> {
    /// Eliminates the first `e` rows of `f`. Returns the factors and the Schur complement.
    pub(crate) fn new(kind: Kind, f: Mat<T>, e: usize) -> Result<(Self, Mat<T>), Error> {
        match kind {
            Kind::Cholesky => cholesky(f, e),
            Kind::Lu => lu(f, e),
        }
    }

    /// Memory in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let entries = |matrix: &Mat<T>| matrix.nrows() * matrix.ncols() * size_of::<T>();
        match self {
            Factors::Cholesky(l) => entries(l),
            Factors::Lu { eliminated, pivots, z } => entries(eliminated) + entries(z) + size_of_val(&pivots[..]),
        }
    }

    /// The forward sweep: x_e := L_ee^{-1} x_e or F_ee^{-1} x_e. Writes the amount to subtract from x_b into `change`. `scratch` has the
    /// size of x_e.
    pub(crate) fn forward(&self, mut x_e: MatMut<'_, T>, change: MatMut<'_, T>, scratch: &mut [T]) {
        let below = match self {
            Factors::Cholesky(l) => {
                let (l_ee, l_be) = l.split_at_row(l.ncols());
                solve_lower_triangular_in_place(l_ee, x_e.rb_mut(), SEQUENTIAL);
                l_be
            }
            Factors::Lu { eliminated, pivots, .. } => {
                let (f_ee, f_be) = eliminated.split_at_row(eliminated.ncols());
                interchange(pivots, x_e.rb_mut(), scratch);
                solve_unit_lower_triangular_in_place(f_ee, x_e.rb_mut(), SEQUENTIAL);
                solve_upper_triangular_in_place(f_ee, x_e.rb_mut(), SEQUENTIAL);
                f_be
            }
        };
        matmul(change, Accum::Replace, below, x_e.as_ref(), T::one(), SEQUENTIAL);
    }

    /// The backward sweep: x_e := L_ee^{-H} (x_e - L_be^H x_b) or x_e - Z x_b.
    pub(crate) fn backward(&self, mut x_e: MatMut<'_, T>, x_b: MatMut<'_, T>) {
        match self {
            Factors::Cholesky(l) => {
                let (l_ee, l_be) = l.split_at_row(l.ncols());
                matmul(x_e.rb_mut(), Accum::Add, l_be.adjoint(), x_b.as_ref(), -T::one(), SEQUENTIAL);
                solve_upper_triangular_in_place(l_ee.adjoint(), x_e, SEQUENTIAL);
            }
            Factors::Lu { z, .. } => matmul(x_e, Accum::Add, z, x_b.as_ref(), -T::one(), SEQUENTIAL),
        }
    }
}

/// (front-llh). A pivot at round-off of its diagonal entry is refused, because rounding alone decides its sign.
fn cholesky<T: Scalar>(mut f: Mat<T>, e: usize) -> Result<(Factors<T>, Mat<T>), Error> {
    let (mut f_ee, _, f_be, f_bb) = f.as_mut().split_at_mut(e, e);
    let diagonal: Vec<T> = (0..e).map(|k| f_ee[(k, k)]).collect();
    let mut memory = MemBuffer::new(cholesky_in_place_scratch::<T>(e, SEQUENTIAL, Spec::default()));
    let (stack, regularization) = (MemStack::new(&mut memory), LltRegularization::default());
    cholesky_in_place(f_ee.rb_mut(), regularization, SEQUENTIAL, stack, Spec::default())
        .map_err(|cause| Error::NotDefinite { cause: format!("{cause:?}") })?;
    for (k, entry) in diagonal.iter().enumerate() {
        check_pivot(f_ee[(k, k)].abs2(), entry.abs(), e)?;
    }
    let mut l_eb = f_be.transpose_mut();
    // L_be^T = conj(L_ee)^{-1} F_be^T.
    solve_lower_triangular_in_place(f_ee.as_ref().conjugate(), l_eb.rb_mut(), SEQUENTIAL);
    let (lower, full, l_be) = (BlockStructure::TriangularLower, BlockStructure::Rectangular, l_eb.as_ref().transpose());
    triangular_matmul(f_bb, lower, Accum::Add, l_be, full, l_be.adjoint(), full, -T::one(), SEQUENTIAL);
    Ok(split(f, e, |own, _| Factors::Cholesky(own)))
}

/// Whether a pivot is more than round-off of the diagonal entry from which it was computed.
fn check_pivot<R: faer::traits::RealField>(pivot: R, entry: R, rows: usize) -> Result<(), Error> {
    let round_off = R::from_f64_impl(10.0 * rows as f64) * R::epsilon_impl() * entry.clone();
    if pivot > round_off {
        return Ok(());
    }
    Err(Error::NotDefinite { cause: format!("the pivot {pivot:?} is round-off of the diagonal entry {entry:?}") })
}

/// (front-lu). A zero pivot leads to entries that are not finite, unless it is the last one.
fn lu<T: Scalar>(mut f: Mat<T>, e: usize) -> Result<(Factors<T>, Mat<T>), Error> {
    let (mut pivots, mut inverse) = (vec![0_usize; e], vec![0; e]);
    let mut memory = MemBuffer::new(lu_in_place_scratch::<usize, T>(e, e, SEQUENTIAL, Spec::default()));
    let (mut f_ee, mut f_eb, f_be, f_bb) = f.as_mut().split_at_mut(e, e);
    let stack = MemStack::new(&mut memory);
    lu_in_place(f_ee.rb_mut(), &mut pivots, &mut inverse, SEQUENTIAL, stack, Spec::default());
    let mut scratch = vec![T::zero_impl(); e * f_eb.ncols()];
    interchange(&pivots, f_eb.rb_mut(), &mut scratch);
    solve_unit_lower_triangular_in_place(f_ee.as_ref(), f_eb.rb_mut(), SEQUENTIAL);
    solve_upper_triangular_in_place(f_ee.as_ref(), f_eb.rb_mut(), SEQUENTIAL);
    let has_zero_pivot = (0..e).any(|k| f_ee[(k, k)] == T::zero_impl());
    if has_zero_pivot || !(f_ee.as_ref().is_all_finite() && f_eb.as_ref().is_all_finite()) {
        return Err(Error::Singular);
    }
    matmul(f_bb, Accum::Add, f_be.as_ref(), f_eb.as_ref(), -T::one(), SEQUENTIAL);
    Ok(split(f, e, |eliminated, z| Factors::Lu { eliminated, pivots, z }))
}

/// x := P x. `scratch` has the size of x.
fn interchange<T: Scalar>(pivots: &[usize], mut x: MatMut<'_, T>, scratch: &mut [T]) {
    let rows = pivots.len();
    for column in 0..x.ncols() {
        pivots.iter().enumerate().for_each(|(k, &pivot)| scratch[column * rows + k] = x[(pivot, column)]);
        (0..rows).for_each(|k| x[(k, column)] = scratch[column * rows + k]);
    }
}

/// The factors, which `keep` makes of the first `e` columns and of the block beside them, and the Schur complement.
fn split<T: Scalar>(f: Mat<T>, e: usize, keep: impl FnOnce(Mat<T>, Mat<T>) -> Factors<T>) -> (Factors<T>, Mat<T>) {
    let b = f.nrows() - e;
    let factors = keep(f.subcols(0, e).to_owned(), f.submatrix(0, e, e, b).to_owned());
    (factors, f.submatrix(e, e, b, b).to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With the entry 1/3 the matrix is singular, and round-off decides on the sign of its second pivot.
    #[test]
    fn a_pivot_of_round_off_is_an_error() {
        let factors =
            |last: f64| Factors::new(Kind::Cholesky, Mat::from_fn(2, 2, |i, j| [[3.0, 1.0], [1.0, last]][i][j]), 2);
        for last in [1.0 / 3.0 - 1e-16, 1.0 / 3.0, 1.0 / 3.0 + 1e-16] {
            assert!(matches!(factors(last), Err(Error::NotDefinite { .. })));
        }
        assert!(factors(0.34).is_ok());
    }
}
