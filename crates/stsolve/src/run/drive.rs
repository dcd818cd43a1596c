//! A run, slab by slab: the same for flow, mesh and structure.

use super::checkpoint;
use super::context::{RunContext, Stop};
use super::failure::{self, FailureReport, Finding};
use super::flow_run::run_flow;
use super::mesh_run::move_mesh;
use super::occupied;
use super::record::{MeshView, Recorder, Snapshot};
use super::restart;
use super::statistics::RunStatistics;
use super::structure_run::run_structure;
use crate::case::{AnyCase, Case, State};
use crate::cli::RunArguments;
use crate::commands::Session;
use crate::failure::Failure;
use crate::progress::rounded;
use coupled::Past;
use fem::StateField;
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};
use output::{SolverState, Summary};
use std::time::Instant;

/// `stsolve run`: mesh and flow; without a flow the mesh or a structure alone.
///
/// # Errors
/// Bad input before anything is written; a slab that cannot be solved after the last good state is written.
pub fn run(case: &AnyCase, arguments: &RunArguments) -> Result<(), Failure> {
    occupied::check_case(case, arguments, "run")?;
    // Inside the pool, so that every parallel loop starts without waking the pool.
    rayon::scope(|_| match case {
        AnyCase::Plane(case) => run_in::<2, 4>(case, arguments),
        AnyCase::Space(case) => run_in::<3, 5>(case, arguments),
    })
}

/// `stsolve motion`: the mesh alone, over the whole run.
///
/// # Errors
/// As [`run`]; an invalid mesh is a failed solve.
pub fn motion(case: &AnyCase, arguments: &RunArguments) -> Result<(), Failure> {
    occupied::check_case(case, arguments, "motion")?;
    rayon::scope(|_| match case {
        AnyCase::Plane(case) => move_mesh::<2, 4>(case, arguments, "motion"),
        AnyCase::Space(case) => move_mesh::<3, 5>(case, arguments, "motion"),
    })
}

fn run_in<const D: usize, const M: usize>(case: &Case<D>, arguments: &RunArguments) -> Result<(), Failure>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    match (&case.flow, &case.structure) {
        (Some(flow), _) => run_flow::<D, M>(case, flow, arguments),
        (None, Some(structure)) => run_structure::<D, M>(case, structure, arguments),
        (None, None) => move_mesh::<D, M>(case, arguments, "run"),
    }
}

/// A march from slab to slab, and its output.
pub(super) trait Run {
    /// The report of a slab.
    type Report;
    /// The state of the march.
    fn state(&self) -> &coupled::State;
    /// Whether the end has been reached.
    fn is_done(&self) -> bool;
    /// Advances one slab.
    fn advance(&mut self) -> anyhow::Result<Self::Report>;
    /// Velocities and flow at the start, at every time node, laid out like those of a slab.
    fn slab_at_start(&self) -> (Vec<f64>, Vec<f64>);
    /// Prepares and records the start of the run; returns its row of history.csv, if it has one.
    fn open(&mut self, _books: &mut RunContext) -> anyhow::Result<Option<Vec<f64>>> {
        Ok(None)
    }
    /// Records a slab and reports it; returns its row of history.csv.
    fn enter(&self, report: &Self::Report, context: &mut RunContext) -> Vec<f64>;
    /// The state from which the next slab can start.
    fn store(&self) -> SolverState;
    /// Restores the march from a checkpoint; `None` if something is missing there.
    fn restore(&mut self, stored: &SolverState) -> Option<()>;
    /// summary.json
    fn summary(&self, context: &RunContext, stop: Option<&Stop>) -> Summary;
    /// Examines the `error` of a failed slab.
    fn examine(&self, error: &anyhow::Error, statistics: &RunStatistics) -> Finding;
    /// The final verdict on a run that has reached its end.
    fn judge(&self, context: &RunContext, session: &Session) -> Result<(), Failure>;
}

/// The call of a run.
#[derive(Clone, Copy)]
pub(super) struct Call<'a> {
    /// The arguments.
    pub arguments: &'a RunArguments,
    /// The command.
    pub command: &'a str,
    /// The time of the call.
    pub begun: Instant,
    /// The state of another run from which this one starts, if any.
    pub origin: Option<&'a restart::Start>,
}

