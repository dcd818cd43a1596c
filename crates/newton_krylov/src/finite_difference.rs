//! The action of the Jacobian by differences of the residual: an oracle for the exact action, and a setting.
//!
//! ```text
//! (one-sided)   dR/dz d = ( R(z + h d) - R(z) ) / h + O(h)              h = sqrt(eps) (1 + |z|) / |d|
//! (central)     dR/dz d = ( R(z + h d) - R(z - h d) ) / 2h + O(h^2)     h = cbrt(eps) (1 + |z|) / |d|
//! ```

use crate::inner_product::{InnerProduct, axpy, copy, scale};
use crate::problem::{Field, Inadmissible, NonlinearProblem};

/// Which difference quotient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// (one-sided): one residual per product, about eight digits.
    OneSided,
    /// (central): two residuals per product, about ten digits.
    Central,
}

/// A problem with its [`NonlinearProblem::jacobian_product`] replaced by a difference quotient.
///
/// If R is not defined next to the point of linearisation, the quotient is filled with NaN, which FGMRES reports.
pub struct FiniteDifference<'a, P: NonlinearProblem + ?Sized> {
    problem: &'a mut P,
    scheme: Scheme,
    z: Vec<f64>,
    residual: Vec<f64>,
    shifted: Vec<f64>,
}

impl<'a, P: NonlinearProblem + ?Sized> FiniteDifference<'a, P> {
    /// Wraps `problem`.
    pub fn new(problem: &'a mut P, scheme: Scheme) -> Self {
        let n = problem.len();
        Self { problem, scheme, z: vec![0.0; n], residual: vec![0.0; n], shifted: vec![0.0; n] }
    }

    /// R(z + h d) in `out`.
    fn shifted_residual(&mut self, h: f64, direction: &[f64], out: &mut [f64]) -> Result<(), Inadmissible> {
        copy(&self.z, &mut self.shifted);
        axpy(h, direction, &mut self.shifted);
        self.problem.residual(&self.shifted, out)
    }

    /// (one-sided) or (central) in `out`.
    fn quotient(&mut self, direction: &[f64], out: &mut [f64]) -> Result<(), Inadmissible> {
        let inner_product = self.problem.inner_product();
        let length = inner_product.norm(direction);
        if length == 0.0 {
            scale(0.0, out);
            return Ok(());
        }
        let size = (1.0 + inner_product.norm(&self.z)) / length;
        match self.scheme {
            Scheme::OneSided => {
                let h = f64::EPSILON.sqrt() * size;
                self.shifted_residual(h, direction, out)?;
                axpy(-1.0, &self.residual, out);
                scale(1.0 / h, out);
            }
            Scheme::Central => {
                let h = f64::EPSILON.cbrt() * size;
                let mut minus = std::mem::take(&mut self.residual);
                let evaluated = self
                    .shifted_residual(-h, direction, &mut minus)
                    .and_then(|()| self.shifted_residual(h, direction, out));
                axpy(-1.0, &minus, out);
                scale(0.5 / h, out);
                self.residual = minus;
                evaluated?;
            }
        }
        Ok(())
    }
}

impl<P: NonlinearProblem + ?Sized> NonlinearProblem for FiniteDifference<'_, P> {
    fn len(&self) -> usize {
        self.problem.len()
    }

    fn fields(&self) -> &[Field] {
        self.problem.fields()
    }

    fn inner_product(&self) -> &dyn InnerProduct {
        self.problem.inner_product()
    }

    fn residual(&mut self, z: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        self.problem.residual(z, r)
    }

    fn linearise(&mut self, z: &[f64], inverse_pseudo_time: &[f64]) -> Result<(), Inadmissible> {
        copy(z, &mut self.z);
        if self.scheme == Scheme::OneSided {
            self.problem.residual(z, &mut self.residual)?;
        }
        self.problem.linearise(z, inverse_pseudo_time)
    }

    fn jacobian_product(&mut self, direction: &[f64], out: &mut [f64]) {
        if self.quotient(direction, out).is_err() {
            out.fill(f64::NAN);
        }
    }

    fn add_pseudo_time(&mut self, direction: &[f64], out: &mut [f64]) {
        self.problem.add_pseudo_time(direction, out);
    }

    fn precondition(&mut self, r: &[f64], out: &mut [f64]) {
        self.problem.precondition(r, out);
    }

    fn largest_step(&mut self, z: &[f64], increment: &[f64]) -> f64 {
        self.problem.largest_step(z, increment)
    }
}
