//! The inexact Newton method for R(z) = 0, with pseudo-transient continuation.
//!
//! ```text
//! (newton-step)   | R + (dR/dz + T_tau) dz | <= eta |R|,     z := z + a dz
//! ```
//!
//! eta is chosen by [`crate::forcing`], T_tau by [`crate::pseudo_time`], a by [`crate::line_search`]. The line search uses
//!
//! ```text
//! (merit)         G(a) = R(z + a dz) + a T_tau dz
//! ```
//!
//! the residual of one implicit Euler step in pseudo-time. dz is a descent direction of |G| for any T_tau, and G = R without
//! damping. While fields are damped |R| itself may grow.
//!
//! A solve also ends when only rounding is left. That is the case if a step made less progress than its linear solve predicted, or
//! failed, and the norm is within the problem's estimate of its rounding ([`NonlinearProblem::round_off`]).
//!
//! A step is rejected if the linear solver finds no useful increment or the line search finds no a. It is then repeated
//! with more damping, until more damping has no effect.

mod driver;
mod log;
mod report;
mod tolerances;

pub use report::{Convergence, Error, Report, StepReport};

use crate::problem::NonlinearProblem;
use crate::{fgmres, forcing, line_search, pseudo_time};
use driver::Driver;

/// The settings of [`solve`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The tolerance relative to the reference norms, for the total norm and for each field.
    pub relative_tolerance: f64,
    /// The absolute tolerance for the total norm and for each field.
    pub absolute_tolerance: f64,
    /// The level of round-off, relative to the reference norm: below it no decrease is required.
    pub round_off: f64,
    /// Below this norm, a step that falls short of its linear solve may have met rounding. Then the problem is asked for an estimate.
    pub rounding_suspected_below: f64,
    /// The number of steps after which the driver gives up.
    pub max_steps: usize,
    /// The solve has diverged if the residual exceeds the reference and the initial norm by this factor.
    pub divergence: f64,
    /// When the driver gives up because the residual has stopped falling; `None`: never. If set, a failed solve ends at
    /// the iterate with the least residual.
    pub stall: Option<Stall>,
    /// When the driver gives up because its steps lead nowhere; `None`: never.
    pub fruitless_steps: Option<FruitlessSteps>,
    /// A linear solve that fails is still used if it leaves at most this fraction of the residual.
    pub usable_linear_residual: f64,
    /// The accuracy of the linear solves.
    pub forcing: forcing::Settings,
    /// The linear solver; its tolerances are set by the driver.
    pub krylov: fgmres::Settings,
    /// The line search.
    pub line_search: line_search::Settings,
    /// The damping of fields.
    pub pseudo_time: pseudo_time::Settings,
}

/// The definition of a stall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stall {
    /// The number of steps without progress.
    pub steps: usize,
    /// A step makes progress if its residual is at most this factor of the least one before.
    pub factor: f64,
}

/// The driver gives up after `steps` fruitless steps in a row, if together they leave more than `left` of the residual. A step is fruitless if
/// it is at most a quarter of its increment, or is damped and raises the residual. Attempts at these steps that were rejected count, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FruitlessSteps {
    /// The number of steps.
    pub steps: usize,
    /// The part of the residual.
    pub left: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            relative_tolerance: 1e-8,
            absolute_tolerance: 0.0,
            round_off: 1e-13,
            rounding_suspected_below: 0.0,
            max_steps: 30,
            divergence: 1e6,
            stall: None,
            fruitless_steps: None,
            usable_linear_residual: 0.9,
            forcing: forcing::Settings::default(),
            krylov: fgmres::Settings::default(),
            line_search: line_search::Settings::default(),
            pseudo_time: pseudo_time::Settings::default(),
        }
    }
}

/// The work memory of [`solve`]: after the first solve, later ones of the same size allocate no vectors of that size.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    residual: Vec<f64>,
    increment: Vec<f64>,
    /// T_tau dz, while fields are damped.
    pseudo_term: Vec<f64>,
    /// G, while fields are damped.
    merit: Vec<f64>,
    /// Of the linear solver; between two solves its spare vectors hold the trial and R there.
    krylov: fgmres::Workspace,
}

impl Workspace {
    /// R at the last iterate of the last solve.
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Two vectors of numbers without meaning, each as long as the problem last solved, to work with until the next solve.
    pub fn room(&mut self) -> [&mut Vec<f64>; 2] {
        self.krylov.spares(self.residual.len())
    }

    /// Makes room for a problem of the given length.
    fn prepare(&mut self, length: usize) {
        for vector in [&mut self.residual, &mut self.increment] {
            vector.resize(length, 0.0);
        }
        // A workspace may serve problems of several lengths.
        self.pseudo_term.clear();
        self.merit.clear();
    }

    /// Makes room for the damping, and forgets T_tau dz.
    fn prepare_damping(&mut self) {
        let length = self.residual.len();
        self.pseudo_term.clear();
        self.pseudo_term.resize(length, 0.0);
        self.merit.resize(length, 0.0);
    }
}

/// Solves R(z) = 0. z holds the initial guess on entry, the solution on return.
///
/// `references` are the norms for the relative tolerance, one per field. Without them the norms at the initial guess
/// are used; a good guess makes these hard to meet.
///
/// # Errors
/// [`Error`] if the tolerances are not met. Then z is an admissible iterate: the one with the least residual if [`Settings::stall`]
/// is set, otherwise the last accepted one.
///
/// # Panics
/// If the number of references differs from the number of fields.
pub fn solve(
    problem: &mut dyn NonlinearProblem,
    z: &mut [f64],
    references: Option<&[f64]>,
    settings: &Settings,
    workspace: &mut Workspace,
) -> Result<Report, Error> {
    solve_until(problem, z, references, (settings, &|| false), workspace)
}

/// As [`solve`], but ends if `is_stopped` before a step. It must give the same answer on all ranks.
///
/// # Errors
/// As [`solve`]; [`Error::Stopped`].
///
/// # Panics
/// As [`solve`].
pub fn solve_until(
    problem: &mut dyn NonlinearProblem,
    z: &mut [f64],
    references: Option<&[f64]>,
    (settings, is_stopped): (&Settings, &dyn Fn() -> bool),
    workspace: &mut Workspace,
) -> Result<Report, Error> {
    let mut driver = Driver::start(problem, z, references, settings, workspace)?;
    while !driver.has_converged() {
        let stepped = if is_stopped() { Err(driver.stopped()) } else { driver.step(z) };
        if let Err(error) = stepped {
            driver.return_best(z);
            return Err(error);
        }
    }
    Ok(driver.into_report())
}

#[cfg(test)]
mod tests;
