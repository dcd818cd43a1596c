//! The mesh alone, slab by slab.

use super::books::{Books, Stop};
use super::record::{MeshMoverView, Recorder, Snapshot};
use super::tally::{FirstInvalid, Tally};
use super::{build, checkpoint, history, summary};
use crate::case::Case;
use crate::cli::RunArguments;
use crate::commands::Session;
use crate::failure::Failure;
use crate::progress::rounded;
use coupled::{MeshMarch, MeshQuality, MeshReport};
use output::SolverState;
use std::time::Instant;

/// Moves the mesh over the whole run, even where cells are inverted; `command` is what the user has called.
///
/// # Errors
/// Bad input before anything is written; an invalid mesh after all is written.
pub fn move_mesh<const D: usize, const M: usize>(
    case: &Case<D>,
    arguments: &RunArguments,
    command: &str,
) -> Result<(), Failure> {
    let begun = Instant::now();
    let mover = build::mover(case).map_err(Failure::bad_input)?;
    let view = MeshMoverView::new(&mover);
    let session = Session::start(arguments, &case.about, case.output.directory.as_deref())?;
    let case = &Case { flow: None, ..case.clone() };
    let (mut recorder, stored) = Recorder::<D, M>::start(&session, case, &view, arguments.resume)?;
    let time = &case.time;
    let mut march = MeshMarch::new(mover, time.start, time.end, time.step, time.slabs);
    let tally = resume(&mut march, stored.as_ref(), case)?;
    let mut books = Books::new(time, march.state.time, arguments, &session, begun, tally);
    if stored.is_none() {
        let velocities = vec![0.0; march.state.d.len() * time.order];
        recorder.step(&snapshot(&march, &velocities))?;
    }
    let stop = move_slabs(case, &mut march, &mut recorder, &mut books, &session)?;
    recorder.checkpoint(solver_state(&march), &books.tally)?;
    books.progress.finish();
    summary::of_mesh(case, &march.mover, &march.state, &books, stop.as_ref()).write(&session.directory)?;
    match stop {
        Some(stop) => {
            let again = arguments.to_resume(command, session.directory.path());
            books.conclude(stop, march.state.time, &session, &again)
        }
        None => judge(&books, &session, march.state.time),
    }
}

/// Puts the march where the checkpoint left it.
fn resume<const D: usize>(
    march: &mut MeshMarch<D>,
    stored: Option<&SolverState>,
    case: &Case<D>,
) -> Result<Tally, Failure> {
    let Some(stored) = stored else { return Ok(Tally::default()) };
    let (state, ..) = checkpoint::load(stored, &case.time).ok_or_else(checkpoint::incomplete)?;
    if state.d.len() != march.state.d.len() {
        return Err(checkpoint::incomplete());
    }
    march.state = state;
    Tally::from_arrays(&stored.arrays, 0).ok_or_else(checkpoint::incomplete)
}

fn move_slabs<const D: usize, const M: usize>(
    case: &Case<D>,
    march: &mut MeshMarch<D>,
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
    march: &MeshMarch<D>,
    report: &MeshReport,
    recorder: &mut Recorder<D, M>,
    books: &mut Books,
) -> Result<(), Failure> {
    let MeshReport { slab, interval, iterations, quality, first_invalid, first_invalid_sampled } = report;
    let tally = &mut books.tally;
    tally.elasticity += *iterations as u64;
    tally.add_quality(*quality);
    let first_invalid = first_invalid.map(|time| FirstInvalid { time, cell: quality.cell });
    tally.first_invalid = tally.first_invalid.or(first_invalid);
    tally.first_invalid_sampled = tally.first_invalid_sampled.or(*first_invalid_sampled);
    recorder.history.push(&history::row_of_mesh(*interval, *iterations, quality))?;
    if let Some(past) = &march.state.past
        && (slab % case.output.every == 0 || march.is_done())
    {
        recorder.step(&snapshot(march, &past.v))?;
    }
    if recorder.is_checkpoint_due() {
        recorder.checkpoint(solver_state(march), &books.tally)?;
    }
    books.progress.mesh(*slab, march.state.time, quality);
    Ok(())
}

fn snapshot<'a, const D: usize>(march: &'a MeshMarch<D>, velocities: &'a [f64]) -> Snapshot<'a> {
    Snapshot { time: march.state.time, displacement: &march.state.d, velocities, flow: &[] }
}

fn solver_state<const D: usize>(march: &MeshMarch<D>) -> SolverState {
    checkpoint::store(&march.state, None, false)
}

/// Says what was proved.
fn judge(books: &Books, session: &Session, time: f64) -> Result<(), Failure> {
    let Some(quality) = books.tally.quality else { return Ok(()) };
    let directory = session.directory.path().display();
    let MeshQuality { lower_bound, sampled_min, cell, time: at, .. } = quality;
    let at = rounded(at);
    if let Some(first) = books.tally.first_invalid {
        let sampled = match books.tally.first_invalid_sampled {
            Some(time) => format!("at 2N Gauss points per direction from t = {} on", rounded(time)),
            None => "nowhere at 2N Gauss points per direction".to_owned(),
        };
        return Err(Failure::solve(anyhow::anyhow!(
            "the mesh is not valid: cell {} is inverted or nearly so from t = {} on by proof, {sampled}; det J / det J_0 falls to \
             {sampled_min:.6} in cell {cell} at t = {at}; results in {directory}",
            first.cell,
            rounded(first.time),
        )));
    }
    books.progress.say(&format!(
        "valid until t = {}: det J / det J_0 >= {lower_bound:.6} proved, smallest in cell {cell} near t = {at}; {:.1} s; results \
         in {directory}",
        rounded(time),
        books.seconds(),
    ));
    Ok(())
}
