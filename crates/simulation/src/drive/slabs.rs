//! The march of a run, and what every slab writes.

use super::Run;
use super::begin::append_surfaces;
use super::fall_back::{fall_back, is_held};
use crate::body_checks::beyond_linear;
use crate::context::{RunContext, Stop};
use crate::controls;
use crate::error::Failure;
use crate::record::{Recorder, Snapshot, StructureSnapshot};
use crate::session::Session;
use case::Case;
use coupled::Past;
use std::path::Path;

/// Runs the remaining slabs; returns why it stopped before its end, if it did.
pub(super) fn run_slabs<const D: usize, const M: usize>(
    case: &Case<D>,
    run: &mut dyn Run,
    recorder: &mut Recorder<D, M>,
    context: &mut RunContext,
    session: &Session,
) -> Result<Option<Stop>, Failure> {
    let mut given_up = None;
    while !run.is_done() {
        if session.observer.is_stop_requested() {
            return Ok(Some(Stop::Asked));
        }
        let was_held = is_held(run);
        match run.advance() {
            Ok(true) => {
                given_up = None;
                let of_controls = finish_slab(case, run, recorder, context, session.directory.path())?;
                if let Err(error) = of_controls {
                    return Ok(Some(Stop::Failed(error, None)));
                }
            }
            Ok(false) => {
                controls::note_preconditioner(case, run.counts().rebuilds > 0, &mut context.statistics);
                if is_held(run) && !was_held {
                    recorder.checkpoint(run.store(), &context.statistics)?;
                }
            }
            Err(error) if run.falls_back_after(&error) => {
                given_up = Some(fall_back(case, run, recorder, context, (session, error))?);
            }
            Err(error) => return Ok(Some(given_up.unwrap_or(Stop::Failed(error, None)))),
        }
    }
    Ok(None)
}

/// Writes what a slab has given. Returns the error of the controls, if one of them has no value for the next slab.
fn finish_slab<const D: usize, const M: usize>(
    case: &Case<D>,
    run: &mut dyn Run,
    recorder: &mut Recorder<D, M>,
    context: &mut RunContext,
    directory: &Path,
) -> Result<anyhow::Result<()>, Failure> {
    context.slabs += 1;
    context.warn_once_of_linear_law(|| beyond_linear(case, run.state()));
    let row = [run.enter(context), controls::values(case)].concat();
    recorder.history.push(&row)?;
    let coupled::State { slab, time, d: displacement, past, .. } = run.state();
    let of_controls = controls::update(case, &context.control_columns, (&row, displacement), &mut context.statistics);
    if let Some(Past { v: velocities, .. }) = past
        && (slab.is_multiple_of(case.output.every) || run.is_done())
    {
        let structure = StructureSnapshot::new(case, run.state());
        let (averages, flow) = (&|cells| run.averages(cells), &|cells| run.flow_of_slab(cells));
        let together = run.together();
        recorder.step(&Snapshot { time: *time, displacement, velocities, flow, structure, averages, together })?;
    }
    if case.output.surfaces_every.is_some_and(|every| slab.is_multiple_of(every)) || run.is_done() {
        append_surfaces(run, recorder)?;
    }
    run.cut(directory, run.is_done())?;
    if recorder.is_checkpoint_due() && !is_held(run) {
        recorder.checkpoint(run.store(), &context.statistics)?;
    }
    // An observer may read the files.
    context.observer.state(&recorder.tell(&row, run.state(), &|| run.whole_flow_of_slab()));
    Ok(of_controls)
}
