//! A run, slab by slab: the same for flow, mesh and structure.

mod begin;
mod fall_back;

use super::context::{RunContext, Stop};
use super::controls;
use super::crew::Orders;
use super::cuts;
use super::failure::{self, FailureReport, Finding};
use super::flow_run::run_flow;
use super::mesh_run::move_mesh;
use super::occupied::{self, Beginning};
use super::record::{MeshView, Recorder, Snapshot, StructureSnapshot};
use super::restart;
use super::statistics::RunStatistics;
use super::structure_run::run_structure;
use crate::destination::Destination;
use crate::error::Failure;
use crate::observer::{NextStep, Observer};
use crate::session::Session;
use begin::{append_surfaces, begin, continue_surfaces, restore, take_over};
use case::rounded_time;
use case::{AnyCase, Case, State};
use coupled::Past;
use fall_back::{fall_back, is_held};
use fem::StateField;
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};
use output::{ArraySpec, OutputError, SolverState, Summary};
use ranks::{Alone, Communicator};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Runs a case: mesh and flow, or the mesh or a structure alone where there is no flow. Returns the contents of summary.json.
///
/// # Errors
/// Bad input before anything is written; a slab that cannot be solved after the last good state is written.
pub fn run(case: &AnyCase, destination: &Destination, observer: &dyn Observer) -> Result<Summary, Failure> {
    run_on(Arc::new(Alone), case, destination, observer)
}

/// The same on all ranks of `communicator`, of which this is rank 0. The others call [`crate::serve`].
///
/// # Errors
/// As [`run`]; more ranks than blocks.
pub fn run_on(
    communicator: Arc<dyn Communicator>,
    case: &AnyCase,
    destination: &Destination,
    observer: &dyn Observer,
) -> Result<Summary, Failure> {
    let orders = Arc::new(Orders::new(communicator));
    check_ranks(case, orders.communicator().size())?;
    occupied::check_unless_held(destination, observer, Beginning::of_run(case))?;
    // Inside the pool, so that every parallel loop starts without waking the pool.
    rayon::scope(|_| match case {
        AnyCase::Plane(case) => run_in::<2, 4>(case, destination, observer, &orders),
        AnyCase::Space(case) => run_in::<3, 5>(case, destination, observer, &orders),
    })
}

/// Moves the mesh of a case alone, over the whole run.
///
/// # Errors
/// As [`run`]; an invalid mesh is a failed solve.
pub fn motion(case: &AnyCase, destination: &Destination, observer: &dyn Observer) -> Result<Summary, Failure> {
    let beginning = Beginning { is_mesh_alone: true, ..Beginning::of_run(case) };
    occupied::check_unless_held(destination, observer, beginning)?;
    rayon::scope(|_| match case {
        AnyCase::Plane(case) => move_mesh::<2, 4>(case, destination, observer),
        AnyCase::Space(case) => move_mesh::<3, 5>(case, destination, observer),
    })
}

/// Whether every rank has a block.
fn check_ranks(case: &AnyCase, ranks: usize) -> Result<(), Failure> {
    let (blocks, has_flow) = match case {
        AnyCase::Plane(case) => (case.blocks, case.flow.is_some()),
        AnyCase::Space(case) => (case.blocks, case.flow.is_some()),
    };
    if ranks > 1 && !has_flow {
        return Err(Failure::bad_input(anyhow::anyhow!("a case without a flow runs in one process, not in {ranks}")));
    }
    if ranks > blocks {
        let problem = format!("{ranks} processes for {blocks} blocks: each process needs a block");
        let remedy = format!("`parallel.blocks` = {ranks} or more, or fewer processes");
        return Err(Failure::bad_input(anyhow::anyhow!("{problem}; {remedy}")));
    }
    Ok(())
}

