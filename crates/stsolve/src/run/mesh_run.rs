//! The mesh alone.

use super::books::{Books, Stop};
use super::drive::{Call, Run, drive};
use super::failure::{Finding, examine_mesh};
use super::record::MeshView;
use super::tally::FirstInvalid;
use super::{build, checkpoint, history, summary};
use crate::case::Case;
use crate::cli::RunArguments;
use crate::commands::Session;
use crate::failure::Failure;
use crate::progress::rounded;
use coupled::{MeshMarch, MeshQuality, MeshReport};
use output::{SolverState, Summary};
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
    let call = Call { arguments, command, begun: Instant::now(), origin: None };
    if case.structure.is_some() {
        let problem = "the case is a structure: there is no mesh motion to look at; use `stsolve run`";
        return Err(Failure::bad_input(anyhow::anyhow!(problem)));
    }
    let mover = build::mover(case).map_err(Failure::bad_input)?;
    let mesh = MeshView::new(&mover.reference, &mover.numbering);
    let case = &Case { flow: None, ..case.clone() };
    let march = MeshMarch::new(mover, case.time.schedule(), case.solver.slab_halvings as u32);
    drive::<D, M, _>(case, MeshRun { case, march }, &mesh, call)
}

struct MeshRun<'a, const D: usize> {
    case: &'a Case<D>,
    march: MeshMarch<D>,
}

impl<const D: usize> Run for MeshRun<'_, D> {
    type Report = MeshReport;

    fn state(&self) -> &coupled::State {
        &self.march.state
    }
    fn is_done(&self) -> bool {
        self.march.is_done()
    }
    fn advance(&mut self) -> anyhow::Result<MeshReport> {
        Ok(self.march.advance()?)
    }
    fn slab_at_start(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![0.0; self.march.state.d.len() * self.case.time.order], Vec::new())
    }

    fn enter(&self, report: &MeshReport, books: &mut Books) -> Vec<f64> {
        let MeshReport { slab, interval, rejected, work, quality, first_invalid, first_invalid_sampled } = report;
        let tally = &mut books.tally;
        tally.rejected += *rejected as u64;
        tally.elasticity += work.iterations as u64;
        tally.add_quality(*quality);
        let first_invalid = first_invalid.map(|time| FirstInvalid { time, cell: quality.cell });
        tally.first_invalid = tally.first_invalid.or(first_invalid);
        tally.first_invalid_sampled = tally.first_invalid_sampled.or(*first_invalid_sampled);
        books.progress.mesh(*slab, self.march.state.time, quality);
        history::row_of_mesh(*interval, work.iterations, quality)
    }

    fn store(&self) -> SolverState {
        checkpoint::store(&self.march.state, None, false)
    }

    fn restore(&mut self, stored: &SolverState) -> Option<()> {
        let (state, ..) = checkpoint::load(stored, &self.case.time)?;
        let fits = state.d.len() == self.march.state.d.len();
        self.march.state = state;
        fits.then_some(())
    }

    fn summary(&self, books: &Books, stop: Option<&Stop>) -> Summary {
        summary::of_mesh(self.case, &self.march.mover, &self.march.state, books, stop)
    }

    fn examine(&self, error: &anyhow::Error) -> Option<Finding> {
        Some(examine_mesh(self.case, &self.march.mover, &self.march.state, error))
    }

    fn judge(&self, books: &Books, session: &Session) -> Result<(), Failure> {
        judge(books, session, self.march.state.time)
    }
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
         in {directory}; {}",
        rounded(time),
        books.seconds(),
        RunArguments::to_report(session.directory.path()),
    ));
    Ok(())
}
