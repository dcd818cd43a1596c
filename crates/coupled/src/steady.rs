//! The steady flow, by the solver of slabs.
//!
//! ```text
//! M (u - u_n) + dt f(u) = 0,   dt -> infinity                                                             (steady)
//! ```
//!
//! one slab with one node in time (implicit Euler) that is so long that its mass term vanishes. Newton is damped by
//! pseudo-time, (1/dtau) M, and dtau grows as the residual falls.

mod equilibrium;
mod invariants;
mod reliability;
mod search;
mod settling;

pub use equilibrium::{Equilibrium, NoEquilibrium, find_equilibrium};
pub use invariants::Invariants;
pub use reliability::{Reliability, Stability};
pub use search::{Discretisation, Discretised, Search, Stage, SteadyError, SteadyFlow};
pub use settling::Settling;

use crate::coupled_slab::{ROUND_OFF, SlabReport};
use crate::slab_error::SlabError;
use crate::state::{Interval, State};
use crate::system::System;
use fem::FluxesAt;
use newton_krylov::fgmres;
use newton_krylov::forcing;
use newton_krylov::newton::{self, Workspace};
use newton_krylov::problem::{Inadmissible, NonlinearProblem};
use newton_krylov::pseudo_time;

/// The length of the slab in time units of the flow: so long that u_n has no influence. All terms scale with it, so it costs no digits.
const STEADY_SLAB_LENGTH: f64 = 1e12;

/// The smallest eta of a step that is damped. Such a step follows the flow in time and does not end at a solution.
const LOOSE: f64 = 0.1;

/// Replaces `u` by the steady flow of the data at `time`, found from `u` by pseudo-time on the mesh of `problem` displaced by `d`.
/// `problem` has one node in time and a mesh that stands still; 1/dtau of the settings is per time, not per `time_unit`. Tolerance and 1/dtau are those
/// for the residual of the state `initial`: a better `u` begins with longer steps in pseudo-time. The report is that of a slab of length
/// zero at `time`, the start of a run. It ends before a step if `is_stopped`.
///
/// # Errors
/// [`SlabError::Guess`] if `u` or `initial` is not admissible; `u` is then unchanged. [`SlabError::Stopped`]. [`SlabError::Newton`] if there is no convergence; `u`
/// is then where [`newton::solve_until`] has ended.
///
/// # Panics
/// If `problem` has more than one node in time or solves for its mesh.
fn solve_steady<const D: usize, const M: usize>(
    problem: &mut System<D, M>,
    u: &mut [f64],
    d: &[f64],
    initial: &[f64],
    (time, time_unit): (f64, f64),
    (settings, is_stopped): (&newton::Settings, &dyn Fn() -> bool),
) -> Result<SlabReport<M>, SlabError> {
    assert!(
        problem.flow.operator.layout.time_order == 1 && problem.mesh_len() == 0,
        "one node in time, and no mesh to solve for"
    );
    let at_rest = vec![0.0; problem.mover().field_len()];
    problem.at_rest((time, time_unit), u, d)?;
    problem.flow.preconditioner.steady = true;
    // The residual of (steady) is dt times a rate, which the time unit makes a number.
    let absolute_tolerance = settings.absolute_tolerance.max(ROUND_OFF) * STEADY_SLAB_LENGTH;
    let references = residual_norms(problem, initial)?;
    let pseudo_time = continued(settings.pseudo_time, references[0], residual_norms(problem, u)?[0]);
    let krylov = fgmres::Settings { precision: problem.krylov_precision(), ..settings.krylov };
    let forcing = forcing::Settings { damped_minimum: LOOSE, ..settings.forcing };
    let settings = newton::Settings { absolute_tolerance, pseudo_time, krylov, forcing, ..*settings };
    let mut z = u.to_vec();
    let how = (&settings, is_stopped);
    let solved = newton::solve_until(problem, &mut z, Some(&references), how, &mut Workspace::default());
    u.copy_from_slice(&z);
    let newton = solved.map_err(|source| match source {
        newton::Error::Stopped { .. } => SlabError::Stopped,
        source => {
            let residual_breakdown = problem.residual_breakdown(&z).map(Box::new);
            SlabError::Newton { residual_breakdown, source: Box::new(source) }
        }
    })?;
    // The tolerance refers to the initial state, not to the guess.
    let residual_norms = [references[0], newton.final_norm()];
    problem.set_point(&z);
    let interval = Interval { start: time, end: time, halvings: 0 };
    let top = problem.flow.operator.boundary_fluxes(None).pop();
    Ok(SlabReport {
        jump: 0.0,
        slab: 0,
        interval,
        rejected: 0,
        eased: None,
        newton,
        residual_norms,
        counts: problem.take_counts(),
        quality: problem.mover().quality(d, &at_rest, interval),
        fluxes: top.map(|top| FluxesAt { time, ..top }).into_iter().collect(),
        totals: problem.flow.totals(u),
    })
}

impl<const D: usize, const M: usize> System<D, M> {
    /// Begins the slab of (steady) at `time` on top of `u`, on the mesh displaced by `d`. The flow has the given time unit.
    fn at_rest(&mut self, (time, time_unit): (f64, f64), u: &[f64], d: &[f64]) -> Result<(), SlabError> {
        self.hold_time(time);
        let state = State::new(time, u.to_vec(), d.to_vec());
        self.begin(Interval { start: time, end: time + STEADY_SLAB_LENGTH * time_unit, halvings: 0 }, &state)?;
        self.move_mesh(&mut vec![0.0; d.len()])?;
        Ok(())
    }
}

fn residual_norms<const D: usize, const M: usize>(
    problem: &mut System<D, M>,
    u: &[f64],
) -> Result<Vec<f64>, Inadmissible> {
    let mut r = vec![0.0; u.len()];
    problem.residual(u, &mut r)?;
    Ok(problem.field_norms(&r))
}

/// The pseudo-time at the residual `here`, if it began at the residual `begun`: 1/dtau = 1/dtau_0 (|R| / |R_0|)^power.
fn continued(settings: pseudo_time::Settings, begun: f64, here: f64) -> pseudo_time::Settings {
    let ratio = if begun > 0.0 { here / begun } else { 1.0 };
    pseudo_time::Settings { initial_inverse: settings.initial_inverse * ratio.powf(settings.power), ..settings }
}
