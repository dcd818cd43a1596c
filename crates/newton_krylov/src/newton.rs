//! The inexact Newton method for R(z) = 0, with pseudo-transient continuation.
//!
//! ```text
//! (newton-step)   | R + (dR/dz + T) dz | <= eta |R|,     z := z + a dz
//! ```
//!
//! eta by [`crate::forcing`], T by [`crate::pseudo_time`], a by [`crate::line_search`]. The search looks at
//!
//! ```text
//! (merit)         G(a) = R(z + a dz) + a T dz
//! ```
//!
//! the residual of one implicit Euler step in pseudo-time: dz is a direction of descent of |G| for any T, and G = R without
//! damping. While fields are damped |R| itself may grow.
//!
//! A step is rejected if the linear solver makes no use of the increment or the search finds no a. It is then repeated with
//! more damping, until that has no effect.

mod report;
mod tolerances;

pub use report::{Convergence, Error, Report, StepReport};

use crate::forcing::Previous;
use crate::inner_product::{InnerProduct, axpy, copy, scaled_copy};
use crate::operator::LinearSystem;
use crate::problem::{Inadmissible, NonlinearProblem};
use crate::pseudo_time::PseudoTime;
use crate::{fgmres, forcing, line_search, pseudo_time};
use tolerances::Tolerances;

/// The settings of [`solve`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The tolerance relative to the reference norms, for the total norm and for each field.
    pub relative_tolerance: f64,
    /// The tolerance for the total norm and for each field, whatever the reference norms.
    pub absolute_tolerance: f64,
    /// The level of round-off, relative to the reference norm: no decrease is asked for below.
    pub round_off: f64,
    /// The number of steps after which the driver gives up.
    pub max_steps: usize,
    /// Diverged is what exceeds the reference and the initial norm by this factor.
    pub divergence: f64,
    /// A linear solve that fails is still used if it leaves at most this part of the residual.
    pub usable_linear_residual: f64,
    /// How exactly the linear systems are solved.
    pub forcing: forcing::Settings,
    /// The linear solver; its tolerances are set by the driver.
    pub krylov: fgmres::Settings,
    /// How the step length is found.
    pub line_search: line_search::Settings,
    /// How fields are damped.
    pub pseudo_time: pseudo_time::Settings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            relative_tolerance: 1e-8,
            absolute_tolerance: 0.0,
            round_off: 1e-13,
            max_steps: 30,
            divergence: 1e6,
            usable_linear_residual: 0.9,
            forcing: forcing::Settings::default(),
            krylov: fgmres::Settings::default(),
            line_search: line_search::Settings::default(),
            pseudo_time: pseudo_time::Settings::default(),
        }
    }
}

/// The memory of [`solve`]: after a first solve no later one of the same size allocates vectors of that size.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    residual: Vec<f64>,
    /// -R
    right_side: Vec<f64>,
    increment: Vec<f64>,
    /// T dz
    pseudo_term: Vec<f64>,
    trial: Vec<f64>,
    trial_residual: Vec<f64>,
    /// G
    merit: Vec<f64>,
    krylov: fgmres::Workspace,
}

impl Workspace {
    /// Makes room for a problem of the given length.
    fn prepare(&mut self, length: usize) {
        for vector in [
            &mut self.residual,
            &mut self.right_side,
            &mut self.increment,
            &mut self.pseudo_term,
            &mut self.trial,
            &mut self.trial_residual,
            &mut self.merit,
        ] {
            vector.resize(length, 0.0);
        }
    }
}

/// Solves R(z) = 0. z holds the initial guess on entry, the solution on return.
///
/// `references` are the norms that the relative tolerance refers to, one per field; without them those at the initial
/// guess, which a good guess makes hard to meet.
///
/// # Errors
/// [`Error`] if the tolerances are not met; z then is the last accepted, admissible iterate.
pub fn solve<P: NonlinearProblem + ?Sized>(
    problem: &mut P,
    z: &mut [f64],
    references: Option<&[f64]>,
    settings: &Settings,
    workspace: &mut Workspace,
) -> Result<Report, Error> {
    let mut driver = Driver::start(problem, z, references, settings, workspace)?;
    while driver.report.convergence.is_none() {
        driver.step(z)?;
    }
    Ok(driver.report)
}

