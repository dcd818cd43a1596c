//! The preconditioned method of conjugate gradients for symmetric positive definite A and P (Hestenes & Stiefel 1952).
//!
//! ```text
//! (cg)   alpha = (r, z) / (p, A p),   x += alpha p,   r -= alpha A p,   z = P^-1 r,   beta = (r, z) / (r, z)_old,   p = z + beta p
//! ```
//!
//! Several right-hand sides are solved one after the other with one [`Workspace`].

use crate::inner_product::{axpy, copy, xpay};
use crate::operator::LinearSystem;

/// The settings of [`solve`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Stop at |b - A x| <= relative_tolerance |b| ...
    pub relative_tolerance: f64,
    /// ... or at |b - A x| <= absolute_tolerance.
    pub absolute_tolerance: f64,
    /// The number of iterations after which the solver gives up.
    pub max_iterations: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { relative_tolerance: 1e-10, absolute_tolerance: 0.0, max_iterations: 500 }
    }
}

/// The report of a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// The number of iterations. Each takes one product with A; a non-zero initial guess takes one more.
    pub iterations: usize,
    /// |b - A x| at the start.
    pub initial_norm: f64,
    /// |b - A x| at the end, from the recursion.
    pub final_norm: f64,
}

/// Why a solve did not reach its tolerance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The number of iterations is used up; x holds the last iterate.
    #[error("no convergence: the residual fell from {:e} to {:e} in {} iterations", .0.initial_norm, .0.final_norm, .0.iterations)]
    MaxIterations(Report),
    /// A is not positive definite.
    #[error("the operator is not positive definite: (p, A p) = {curvature:e} in iteration {}", report.iterations)]
    IndefiniteOperator {
        /// (p, A p), not positive, or not a number.
        curvature: f64,
        /// The report up to the failure.
        report: Report,
    },
    /// P is not positive definite.
    #[error("the preconditioner is not positive definite: (r, z) = {product:e} in iteration {}", report.iterations)]
    IndefinitePreconditioner {
        /// (r, P^-1 r), not positive, or not a number.
        product: f64,
        /// The report up to the failure.
        report: Report,
    },
}

/// The work memory of [`solve`]: after the first solve, later ones of the same size do not allocate.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    r: Vec<f64>,
    z: Vec<f64>,
    p: Vec<f64>,
    a_p: Vec<f64>,
    history: Vec<f64>,
}

impl Workspace {
    /// |b - A x| at the start and after every iteration of the last solve.
    pub fn history(&self) -> &[f64] {
        &self.history
    }

    /// Allocates memory for a solve of the given length.
    fn prepare(&mut self, length: usize) {
        for vector in [&mut self.r, &mut self.z, &mut self.p, &mut self.a_p] {
            vector.resize(length, 0.0);
        }
        self.history.clear();
    }
}

/// Solves A x = b. x holds the initial guess on entry, the solution on return.
///
/// A and P are symmetric positive definite in the inner product of the system.
///
/// # Errors
/// [`Error`] if the tolerance is not reached, or if A or P proves not to be positive definite.
pub fn solve(
    system: &mut dyn LinearSystem,
    b: &[f64],
    x: &mut [f64],
    settings: &Settings,
    workspace: &mut Workspace,
) -> Result<Report, Error> {
    workspace.prepare(b.len());
    let target = settings.absolute_tolerance.max(settings.relative_tolerance * system.inner_product().norm(b));
    let initial_norm = start(system, b, x, workspace);
    let mut report = Report { iterations: 0, initial_norm, final_norm: initial_norm };
    workspace.history.push(initial_norm);
    let mut r_z_old = f64::INFINITY;
    loop {
        if report.final_norm.is_finite() && report.final_norm <= target {
            return Ok(report);
        }
        if report.iterations >= settings.max_iterations {
            return Err(Error::MaxIterations(report));
        }
        r_z_old = next_direction(system, workspace, r_z_old)
            .map_err(|product| Error::IndefinitePreconditioner { product, report })?;
        advance(system, x, workspace, r_z_old).map_err(|curvature| Error::IndefiniteOperator { curvature, report })?;
        report.iterations += 1;
        report.final_norm = system.inner_product().norm(&workspace.r);
        workspace.history.push(report.final_norm);
    }
}

