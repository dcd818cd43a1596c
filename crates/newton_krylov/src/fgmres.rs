//! Flexible, right-preconditioned, restarted GMRES (Saad, SIAM J. Sci. Comput. 14, 1993) in any inner product.
//!
//! ```text
//! (arnoldi)   A Z_m = V_{m+1} H_m,   z_j = P_j^-1 v_j,   (v_i, v_j) = delta_ij
//! (fgmres)    x := x + Z_m y,        y = argmin | |r_0| e_1 - H_m y |
//! ```
//!
//! The preconditioner acts from the right, so the true residual is minimised. It may change in every iteration.
//!
//! V and Z may be stored in single precision ([`Precision`]). The products A z_j and all sums are in double precision, and z_j is rounded
//! before the product, so that (fgmres) minimises the true residual as before. Rounding of v_j limits what a cycle can reduce to some 1e-6;
//! more cycles follow where more is wanted.

mod least_squares;

use crate::inner_product::{
    InnerProduct, Stored, add_combination, add_combination_and_norm, copy, dots, scale, store, xpay,
};
use crate::operator::LinearSystem;
use least_squares::LeastSquares;

/// The recursive estimate of a converged residual is trusted while it is more than this fraction of the residual at the start of its cycle.
/// The basis is orthogonal to some 1e-14 in double precision and 1e-6 in single precision, which does not affect the digits of such an
/// estimate. Below, one more product computes the residual.
fn trusted(precision: Precision) -> f64 {
    match precision {
        Precision::Double => 1e-6,
        Precision::Single => 1e-3,
    }
}

/// A vector is orthogonalised once more if this fraction of it, or less, is left. Otherwise the rest is orthogonal to ten times the
/// round-off. The usual threshold is 1 / sqrt(2), but a good preconditioner leaves less than that in most iterations.
const CANCELLED: f64 = 0.1;

/// How v_j and z_j are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// In 8 bytes per number.
    #[default]
    Double,
    /// In 4 bytes per number. It suits a preconditioner that works in single precision itself, and moderate tolerances.
    Single,
}

/// The settings of [`solve`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Stop at |b - A x| <= relative_tolerance |b| ...
    pub relative_tolerance: f64,
    /// ... or at |b - A x| <= absolute_tolerance.
    pub absolute_tolerance: f64,
    /// m, the number of iterations between restarts; each stores two vectors.
    pub restart: usize,
    /// The total number of iterations after which the solver gives up.
    pub max_iterations: usize,
    /// A cycle that leaves more than this fraction of the residual is stagnation.
    pub stagnation: f64,
    /// How v_j and z_j are stored.
    pub precision: Precision,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            relative_tolerance: 1e-6,
            absolute_tolerance: 0.0,
            restart: 60,
            max_iterations: 300,
            stagnation: 0.999,
            precision: Precision::Double,
        }
    }
}

/// The report of a solve. Norms are of the true residual, or of its recursive estimate if a cycle has reduced the residual
/// by less than 10^6, in single precision 10^3; the estimate is then as good.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// The number of iterations, that is, of preconditioner applications.
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

/// Why a solve did not reach its tolerance. x holds the best iterate in all cases.
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
    /// The report up to the failure.
    pub fn report(&self) -> &Report {
        let (Self::MaxIterations(report) | Self::Stagnated(report) | Self::NotFinite(report)) = self;
        report
    }
}

/// The work memory of [`solve`]: after the first solve, later ones of the same size and number of iterations do not
/// allocate.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    double: Columns<f64>,
    single: Columns<f32>,
    work: Work,
}

/// The stored vectors of a cycle.
#[derive(Clone, Debug, Default)]
struct Columns<S> {
    /// v_j, orthonormal.
    basis: Vec<Vec<S>>,
    /// z_j = P_j^-1 v_j.
    preconditioned: Vec<Vec<S>>,
}

/// What is at work in double precision.
#[derive(Clone, Debug, Default)]
struct Work {
    /// The residual, then v_j, then A z_j.
    w: Vec<f64>,
    /// z_j
    z: Vec<f64>,
    /// Sums of chunks.
    partial: Vec<f64>,
    least_squares: LeastSquares,
    history: Vec<f64>,
}

impl Workspace {
    /// |b - A x| at the start and its recursive estimate after every iteration of the last solve.
    pub fn history(&self) -> &[f64] {
        &self.work.history
    }

    /// Two vectors that are free between two solves.
    pub(crate) fn spares(&mut self, length: usize) -> [&mut Vec<f64>; 2] {
        let spares = [&mut self.work.z, &mut self.work.w];
        spares.map(|spare| {
            spare.resize(length, 0.0);
            spare
        })
    }

    /// Allocates memory for a solve of the given length.
    fn prepare(&mut self, length: usize) {
        self.work.w.resize(length, 0.0);
        self.work.z.resize(length, 0.0);
        self.work.history.clear();
    }
}

impl<S: Stored> Columns<S> {
    /// Allocates z_j and v_j up to the given number of iterations, since most solves need few.
    fn prepare(&mut self, iterations: usize, length: usize) {
        resize_columns(&mut self.basis, iterations + 1, length);
        resize_columns(&mut self.preconditioned, iterations, length);
    }
}

/// Makes the first `count` columns vectors of the given length.
fn resize_columns<S: Stored>(columns: &mut Vec<Vec<S>>, count: usize, length: usize) {
    if columns.len() < count {
        columns.resize_with(count, Vec::new);
    }
    for column in &mut columns[..count] {
        column.resize(length, S::default());
    }
}

