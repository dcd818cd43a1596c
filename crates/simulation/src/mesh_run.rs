//! The mesh alone.

use super::context::{RunContext, Stop};
use super::drive::{Call, Run, drive};
use super::failure::{self, FailureReport, Finding, examine_inverted, examine_mesh};
use super::record::{MeshView, Stored};
use super::statistics::FirstInvalid;
use super::{build, checkpoint, history, summary};
use crate::destination::Destination;
use crate::error::Failure;
use crate::observer::{NextStep, Observer};
use crate::session::Session;
use case::rounded_time;
use case::{Case, Observed};
use coupled::{MeshMarch, MeshQuality, MeshReport};
use output::{Checkpoint, Summary};
use std::sync::Arc;
use std::time::Instant;

/// Moves the mesh over the whole run, even where cells are inverted.
///
/// # Errors
/// Bad input before anything is written; an invalid mesh after everything is written.
pub fn move_mesh<const D: usize, const M: usize>(
    case: &Case<D>,
    destination: &Destination,
    observer: &dyn Observer,
) -> Result<Summary, Failure> {
    let call = Call { destination, observer, begun: Instant::now(), origin: None };
    if case.flow.is_none() && case.structure.is_some() {
        let problem = "the case is a structure: there is no mesh motion to look at; use `stsolve run`";
        return Err(Failure::bad_input(anyhow::anyhow!(problem)));
    }
    let moved_by_flow = case.is_moved_by_flow();
    if moved_by_flow && build::prescribed_nodes(case).is_empty() && build::nodes_of_driven_bodies(case).is_empty() {
        let problem = "only the flow moves this mesh: there is no motion to look at without it; use `stsolve run`";
        return Err(Failure::bad_input(anyhow::anyhow!(problem)));
    }
    let mover = build::mover_without_flow(case).map_err(Failure::bad_input)?;
    let mesh = Arc::new(MeshView::new(&mover.reference, &mover.numbering));
    let (averages, observed) = match &case.flow {
        // Nothing else would be written of the flow than NaN.
        Some(_) => (None, Observed::default()),
        None => (case.averages.clone(), case.observed.clone()),
    };
    let case = &Case { flow: None, structure: None, averages, observed, ..case.clone() };
    let march = MeshMarch::new(mover, case.time.schedule(), case.solver.slab_halvings as u32);
    drive::<D, M>(case, &mut MeshRun { case, march, report: None, moved_by_flow, inverted: None }, &mesh, call)
}

struct MeshRun<'a, const D: usize> {
    case: &'a Case<D>,
    march: MeshMarch<D>,
    /// That of the last slab, until it is entered.
    report: Option<MeshReport>,
    /// Whether the flow moves bodies or structures, which rest here.
    moved_by_flow: bool,
    /// The first slab in which a cell is inverted.
    inverted: Option<Inverted>,
}

/// A slab in which a cell is inverted.
struct Inverted {
    finding: Finding,
    /// Time at its bottom.
    start: f64,
    /// Slabs done before it.
    slabs: usize,
}

