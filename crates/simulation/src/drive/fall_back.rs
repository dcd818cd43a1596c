//! How a run goes on in a more robust way, see [`crate::fallback`].

use super::Run;
use super::begin::{cut_files, restore, walls};
use crate::context::{RunContext, Stop};
use crate::error::Failure;
use crate::fallback;
use crate::record::Recorder;
use crate::session::Session;
use crate::statistics::RunStatistics;
use case::{Case, rounded_time};

/// Whether the last checkpoint stays, because the run may go back to it: that before the slab that is halved.
pub(super) fn is_held(run: &dyn Run) -> bool {
    run.state().failed.is_some() && run.can_fall_back()
}

/// Goes back to the checkpoint before the slab that could not be solved because of `error`, and on in a more robust way. Returns why the
/// run stops if that fails in the same slab.
pub(super) fn fall_back<const D: usize, const M: usize>(
    case: &Case<D>,
    run: &mut dyn Run,
    recorder: &mut Recorder<D, M>,
    context: &mut RunContext,
    (session, error): (&Session, anyhow::Error),
) -> Result<Stop, Failure> {
    let finding = run.examine(&error, &context.statistics);
    if !is_held(run) {
        recorder.checkpoint(run.store(), &context.statistics)?;
    }
    // Also the attempts in parts of the slab that had been solved, and the last one.
    let (reached, of_attempts) = (context.statistics.clone(), run.counts());
    let rejected = reached.rejected + run.state().rejected as u64 + 1;
    let stored = recorder.go_back(session)?;
    let before = RunStatistics::from_arrays(&stored.state.arrays, walls(case)).unwrap_or_default();
    let rejected = rejected.saturating_sub(before.rejected) as usize;
    let stored = fallback::in_split_form(stored, rejected, reached.counts_since(&before, of_attempts));
    context.statistics = restore(run, Some(&stored), case)?;
    run.begin_balances(&mut context.statistics);
    cut_files(session, recorder, run, true)?;
    let (time, cause) = (rounded_time(run.state().time), coupled::chain(error.as_ref()));
    let reason = finding.too_few_steps().unwrap_or_else(|| "the mesh does not resolve the flow".to_owned());
    let told = format!(
        "{cause}; {reason}, so the run goes on from t = {time} in a split form, with the nodes as points of quadrature (`solver.fallback`)"
    );
    tracing::warn!("{told}");
    Ok(Stop::Failed(error, Some(Box::new(finding))))
}
