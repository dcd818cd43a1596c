//! The report of the Newton driver, and its errors.

use crate::problem::Inadmissible;
use crate::{fgmres, line_search};

/// "the last step" or "the last 4 steps".
fn last_steps(count: usize) -> String {
    if count == 1 { "the last step".to_owned() } else { format!("the last {count} steps") }
}

/// How a solve converged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Convergence {
    /// The total norm and the norm of each field are within their tolerances.
    Tolerance,
    /// The tolerance is below round-off: the residual is at the level of round-off and cannot be reduced further.
    RoundOff,
}

/// One accepted Newton step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepReport {
    /// |R| at the end of the step.
    pub residual_norm: f64,
    /// |R_k| of each field at the end of the step.
    pub field_norms: Vec<f64>,
    /// The relative tolerance of the linear solver.
    pub forcing: f64,
    /// The relative residual that it reached.
    pub linear_residual: f64,
    /// Its iterations in the accepted attempt.
    pub krylov_iterations: usize,
    /// The fraction of the increment that was taken.
    pub step_length: f64,
    /// 1/dtau_k of each field during the step.
    pub inverse_pseudo_time: Vec<f64>,
    /// The number of earlier attempts, with less damping, that were rejected.
    pub rejections: usize,
}

impl StepReport {
    /// Whether a field was damped.
    pub fn is_damped(&self) -> bool {
        self.inverse_pseudo_time.iter().any(|inverse| *inverse > 0.0)
    }
}

/// The report of a solve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// |R| at the initial guess.
    pub initial_norm: f64,
    /// |R_k| of each field at the initial guess.
    pub initial_field_norms: Vec<f64>,
    /// The accepted steps.
    pub steps: Vec<StepReport>,
    /// Evaluations of R by the driver.
    pub residual_evaluations: usize,
    /// Products with dR/dz.
    pub jacobian_products: usize,
    /// Iterations of the linear solver, including those of rejected attempts.
    pub krylov_iterations: usize,
    /// The part of |R| caused by rounding, as the problem estimates it; `None` if the problem was not asked.
    pub round_off: Option<f64>,
    /// How the solve converged; `None` in the report of a failure.
    pub convergence: Option<Convergence>,
}

impl Report {
    /// |R| at the initial guess and after every step.
    pub fn residual_history(&self) -> Vec<f64> {
        std::iter::once(self.initial_norm).chain(self.steps.iter().map(|step| step.residual_norm)).collect()
    }

    /// |R| at the last accepted iterate.
    pub fn final_norm(&self) -> f64 {
        self.steps.last().map_or(self.initial_norm, |step| step.residual_norm)
    }

    /// The fraction of |R| that the last step has left; 0 before the first step.
    pub fn last_reduction(&self) -> f64 {
        match self.residual_history()[..] {
            [.., before, last] => last / before,
            _ => 0.0,
        }
    }

    /// The longest of the last `steps` step lengths; 0 without steps.
    pub fn longest_of_last(&self, steps: usize) -> f64 {
        self.steps.iter().rev().take(steps).map(|step| step.step_length).fold(0.0, f64::max)
    }

    /// |R_k| of each field at the last accepted iterate.
    pub fn final_field_norms(&self) -> &[f64] {
        self.steps.last().map_or(&self.initial_field_norms, |step| &step.field_norms)
    }
}

/// Why a solve failed. z is left at an accepted iterate, see [`super::solve`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// R or dR/dz is not defined at an iterate. This can only be the initial guess, unless the problem contradicts
    /// itself.
    #[error("Newton step {}: the problem cannot be evaluated at the iterate", report.steps.len() + 1)]
    Inadmissible {
        /// Why the state is inadmissible.
        source: Inadmissible,
        /// The report up to the failure.
        report: Box<Report>,
    },
    /// No step along the increment was acceptable, and pseudo-time damping did not help.
    #[error("Newton step {}: the line search failed at residual norm {:e}", report.steps.len() + 1, report.final_norm())]
    LineSearch {
        /// Why the last search failed.
        source: line_search::Error,
        /// The report up to the failure.
        report: Box<Report>,
    },
    /// The linear solver found no useful increment, and pseudo-time damping did not help.
    #[error("Newton step {}: the linear solver failed at residual norm {:e}", report.steps.len() + 1, report.final_norm())]
    Krylov {
        /// Why the last linear solve failed.
        source: fgmres::Error,
        /// The report up to the failure.
        report: Box<Report>,
    },
    /// The number of steps is used up.
    #[error(
        "Newton: no convergence in {} steps: the residual norm went from {:e} to {:e}, the tolerance is {tolerance:e}",
        report.steps.len(), report.initial_norm, report.final_norm()
    )]
    MaxSteps {
        /// The tolerance of the total norm.
        tolerance: f64,
        /// The report up to the failure.
        report: Box<Report>,
    },
    /// The residual falls by too little, or no longer.
    #[error(
        "Newton step {}: the residual norm has not fallen enough in {}: it is {:e}, and was {least:e} before",
        report.steps.len(), last_steps(report.steps.len() - since), report.final_norm()
    )]
    Stalled {
        /// The least norm.
        least: f64,
        /// The step that ended there.
        since: usize,
        /// The report up to the failure.
        report: Box<Report>,
    },
    /// The last steps are short or raise the residual.
    #[error(
        "Newton step {}: {} led nowhere, short or damped with a residual that rose; its norm is {:e}, and was {before:e}",
        report.steps.len(), last_steps(*steps), report.final_norm()
    )]
    Fruitless {
        /// The number of these steps.
        steps: usize,
        /// The norm before them.
        before: f64,
        /// The report up to the failure.
        report: Box<Report>,
    },
    /// The caller wants no more steps.
    #[error("Newton: stopped after {} steps, at residual norm {:e}", report.steps.len(), report.final_norm())]
    Stopped {
        /// The report up to that step.
        report: Box<Report>,
    },
    /// The residual grew beyond all bounds, or is not finite.
    #[error(
        "Newton step {}: diverged, the residual norm is {:e}, against {reference:e} for reference",
        report.steps.len(), report.final_norm()
    )]
    Diverged {
        /// The reference norm.
        reference: f64,
        /// The report up to the failure.
        report: Box<Report>,
    },
}

impl Error {
    /// The report up to the failure.
    pub fn report(&self) -> &Report {
        match self {
            Self::Inadmissible { report, .. }
            | Self::LineSearch { report, .. }
            | Self::Krylov { report, .. }
            | Self::MaxSteps { report, .. }
            | Self::Stalled { report, .. }
            | Self::Fruitless { report, .. }
            | Self::Stopped { report }
            | Self::Diverged { report, .. } => report,
        }
    }
}