/// A solve under way, between two steps.
struct Driver<'a, P: NonlinearProblem + ?Sized> {
    problem: &'a mut P,
    settings: &'a Settings,
    workspace: &'a mut Workspace,
    tolerances: Tolerances,
    pseudo_time: PseudoTime,
    previous: Option<Previous>,
    report: Report,
}

/// An increment that was found useful, and how far to follow it.
struct Attempt {
    linear: fgmres::Report,
    search: line_search::Report,
}

/// Why a step must be repeated with more damping.
enum Rejection {
    Linearisation(Inadmissible),
    Krylov(fgmres::Error),
    LineSearch(line_search::Error),
}

impl<'a, P: NonlinearProblem + ?Sized> Driver<'a, P> {
    /// Evaluates R at the initial guess.
    fn start(
        problem: &'a mut P,
        z: &[f64],
        references: Option<&[f64]>,
        settings: &'a Settings,
        workspace: &'a mut Workspace,
    ) -> Result<Self, Error> {
        workspace.prepare(problem.len());
        let mut report = Report { residual_evaluations: 1, ..Report::default() };
        if let Err(source) = problem.residual(z, &mut workspace.residual) {
            return Err(Error::Inadmissible { source, report: Box::new(report) });
        }
        let (norm, field_norms) = norms(problem, &workspace.residual);
        let tolerances = Tolerances::new(settings, references.unwrap_or(&field_norms));
        let pseudo_time = PseudoTime::new(settings.pseudo_time, &field_norms);
        report.initial_norm = norm;
        report.initial_field_norms = field_norms;
        let mut driver = Self { problem, settings, workspace, tolerances, pseudo_time, previous: None, report };
        driver.judge(true)?;
        Ok(driver)
    }

    /// One accepted step, after as many rejected attempts as it takes.
    fn step(&mut self, z: &mut [f64]) -> Result<(), Error> {
        if self.report.steps.len() >= self.settings.max_steps {
            let (tolerance, report) = (self.tolerances.total, Box::new(self.report.clone()));
            return Err(Error::MaxSteps { tolerance, report });
        }
        let norm = self.report.final_norm();
        let aim = self.tolerances.aim(norm, self.report.final_field_norms());
        let forcing = self.settings.forcing.next(norm, self.previous, aim);
        self.previous = Some(Previous { norm, forcing });
        let mut rejections = 0;
        loop {
            match self.attempt(z, forcing) {
                Ok(attempt) => return self.accept(z, forcing, rejections, &attempt),
                Err(rejection) => self.damp(rejections, rejection)?,
            }
            rejections += 1;
        }
    }

    /// Finds an increment and a step length; the state there is left in the workspace.
    fn attempt(&mut self, z: &[f64], forcing: f64) -> Result<Attempt, Rejection> {
        self.problem.linearise(z, self.pseudo_time.inverse()).map_err(Rejection::Linearisation)?;
        let linear = self.solve_linear(forcing).map_err(Rejection::Krylov)?;
        let search = self.search(z).map_err(Rejection::LineSearch)?;
        Ok(Attempt { linear, search })
    }

    /// (newton-step): dz from zero.
    fn solve_linear(&mut self, forcing: f64) -> Result<fgmres::Report, fgmres::Error> {
        let w = &mut *self.workspace;
        scaled_copy(-1.0, &w.residual, &mut w.right_side);
        w.increment.fill(0.0);
        let settings =
            fgmres::Settings { relative_tolerance: forcing, absolute_tolerance: 0.0, ..self.settings.krylov };
        let mut system = Linearised { problem: &mut *self.problem, damped: self.pseudo_time.is_active() };
        let result = fgmres::solve(&mut system, &w.right_side, &mut w.increment, &settings, &mut w.krylov);
        let report = *result.as_ref().map_or_else(fgmres::Error::report, |report| report);
        self.report.krylov_iterations += report.iterations;
        self.report.jacobian_products += report.products;
        match result {
            Err(error) if !(report.final_norm <= self.settings.usable_linear_residual * report.initial_norm) => {
                Err(error)
            }
            Err(error @ fgmres::Error::NotFinite(_)) => Err(error),
            _ => Ok(report),
        }
    }