/// Solves A x = b. x holds the initial guess on entry, the solution on return.
///
/// # Errors
/// [`Error`] if the tolerance is not reached. Then x is the best iterate, and the caller decides whether it is good
/// enough.
pub fn solve(
    system: &mut dyn LinearSystem,
    b: &[f64],
    x: &mut [f64],
    settings: &Settings,
    workspace: &mut Workspace,
) -> Result<Report, Error> {
    let _timed = tracing::trace_span!(target: "cost", "orthogonalisation").entered();
    workspace.prepare(b.len());
    let Workspace { double, single, work } = workspace;
    let target = settings.absolute_tolerance.max(settings.relative_tolerance * system.inner_product().norm(b));
    let mut report = Report::default();
    report.initial_norm = residual(system, b, x, &mut work.w, &mut report);
    report.final_norm = report.initial_norm;
    work.history.push(report.initial_norm);
    for restarts in 0.. {
        if report.final_norm.is_finite() && report.final_norm <= target {
            break;
        }
        report.restarts = restarts;
        let before = report.final_norm;
        let mut cycle = Cycle { settings, target, work: &mut *work, report: &mut report };
        let finite = match settings.precision {
            Precision::Double => cycle.run(system, double, x),
            Precision::Single => cycle.run(system, single, x),
        };
        let estimate = work.history.last().copied().filter(|estimate| *estimate <= target);
        let trusted = trusted(settings.precision) * before;
        report.final_norm = match estimate.filter(|estimate| finite && *estimate > trusted) {
            Some(estimate) => estimate,
            None => residual(system, b, x, &mut work.w, &mut report),
        };
        check(settings, target, before, finite, report)?;
    }
    Ok(report)
}

/// Whether another cycle is useful, if one is needed.
fn check(settings: &Settings, target: f64, before: f64, finite: bool, report: Report) -> Result<(), Error> {
    if !finite || !report.final_norm.is_finite() {
        Err(Error::NotFinite(report))
    } else if report.final_norm <= target {
        Ok(())
    } else if report.iterations >= settings.max_iterations {
        Err(Error::MaxIterations(report))
    } else if report.final_norm > settings.stagnation * before {
        Err(Error::Stagnated(report))
    } else {
        Ok(())
    }
}

/// w := b - A x; returns |w|. For x = 0 no product is computed. A product may be a collective call, so |x| decides and not the part of x on this
/// rank.
fn residual(system: &mut dyn LinearSystem, b: &[f64], x: &[f64], w: &mut [f64], report: &mut Report) -> f64 {
    if system.inner_product().norm(x) == 0.0 {
        copy(b, w);
    } else {
        system.multiply(x, w);
        report.products += 1;
        xpay(b, -1.0, w);
    }
    system.inner_product().norm(w)
}

/// One cycle from the residual w.
struct Cycle<'a> {
    settings: &'a Settings,
    /// The norm at which the solve ends.
    target: f64,
    work: &'a mut Work,
    report: &'a mut Report,
}

impl Cycle<'_> {
    /// (arnoldi), then (fgmres). Returns false if a vector is not finite.
    fn run<S: Stored>(&mut self, system: &mut dyn LinearSystem, columns: &mut Columns<S>, x: &mut [f64]) -> bool {
        let finite = self.build_basis(system, columns);
        add_combination(self.work.least_squares.solve(), &columns.preconditioned, x);
        finite
    }

    /// (arnoldi). Returns false if a vector is not finite.
    fn build_basis<S: Stored>(&mut self, system: &mut dyn LinearSystem, columns: &mut Columns<S>) -> bool {
        let Cycle { settings, target, work, report } = self;
        let beta = report.final_norm;
        work.least_squares.start(beta);
        if !beta.is_finite() {
            return false;
        }
        scale(1.0 / beta, &mut work.w);
        for j in 0..settings.restart.min(settings.max_iterations - report.iterations) {
            columns.prepare(j + 1, work.w.len());
            store(&mut work.w, &mut columns.basis[j]);
            system.precondition(&work.w, &mut work.z);
            store(&mut work.z, &mut columns.preconditioned[j]);
            system.multiply(&work.z, &mut work.w);
            report.iterations += 1;
            report.products += 1;
            let Some(norm) = orthonormalise(system.inner_product(), &columns.basis[..=j], work) else { return false };
            let estimate = work.least_squares.rotate(norm);
            work.history.push(estimate);
            if estimate <= *target || norm == 0.0 {
                break;
            }
        }
        true
    }
}

/// w := (w - V h) / |w - V h| with h = (V, w), which becomes the new column of H. Returns |w - V h|. It is zero if w lies
/// in the span of V up to round-off, and `None` if it is not finite.
///
/// Classical Gram-Schmidt, repeated after strong cancellation (Daniel, Gragg, Kaufman & Stewart, Math. Comp. 30, 1976),
/// see [`CANCELLED`].
fn orthonormalise<S: Stored>(inner_product: &dyn InnerProduct, v: &[Vec<S>], work: &mut Work) -> Option<f64> {
    let Work { w, partial, least_squares, .. } = work;
    let (mut initial, mut norm) = (0.0, 0.0);
    for pass in 0..2 {
        let mut before = 0.0;
        let minus_h = least_squares.subtract_from_column(|h| before = dots(inner_product, v, w, partial, h));
        norm = add_combination_and_norm(inner_product, minus_h, v, w, partial);
        if pass == 0 {
            initial = before;
        }
        if norm > CANCELLED * before {
            break;
        }
    }
    if norm <= S::EPSILON * initial {
        return Some(0.0);
    }
    scale(1.0 / norm, w);
    norm.is_finite().then_some(norm)
}

#[cfg(test)]
mod tests;
