//! A Newton solve, step by step.

use super::tolerances::Tolerances;
use super::{Convergence, Error, FruitlessSteps, Report, Settings, StepReport, Workspace, log};
use crate::forcing::Previous;
use crate::inner_product::{InnerProduct, axpy, copy, scale};
use crate::operator::LinearSystem;
use crate::problem::{Inadmissible, NonlinearProblem};
use crate::pseudo_time::PseudoTime;
use crate::{fgmres, line_search};
use std::cell::RefCell;

/// After this many steps in a row, each at most this fraction of its increment, fields are damped.
const SHORT_STEPS: (usize, f64) = (3, 0.25);

/// A step that leaves more than this fraction of the residual has made little progress: perhaps only rounding is left.
const LITTLE_PROGRESS: f64 = 0.2;

/// If the residual is small, a step has also made little progress if it leaves more than this times what its linear
/// solve predicted.
const SHORT_OF_LINEAR: f64 = 1.5;

/// A solve in progress, between two steps.
pub(super) struct Driver<'a> {
    problem: &'a mut dyn NonlinearProblem,
    settings: &'a Settings,
    workspace: &'a mut Workspace,
    tolerances: Tolerances,
    pseudo_time: PseudoTime,
    previous: Option<Previous>,
    best: Best,
    report: Report,
}

/// The iterate with the least residual, kept if the settings ask for it.
struct Best {
    norm: f64,
    z: Vec<f64>,
    /// The number of the step whose residual was last well below all earlier ones.
    progress: usize,
    /// The least norm at that step.
    progress_norm: f64,
}

impl Best {
    fn new(norm: f64) -> Self {
        Best { norm: f64::INFINITY, z: Vec::new(), progress: 0, progress_norm: norm }
    }
}

/// A usable increment, and the step length along it.
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

impl<'a> Driver<'a> {
    /// Evaluates R at the initial guess.
    pub(super) fn start(
        problem: &'a mut dyn NonlinearProblem,
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
        let references = references.unwrap_or(&field_norms);
        assert_eq!(references.len(), field_norms.len(), "one reference norm per field");
        let tolerances = Tolerances::new(settings, references);
        let pseudo_time = PseudoTime::new(settings.pseudo_time, &field_norms, &tolerances.fields);
        report.initial_norm = norm;
        report.initial_field_norms = field_norms;
        let best = Best::new(norm);
        let mut driver = Self { problem, settings, workspace, tolerances, pseudo_time, previous: None, best, report };
        driver.note_progress(z);
        driver.judge(z, true)?;
        Ok(driver)
    }

    /// Whether the last accepted iterate has converged.
    pub(super) fn has_converged(&self) -> bool {
        self.report.convergence.is_some()
    }

    /// The report.
    pub(super) fn into_report(self) -> Report {
        self.report
    }

    /// The error of a solve that was stopped.
    pub(super) fn stopped(&self) -> Error {
        Error::Stopped { report: Box::new(self.report.clone()) }
    }

    /// Puts the iterate with the least residual into `z`, after a failure, if the settings ask for it.
    pub(super) fn return_best(&mut self, z: &mut [f64]) {
        if !self.best.z.is_empty() {
            copy(&self.best.z, z);
        }
    }

    /// Keeps the iterate `z` if it is the best so far.
    fn note_progress(&mut self, z: &[f64]) {
        let Some(stall) = self.settings.stall else { return };
        let norm = self.report.final_norm();
        if norm < self.best.norm {
            self.best.norm = norm;
            self.best.z.resize(z.len(), 0.0);
            copy(z, &mut self.best.z);
        }
        if norm <= stall.factor * self.best.progress_norm {
            (self.best.progress, self.best.progress_norm) = (self.report.steps.len(), norm);
        }
    }

    /// Whether the residual has not fallen for as many steps as the settings allow.
    fn has_stalled(&self) -> bool {
        self.settings.stall.is_some_and(|stall| self.report.steps.len() - self.best.progress >= stall.steps)
    }

    /// The number of the last steps that were all fruitless and have left most of the residual, with the norm before them; `None` if there
    /// is no such number. An attempt that was rejected counts as a fruitless step.
    fn fruitless_streak(&self, FruitlessSteps { steps, left }: FruitlessSteps) -> Option<(usize, f64)> {
        let history = self.report.residual_history();
        let with_norms = self.report.steps.iter().zip(&history).rev();
        let fruitless = with_norms.take_while(|(step, before)| {
            step.step_length <= SHORT_STEPS.1 || step.is_damped() && step.residual_norm > **before
        });
        let attempts = fruitless.scan(0, |attempts, (step, _)| {
            *attempts += 1 + step.rejections;
            Some(*attempts)
        });
        let count = 1 + attempts.take(steps).position(|attempts| attempts >= steps)?;
        let before = history[history.len() - 1 - count];
        (self.report.final_norm() > left * before).then_some((count, before))
    }

