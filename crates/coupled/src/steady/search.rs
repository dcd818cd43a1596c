//! The steady flow from any start: directly if that is easy, otherwise from one discretisation to the next.
//!
//! 1. Pseudo-time at the order asked for. It gives up as soon as its residual falls by too little.
//! 2. If it has given up: order 2 with the most dissipative flux, then with the flux of the case orders 3, 4, .., each from the flow before.
//! 3. If that has failed: some slabs of the march in time from the best state, on data of one time. Where their residual falls,
//!    pseudo-time is tried again from there. Where it does not, the flow is unsteady.

use super::invariants::Invariants;
use super::reliability::Reliability;
use super::settling::{Settling, settle};
use super::solve_steady;
use crate::coupled_slab::SlabReport;
use crate::mesh_mover::MeshMover;
use crate::slab_error::SlabError;
use crate::system::System;
use crate::transfer::transfer_flow;
use fem::Share;
use newton_krylov::newton::{self, Stall};
use newton_krylov::{line_search, pseudo_time};

/// The residual at a lower order need only fall by this factor: a better flow does not shorten the next stage.
const ROUGHLY: f64 = 1e-4;

/// When the first attempt gives up: a start that is easy lets its residual fall in every step.
const AT_ONCE: Stall = Stall { steps: 5, factor: 0.9 };

/// When a later one does: waves that leave the domain may raise the residual for some steps.
pub(super) const PATIENT: Stall = Stall { steps: 25, factor: 0.9 };

/// How the equations are discretised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Discretisation {
    /// N_s.
    pub order: usize,
    /// N_t.
    pub time_order: usize,
    /// Whether the flux between cells is the most dissipative one, instead of that of the case.
    pub dissipative: bool,
}

/// What was done in one discretisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stage {
    /// How.
    pub discretisation: Discretisation,
    /// Newton steps.
    pub steps: usize,
    /// Krylov iterations.
    pub iterations: usize,
    /// Whether the flow was found.
    pub converged: bool,
}

/// A discretisation of the case, on the mesh at rest, and the initial state there.
pub type Discretised<const D: usize, const M: usize> = (System<D, M>, Vec<f64>);

/// The search for a steady flow. Several ranks search together, each for the flow of its own cells.
pub struct Search<'a, const D: usize, const M: usize> {
    /// Makes the problem of a discretisation.
    pub discretise: &'a (dyn Fn(Discretisation) -> Discretised<D, M> + Sync),
    /// N_s.
    pub order: usize,
    /// The mesh.
    pub mover: &'a MeshMover<D>,
    /// The cells of this rank.
    pub share: &'a Share,
    /// Its displacement.
    pub displacement: &'a [f64],
    /// The time of all data.
    pub time: f64,
    /// The time in which the flow passes its reference length.
    pub time_unit: f64,
    /// The Newton driver.
    pub settings: newton::Settings,
    /// Whether other discretisations may be tried.
    pub sequence: bool,
    /// The totals that the steady flow has from the initial state.
    pub invariants: Invariants<D>,
    /// The time units for which the steady flow is marched in time, to see whether it is stable. `None`: the flow decides.
    pub stability_time: Option<f64>,
    /// Whether the search ends early, without a steady flow. A collective call, with the same answer on all ranks.
    pub is_stopped: &'a dyn Fn() -> bool,
}

/// A steady flow.
#[derive(Debug)]
pub struct SteadyFlow<const M: usize> {
    /// The last solve.
    pub report: SlabReport<M>,
    /// All solves, the last one last.
    pub stages: Vec<Stage>,
    /// How far it can be trusted.
    pub reliability: Reliability,
}

/// Why there is no steady flow.
#[derive(Debug, thiserror::Error)]
#[error("no steady flow was found{}", described(settling.as_ref()))]
pub struct SteadyError {
    /// Whether slabs in time from the best state calm down, if they were tried.
    pub settling: Option<Settling>,
    /// All solves.
    pub stages: Vec<Stage>,
    /// Why the last solve failed.
    #[source]
    pub source: SlabError,
}

fn described(settling: Option<&Settling>) -> String {
    settling.map_or(String::new(), |settling| format!(", {}", settling.describe()))
}

/// Whether more steps would not help.
fn is_stuck(error: &SlabError) -> bool {
    let SlabError::Newton { source, .. } = error else { return false };
    !matches!(**source, newton::Error::MaxSteps { .. }) || source.report().steps.len() >= PATIENT.steps
}

