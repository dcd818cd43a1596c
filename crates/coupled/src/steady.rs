//! The steady flow, by the solver of slabs.
//!
//! ```text
//! M (u - u_n) + dt f(u) = 0,   dt -> infinity                                                             (steady)
//! ```
//!
//! one slab with one node in time (implicit Euler) that is so long that its mass term vanishes. Newton is damped by
//! pseudo-time, (1/dtau) M, and dtau grows as the residual falls.

use crate::march::{ROUND_OFF, SlabError, SlabReport};
use crate::slab_problem::SlabProblem;
use crate::state::Interval;
use fem::FluxesAt;
use newton_krylov::newton::{self, Workspace};

/// The length of the slab: u_n is forgotten but for this part of a time unit. Everything scales with it, so that nothing is lost
/// to round-off.
const LONG: f64 = 1e12;

/// Replaces `u` by the steady flow on the mesh of `problem` at rest, found from `u` by pseudo-time. `problem` has one node in time
/// and a mesh that stands still; 1/dtau of the settings is per time unit. The report is that of a slab of no length at `time`,
/// the start of a run.
///
/// # Errors
/// [`SlabError::Guess`] if `u` is no state, [`SlabError::Newton`] if there is no convergence; `u` is then unchanged.
///
/// # Panics
/// If `problem` has more than one node in time or solves for its mesh.
pub fn solve_steady<const D: usize, const M: usize>(
    problem: &mut SlabProblem<D, M>,
    u: &mut [f64],
    time: f64,
    settings: &newton::Settings,
) -> Result<SlabReport<M>, SlabError> {
    assert!(
        problem.flow.layout.time_order == 1 && problem.mesh_len() == 0,
        "one node in time, and no mesh to solve for"
    );
    let at_rest = vec![0.0; problem.mover.field_len()];
    problem.begin(time - LONG, LONG, u, &at_rest)?;
    problem.move_mesh(&mut vec![0.0; at_rest.len()])?;
    problem.frozen_flow.always_fresh = true;
    // Residuals are those of (steady): dt times rates.
    let absolute_tolerance = settings.absolute_tolerance.max(ROUND_OFF) * LONG;
    let settings = newton::Settings { absolute_tolerance, ..*settings };
    let mut z = u.to_vec();
    let solved = newton::solve(problem, &mut z, None, &settings, &mut Workspace::default());
    let newton = solved.map_err(|source| {
        let remainder = problem.remainder(&z).map(Box::new);
        SlabError::Newton { remainder, source: Box::new(source) }
    })?;
    problem.set_point(&z);
    u.copy_from_slice(&z);
    let interval = Interval { start: time, end: time, halvings: 0 };
    let top = problem.flow.boundary_fluxes().pop();
    Ok(SlabReport {
        jump: 0.0,
        slab: 0,
        interval,
        rejected: 0,
        newton,
        counts: std::mem::take(&mut problem.counts),
        quality: problem.mover.quality(&at_rest, &at_rest, interval),
        fluxes: top.map(|top| FluxesAt { time, ..top }).into_iter().collect(),
        totals: problem.totals(u),
    })
}
