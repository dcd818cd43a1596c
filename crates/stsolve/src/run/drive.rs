//! Mesh and flow, slab by slab.

use super::books::{Books, Stop};
use super::mesh_run::move_mesh;
use super::record::{MeshMoverView, Recorder, Snapshot};
use super::tally::Tally;
use super::{build, checkpoint, history, summary};
use crate::case::{AnyCase, Case, Flow, State};
use crate::cli::RunArguments;
use crate::commands::Session;
use crate::failure::Failure;
use crate::progress::{SlabDone, rounded};
use coupled::{March, SlabReport};
use fem::StateField;
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};
use output::SolverState;
use std::time::Instant;

/// `stsolve run`: mesh and flow, or the mesh alone where there is no flow.
///
/// # Errors
/// Bad input before anything is written; a slab that cannot be solved after the last good state is written.
pub fn run(case: &AnyCase, arguments: &RunArguments) -> Result<(), Failure> {
    // Inside the pool: every parallel loop then starts without waking it up.
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
    match &case.flow {
        Some(flow) => solve::<D, M>(case, flow, arguments),
        None => move_mesh::<D, M>(case, arguments, "run"),
    }
}

fn solve<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    arguments: &RunArguments,
) -> Result<(), Failure>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let begun = Instant::now();
    let mut march: March<D, M> = build::march(case, flow).map_err(Failure::bad_input)?;
    let view = MeshMoverView::new(&march.problem.mover);
    let session = Session::start(arguments, &case.about, case.output.directory.as_deref())?;
    let (mut recorder, stored) = Recorder::<D, M>::start(&session, case, &view, arguments.resume)?;
    let tally = resume(&mut march, stored.as_ref(), case)?;
    let mut books = Books::new(&case.time, march.state.time, arguments, &session, begun, tally);
    if stored.is_none() {
        books.tally.totals_at_start = march.totals();
        let (velocities, flow) = (vec![0.0; march.state.d.len() * case.time.order], flow_at_start(&march));
        let (time, displacement) = (march.state.time, &march.state.d[..]);
        recorder.step(&Snapshot { time, displacement, velocities: &velocities, flow: &flow })?;
    }
    let stop = solve_slabs(case, &mut march, &mut recorder, &mut books, &session)?;
    recorder.checkpoint(solver_state(&march), &books.tally)?;
    books.progress.finish();
    summary::of_flow(case, flow, &march, &books, stop.as_ref()).write(&session.directory)?;
    let (time, directory) = (march.state.time, session.directory.path());
    if let Some(stop) = stop {
        return books.conclude(stop, time, &session, &arguments.to_resume("run", directory));
    }
    let (time, seconds) = (rounded(time), books.seconds());
    let next = RunArguments::to_report(directory);
    books.progress.say(&format!("done: t = {time} in {seconds:.1} s; results in {}; {next}", directory.display()));
    Ok(())
}

/// Puts the march where the checkpoint left it.
fn resume<const D: usize, const M: usize>(
    march: &mut March<D, M>,
    stored: Option<&SolverState>,
    case: &Case<D>,
) -> Result<Tally, Failure> {
    let Some(stored) = stored else { return Ok(Tally::default()) };
    let (state, frozen, stale) = checkpoint::load(stored, &case.time).ok_or_else(checkpoint::incomplete)?;
    if state.u.len() != march.state.u.len() || state.d.len() != march.state.d.len() {
        return Err(checkpoint::incomplete());
    }
    march.state = state;
    if let Some(frozen) = frozen {
        march.problem.thaw(frozen);
    }
    march.problem.stale = stale;
    Tally::from_arrays(&stored.arrays, case.mesh.boundary_names().len()).ok_or_else(checkpoint::incomplete)
}

fn solver_state<const D: usize, const M: usize>(march: &March<D, M>) -> SolverState {
    checkpoint::store(&march.state, march.problem.frozen(), march.problem.stale)
}

/// The flow at the start, at every time node.
fn flow_at_start<const D: usize, const M: usize>(march: &March<D, M>) -> Vec<f64> {
    let (layout, one) = (march.problem.flow.layout, march.problem.flow.layout.at_one_time());
    let cell = |cell| (0..layout.time_order).flat_map(move |_| march.state.u[one.cell(cell)].iter().copied());
    (0..layout.cells).flat_map(cell).collect()
}

/// Solves what is left of the run; returns why it stopped before its end, if it did.
fn solve_slabs<const D: usize, const M: usize>(
    case: &Case<D>,
    march: &mut March<D, M>,
    recorder: &mut Recorder<D, M>,
    books: &mut Books,
    session: &Session,
) -> Result<Option<Stop>, Failure> {
    while !march.is_done() {
        if session.stop.is_set() {
            return Ok(Some(Stop::Asked));
        }
        match march.advance() {
            Ok(report) => finish_slab(case, march, &report, recorder, books)?,
            Err(error) => return Ok(Some(Stop::Failed(error.into()))),
        }
    }
    Ok(None)
}

fn finish_slab<const D: usize, const M: usize>(
    case: &Case<D>,
    march: &March<D, M>,
    report: &SlabReport,
    recorder: &mut Recorder<D, M>,
    books: &mut Books,
) -> Result<(), Failure> {
    books.tally.add(report);
    recorder.history.push(&history::row(case, report, &books.tally))?;
    if let Some(past) = &march.state.past
        && (report.slab.is_multiple_of(case.output.every) || march.is_done())
    {
        let (displacement, velocities) = (&march.state.d[..], &past.v[..]);
        recorder.step(&Snapshot { time: march.state.time, displacement, velocities, flow: &past.u })?;
    }
    if recorder.is_checkpoint_due() {
        recorder.checkpoint(solver_state(march), &books.tally)?;
    }
    books.progress.slab(&SlabDone {
        number: report.slab,
        time: march.state.time,
        newton: report.newton.steps.len(),
        krylov: report.newton.krylov_iterations,
        residual: report.newton.final_norm() / report.newton.initial_norm.max(f64::MIN_POSITIVE),
    });
    Ok(())
}