/// r := b - A x; returns |r|. For x = 0 no product is computed.
fn start(system: &mut dyn LinearSystem, b: &[f64], x: &[f64], workspace: &mut Workspace) -> f64 {
    if x.iter().all(|&x_i| x_i == 0.0) {
        copy(b, &mut workspace.r);
    } else {
        system.multiply(x, &mut workspace.r);
        xpay(b, -1.0, &mut workspace.r);
    }
    workspace.p.fill(0.0);
    system.inner_product().norm(&workspace.r)
}

/// z := P^-1 r and p := z + (r, z) / (r, z)_old p; returns (r, z), as an error if it is not positive.
fn next_direction(system: &mut dyn LinearSystem, workspace: &mut Workspace, r_z_old: f64) -> Result<f64, f64> {
    system.precondition(&workspace.r, &mut workspace.z);
    let r_z = positive(system.inner_product().dot(&workspace.r, &workspace.z))?;
    xpay(&workspace.z, r_z / r_z_old, &mut workspace.p);
    Ok(r_z)
}

/// x := x + alpha p and r := r - alpha A p; returns (p, A p) as an error if it is not positive.
fn advance(system: &mut dyn LinearSystem, x: &mut [f64], workspace: &mut Workspace, r_z: f64) -> Result<(), f64> {
    system.multiply(&workspace.p, &mut workspace.a_p);
    let curvature = positive(system.inner_product().dot(&workspace.p, &workspace.a_p))?;
    let alpha = r_z / curvature;
    axpy(alpha, &workspace.p, x);
    axpy(-alpha, &workspace.a_p, &mut workspace.r);
    Ok(())
}