impl<const D: usize> Run for MeshRun<'_, D> {
    fn state(&self) -> &coupled::State {
        &self.march.state
    }
    fn is_done(&self) -> bool {
        self.march.is_done()
    }
    fn advance(&mut self) -> anyhow::Result<bool> {
        let report = self.march.advance()?;
        if report.first_invalid.is_some() && self.inverted.is_none() {
            let (start, slabs, march) = (report.interval.start, report.slab - 1, &self.march);
            let finding = examine_inverted(self.case, &march.solver.mover, &march.state, &report);
            self.inverted = finding.map(|finding| Inverted { finding, start, slabs });
        }
        self.report = Some(report);
        Ok(true)
    }
    fn velocities_at_start(&self) -> Vec<f64> {
        vec![0.0; self.march.state.d.len() * self.case.time.order]
    }

    fn enter(&mut self, context: &mut RunContext) -> Vec<f64> {
        let Some(report) = &self.report.take() else { return Vec::new() };
        let MeshReport { slab, interval, rejected, work, quality, first_invalid, first_invalid_sampled } = report;
        let statistics = &mut context.statistics;
        statistics.rejected += *rejected as u64;
        statistics.elasticity += work.iterations as u64;
        statistics.add_quality(*quality);
        let first_invalid = first_invalid.map(|time| FirstInvalid { time, cell: quality.cell });
        statistics.first_invalid = statistics.first_invalid.or(first_invalid);
        statistics.first_invalid_sampled = statistics.first_invalid_sampled.or(*first_invalid_sampled);
        context.observer.mesh_slab(*slab, self.march.state.time, quality);
        history::row_of_mesh(*interval, work.iterations, quality)
    }

    fn store(&self) -> Stored<'_> {
        checkpoint::store(&self.march.state, None, false).into()
    }

    fn restore(&mut self, stored: &Checkpoint) -> Result<(), Failure> {
        // The slabs of a mesh alone are not adapted.
        let time = case::Time { control: None, ..self.case.time };
        checkpoint::restore(&mut self.march.state, &stored.whole()?, &time).ok_or_else(checkpoint::incomplete)
    }

    fn summary(&mut self, context: &RunContext, stop: Option<&Stop>) -> Summary {
        summary::of_mesh(self.case, &self.march.solver.mover, &self.march.state, context, stop)
    }

    fn examine(&self, error: &anyhow::Error, _: &super::statistics::RunStatistics) -> Finding {
        examine_mesh(self.case, &self.march.solver.mover, &self.march.state, error)
    }

    fn judge(&self, context: &RunContext, session: &Session) -> Result<(), Failure> {
        let Some(quality) = context.statistics.quality else { return Ok(()) };
        match context.statistics.first_invalid {
            Some(first) => Err(self.invalid(first, &quality, context, session)),
            None => {
                say_valid(&quality, self.march.state.time, self.moved_by_flow, context, session);
                Ok(())
            }
        }
    }
}

impl<const D: usize> MeshRun<'_, D> {
    /// The failure of a mesh that is invalid from `first` on, after the failure report is written.
    fn invalid(&self, first: FirstInvalid, quality: &MeshQuality, context: &RunContext, session: &Session) -> Failure {
        let (MeshQuality { sampled_min, cell, time, .. }, directory) = (quality, session.directory.path());
        let sampled = match context.statistics.first_invalid_sampled {
            Some(time) => format!("at 2N Gauss points per direction from t = {} on", rounded_time(time)),
            None => "nowhere at 2N Gauss points per direction".to_owned(),
        };
        let error = anyhow::anyhow!(
            "the mesh is not valid: cell {} is inverted or nearly so from t = {} on by proof, {sampled}; over the whole run \
             det J / det J_0 falls to {sampled_min:.6}, in cell {cell} at t = {}; results in {}",
            first.cell,
            rounded_time(first.time),
            rounded_time(*time),
            directory.display()
        );
        // After a resume, the first slab that was seen inverted may be a later one: the report of the earlier one stays.
        let of_first = self.inverted.as_ref().filter(|inverted| inverted.start <= first.time);
        let Some(Inverted { finding, start, slabs }) = of_first else { return Failure::solve(error) };
        let case = &self.case.about.name;
        let report = FailureReport { case, error: &error, time: rounded_time(*start), slabs: *slabs, again: None };
        let hint = failure::tell(directory, finding, &report);
        Failure::solve(anyhow::anyhow!("{error}{hint}"))
    }
}

/// Reports the proof up to `time`.
fn say_valid(quality: &MeshQuality, time: f64, moved_by_flow: bool, context: &RunContext, session: &Session) {
    let directory = session.directory.path();
    let held = if moved_by_flow { ", while all that the flow moves rests" } else { "" };
    context.observer.say(&format!(
        "valid until t = {}{held}: det J / det J_0 >= {:.6} proved, smallest in cell {} near t = {}; {:.1} s; results in {}; {}",
        rounded_time(time),
        quality.lower_bound,
        quality.cell,
        rounded_time(quality.time),
        context.seconds(),
        directory.display(),
        session.observer.advice(NextStep::Report, directory),
    ));
}
