//! Causes in the settings of the solver.

use super::super::data::{Attempt, FailureData, GaveUp, Settling};
use super::{Cause, NEWTON_STEPS, number, rises};

/// A residual that stagnates at less than this times the estimate of its round-off is probably round-off.
const NEAR_ROUND_OFF: f64 = 30.0;

/// Below this Mach number sound is much faster than the flow.
const SLOW: f64 = 0.3;

/// The residual was still falling when the steps were used up: by (|R_0| / |R_n|)^(1/n) in each step, or less in the last
/// one.
pub fn newton_steps(data: &FailureData) -> Option<Cause> {
    let newton = data.newton.as_ref().filter(|newton| newton.steps_used_up)?;
    let norms = &newton.residuals;
    let steps = norms.len().checked_sub(1).filter(|steps| *steps > 0)?;
    let mean = (norms[0] / norms[steps]).powf(1.0 / steps as f64);
    let factor = mean.min(norms[steps - 1] / norms[steps]);
    let key = if data.attempt.steady { "solver.steady.steps" } else { "solver.newton_steps" };
    Some(Cause {
        name: NEWTON_STEPS,
        likelihood: 0.95 * rises((factor - 1.0).max(0.0), 1.0),
        what: format!(
            "too few Newton steps are allowed: the residual was still falling, by a factor of {} in each of the {steps} steps",
            number(factor)
        ),
        remedy: format!("raise `{key}`, now {}", newton.steps_allowed),
    })
}

/// A steady flow was not found, and a march in time has shown whether the flow becomes steady.
pub fn no_steady_flow(data: &FailureData) -> Option<Cause> {
    let Settling { early, late, duration, calms_down, is_unsteady } = data.newton.as_ref()?.settling?;
    let [early, late, duration] = [early, late, duration].map(number);
    let seen =
        format!("marched in time for {duration} from the best state, its rate of change went from {early} to {late}");
    let (name, likelihood, what) = match (calms_down, is_unsteady) {
        (_, true) => {
            ("unsteady_flow", 0.9, format!("perhaps there is no steady flow, for the flow is unsteady: {seen}"))
        }
        (true, _) => (
            "slow_settling",
            0.7,
            format!("Newton's method does not find the steady flow, though the flow calms down: {seen}"),
        ),
        _ => ("slow_settling", 0.9, format!("the flow settles slowly: {seen}")),
    };
    let march = "march in time: remove `[solver.steady]`, and give a `time.end` and `time.step`";
    let length = "the size of the body as `flow.reference.length`, if that is another one, for it scales the steps";
    let longer =
        |steps| format!("a longer first step of pseudo-time, for instance `solver.steady.first_step = {steps}`");
    let remedy = match calms_down || is_unsteady {
        // Pseudo-time in short steps follows the sound in a closed domain, which hardly fades.
        true if !is_unsteady && data.gas.as_ref().is_some_and(|gas| gas.mach < SLOW) => {
            format!("{march}; or {}", longer(100))
        }
        true => march.to_owned(),
        false => format!("{}; {length}; or {march}", longer(10)),
    };
    Some(Cause { name, likelihood, what, remedy })
}

/// Linear solves ended too early.
pub fn linear_solver(data: &FailureData) -> Option<Cause> {
    let newton = data.newton.as_ref()?;
    let part = if data.gave_up == GaveUp::LinearSolver { 1.0 } else { newton.unfinished_linear_solves };
    let (limit, restart) = match data.attempt.steady {
        true => ("solver.steady.krylov_iterations", ""),
        false => ("solver.krylov_iterations", " and `solver.krylov_restart`"),
    };
    let other = if newton.has_blocks { "" } else { ", take `solver.preconditioner = \"blocks\"`" };
    let shorter = if data.attempt.has_given_length() { ", or shorten `time.step`" } else { "" };
    // Ten iterations are few for any problem. If hundreds do not suffice, the cause is mostly elsewhere.
    let few = 1.0 - rises(newton.krylov_allowed as f64, 50.0);
    Some(Cause {
        name: "linear_solver",
        likelihood: part * (0.3 + 0.65 * few),
        what: format!(
            "the linear solver is cut short: {} % of its solves ran into the limit of {} iterations",
            (100.0 * part).round(),
            newton.krylov_allowed
        ),
        remedy: format!("raise `{limit}`{restart}{other}{shorter}"),
    })
}

/// The fastest wave travels over many nodes in a slab.
pub fn time_step(data: &FailureData) -> Option<Cause> {
    let gas = data.gas.as_ref().filter(|gas| data.attempt.has_given_length() && gas.waves_per_slab > 1.0)?;
    let Attempt { length, halvings, halvings_used_up, .. } = data.attempt;
    let more = if halvings_used_up { ", allow more `solver.slab_halvings`" } else { "" };
    let waves = gas.waves_per_slab;
    Some(Cause {
        name: "time_step",
        likelihood: 0.1 + 0.75 * rises(waves, 200.0),
        what: format!(
            "the slab is too long for Newton's method: in its length of {}, halved {halvings} times, the fastest wave passes {} \
             distances of nodes",
            number(length),
            number(waves)
        ),
        remedy: format!(
            "shorten `time.step`{more}, or damp the first steps with `solver.pseudo_time.initial_inverse = 1`"
        ),
    })
}

/// The residual stagnates, not far above its round-off.
pub fn tolerance(data: &FailureData) -> Option<Cause> {
    let newton = data.newton.as_ref()?;
    let (round_off, last) = (newton.round_off?, *newton.residuals.last()?);
    Some(Cause {
        name: "tolerance",
        likelihood: 0.95 * (1.0 - rises(last / round_off, NEAR_ROUND_OFF)),
        what: format!(
            "the tolerance is below what round-off allows: the residual stands at {}, and about {} of it is rounding",
            number(last),
            number(round_off)
        ),
        remedy: match data.attempt.steady {
            true => "raise `solver.steady.tolerance`".to_owned(),
            false => format!(
                "raise `solver.newton_tolerance`, or set `solver.newton_absolute_tolerance = {:.0e}`",
                2.0 * last
            ),
        },
    })
}
