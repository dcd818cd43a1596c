//! Flexible, right-preconditioned, restarted GMRES (Saad, SIAM J. Sci. Comput. 14, 1993) in any inner product.
//!
//! ```text
//! (arnoldi)   A Z_m = V_{m+1} H_m,   z_j = P_j^-1 v_j,   (v_i, v_j) = delta_ij
//! (fgmres)    x := x + Z_m y,        y = argmin | |r_0| e_1 - H_m y |
//! ```
//!
//! The preconditioner acts from the right, so the norm that is minimised is that of the true residual; it may change in
//! every iteration.

use crate::inner_product::{InnerProduct, axpy, copy, scaled_copy, xpay};
use crate::operator::LinearSystem;

mod least_squares;

use least_squares::LeastSquares;

/// The settings of [`solve`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Stop at |b - A x| <= relative_tolerance |b| ...
    pub relative_tolerance: f64,
    /// ... or at |b - A x| <= absolute_tolerance.
    pub absolute_tolerance: f64,
    /// m, the number of iterations from one restart to the next: two vectors are stored for each.
    pub restart: usize,
    /// The total number of iterations after which the solver gives up.
    pub max_iterations: usize,
    /// A cycle that leaves more than this part of the residual is stagnation.
    pub stagnation: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            relative_tolerance: 1e-6,
            absolute_tolerance: 0.0,
            restart: 60,
            max_iterations: 300,
            stagnation: 0.999,
        }
    }
}

/// What a solve has done. Norms are of the true residual, not of its recursive estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// The number of iterations: of preconditioner applications.
    pub iterations: usize,
    /// The number of cycles after the first one.
    pub restarts: usize,
    /// The number of products with A.
    pub products: usize,
    /// |b - A x| at the start.
    pub initial_norm: f64,
    /// |b - A x| at the end.
    pub final_norm: f64,
}

/// Why a solve stopped short of its tolerance. x holds the best iterate in all cases.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The number of iterations is used up.
    #[error("no convergence: the residual fell from {:e} to {:e} in {} iterations", .0.initial_norm, .0.final_norm, .0.iterations)]
    MaxIterations(Report),
    /// A full cycle did not reduce the residual.
    #[error("stagnation: the residual is {:e}, at the start it was {:e}, after {} iterations", .0.final_norm, .0.initial_norm, .0.iterations)]
    Stagnated(Report),
    /// Operator or preconditioner returned infinities or NaN.
    #[error("the operator or its preconditioner returned a vector that is not finite in iteration {}", .0.iterations)]
    NotFinite(Report),
}

impl Error {
    /// What was done until then.
    pub fn report(&self) -> &Report {
        let (Self::MaxIterations(report) | Self::Stagnated(report) | Self::NotFinite(report)) = self;
        report
    }
}

/// The memory of [`solve`]: after a first solve no later one of the same size allocates.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    /// v_j, orthonormal.
    basis: Vec<Vec<f64>>,
    /// z_j = P_j^-1 v_j.
    preconditioned: Vec<Vec<f64>>,
    residual: Vec<f64>,
    least_squares: LeastSquares,
    history: Vec<f64>,
}

impl Workspace {
    /// |b - A x| at the start and its recursive estimate after every iteration of the last solve.
    pub fn history(&self) -> &[f64] {
        &self.history
    }

    /// Makes room for a solve: `length` unknowns, `restart` columns.
    fn prepare(&mut self, length: usize, settings: &Settings) {
        self.residual.resize(length, 0.0);
        self.least_squares.resize(settings.restart);
        self.history.clear();
        self.history.reserve(settings.max_iterations + 1);
    }

    /// Makes room for column j and its successor. Columns are made when they are first needed: most solves need few.
    fn prepare_column(&mut self, j: usize) {
        let length = self.residual.len();
        resize_column(&mut self.basis, j, length);
        resize_column(&mut self.basis, j + 1, length);
        resize_column(&mut self.preconditioned, j, length);
    }
}

/// Makes `columns[j]` a vector of the given length.
fn resize_column(columns: &mut Vec<Vec<f64>>, j: usize, length: usize) {
    if columns.len() <= j {
        columns.resize_with(j + 1, Vec::new);
    }
    columns[j].resize(length, 0.0);
}

/// Solves A x = b. x holds the initial guess on entry, the solution on return.
///
/// # Errors
/// [`Error`] if the tolerance is not reached; x then is the best iterate, and the caller decides whether it will do.
pub fn solve(
    system: &mut (impl LinearSystem + ?Sized),
    b: &[f64],
    x: &mut [f64],
    settings: &Settings,
    workspace: &mut Workspace,
) -> Result<Report, Error> {
    workspace.prepare(b.len(), settings);
    let target = settings.absolute_tolerance.max(settings.relative_tolerance * system.inner_product().norm(b));
    let mut report = Report::default();
    report.initial_norm = initial_residual(system, b, x, workspace, &mut report);
    report.final_norm = report.initial_norm;
    workspace.history.push(report.initial_norm);
    while !(report.final_norm <= target) {
        let before = report.final_norm;
        if report.iterations >= settings.max_iterations {
            return Err(Error::MaxIterations(report));
        }
        cycle(system, settings, target, workspace, &mut report)?;
        let columns = workspace.least_squares.columns();
        update(x, workspace);
        report.final_norm = residual_norm(system, b, x, workspace, &mut report);
        report.restarts += 1;
    }
    Ok(report)
}
