//! The loop over slabs.

use super::build;
use super::checkpoint;
use super::record::{MeshMoverView, Recorder, Snapshot, walls};
use super::tally::Tally;
use crate::case::{AnyCase, Case, Flow, State};
use crate::cli::RunArguments;
use crate::commands::{Session, set_threads};
use crate::failure::Failure;
use crate::progress::{Progress, SlabDone};
use coupled::{Interval, March, MeshMarch, MeshQuality, SlabReport};
use fem::{StateField, squared_errors};
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};
use output::{
    Conservation, Cost, ErrorNorms, Krylov, MeshQuality as QualitySummary, MeshSize, Newton, SolverState, Summary,
    Unknowns, Wall,
};
use std::time::Instant;

/// `stsolve run`: mesh and flow, or the mesh alone where there is no flow.
///
/// # Errors
/// Bad input before anything is written; a slab that cannot be solved after the last good state is written.
pub fn run(case: &AnyCase, arguments: &RunArguments) -> Result<(), Failure> {
    set_threads(arguments)?;
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
    set_threads(arguments)?;
    rayon::scope(|_| match case {
        AnyCase::Plane(case) => move_mesh::<2, 4>(case, arguments),
        AnyCase::Space(case) => move_mesh::<3, 5>(case, arguments),
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
        None => move_mesh::<D, M>(case, arguments),
    }
}

/// What both kinds of run keep beside the march.
struct Books {
    tally: Tally,
    begun: Instant,
    setup_seconds: f64,
    progress: Progress,
}

impl Books {
    fn new<const D: usize>(
        case: &Case<D>,
        arguments: &RunArguments,
        session: &Session,
        begun: Instant,
        tally: Tally,
        time: f64,
    ) -> Self {
        let progress = Progress::new(&case.time, time, arguments.verbosity, &session.terminal);
        Books { tally, begun, setup_seconds: begun.elapsed().as_secs_f64(), progress }
    }

    fn cost(&self) -> Cost {
        Cost {
            wall_seconds: self.begun.elapsed().as_secs_f64(),
            setup_seconds: self.setup_seconds,
            peak_memory_bytes: peak_memory(),
            threads: rayon::current_num_threads(),
            residual_evaluations: self.tally.residuals,
            jacobian_products: self.tally.products,
        }
    }
}

/// The largest memory of this process so far, where the system tells.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(1024 * kilobytes)
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
    let mut books = Books::new(case, arguments, &session, begun, tally, march.state.time);
    if stored.is_none() {
        books.tally.totals_at_start = march.totals();
        let (velocities, flow) = (vec![0.0; march.state.d.len() * case.time.order], flow_at_start(&march));
        let (time, displacement) = (march.state.time, &march.state.d[..]);
        recorder.step(&Snapshot { time, displacement, velocities: &velocities, flow: &flow })?;
    }
    let mut reason = None;
    while !march.is_done() && reason.is_none() {
        match march.advance() {
            Ok(report) => {
                finish_slab(case, &march, &report, &mut recorder, &mut books)?;
                if session.stop.is_set() {
                    reason = Some(Stop::Asked);
                }
            }
            Err(error) => reason = Some(Stop::Failed(error)),
        }
    }
    recorder.checkpoint(solver_state(&march), &books.tally)?;
    books.progress.finish();
    summarise(case, flow, &march, &books, reason.as_ref()).write(&session.directory)?;
    conclude(&session, arguments, &books, march.state.time, reason)
}

/// Why a run ended before its end.
enum Stop {
    Asked,
    Failed(coupled::MarchError),
}