    /// The reason to take no further step, if there is one.
    fn gives_up(&self) -> Option<Error> {
        let report = || Box::new(self.report.clone());
        if self.report.steps.len() >= self.settings.max_steps {
            return Some(Error::MaxSteps { tolerance: self.tolerances.total, report: report() });
        }
        if let Some((steps, before)) = self.settings.fruitless_steps.and_then(|rule| self.fruitless_streak(rule)) {
            return Some(Error::Fruitless { steps, before, report: report() });
        }
        let (least, since) = (self.best.progress_norm, self.best.progress);
        self.has_stalled().then(|| Error::Stalled { least, since, report: report() })
    }

    /// One accepted step, after any number of rejected attempts.
    pub(super) fn step(&mut self, z: &mut [f64]) -> Result<(), Error> {
        if let Some(error) = self.gives_up() {
            return if self.ends_at_round_off(z) { Ok(()) } else { Err(error) };
        }
        let norm = self.report.final_norm();
        let aim = self.tolerances.aim(norm, self.report.final_field_norms());
        let forcing = self.settings.forcing.next(norm, self.previous, aim, self.pseudo_time.is_active());
        self.previous = Some(Previous { norm, forcing });
        let mut rejections = 0;
        loop {
            match self.attempt(z, forcing) {
                Ok(attempt) => return self.accept(z, forcing, rejections, &attempt),
                Err(_) if self.ends_at_round_off(z) => return Ok(()),
                Err(rejection) => self.damp(rejections, rejection)?,
            }
            rejections += 1;
        }
    }

    /// Finds an increment and a step length. The workspace then holds the new state.
    fn attempt(&mut self, z: &[f64], forcing: f64) -> Result<Attempt, Rejection> {
        self.problem.linearise(z, self.pseudo_time.inverse()).map_err(Rejection::Linearisation)?;
        let linear = self.solve_linear(forcing).map_err(Rejection::Krylov)?;
        let search = self.search(z).map_err(Rejection::LineSearch)?;
        Ok(Attempt { linear, search })
    }

    /// (newton-step): dz, starting from the problem's guess. The system is solved for -dz, whose right side R is at hand.
    fn solve_linear(&mut self, forcing: f64) -> Result<fgmres::Report, fgmres::Error> {
        let w = &mut *self.workspace;
        self.problem.guess_increment(&w.residual, &mut w.increment);
        // eta |R|, even if the guess has reduced the residual already.
        let norm = self.report.final_norm();
        let absolute_tolerance = forcing * norm;
        let settings = fgmres::Settings { relative_tolerance: 0.0, absolute_tolerance, ..self.settings.krylov };
        let mut system = Linearised { problem: &mut *self.problem, damped: self.pseudo_time.is_active() };
        let result = fgmres::solve(&mut system, &w.residual, &mut w.increment, &settings, &mut w.krylov);
        scale(-1.0, &mut w.increment);
        let report = *result.as_ref().unwrap_or_else(fgmres::Error::report);
        self.report.krylov_iterations += report.iterations;
        self.report.jacobian_products += report.products;
        let usable = report.final_norm <= self.settings.usable_linear_residual * norm;
        if usable { Ok(report) } else { result }
    }

    /// Searches for a along dz by (merit).
    fn search(&mut self, z: &[f64]) -> Result<line_search::Report, line_search::Error> {
        let (problem, w) = (&mut *self.problem, &mut *self.workspace);
        let (initial, damped) = (problem.merit(&w.residual), self.pseudo_time.is_active());
        if damped {
            w.prepare_damping();
            problem.add_pseudo_time(&w.increment, &mut w.pseudo_term);
        }
        let largest = problem.largest_step(z, &w.increment);
        let (evaluations, tolerances) = (&mut self.report.residual_evaluations, &mut self.tolerances);
        let problem = RefCell::new(problem);
        let round_off = || tolerances.floor(|| problem.borrow_mut().round_off(z));
        let merit_norm = |a: f64| {
            let [trial, residual] = w.krylov.spares(z.len());
            copy(z, trial);
            axpy(a, &w.increment, trial);
            *evaluations += 1;
            let mut problem = problem.borrow_mut();
            problem.residual(trial, residual)?;
            if !damped {
                return Ok(problem.merit(residual));
            }
            copy(residual, &mut w.merit);
            axpy(a, &w.pseudo_term, &mut w.merit);
            Ok(problem.merit(&w.merit))
        };
        line_search::search(&self.settings.line_search, initial, largest, round_off, merit_norm)
    }

