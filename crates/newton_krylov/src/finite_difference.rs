//! Jacobian products by differences of the residual: a reference for exact products, and a setting.
//!
//! ```text
//! (one-sided)   dR/dz d = ( R(z + h d) - R(z) ) / h + O(h)              h = sqrt(eps) (1 + |z|) / |d|
//! (central)     dR/dz d = ( R(z + h d) - R(z - h d) ) / 2h + O(h^2)     h = cbrt(eps) (1 + |z|) / |d|
//! ```

use crate::inner_product::{InnerProduct, axpy, copy, scale};
use crate::problem::{Field, Inadmissible, NonlinearProblem};

/// The difference quotient.
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
pub struct FiniteDifference<'a> {
    problem: &'a mut dyn NonlinearProblem,
    scheme: Scheme,
    z: Vec<f64>,
    residual: Vec<f64>,
    shifted: Vec<f64>,
}

impl<'a> FiniteDifference<'a> {
    /// Wraps `problem`.
    pub fn new(problem: &'a mut dyn NonlinearProblem, scheme: Scheme) -> Self {
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
            out.fill(0.0);
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

impl NonlinearProblem for FiniteDifference<'_> {
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

    fn guess_increment(&mut self, right_side: &[f64], increment: &mut [f64]) {
        self.problem.guess_increment(right_side, increment);
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

    fn merit(&mut self, r: &[f64]) -> f64 {
        self.problem.merit(r)
    }

    fn round_off(&mut self, z: &[f64]) -> Option<Vec<f64>> {
        self.problem.round_off(z)
    }

    fn largest_step(&mut self, z: &[f64], increment: &[f64]) -> f64 {
        self.problem.largest_step(z, increment)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::inner_product::Euclidean;
    use crate::newton;
    use crate::test_problems::{Bratu, Small, scattered};

    /// The relative difference between the quotient and the exact product, for a pseudo-random state and direction.
    fn error(scheme: Scheme) -> f64 {
        let (z, d) = (scattered(30), scattered(60)[30..].to_vec());
        let mut exact = vec![0.0; 30];
        let mut quotient = vec![0.0; 30];
        let mut problem = Bratu::new(30);
        problem.linearise(&z, &[0.0]).unwrap();
        problem.jacobian_product(&d, &mut exact);
        let mut difference = FiniteDifference::new(&mut problem, scheme);
        difference.linearise(&z, &[0.0]).unwrap();
        difference.jacobian_product(&d, &mut quotient);
        axpy(-1.0, &exact, &mut quotient);
        Euclidean.norm(&quotient) / Euclidean.norm(&exact)
    }

    #[test]
    fn differences_agree_with_the_exact_action() {
        assert!(error(Scheme::OneSided) <= 1e-7);
        assert!(error(Scheme::Central) <= 1e-10);
    }

    #[test]
    fn the_derivative_in_direction_zero_is_zero() {
        let mut problem = Bratu::new(3);
        let mut difference = FiniteDifference::new(&mut problem, Scheme::Central);
        difference.linearise(&[0.0; 3], &[0.0]).unwrap();
        let mut out = [f64::NAN; 3];
        difference.jacobian_product(&[0.0; 3], &mut out);
        assert_eq!(out, [0.0; 3]);
    }

    #[test]
    fn newton_takes_as_many_steps_with_differences_as_with_the_exact_action() {
        let solve = |problem: &mut dyn NonlinearProblem| {
            let mut z = vec![0.0; 63];
            newton::solve(problem, &mut z, None, &newton::Settings::default(), &mut newton::Workspace::default())
                .unwrap()
        };
        let mut problem = Bratu::new(63);
        let exact = solve(&mut problem).steps.len();
        for scheme in [Scheme::OneSided, Scheme::Central] {
            assert_eq!(solve(&mut FiniteDifference::new(&mut problem, scheme)).steps.len(), exact);
        }
    }

    #[test]
    fn an_undefined_residual_next_to_the_state_is_a_typed_failure() {
        let at_the_edge = |z: &[f64]| match z[0] {
            x if x < 1.0 => Err(Inadmissible { quantity: "x".into(), value: x, location: "below 1".into() }),
            x => Ok(vec![x - 2.0]),
        };
        let mut problem = Small::new(1, at_the_edge, |_| vec![vec![1.0]]);
        let mut difference = FiniteDifference::new(&mut problem, Scheme::OneSided);
        let result = newton::solve(
            &mut difference,
            &mut [1.0],
            None,
            &newton::Settings::default(),
            &mut newton::Workspace::default(),
        );
        assert!(matches!(result, Err(newton::Error::Krylov { .. })));
    }
}