fn conclude(
    session: &Session,
    arguments: &RunArguments,
    books: &Books,
    time: f64,
    reason: Option<Stop>,
) -> Result<(), Failure> {
    let directory = session.directory.path().display();
    let seconds = books.begun.elapsed().as_secs_f64();
    match reason {
        None => books.progress.say(&format!("done: t = {time} in {seconds:.1} s; results in {directory}")),
        Some(Stop::Asked) => {
            let case = arguments.case.case.display();
            books.progress.say(&format!(
                "stopped at t = {time}; continue with: stsolve run {case} --output {directory} --resume"
            ));
        }
        Some(Stop::Failed(error)) => {
            let context = format!("the run stopped at t = {time}; the state then is in {directory}");
            return Err(Failure::solve(anyhow::Error::new(error).context(context)));
        }
    }
    Ok(())
}

/// Puts the march where the checkpoint left it.
fn resume<const D: usize, const M: usize>(
    march: &mut March<D, M>,
    stored: Option<&SolverState>,
    case: &Case<D>,
) -> Result<Tally, Failure> {
    let Some(stored) = stored else { return Ok(Tally::default()) };
    let incomplete = || {
        Failure::bad_input(anyhow::anyhow!(
            "the checkpoint lacks a part of the state; start the run anew, without --resume"
        ))
    };
    let (state, frozen, stale) = checkpoint::load(stored).ok_or_else(incomplete)?;
    if state.u.len() != march.state.u.len() || state.d.len() != march.state.d.len() {
        return Err(incomplete());
    }
    march.state = state;
    if let Some(frozen) = frozen {
        march.problem.thaw(frozen);
    }
    march.problem.stale = stale;
    Tally::from_arrays(&stored.arrays, case.mesh.boundary_names().len()).ok_or_else(incomplete)
}

fn solver_state<const D: usize, const M: usize>(march: &March<D, M>) -> SolverState {
    let mut out = SolverState::default();
    checkpoint::store(&march.state, march.problem.frozen(), march.problem.stale, &mut out);
    out
}

/// The flow at the start, at every time node.
fn flow_at_start<const D: usize, const M: usize>(march: &March<D, M>) -> Vec<f64> {
    let (layout, one) = (march.problem.flow.layout, march.problem.flow.layout.at_one_time());
    let cell = |cell| (0..layout.time_order).flat_map(move |_| march.state.u[one.cell(cell)].iter().copied());
    (0..layout.cells).flat_map(cell).collect()
}

