//! The end of a run: its last state, and the verdict.

use super::Run;
use super::fall_back::is_held;
use super::slabs::write_last_state;
use crate::context::{RunContext, Stop};
use crate::crew::OtherMesh;
use crate::error::Failure;
use crate::failure::{self, FailureReport, Finding};
use crate::observer::NextStep;
use crate::record::Recorder;
use crate::session::Session;
use case::{Case, rounded_time};
use output::Summary;

/// Writes the last state and summary.json.
pub(super) fn close<const D: usize, const M: usize>(
    run: &mut dyn Run,
    recorder: &mut Recorder<D, M>,
    context: &RunContext,
    session: &Session<'_>,
    stop: Option<&Stop>,
) -> Result<Summary, Failure> {
    let keeps_checkpoint = match stop {
        // Nothing of the last slab is recorded, so a resumed run solves it again.
        Some(Stop::Failed(error, _)) => error.is::<OtherMesh>(),
        _ => is_held(run),
    };
    if !keeps_checkpoint {
        if stop.is_some() {
            write_last_state(run, recorder, session.directory.path())?;
        }
        recorder.checkpoint(run.store(), &context.statistics)?;
    }
    session.observer.finish();
    let summary = run.summary(context, stop);
    summary.write(&session.directory)?;
    run.leave(session.directory.path()).map_err(Failure::solve)?;
    Ok(summary)
}

/// What the run has come to, after it has said its cost.
pub(super) fn verdict<const D: usize>(
    run: &dyn Run,
    case: &Case<D>,
    context: &RunContext,
    session: &Session<'_>,
    stop: Option<Stop>,
) -> Result<(), Failure> {
    let again = session.observer.advice(NextStep::Resume, session.directory.path());
    context.say_cost();
    match stop {
        Some(Stop::Asked) => {
            context.say_stopped(run.state().time, &again);
            Err(Failure::Stopped)
        }
        Some(Stop::Failed(error, finding)) => {
            let finding = finding.map_or_else(|| run.examine(&error, &context.statistics), |finding| *finding);
            Err(explained(run, error, &finding, &case.about.name, session, &again))
        }
        None => run.judge(context, session),
    }
}

/// The failure of `run`, with the likeliest cause, after the failure report is written.
fn explained(
    run: &dyn Run,
    error: anyhow::Error,
    finding: &Finding,
    case: &str,
    session: &Session,
    again: &str,
) -> Failure {
    let (directory, state) = (session.directory.path(), run.state());
    let time = rounded_time(state.time);
    let message = format!("the run stopped at t = {time}; the state then is in {}", directory.display());
    let report = FailureReport { case, error: &error, time, slabs: state.slab, again: Some(again) };
    let hint = failure::tell(directory, finding, &report);
    Failure::solve(error.context(message + &hint))
}
