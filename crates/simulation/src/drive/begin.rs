//! The begin of a run: anew, from the state of another run, or from a checkpoint of its own.

use super::{Call, Run};
use crate::context::{RunContext, Stop};
use crate::cuts::{Due, Reached};
use crate::error::Failure;
use crate::frame_checks::jump_of_centrifugal_force;
use crate::occupied::{self, Beginning};
use crate::record::{MeshView, Recorder, Snapshot, StructureSnapshot};
use crate::restart::Start;
use crate::session::Session;
use crate::statistics::RunStatistics;
use crate::steady_search::Stopped;
use crate::{checkpoint, controls, cuts, failure, surfaces};
use case::{Case, rounded_time, surface_name};
use output::{Checkpoint, RESULT_FILE, ResultReader, Series};
use std::path::Path;
use std::sync::Arc;

/// The files of the run, and the state that they hold if it is resumed.
pub(super) fn open_files<'a, const D: usize, const M: usize>(
    session: &Session<'_>,
    case: &'a Case<D>,
    mesh: &Arc<MeshView<D>>,
    Call { destination, observer, origin, .. }: &Call<'_>,
) -> Result<(Recorder<'a, D, M>, Option<Checkpoint>), Failure> {
    // Checked once more, now that no other run can write there.
    let is_mesh_alone = case.flow.is_none() && case.structure.is_none();
    let beginning = Beginning { source: case.restart.as_deref(), case: &case.about.resolved, is_mesh_alone };
    occupied::check(destination, *observer, beginning)?;
    let state = origin.as_ref().map(|start| &start.checkpoint.state);
    let opened = Recorder::<D, M>::start(session, case, mesh, destination.is_resumed(), state)?;
    origin.iter().flat_map(|start| &start.warnings).for_each(|warning| tracing::warn!("{warning}"));
    let is_inverted = opened.1.as_ref().is_some_and(|stored| RunStatistics::has_invalid_mesh(&stored.state.arrays));
    if !is_inverted {
        failure::clear(session.directory.path())?;
    }
    Ok(opened)
}

/// Cuts files of lines and slices behind the state of `run`, or empties them if it has not begun. Fields and distributions of a former end
/// go, too.
pub(super) fn cut_files<const D: usize, const M: usize>(
    session: &Session<'_>,
    recorder: &mut Recorder<D, M>,
    run: &dyn Run,
    has_begun: bool,
) -> Result<(), Failure> {
    let reached = match has_begun {
        true => Some(Reached { is_start: recorder.begins_at(run.state().time)?, ..reached(run) }),
        false => None,
    };
    reached.map_or(Ok(()), |reached| recorder.drop_former_end(reached))?;
    Ok(cuts::begin(recorder.case(), session.directory.path(), reached)?)
}

/// Where `run` stands.
pub(super) fn reached(run: &dyn Run) -> Reached {
    let coupled::State { time, slab: slabs, .. } = *run.state();
    Reached { time, slabs, is_end: run.is_done(), is_start: false }
}

/// Warns if a resumed run is at a `time` after its end.
pub(super) fn warn_of_end<const D: usize>(case: &Case<D>, time: f64) {
    if time > case.time.end + case.time.round_off() {
        let (time, end) = (rounded_time(time), case.time.end);
        tracing::warn!("the checkpoint is at t = {time}, after the end {end}: nothing is left to do");
    }
}

/// Says that the averages of `case` cover no part of the run, if they do not.
pub(super) fn warn_of_averages<const D: usize>(case: &Case<D>) {
    if let Some(reason) = case.averages.as_ref().and_then(|averages| averages.missed_by(&case.time)) {
        tracing::warn!("the run has no averages: {reason}");
    }
}

/// Warns if the forces of a rotating frame are not periodic where the mesh is.
pub(super) fn warn_of_frame<const D: usize>(case: &Case<D>) {
    jump_of_centrifugal_force(case).iter().for_each(|text| tracing::warn!("{text}"));
}

/// Begins a new run, also one that starts from the result of another. Returns why it stopped early, if it did.
pub(super) fn begin<const D: usize, const M: usize>(
    run: &mut dyn Run,
    recorder: &mut Recorder<D, M>,
    context: &mut RunContext,
    directory: &Path,
) -> Result<Option<Stop>, Failure> {
    let row = match run.open(context) {
        Ok(row) => row,
        Err(error) if error.is::<Stopped>() => return Ok(Some(Stop::Asked)),
        Err(error) => return Ok(Some(Stop::Failed(error, None))),
    };
    let velocities = match &run.state().past {
        Some(past) => past.v.clone(),
        None => Arc::new(run.velocities_at_start()),
    };
    let flow = &|cells| run.flow_of_slab(cells);
    let (time, displacement) = (run.state().time, &run.state().d[..]);
    let structure = StructureSnapshot::new(recorder.case(), run.state());
    let averages = &|cells| run.averages(cells);
    let together = run.together();
    recorder.step(&Snapshot { time, displacement, velocities: &velocities, flow, structure, averages, together })?;
    if let Some(row) = row {
        controls::follow_steady_flow(recorder.case(), &context.control_columns, &row, &mut context.statistics);
        recorder.history.push(&[row, controls::values(recorder.case())].concat())?;
        // The steady flow that the run begins with has distributions along walls; another initial state has none worth keeping. Without
        // intervals there are those of the end alone, which may be here.
        if recorder.case().output.surfaces_every.is_some() || run.is_done() {
            append_surfaces(run, recorder)?;
        }
        recorder.checkpoint(run.store(), &context.statistics)?;
    }
    run.cut(directory, Due::All)?;
    Ok(None)
}