fn finish_slab<const D: usize, const M: usize>(
    case: &Case<D>,
    march: &March<D, M>,
    report: &SlabReport,
    recorder: &mut Recorder<D, M>,
    books: &mut Books,
) -> Result<(), Failure> {
    books.tally.add(report);
    recorder.history.push(&history_row(case, report, &books.tally))?;
    let Some(past) = &march.state.past else { return Ok(()) };
    if report.slab % case.output.every == 0 || march.is_done() {
        let (displacement, velocities) = (&march.state.d[..], &past.v[..]);
        recorder.step(&Snapshot { time: march.state.time, displacement, velocities, flow: &past.u })?;
    }
    recorder.slabs_since_checkpoint += 1;
    if recorder.slabs_since_checkpoint >= case.output.checkpoint_every {
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

fn mesh_columns(interval: Interval, iterations: usize, quality: &MeshQuality) -> Vec<f64> {
    let MeshQuality { lower_bound, sampled_min, scaled_jacobian, .. } = *quality;
    vec![interval.end, interval.end - interval.start, iterations as f64, lower_bound, sampled_min, scaled_jacobian]
}

/// A row of history.csv, in the order of `record::columns`.
fn history_row<const D: usize>(case: &Case<D>, report: &SlabReport, tally: &Tally) -> Vec<f64> {
    let mut row = mesh_columns(report.interval, report.counts.elasticity_iterations, &report.quality);
    let newton = &report.newton;
    row.extend([newton.steps.len() as f64, newton.krylov_iterations as f64, newton.initial_norm, newton.final_norm()]);
    row.extend([
        report.counts.rebuilds as f64,
        report.rejected as f64,
        report.totals[0],
        tally.mass_balance(&report.totals),
    ]);
    let dt = report.interval.end - report.interval.start;
    for wall in walls(case) {
        // What momentum leaves through a wall is the force of the fluid on it; what energy leaves is the work on it.
        row.extend(report.through[wall][1..].iter().map(|through| through / dt));
    }
    row
}

fn summarise<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    march: &March<D, M>,
    books: &Books,
    reason: Option<&Stop>,
) -> Summary
where
    Exact<State<D>>: StateField<D, M>,
{
    let (tally, slabs) = (&books.tally, march.state.slab as u64);
    let mut summary = summary_of_mesh(case, books, march.state.time, slabs);
    summary.completed = reason.is_none();
    summary.reason = reason.map(|reason| match reason {
        Stop::Asked => "stopped by a signal; continue with --resume".into(),
        Stop::Failed(error) => coupled::chain(error),
    });
    let mesh = march.problem.mesh_len();
    summary.unknowns = Unknowns { flow: Some(march.problem.flow.layout.len()), mesh: (mesh > 0).then_some(mesh) };
    summary.rejected_slabs = tally.rejected;
    summary.newton = Some(Newton { total: tally.newton, max: tally.newton_max, per_slab: ratio(tally.newton, slabs) });
    summary.krylov = Some(Krylov {
        total: tally.krylov,
        max_per_newton: tally.krylov_max,
        mean_per_newton: ratio(tally.krylov, tally.newton),
        elasticity_total: (mesh > 0).then_some(tally.elasticity),
    });
    summary.error = flow.exact.as_ref().map(|exact| errors(march, exact));
    summary.conservation = Some(Conservation {
        mass_error: Some(tally.mass_error),
        free_stream_error: match &flow.exact {
            Some(exact @ State::Uniform(_)) => Some(largest_deviation(march, exact)),
            _ => None,
        },
    });
    for wall in walls(case) {
        let Some(through) = tally.through.get(wall) else { continue };
        let wall_summary = Wall { impulse: through[1..=D].to_vec(), work: through[M - 1], drag_coefficient: None };
        summary.walls.insert(case.mesh.boundary_names()[wall].clone(), wall_summary);
    }
    summary
}

fn ratio(a: u64, b: u64) -> f64 {
    if b == 0 { 0.0 } else { a as f64 / b as f64 }
}

/// L2 errors at the time reached.
fn errors<const D: usize, const M: usize>(march: &March<D, M>, exact: &State<D>) -> ErrorNorms
where
    Exact<State<D>>: StateField<D, M>,
{
    let flow = &march.problem.flow;
    let row = if march.state.slab == 0 { flow.tables.bottom_row() } else { flow.top_row() };
    let squares = squared_errors(flow, &march.state.u, row.row(0), &Exact(exact.clone()), march.state.time);
    ErrorNorms {
        density_l2: Some(squares[0].sqrt()),
        momentum_l2: Some(squares[1..=D].iter().sum::<f64>().sqrt()),
        energy_l2: Some(squares[M - 1].sqrt()),
        displacement_max: None,
    }
}

/// The largest difference of a coefficient from a uniform state, relative to the largest of that state.
fn largest_deviation<const D: usize, const M: usize>(march: &March<D, M>, exact: &State<D>) -> f64
where
    Exact<State<D>>: StateField<D, M>,
{
    let state = Exact(exact.clone()).value(&[0.0; D], 0.0);
    let nodes = march.problem.flow.layout.nodes;
    let difference = |(i, u): (usize, &f64)| (u - state[i / nodes % M]).abs();
    let largest = state.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
    march.state.u.iter().enumerate().map(difference).fold(0.0, f64::max) / largest
}

fn summary_of_mesh<const D: usize>(case: &Case<D>, books: &Books, time: f64, slabs: u64) -> Summary {
    let tally = &books.tally;
    let quality = tally.quality.map(|quality| QualitySummary {
        det_j_lower_bound: Some(quality.lower_bound),
        det_j_sampled_min: Some(quality.sampled_min),
        scaled_jacobian_min: Some(quality.scaled_jacobian),
        first_invalid_time: tally.first_invalid,
    });
    Summary {
        case: case.about.name.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        completed: true,
        reason: None,
        mesh: MeshSize { dimension: D, cells: case.mesh.n_cells(), order: case.mesh.order() },
        unknowns: Unknowns { flow: None, mesh: None },
        slabs,
        rejected_slabs: 0,
        time,
        newton: None,
        krylov: None,
        mesh_quality: quality,
        conservation: None,
        error: None,
        walls: Default::default(),
        cost: books.cost(),
    }
}

/// The mesh alone.
fn move_mesh<const D: usize, const M: usize>(case: &Case<D>, arguments: &RunArguments) -> Result<(), Failure> {
    let begun = Instant::now();
    let mover = build::mover(case).map_err(Failure::bad_input)?;
    let view = MeshMoverView::new(&mover);
    let session = Session::start(arguments, &case.about, case.output.directory.as_deref())?;
    let mesh_case = Case { flow: None, ..case.clone() };
    let (mut recorder, stored) = Recorder::<D, M>::start(&session, &mesh_case, &view, arguments.resume)?;
    let time = &case.time;
    let mut march = MeshMarch::new(mover, time.start, time.end, time.step, time.slabs);
    let mut tally = Tally::default();
    if let Some(stored) = &stored {
        let incomplete = || {
            Failure::bad_input(anyhow::anyhow!(
                "the checkpoint lacks a part of the state; start the run anew, without --resume"
            ))
        };
        march.state = checkpoint::load(stored).ok_or_else(incomplete)?.0;
        tally = Tally::from_arrays(&stored.arrays, 0).ok_or_else(incomplete)?;
    }
    let mut books = Books::new(case, arguments, &session, begun, tally, march.state.time);
    if stored.is_none() {
        let velocities = vec![0.0; march.state.d.len() * time.order];
        recorder.step(&Snapshot {
            time: time.start,
            displacement: &march.state.d,
            velocities: &velocities,
            flow: &[],
        })?;
    }
    let mut stopped = false;
    while !march.is_done() && !stopped {
        let report = march.advance().map_err(Failure::solve)?;
        books.tally.elasticity += report.iterations as u64;
        books.tally.add_quality(report.quality);
        books.tally.first_invalid = books.tally.first_invalid.or(report.first_invalid);
        recorder.history.push(&mesh_columns(report.interval, report.iterations, &report.quality))?;
        if let Some(past) =
            march.state.past.as_ref().filter(|_| report.slab % case.output.every == 0 || march.is_done())
        {
            recorder.step(&Snapshot {
                time: march.state.time,
                displacement: &march.state.d,
                velocities: &past.v,
                flow: &[],
            })?;
        }
        books.progress.mesh(report.slab, march.state.time, &report.quality);
        stopped = session.stop.is_set();
    }
    let mut state = SolverState::default();
    checkpoint::store(&march.state, None, false, &mut state);
    recorder.checkpoint(state, &books.tally)?;
    books.progress.finish();
    let mut summary = summary_of_mesh(case, &books, march.state.time, march.state.slab as u64);
    summary.completed = !stopped;
    summary.write(&session.directory)?;
    report_motion(&books, &session, march.state.time)
}

fn report_motion(books: &Books, session: &Session, time: f64) -> Result<(), Failure> {
    let Some(quality) = books.tally.quality else { return Ok(()) };
    let directory = session.directory.path().display();
    if let Some(first) = books.tally.first_invalid {
        return Err(Failure::solve(anyhow::anyhow!(
            "the mesh is not valid from t = {first} on: det J / det J_0 of cell {} falls to {:e} at t = {}; results in {directory}",
            quality.cell,
            quality.sampled_min,
            quality.time
        )));
    }
    let seconds = books.begun.elapsed().as_secs_f64();
    let MeshQuality { lower_bound, cell, time: at, .. } = quality;
    books.progress.say(&format!(
        "valid until t = {time}: det J / det J_0 >= {lower_bound:.6} proved, smallest in cell {cell} near t = {at}; {seconds:.1} s; results in {directory}"
    ));
    Ok(())
}
