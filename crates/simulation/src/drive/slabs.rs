//! The march of a run, and what every slab writes.

use super::Run;
use super::begin::{append_surfaces, reached};
use super::fall_back::{fall_back, is_held};
use crate::body_checks::beyond_linear;
use crate::context::{RunContext, Stop};
use crate::controls;
use crate::cuts::{Due, Reached};
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
    let coupled::State { slab, d: displacement, .. } = run.state();
    let of_controls = controls::update(case, &context.control_columns, (&row, displacement), &mut context.statistics);
    if slab.is_multiple_of(case.output.every) || run.is_done() {
        append_step(run, recorder)?;
    }
    if case.output.surfaces_every.is_some_and(|every| slab.is_multiple_of(every)) || run.is_done() {
        append_surfaces(run, recorder)?;
    }
    run.cut(directory, if run.is_done() { Due::All } else { Due::BySlabs })?;
    if recorder.is_checkpoint_due() && !is_held(run) {
        recorder.checkpoint(run.store(), &context.statistics)?;
    }
    // An observer may read the files.
    context.observer.state(&recorder.tell(&row, run.state(), &|| run.whole_flow_of_slab()));
    Ok(of_controls)
}

/// Appends the last slab to the steps of the result.
fn append_step<const D: usize, const M: usize>(run: &dyn Run, recorder: &mut Recorder<D, M>) -> Result<(), Failure> {
    let coupled::State { time, d: displacement, past, .. } = run.state();
    let Some(Past { v: velocities, .. }) = past else { return Ok(()) };
    let structure = StructureSnapshot::new(recorder.case(), run.state());
    let (averages, flow) = (&|cells| run.averages(cells), &|cells| run.flow_of_slab(cells));
    let together = run.together();
    recorder.step(&Snapshot { time: *time, displacement, velocities, flow, structure, averages, together })
}

/// Writes the state in which a run stops early as that of an end: what is not due after the last slab has been left out there. A resumed run
/// drops it again, see [`Reached::keeps_last`]. A start has been written as a whole, and a run without one has nothing.
pub(super) fn write_last_state<const D: usize, const M: usize>(
    run: &dyn Run,
    recorder: &mut Recorder<D, M>,
    directory: &Path,
) -> Result<(), Failure> {
    let times = recorder.step_times()?;
    let last = Reached { is_end: false, ..reached(run) };
    if times.is_empty() || times == [last.time] {
        return Ok(());
    }
    let output = &recorder.case().output;
    let has_surfaces = output.surfaces_every.is_some_and(|every| last.keeps_last(every));
    if !last.keeps_last(output.every) {
        append_step(run, recorder)?;
    }
    if !has_surfaces {
        append_surfaces(run, recorder)?;
    }
    Ok(run.cut(directory, Due::Rest)?)
}