fn run_in<const D: usize, const M: usize>(
    case: &Case<D>,
    destination: &Destination,
    observer: &dyn Observer,
    orders: &Arc<Orders>,
) -> Result<Summary, Failure>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    match (&case.flow, &case.structure) {
        (Some(flow), _) => run_flow::<D, M>(case, flow, destination, observer, orders),
        (None, Some(structure)) => run_structure::<D, M>(case, structure, destination, observer),
        (None, None) => move_mesh::<D, M>(case, destination, observer),
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
    /// Attempts to advance one slab; `None` if the attempt is rejected and the next one is easier.
    fn advance(&mut self) -> anyhow::Result<Option<Self::Report>>;
    /// Whether there is a more robust way to go on.
    fn can_fall_back(&self) -> bool {
        false
    }
    /// Whether the run goes on in it after this `error`.
    fn falls_back_after(&self, _error: &anyhow::Error) -> bool {
        false
    }
    /// Whether the start that it needs first is still missing in the run with these `statistics`.
    fn awaits_start(&self, _statistics: &RunStatistics) -> bool {
        false
    }
    /// Begins the balances anew, after the run was restored with other integrals of the same flow, or other energies of bodies.
    fn begin_balances(&mut self, _statistics: &mut RunStatistics) {}
    /// Velocities and flow at the start, at every time node, laid out like those of a slab.
    fn slab_at_start(&self) -> [Vec<f64>; 2];
    /// Prepares and records the start of the run; returns its row of history.csv, if it has one.
    fn open(&mut self, _context: &mut RunContext) -> anyhow::Result<Option<Vec<f64>>> {
        Ok(None)
    }
    /// Records a slab and reports it; returns its row of history.csv.
    fn enter(&self, report: &Self::Report, context: &mut RunContext) -> Vec<f64>;
    /// The state from which the next slab can start.
    fn store(&self) -> SolverState;
    /// Restores the march from a checkpoint; `None` if something is missing there.
    fn restore(&mut self, stored: &SolverState) -> Option<()>;
    /// summary.json
    fn summary(&mut self, context: &RunContext, stop: Option<&Stop>) -> Summary;
    /// Examines the `error` of a failed slab.
    fn examine(&self, error: &anyhow::Error, statistics: &RunStatistics) -> Finding;
    /// Writes the lines and slices that are due into `directory`; all of them at the start and the end.
    ///
    /// # Errors
    /// A file that cannot be written.
    fn cut(&self, _directory: &Path, _at_end: bool) -> Result<(), OutputError> {
        Ok(())
    }
    /// Distributions along walls at the end of the last slab, with their descriptions.
    fn surfaces(&self) -> Vec<(ArraySpec, Vec<f64>)> {
        Vec::new()
    }
    /// Writes files about the state at the end into `directory`.
    ///
    /// # Errors
    /// A file that cannot be written.
    fn leave(&self, _directory: &Path, _statistics: &RunStatistics) -> anyhow::Result<()> {
        Ok(())
    }
    /// The final verdict on a run that has reached its end.
    fn judge(&self, context: &RunContext, session: &Session) -> Result<(), Failure>;
}

/// The call of a run.
#[derive(Clone, Copy)]
pub(super) struct Call<'a> {
    /// Where it writes.
    pub destination: &'a Destination,
    /// By whom.
    pub observer: &'a dyn Observer,
    /// The time of the call.
    pub begun: Instant,
    /// The state of another run from which this one starts, if any.
    pub origin: Option<&'a restart::Start>,
}

/// Drives `run` from its start or its checkpoint to its end.
pub(super) fn drive<const D: usize, const M: usize, R: Run>(
    case: &Case<D>,
    run: R,
    mesh: &Arc<MeshView<D>>,
    call: Call<'_>,
) -> Result<Summary, Failure> {
    let session = Session::start(call.destination, call.observer, call.begun)?;
    session.timed(|| drive_in::<D, M, R>(&session, case, run, mesh, call))
}