impl<const D: usize, const M: usize> Search<'_, D, M> {
    /// Replaces `u`, a flow of the order asked for, by the steady flow.
    ///
    /// # Errors
    /// [`SteadyError`]; `u` is then the state with the least residual.
    pub fn find(&self, u: &mut Vec<f64>) -> Result<SteadyFlow<M>, SteadyError> {
        let (own, mut stages) = (self.own(), Vec::new());
        let stall = if self.sequence { AT_ONCE } else { PATIENT };
        let start = u.clone();
        let mut solved = self.solve(own, u, self.with(stall), &mut stages);
        if self.sequence && solved.as_ref().is_err_and(|error| !matches!(error, SlabError::Stopped)) {
            *u = start;
            solved = self.climb(u, &mut stages);
        }
        let solved = solved.and_then(|report| self.with_initial_totals(report, u, &mut stages));
        let source = match solved.and_then(|report| Ok((report, self.reliability(u)?))) {
            Ok((report, reliability)) => return Ok(SteadyFlow { report, stages, reliability }),
            Err(source) => source,
        };
        let mut marched = u.clone();
        let settling = if is_stuck(&source) { settle(self, &mut marched) } else { None };
        if settling.as_ref().is_some_and(Settling::calms_down)
            && let Ok(report) = self.solve(own, &mut marched, self.with(PATIENT), &mut stages)
            && let Ok(report) = self.with_initial_totals(report, &mut marched, &mut stages)
            && let Ok(reliability) = self.reliability(&marched)
        {
            *u = marched;
            return Ok(SteadyFlow { report, stages, reliability });
        }
        Err(SteadyError { settling, stages, source })
    }

    /// From order 2 upwards.
    fn climb(&self, u: &mut Vec<f64>, stages: &mut Vec<Stage>) -> Result<SlabReport<M>, SlabError> {
        let mut at = self.order;
        let rough = self.settings.relative_tolerance.max(ROUGHLY);
        let roughly = newton::Settings { relative_tolerance: rough, ..self.with(PATIENT) };
        let lower = (2..self.order.max(3)).map(|order| Discretisation { order, dissipative: order == 2, ..self.own() });
        for next in lower {
            // From the last flow that was found: one that has failed may be near a vacuum.
            let mut trial = u.clone();
            self.carry(&mut trial, at, next.order);
            match self.solve(next, &mut trial, roughly, stages) {
                Ok(_) => (*u, at) = (trial, next.order),
                Err(SlabError::Stopped) => return Err(SlabError::Stopped),
                Err(error) => tracing::info!(order = next.order, %error, "steady flow of a lower order not found"),
            }
        }
        self.carry(u, at, self.order);
        self.solve(self.own(), u, self.with(PATIENT), stages)
    }

    pub(super) fn own(&self) -> Discretisation {
        Discretisation { order: self.order, time_order: 1, dissipative: false }
    }

    /// The settings with a watch for stalls. Steps that the line search would shorten much are damped instead.
    pub(super) fn with(&self, stall: Stall) -> newton::Settings {
        newton::Settings {
            stall: Some(stall),
            line_search: line_search::Settings { max_trials: 4, ..self.settings.line_search },
            pseudo_time: pseudo_time::Settings { recovery: 2.0, ..self.settings.pseudo_time },
            ..self.settings
        }
    }

    fn carry(&self, u: &mut Vec<f64>, from: usize, to: usize) {
        if from != to {
            *u = self.transferred(u, from, to);
        }
    }

    /// The time of all data, and the time unit.
    pub(super) fn times(&self) -> (f64, f64) {
        (self.time, self.time_unit)
    }

    /// `u` of the order `from` as a flow of the order `to`.
    pub(super) fn transferred(&self, u: &[f64], from: usize, to: usize) -> Vec<f64> {
        transfer_flow((&self.share.own, u), (self.mover, self.displacement), from, to)
    }

    pub(super) fn solve(
        &self,
        discretisation: Discretisation,
        u: &mut [f64],
        settings: newton::Settings,
        stages: &mut Vec<Stage>,
    ) -> Result<SlabReport<M>, SlabError> {
        let (mut problem, initial) = (self.discretise)(discretisation);
        let how = (&settings, self.is_stopped);
        let mut solved = solve_steady(&mut problem, u, self.displacement, &initial, self.times(), how);
        if let Err(SlabError::Guess(_)) = solved {
            // The flow that was carried over is not admissible at this order.
            u.copy_from_slice(&initial);
            solved = solve_steady(&mut problem, u, self.displacement, &initial, self.times(), how);
        }
        if matches!(solved, Err(SlabError::Stopped)) {
            return solved;
        }
        let report = match &solved {
            Ok(report) => Some(&report.newton),
            Err(SlabError::Newton { source, .. }) => Some(source.report()),
            Err(_) => None,
        };
        let (steps, iterations) = report.map_or((0, 0), |report| (report.steps.len(), report.krylov_iterations));
        let stage = Stage { discretisation, steps, iterations, converged: solved.is_ok() };
        let Discretisation { order, dissipative, .. } = discretisation;
        tracing::info!(order, dissipative, steps, iterations, converged = stage.converged, "steady flow");
        stages.push(stage);
        solved
    }
}