    /// Moves to the state in the workspace.
    fn accept(&mut self, z: &mut [f64], forcing: f64, rejections: usize, attempt: &Attempt) -> Result<(), Error> {
        let w = &mut *self.workspace;
        let [trial, residual] = w.krylov.spares(z.len());
        copy(trial, z);
        std::mem::swap(&mut w.residual, residual);
        self.tolerances.forget_rounding();
        let (residual_norm, field_norms) = norms(self.problem, &w.residual);
        let step = StepReport {
            residual_norm,
            field_norms,
            forcing,
            linear_residual: attempt.linear.final_norm / self.report.final_norm(),
            krylov_iterations: attempt.linear.iterations,
            step_length: attempt.search.step_length,
            inverse_pseudo_time: self.pseudo_time.inverse().to_vec(),
            rejections,
        };
        log::accepted(self.report.steps.len() + 1, self.problem.fields(), &step);
        self.pseudo_time.accept(&step.field_norms, step.step_length);
        self.report.steps.push(step);
        self.note_progress(z);
        self.damp_after_short_steps();
        self.judge(z, attempt.search.decreased)
    }

    /// Starts damping if the last steps were all short: such increments are of little use, and ever shorter steps would follow.
    fn damp_after_short_steps(&mut self) {
        let (count, length) = SHORT_STEPS;
        let short = self.report.steps.iter().rev().take_while(|step| step.step_length <= length).count() >= count;
        if short && !self.pseudo_time.is_active() {
            self.pseudo_time.reject(self.report.final_field_norms(), &self.tolerances.fields);
        }
    }

    /// Increases the damping after a rejection; returns the rejection as an error if the damping has no effect.
    fn damp(&mut self, rejections: usize, rejection: Rejection) -> Result<(), Error> {
        let field_norms = self.report.final_field_norms();
        let worthwhile =
            !matches!(rejection, Rejection::Linearisation(_)) && rejections < self.settings.pseudo_time.max_rejections;
        if worthwhile && self.pseudo_time.reject(field_norms, &self.tolerances.fields) {
            log::rejected(self.report.steps.len() + 1, self.problem.fields(), self.pseudo_time.inverse());
            return Ok(());
        }
        let report = Box::new(self.report.clone());
        Err(match rejection {
            Rejection::Linearisation(source) => Error::Inadmissible { source, report },
            Rejection::Krylov(source) => Error::Krylov { source, report },
            Rejection::LineSearch(source) => Error::LineSearch { source, report },
        })
    }

    /// Whether the last step has made so little progress that rounding may be the reason.
    fn has_met_rounding(&self) -> bool {
        let (left, norm) = (self.report.last_reduction(), self.report.final_norm());
        let promised = self.report.steps.last().map_or(1.0, |step| step.linear_residual);
        left > LITTLE_PROGRESS || norm <= self.settings.rounding_suspected_below && left > SHORT_OF_LINEAR * promised
    }

    /// Ends the solve if the residual of the iterate `z` is within its rounding. Called after a step that made little progress or failed.
    fn ends_at_round_off(&mut self, z: &[f64]) -> bool {
        self.tolerances.floor(|| self.problem.round_off(z));
        self.report.round_off = self.tolerances.rounding_norm();
        let ends = self.tolerances.met_but_for_rounding(self.report.final_norm(), self.report.final_field_norms());
        if ends {
            self.report.convergence = Some(Convergence::RoundOff);
        }
        ends
    }

    /// Decides after a step to `z`, with or without decrease: converged, diverged or neither.
    fn judge(&mut self, z: &[f64], decreased: bool) -> Result<(), Error> {
        let norm = self.report.final_norm();
        let reference = self.tolerances.reference;
        let diverged = || Err(Error::Diverged { reference, report: Box::new(self.report.clone()) });
        // An infinite norm is never small, not even beside an infinite reference.
        if !norm.is_finite() {
            return diverged();
        }
        if self.tolerances.met(norm, self.report.final_field_norms()) {
            self.report.convergence = Some(Convergence::Tolerance);
        } else if !decreased && norm <= self.tolerances.round_off {
            self.report.convergence = Some(Convergence::RoundOff);
        } else if norm > self.settings.divergence * reference.max(self.report.initial_norm) {
            return diverged();
        } else if self.has_met_rounding() {
            self.ends_at_round_off(z);
        }
        Ok(())
    }
}

/// |R| and |R_k| of each field.
fn norms(problem: &dyn NonlinearProblem, residual: &[f64]) -> (f64, Vec<f64>) {
    let inner_product = problem.inner_product();
    let fields = problem.fields().iter().map(|field| inner_product.norm_on(field.range.clone(), residual));
    (inner_product.norm(residual), fields.collect())
}

/// dR/dz + T at the point of linearisation, as a linear system.
struct Linearised<'a> {
    problem: &'a mut dyn NonlinearProblem,
    damped: bool,
}

impl LinearSystem for Linearised<'_> {
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