/// The value if it is positive and finite, otherwise the value as an error.
fn positive(value: f64) -> Result<f64, f64> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(value) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::inner_product::{Euclidean, InnerProduct};
    use crate::operator::{Identity, LinearOperator, Preconditioned, Preconditioner};
    use crate::test_problems::{Action, Diagonal, bits, laplacian, scattered, with_threads};

    /// Solves from zero.
    fn run(
        operator: &mut dyn LinearOperator,
        preconditioner: &mut dyn Preconditioner,
        b: &[f64],
        workspace: &mut Workspace,
    ) -> (Vec<f64>, Result<Report, Error>) {
        let mut x = vec![0.0; b.len()];
        let mut system = Preconditioned { operator, preconditioner, inner_product: &Euclidean };
        let result = solve(&mut system, b, &mut x, &Settings::default(), workspace);
        (x, result)
    }

    /// -u'' = 1 on n inner points: u = x (1 - x) / 2 at the points, exactly.
    #[test]
    fn solves_the_poisson_problem() {
        let n = 99;
        let h = 1.0 / (n + 1) as f64;
        let (u, result) = run(&mut Action(laplacian), &mut Identity, &vec![h * h; n], &mut Workspace::default());
        for (i, u_i) in u.iter().enumerate() {
            let x = (i + 1) as f64 * h;
            assert!((u_i - 0.5 * x * (1.0 - x)).abs() <= 1e-11);
        }
        // The right-hand side is symmetric about the middle, so half of the eigenvectors do not occur.
        assert_eq!(result.unwrap().iterations, 50);
    }

    #[test]
    fn needs_as_many_iterations_as_there_are_eigenvalues_of_the_preconditioned_operator() {
        let mut workspace = Workspace::default();
        for eigenvalues in 1..=6 {
            let diagonal: Vec<f64> = (0..50).map(|i| (1 + i % eigenvalues) as f64).collect();
            let mut inverse = Action(|r: &[f64], z: &mut [f64]| (0..50).for_each(|i| z[i] = r[i] / diagonal[i]));
            let mut a = Diagonal(diagonal.clone());
            let (_, plain) = run(&mut a, &mut Identity, &scattered(50), &mut workspace);
            let (_, exact) = run(&mut a, &mut inverse, &scattered(50), &mut workspace);
            assert_eq!((plain.unwrap().iterations, exact.unwrap().iterations), (eigenvalues, 1));
        }
    }

    /// |e_k|_A <= 2 ((sqrt(kappa) - 1) / (sqrt(kappa) + 1))^k |e_0|_A
    #[test]
    fn converges_as_fast_as_the_condition_number_promises() {
        let diagonal: Vec<f64> = (0..200).map(|i| 1.0 + 99.0 * i as f64 / 199.0).collect();
        let b = scattered(200);
        let exact: Vec<f64> = b.iter().zip(&diagonal).map(|(b_i, d)| b_i / d).collect();
        let energy = |x: &[f64]| -> f64 { (0..200).map(|i| diagonal[i] * (x[i] - exact[i]).powi(2)).sum::<f64>() };
        for k in [5, 10, 20, 40] {
            let mut x = vec![0.0; 200];
            let mut a = Diagonal(diagonal.clone());
            let mut system =
                Preconditioned { operator: &mut a, preconditioner: &mut Identity, inner_product: &Euclidean };
            let settings = Settings { max_iterations: k, ..Settings::default() };
            let error = solve(&mut system, &b, &mut x, &settings, &mut Workspace::default()).unwrap_err();
            assert!(matches!(error, Error::MaxIterations(Report { iterations, .. }) if iterations == k));
            let bound = 2.0 * (9.0_f64 / 11.0).powi(k as i32);
            assert!((energy(&x) / energy(&[0.0; 200])).sqrt() <= bound);
        }
    }

    #[test]
    fn an_indefinite_operator_is_an_error_with_the_curvature() {
        let (_, result) = run(&mut Diagonal(vec![1.0, -3.0]), &mut Identity, &[1.0, 1.0], &mut Workspace::default());
        assert!(matches!(result, Err(Error::IndefiniteOperator { curvature: -2.0, .. })));
        let (_, result) = run(&mut Diagonal(vec![f64::NAN]), &mut Identity, &[1.0], &mut Workspace::default());
        assert!(matches!(result, Err(Error::IndefiniteOperator { curvature, .. }) if curvature.is_nan()));
    }

    #[test]
    fn an_indefinite_preconditioner_is_an_error_with_the_product() {
        let mut minus = Action(|r: &[f64], z: &mut [f64]| z[0] = -4.0 * r[0]);
        let (_, result) = run(&mut Diagonal(vec![1.0]), &mut minus, &[1.0], &mut Workspace::default());
        assert!(matches!(result, Err(Error::IndefinitePreconditioner { product: -4.0, .. })));
    }

    #[test]
    fn starts_from_the_guess() {
        let mut x = vec![2.0, 1.0];
        let mut a = Diagonal(vec![1.0, 2.0]);
        let mut system = Preconditioned { operator: &mut a, preconditioner: &mut Identity, inner_product: &Euclidean };
        let mut workspace = Workspace::default();
        let report = solve(&mut system, &[2.0, 3.0], &mut x, &Settings::default(), &mut workspace).unwrap();
        assert_eq!((report.iterations, report.initial_norm, x), (1, 1.0, vec![2.0, 1.5]));
        assert_eq!(workspace.history(), [1.0, 0.0]);
    }

    #[test]
    fn an_infinite_right_hand_side_is_an_error() {
        for large in [1e200, f64::INFINITY, f64::NAN] {
            let mut a = Action(|x: &[f64], y: &mut [f64]| copy(x, y));
            let (_, result) = run(&mut a, &mut Identity, &[large], &mut Workspace::default());
            assert!(matches!(result, Err(Error::IndefinitePreconditioner { .. })), "{large}: {result:?}");
        }
    }

    #[test]
    fn same_bits_on_one_two_and_three_threads() {
        let b = scattered(50_001);
        let run = || {
            let mut a = Action(|x: &[f64], y: &mut [f64]| {
                laplacian(x, y);
                axpy(0.5, x, y);
            });
            let (x, result) = run(&mut a, &mut Identity, &b, &mut Workspace::default());
            assert!(result.unwrap().final_norm <= 1e-10 * Euclidean.norm(&b));
            bits(&x)
        };
        let one = with_threads(1, run);
        assert_eq!(one, with_threads(2, run));
        assert_eq!(one, with_threads(3, run));
    }
}
