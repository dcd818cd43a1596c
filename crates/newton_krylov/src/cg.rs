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

/// What a solve has done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// The number of iterations: of products with A, but for one with a non-zero initial guess.
    pub iterations: usize,
    /// |b - A x| at the start.
    pub initial_norm: f64,
    /// |b - A x| at the end, by its recursion.
    pub final_norm: f64,
}

/// Why a solve stopped short of its tolerance.
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
        /// What was done until then.
        report: Report,
    },
    /// P is not positive definite.
    #[error("the preconditioner is not positive definite: (r, z) = {product:e} in iteration {}", report.iterations)]
    IndefinitePreconditioner {
        /// (r, P^-1 r), not positive, or not a number.
        product: f64,
        /// What was done until then.
        report: Report,
    },
}

/// The memory of [`solve`]: after a first solve no later one of the same size allocates.
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

    /// Makes room for a solve of the given length.
    fn prepare(&mut self, length: usize, settings: &Settings) {
        for vector in [&mut self.r, &mut self.z, &mut self.p, &mut self.a_p] {
            vector.resize(length, 0.0);
        }
        self.history.clear();
        self.history.reserve(settings.max_iterations + 1);
    }
}

/// Solves A x = b. x holds the initial guess on entry, the solution on return.
///
/// A and P are symmetric positive definite in the inner product of the system.
///
/// # Errors
/// [`Error`] if the tolerance is not reached, or if A or P turns out not to be positive definite.
pub fn solve(
    system: &mut (impl LinearSystem + ?Sized),
    b: &[f64],
    x: &mut [f64],
    settings: &Settings,
    workspace: &mut Workspace,
) -> Result<Report, Error> {
    workspace.prepare(b.len(), settings);
    let target = settings.absolute_tolerance.max(settings.relative_tolerance * system.inner_product().norm(b));
    let initial_norm = start(system, b, x, workspace);
    let mut report = Report { iterations: 0, initial_norm, final_norm: initial_norm };
    workspace.history.push(initial_norm);
    let mut r_z_old = f64::INFINITY;
    while !(report.final_norm <= target) {
        if report.iterations >= settings.max_iterations {
            return Err(Error::MaxIterations(report));
        }
        r_z_old = next_direction(system, workspace, r_z_old)
            .map_err(|product| Error::IndefinitePreconditioner { product, report })?;
        advance(system, x, workspace, r_z_old)
            .map_err(|curvature| Error::IndefiniteOperator { curvature, report })?;
        report.iterations += 1;
        report.final_norm = system.inner_product().norm(&workspace.r);
        workspace.history.push(report.final_norm);
    }
    Ok(report)
}

/// r := b - A x; returns |r|. No product is spent on x = 0.
fn start(system: &mut (impl LinearSystem + ?Sized), b: &[f64], x: &[f64], workspace: &mut Workspace) -> f64 {
    if x.iter().all(|&x_i| x_i == 0.0) {
        copy(b, &mut workspace.r);
    } else {
        system.multiply(x, &mut workspace.r);
        xpay(b, -1.0, &mut workspace.r);
    }
    workspace.p.fill(0.0);
    system.inner_product().norm(&workspace.r)
}

/// z := P^-1 r and p := z + (r, z) / (r, z)_old p; returns (r, z), as the error if it is not positive.
fn next_direction(
    system: &mut (impl LinearSystem + ?Sized),
    workspace: &mut Workspace,
    r_z_old: f64,
) -> Result<f64, f64> {
    system.precondition(&workspace.r, &mut workspace.z);
    let r_z = positive(system.inner_product().dot(&workspace.r, &workspace.z))?;
    xpay(&workspace.z, r_z / r_z_old, &mut workspace.p);
    Ok(r_z)
}

/// x := x + alpha p and r := r - alpha A p; returns (p, A p) as the error if it is not positive.
fn advance(
    system: &mut (impl LinearSystem + ?Sized),
    x: &mut [f64],
    workspace: &mut Workspace,
    r_z: f64,
) -> Result<(), f64> {
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