    /// Looks for a along dz by (merit).
    fn search(&mut self, z: &[f64]) -> Result<line_search::Report, line_search::Error> {
        let (problem, w) = (&mut *self.problem, &mut *self.workspace);
        let damped = self.pseudo_time.is_active();
        w.pseudo_term.fill(0.0);
        if damped {
            problem.add_pseudo_time(&w.increment, &mut w.pseudo_term);
        }
        let largest = problem.largest_step(z, &w.increment);
        let evaluations = &mut self.report.residual_evaluations;
        let merit_norm = |a: f64| {
            copy(z, &mut w.trial);
            axpy(a, &w.increment, &mut w.trial);
            *evaluations += 1;
            problem.residual(&w.trial, &mut w.trial_residual)?;
            copy(&w.trial_residual, &mut w.merit);
            if damped {
                axpy(a, &w.pseudo_term, &mut w.merit);
            }
            Ok(problem.inner_product().norm(&w.merit))
        };
        let initial = self.report.steps.last().map_or(self.report.initial_norm, |step| step.residual_norm);
        line_search::search(&self.settings.line_search, initial, largest, self.tolerances.round_off, merit_norm)
    }

    /// Moves to the state in the workspace.
    fn accept(&mut self, z: &mut [f64], forcing: f64, rejections: usize, attempt: &Attempt) -> Result<(), Error> {
        let w = &mut *self.workspace;
        copy(&w.trial, z);
        std::mem::swap(&mut w.residual, &mut w.trial_residual);
        let (residual_norm, field_norms) = norms(self.problem, &w.residual);
        let step = StepReport {
            residual_norm,
            field_norms,
            forcing,
            linear_residual: attempt.linear.final_norm / attempt.linear.initial_norm,
            krylov_iterations: attempt.linear.iterations,
            step_length: attempt.search.step_length,
            inverse_pseudo_time: self.pseudo_time.inverse().to_vec(),
            rejections,
        };
        tracing::debug!(?step, "Newton step {}", self.report.steps.len() + 1);
        self.pseudo_time.accept(&step.field_norms);
        self.report.steps.push(step);
        self.judge(attempt.search.decreased)
    }

    /// More damping after a rejection; the rejection as an error if that is of no use.
    fn damp(&mut self, rejections: usize, rejection: Rejection) -> Result<(), Error> {
        let field_norms = self.report.final_field_norms();
        let worthwhile = !matches!(rejection, Rejection::Linearisation(_))
            && rejections < self.settings.pseudo_time.max_rejections;
        if worthwhile && self.pseudo_time.reject(field_norms, &self.tolerances.fields) {
            tracing::debug!(inverse_pseudo_time = ?self.pseudo_time.inverse(), "Newton step rejected");
            return Ok(());
        }
        let report = Box::new(self.report.clone());
        Err(match rejection {
            Rejection::Linearisation(source) => Error::Inadmissible { source, report },
            Rejection::Krylov(source) => Error::Krylov { source, report },
            Rejection::LineSearch(source) => Error::LineSearch { source, report },
        })
    }

    /// Converged, diverged or neither, after a step with or without decrease.
    fn judge(&mut self, decreased: bool) -> Result<(), Error> {
        let norm = self.report.final_norm();
        let reference = self.tolerances.reference;
        if self.tolerances.met(norm, self.report.final_field_norms()) {
            self.report.convergence = Some(Convergence::Tolerance);
        } else if !decreased && norm <= self.tolerances.round_off {
            self.report.convergence = Some(Convergence::RoundOff);
        } else if !(norm <= self.settings.divergence * reference.max(self.report.initial_norm)) {
            return Err(Error::Diverged { reference, report: Box::new(self.report.clone()) });
        }
        Ok(())
    }
}

/// |R| and |R_k| of each field.
fn norms<P: NonlinearProblem + ?Sized>(problem: &P, residual: &[f64]) -> (f64, Vec<f64>) {
    let inner_product = problem.inner_product();
    let fields = problem.fields().iter().map(|field| inner_product.norm_on(field.range.clone(), residual));
    (inner_product.norm(residual), fields.collect())
}

/// dR/dz + T at the point of linearisation, as a linear system.
struct Linearised<'a, P: NonlinearProblem + ?Sized> {
    problem: &'a mut P,
    damped: bool,
}

impl<P: NonlinearProblem + ?Sized> LinearSystem for Linearised<'_, P> {
    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        self.problem.jacobian_product(x, y);
        if self.damped {
            self.problem.add_pseudo_time(x, y);
        }
    }

    fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        self.problem.precondition(r, z);
    }

    fn inner_product(&self) -> &dyn InnerProduct {
        self.problem.inner_product()
    }
}