/// Appends the distributions along walls to their series.
pub(super) fn append_surfaces<const D: usize, const M: usize>(
    run: &dyn Run,
    recorder: &mut Recorder<D, M>,
) -> Result<(), Failure> {
    let time = run.state().time;
    run.surfaces().iter().try_for_each(|(array, values)| recorder.append_to_series(array, time, values))
}

/// Continues the series of distributions along walls. A run that takes over the result of the `origin` begins with its series, where they
/// have the same points; without, it goes on in its own file. The series of a wall of which there was none begins with the present state.
pub(super) fn continue_surfaces<const D: usize, const M: usize>(
    run: &dyn Run,
    recorder: &mut Recorder<D, M>,
    session: &Session<'_>,
    origin: Option<&Start>,
) -> Result<(), Failure> {
    let Some(every) = recorder.case().output.surfaces_every else { return Ok(()) };
    let (case, time) = (recorder.case(), run.state().time);
    let added = match origin {
        // The steady flow is searched anew.
        Some(start) if start.searches_anew => Vec::new(),
        Some(start) => start.added_walls.clone(),
        None => added_on_resume(case, session, time)?,
    };
    let (earlier, last_kept) = (origin.map_or(&[][..], |start| &start.surfaces[..]), reached(run).last_kept(every));
    let is_added = |name: &str| {
        let is_other = earlier.iter().any(|series| series.array.name == name);
        is_other || added.iter().any(|wall| surface_name(wall) == name)
    };
    for (array, values) in run.surfaces() {
        match earlier.iter().find(|series| series.array == array) {
            Some(series) => take_series(recorder, series, last_kept)?,
            None if is_added(&array.name) => recorder.append_to_series(&array, time, &values)?,
            None => {}
        }
    }
    Ok(())
}

/// Takes over what the `series` has up to the time `last`.
fn take_series<const D: usize, const M: usize>(
    recorder: &mut Recorder<D, M>,
    series: &Series,
    last: f64,
) -> Result<(), Failure> {
    let snapshots = series.times.iter().zip(series.values.chunks_exact(series.array.len()));
    let mut kept = snapshots.filter(|(time, _)| **time <= last);
    kept.try_for_each(|(time, values)| recorder.append_to_series(&series.array, *time, values))
}

/// The walls whose distributions begin at the present `time` of a resumed run; warns of their means. A wall whose series already is in the file
/// goes on with it, from the present time if that is missing.
fn added_on_resume<const D: usize>(case: &Case<D>, session: &Session<'_>, time: f64) -> Result<Vec<String>, Failure> {
    let reader = ResultReader::open(&session.directory.path().join(RESULT_FILE))?;
    let (mut new, mut begun) = (Vec::new(), Vec::new());
    for wall in surfaces::added(case, &reader.metadata.case_text) {
        let series = reader.series(&surface_name(&wall))?;
        match series.and_then(|series| series.times.last().copied()) {
            None => new.push(wall.clone()),
            Some(last) if last < time => tracing::warn!("{}", surfaces::interrupted(&wall, last, time)),
            Some(_) => continue,
        }
        begun.push(wall);
    }
    surfaces::late_means(case, &new, time).iter().for_each(|warning| tracing::warn!("{warning}"));
    Ok(begun)
}

/// Restores the run from a checkpoint, its own or that of the run that it continues.
pub(super) fn restore<const D: usize>(
    run: &mut dyn Run,
    stored: Option<&Checkpoint>,
    case: &Case<D>,
) -> Result<RunStatistics, Failure> {
    controls::set_for_preconditioner(case, stored.map(|stored| &stored.state));
    let Some(stored) = stored else { return Ok(RunStatistics::default()) };
    run.restore(stored)?;
    let statistics =
        RunStatistics::from_arrays(&stored.state.arrays, walls(case)).ok_or_else(checkpoint::incomplete)?;
    controls::set_present(case, &statistics);
    Ok(statistics)
}

/// Restores the run from the `start` that another run has left. The balances begin anew if energies are measured in another way here.
pub(super) fn take_over<const D: usize>(
    run: &mut dyn Run,
    start: &Start,
    case: &Case<D>,
) -> Result<RunStatistics, Failure> {
    let mut statistics = restore(run, Some(&start.checkpoint), case)?;
    // Balances that have not begun will begin with the integrals of this run.
    if start.is_measured_anew && !statistics.totals_at_start.is_empty() {
        run.begin_balances(&mut statistics);
    }
    Ok(statistics)
}

/// The number of walls of the flow.
pub(super) fn walls<const D: usize>(case: &Case<D>) -> usize {
    case.flow.as_ref().map_or(0, |flow| flow.walls.len())
}