/// Drives `run` from its start or its checkpoint to its end.
pub(super) fn drive<const D: usize, const M: usize, R: Run>(
    case: &Case<D>,
    mut run: R,
    mesh: &MeshView<D>,
    call: Call<'_>,
) -> Result<(), Failure> {
    let Call { arguments, command, begun, origin } = call;
    let origin_state = origin.map(|start| &start.state);
    let session = Session::start(arguments, &case.about, case.output.directory.as_deref(), begun)?;
    // Checked once more, now that no other run can write there.
    occupied::check(arguments, command, session.directory.path(), case.restart.as_deref())?;
    let (mut recorder, resumed) = Recorder::<D, M>::start(&session, case, mesh, arguments.resume, origin_state)?;
    origin.iter().flat_map(|start| &start.warnings).for_each(|warning| tracing::warn!("{warning}"));
    failure::clear(session.directory.path())?;
    let statistics = restore(&mut run, resumed.as_ref().or(origin_state), case)?;
    let mut context = RunContext::new(&case.time, run.state().time, arguments, &session, begun, statistics);
    let stop = match resumed {
        None => begin(&mut run, &mut recorder, &mut context)?,
        Some(_) => None,
    };
    let stop = match stop {
        None => run_slabs(case, &mut run, &mut recorder, &mut context, &session)?,
        stop => stop,
    };
    recorder.checkpoint(run.store(), &context.statistics)?;
    context.progress.finish();
    run.summary(&context, stop.as_ref()).write(&session.directory)?;
    let again = arguments.to_resume(command, session.directory.path());
    context.say_cost();
    match stop {
        Some(Stop::Asked) => {
            context.say_stopped(run.state().time, &again);
            Err(Failure::Stopped)
        }
        Some(Stop::Failed(error)) => {
            Err(explained(&run, error, &context.statistics, &case.about.name, (&session, &again)))
        }
        None => run.judge(&context, &session),
    }
}

/// The failure of `run`, with the likeliest cause, after the failure report is written.
fn explained(
    run: &impl Run,
    error: anyhow::Error,
    statistics: &RunStatistics,
    case: &str,
    (session, again): (&Session, &str),
) -> Failure {
    let (directory, state) = (session.directory.path(), run.state());
    let time = rounded(state.time);
    let message = format!("the run stopped at t = {time}; the state then is in {}", directory.display());
    let story = FailureReport { case, error: &error, time, slabs: state.slab, again: Some(again) };
    let hint = failure::tell(directory, &run.examine(&error, statistics), &story);
    Failure::solve(error.context(message + &hint))
}

/// Begins a new run, also one that starts from the result of another. Returns why it stopped early, if it did.
fn begin<const D: usize, const M: usize>(
    run: &mut impl Run,
    recorder: &mut Recorder<D, M>,
    context: &mut RunContext,
) -> Result<Option<Stop>, Failure> {
    let row = match run.open(context) {
        Ok(row) => row,
        Err(error) => return Ok(Some(Stop::Failed(error))),
    };
    let (velocities, flow) = match &run.state().past {
        Some(past) => (past.v.clone(), past.u.clone()),
        None => run.slab_at_start(),
    };
    let (time, displacement) = (run.state().time, &run.state().d[..]);
    recorder.step(&Snapshot { time, displacement, velocities: &velocities, flow: &flow })?;
    if let Some(row) = row {
        recorder.history.push(&row)?;
        recorder.checkpoint(run.store(), &context.statistics)?;
    }
    Ok(None)
}

/// Restores the run from a checkpoint, its own or that of the run that it continues.
fn restore<const D: usize>(
    run: &mut impl Run,
    stored: Option<&SolverState>,
    case: &Case<D>,
) -> Result<RunStatistics, Failure> {
    let Some(stored) = stored else { return Ok(RunStatistics::default()) };
    run.restore(stored).ok_or_else(checkpoint::incomplete)?;
    RunStatistics::from_arrays(&stored.arrays, case.flow.as_ref().map_or(0, |flow| flow.walls.len()))
        .ok_or_else(checkpoint::incomplete)
}

/// Runs the remaining slabs; returns why it stopped before its end, if it did.
fn run_slabs<const D: usize, const M: usize>(
    case: &Case<D>,
    run: &mut impl Run,
    recorder: &mut Recorder<D, M>,
    context: &mut RunContext,
    session: &Session,
) -> Result<Option<Stop>, Failure> {
    while !run.is_done() {
        if session.stop.is_set() {
            return Ok(Some(Stop::Asked));
        }
        match run.advance() {
            Ok(report) => finish_slab(case, run, &report, recorder, context)?,
            Err(error) => return Ok(Some(Stop::Failed(error))),
        }
    }
    Ok(None)
}

fn finish_slab<const D: usize, const M: usize, R: Run>(
    case: &Case<D>,
    run: &R,
    report: &R::Report,
    recorder: &mut Recorder<D, M>,
    context: &mut RunContext,
) -> Result<(), Failure> {
    recorder.history.push(&run.enter(report, context))?;
    let coupled::State { slab, time, d: displacement, past, .. } = run.state();
    if let Some(Past { v: velocities, u: flow, .. }) = past
        && (slab.is_multiple_of(case.output.every) || run.is_done())
    {
        recorder.step(&Snapshot { time: *time, displacement, velocities, flow })?;
    }
    if recorder.is_checkpoint_due() {
        recorder.checkpoint(run.store(), &context.statistics)?;
    }
    Ok(())
}