/// [`drive`] in its session.
fn drive_in<const D: usize, const M: usize, R: Run>(
    session: &Session<'_>,
    case: &Case<D>,
    mut run: R,
    mesh: &Arc<MeshView<D>>,
    call: Call<'_>,
) -> Result<Summary, Failure> {
    let Call { destination, observer, begun, origin } = call;
    let origin_state = origin.map(|start| &start.state);
    // Checked once more, now that no other run can write there.
    let is_mesh_alone = case.flow.is_none() && case.structure.is_none();
    occupied::check(
        destination,
        observer,
        Beginning { source: case.restart.as_deref(), case: &case.about.resolved, is_mesh_alone },
    )?;
    let (mut recorder, resumed) = Recorder::<D, M>::start(session, case, mesh, destination.is_resumed(), origin_state)?;
    origin.iter().flat_map(|start| &start.warnings).for_each(|warning| tracing::warn!("{warning}"));
    failure::clear(session.directory.path())?;
    let statistics = match (&resumed, origin) {
        (None, Some(start)) => take_over(&mut run, start, case)?,
        _ => restore(&mut run, resumed.as_ref(), case)?,
    };
    // A run whose search for the steady flow has failed has not begun.
    let has_begun = resumed.is_some() && !run.awaits_start(&statistics);
    let coupled::State { time, slab: slabs, .. } = *run.state();
    let reached = cuts::Reached { time, slabs, is_end: run.is_done() };
    cuts::begin(case, session.directory.path(), has_begun.then_some(reached))?;
    let mut context = RunContext::new(case, run.state().time, session, begun, statistics);
    if resumed.is_some() && run.state().time > case.time.end + 1e-9 * case.time.step {
        let (time, end) = (rounded_time(run.state().time), case.time.end);
        observer.say(&format!("warning: the checkpoint is at t = {time}, after the end {end}: nothing is left to do"));
    }
    if let Some(start) = origin.filter(|_| case.output.surfaces_every.is_some()) {
        continue_surfaces(&run, &mut recorder, &start.surfaces)?;
    }
    let stop = match has_begun {
        false => begin(&mut run, &mut recorder, &mut context, session.directory.path())?,
        true => None,
    };
    let stop = match stop {
        None => run_slabs(case, &mut run, &mut recorder, &mut context, session)?,
        stop => stop,
    };
    if !is_held(&run) || matches!(stop, Some(Stop::Failed(..))) {
        recorder.checkpoint(run.store(), &context.statistics)?;
    }
    observer.finish();
    let summary = run.summary(&context, stop.as_ref());
    summary.write(&session.directory)?;
    run.leave(session.directory.path(), &context.statistics).map_err(Failure::solve)?;
    let again = observer.advice(NextStep::Resume, session.directory.path());
    context.say_cost();
    match stop {
        Some(Stop::Asked) => {
            context.say_stopped(run.state().time, &again);
            Err(Failure::Stopped)
        }
        Some(Stop::Failed(error, finding)) => {
            let finding = finding.map_or_else(|| run.examine(&error, &context.statistics), |finding| *finding);
            Err(explained(&run, error, &finding, &case.about.name, session, &again))
        }
        None => run.judge(&context, session).map(|()| summary),
    }
}

/// The failure of `run`, with the likeliest cause, after the failure report is written.
fn explained(
    run: &impl Run,
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

/// Runs the remaining slabs; returns why it stopped before its end, if it did.
fn run_slabs<const D: usize, const M: usize>(
    case: &Case<D>,
    run: &mut impl Run,
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
            Ok(Some(report)) => {
                given_up = None;
                let of_controls = finish_slab(case, run, &report, recorder, context, session.directory.path())?;
                if let Err(error) = of_controls {
                    return Ok(Some(Stop::Failed(error, None)));
                }
            }
            Ok(None) if is_held(run) && !was_held => recorder.checkpoint(run.store(), &context.statistics)?,
            Ok(None) => {}
            Err(error) if run.falls_back_after(&error) => {
                given_up = Some(fall_back(case, run, recorder, context, (session, error))?);
            }
            Err(error) => return Ok(Some(given_up.unwrap_or(Stop::Failed(error, None)))),
        }
    }
    Ok(None)
}

/// Writes what a slab has given. Returns the error of the controls, if one of them has no value for the next slab.
fn finish_slab<const D: usize, const M: usize, R: Run>(
    case: &Case<D>,
    run: &R,
    report: &R::Report,
    recorder: &mut Recorder<D, M>,
    context: &mut RunContext,
    directory: &Path,
) -> Result<anyhow::Result<()>, Failure> {
    context.slabs += 1;
    let row = [run.enter(report, context), controls::values(case)].concat();
    recorder.history.push(&row)?;
    let of_controls = controls::update(case, &context.control_columns, &row, &mut context.statistics);
    let coupled::State { slab, time, d: displacement, past, .. } = run.state();
    if let Some(Past { v: velocities, u: flow, .. }) = past
        && (slab.is_multiple_of(case.output.every) || run.is_done())
    {
        let structure = StructureSnapshot::new(case, run.state());
        let averages = &context.statistics.averages;
        recorder.step(&Snapshot { time: *time, displacement, velocities, flow, structure, averages })?;
    }
    if case.output.surfaces_every.is_some_and(|every| slab.is_multiple_of(every)) || run.is_done() {
        append_surfaces(run, recorder)?;
    }
    run.cut(directory, run.is_done())?;
    context.observer.state(&recorder.tell(&row, run.state()));
    if recorder.is_checkpoint_due() && !is_held(run) {
        recorder.checkpoint(run.store(), &context.statistics)?;
    }
    Ok(of_controls)
}
