//! Mesh and flow.

mod files;
mod observed;
mod steady_start;

use super::averages::{AverageSums, add_slab};
use super::bodies::is_of_body;
use super::body_record::BodyRecord;
use super::boundary_values::{not_positive, without_value};
use super::context::{RunContext, Stop};
use super::crew::{self, Crew, OfCells, Order, Orders, Own, Together, begin_averages};
use super::cuts::Due;
use super::drive::{Call, Run, drive};
use super::failure::{Failed, Finding};
use super::record::{MeshView, Stored};
use super::statistics::RunStatistics;
use super::surfaces::SurfaceFlow;
use super::walls::wall_loads;
use super::{checkpoint, controls, cuts, errors, fallback, history, restart, summary};
use crate::destination::Destination;
use crate::error::Failure;
use crate::observer::{Observer, SlabDone};
use crate::session::Session;
use basis::Rule;
use case::{Case, Flow};
use coupled::block::BodyState;
use coupled::{Counts, FlowMarch, MarchError, SlabError, SlabReport};
use fem::Layout;
use navier_stokes::{Compiled, NavierStokes};
use output::{ArraySpec, Checkpoint, OutputError, Summary};
use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Runs mesh and flow.
///
/// # Errors
/// Bad input before anything is written; a slab that cannot be solved after the last good state is written.
pub fn run_flow<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    destination: &Destination,
    observer: &dyn Observer,
    orders: &Arc<Orders>,
) -> Result<Summary, Failure>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let begun = Instant::now();
    controls::check(case)?;
    let (march, crew) = crew::start::<D, M>(case, flow, orders)?;
    let origin = match destination.is_resumed() {
        true => None,
        false => restart::read::<D, M>(case, flow, &march.solver.system.mesh.mover)?,
    };
    let call = Call { destination, observer, begun, origin };
    let mover = &march.solver.system.mesh.mover;
    let mesh = Arc::new(MeshView::new(&mover.reference, &mover.numbering));
    let (flow, surface_rule) = (Cow::Borrowed(flow), march.solver.system.flow.operator.tables.rule.clone());
    let averages = AverageSums::default();
    let mut run = FlowRun { case, flow, march, report: None, averages, crew, surface_rule };
    drive::<D, M>(case, &mut run, &mesh, call)
}

struct FlowRun<'a, const D: usize, const M: usize> {
    case: &'a Case<D>,
    /// In a split form, once a slab could not be solved without.
    flow: Cow<'a, Flow<D>>,
    /// Of the share of this rank.
    march: FlowMarch<D, M>,
    /// That of the last slab, until it is entered.
    report: Option<SlabReport<M>>,
    /// The sums of averages over the cells of this rank.
    averages: AverageSums,
    /// All ranks.
    crew: Crew,
    /// The points of distributions along walls: those of the quadrature at the start, also after a change to a split form.
    surface_rule: Rule,
}

impl<const D: usize, const M: usize> FlowRun<'_, D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    /// The layout of the flow of all cells in a slab.
    fn layout(&self) -> Layout {
        let operator = &self.march.solver.system.flow.operator;
        Layout { cells: operator.share.whole_cells(), ..operator.layout }
    }

    /// What this rank has.
    fn own(&self) -> Own<'_, D, M> {
        Own { march: &self.march, averages: &self.averages }
    }

    /// The integrals of the present flow, between two slabs.
    fn totals(&mut self) -> Vec<f64> {
        let FlowRun { crew, march, .. } = self;
        crew.all(Order::AddUp, || crew::add_up(march))
    }

    /// The walls of all bodies, by their number in the list of walls.
    fn walls_of_bodies(&self) -> Vec<usize> {
        let walls = self.flow.walls.iter().enumerate();
        walls.filter(|(_, wall)| is_of_body(self.case, wall.boundary)).map(|(number, _)| number).collect()
    }

    /// Drops the averages of a run that this one continues, if their settings or orders differ.
    fn begin_averages(&mut self) {
        let FlowRun { case, march, averages, crew, .. } = self;
        let are_other = crew.all(Order::BeginAverages, || begin_averages(case, march, averages));
        if are_other && case.averages.is_some() {
            tracing::warn!("the averages of the earlier run are others or in other orders; they begin anew");
        }
    }
}

impl<const D: usize, const M: usize> Run for FlowRun<'_, D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    fn state(&self) -> &coupled::State {
        &self.march.state
    }
    fn is_done(&self) -> bool {
        self.march.is_done()
    }
    fn advance(&mut self) -> anyhow::Result<bool> {
        self.report = self.crew.advance(self.case, &mut self.march)?;
        Ok(self.report.is_some())
    }
    fn can_fall_back(&self) -> bool {
        fallback::split_form(self.case, &self.flow).is_some()
    }
    fn falls_back_after(&self, error: &anyhow::Error) -> bool {
        let Some(MarchError { source, interval, .. }) = error.downcast_ref::<MarchError>() else { return false };
        let is_of_flow = source.is_of_flow() || matches!(source, SlabError::Guess(_));
        let (problem, mover) = ((self.case, &*self.flow), &self.march.solver.system.mesh.mover);
        let d = &self.march.state.d;
        // No other form has a solution for a boundary value that no gas has, or for none.
        is_of_flow
            && self.can_fall_back()
            && not_positive(problem, mover, d, *interval).is_none()
            && without_value(problem, mover, d, *interval).is_none()
    }
    fn awaits_start(&self, statistics: &RunStatistics) -> bool {
        self.case.solver.steady.is_some() && self.state().slab == 0 && statistics.steady.is_none()
    }
    fn begin_balances(&mut self, statistics: &mut RunStatistics) {
        let totals = self.totals();
        if let Some(eased) = &mut self.march.state.eased {
            eased.totals.clone_from(&totals);
        }
        statistics.rebase(totals);
        statistics.rebase_bodies(&self.march.bodies(), &self.walls_of_bodies());
    }

    fn velocities_at_start(&self) -> Vec<f64> {
        vec![0.0; self.state().d.len() * self.case.time.order]
    }

    fn flow_of_slab(&self, cells: Range<usize>) -> Cow<'_, [f64]> {
        self.own().flow_of_slab(|of| self.crew.numbers(self.own(), of, cells))
    }

    fn averages(&self, cells: Range<usize>) -> AverageSums {
        self.own().averages_in(|of| self.crew.numbers(self.own(), of, cells.clone()))
    }

    fn together(&self) -> Option<Together<'_>> {
        self.crew.together(self.own())
    }

    fn whole_flow_of_slab(&self) -> Option<Arc<Vec<f64>>> {
        let past = self.state().past.as_ref()?;
        if self.march.solver.system.flow.operator.share.is_whole() {
            return Some(past.u.clone());
        }
        Some(Arc::new(self.crew.numbers(self.own(), OfCells::Slab, 0..self.layout().cells).into_owned()))
    }

    fn open(&mut self, context: &mut RunContext) -> anyhow::Result<Option<Vec<f64>>> {
        // A run that continues another one does not search the steady flow again, unless that is another one, see `Start::searches_anew`.
        let row = match &self.case.solver.steady {
            Some(steady) if self.awaits_start(&context.statistics) => {
                Some(self.start_from_steady_flow(steady, context)?)
            }
            _ => None,
        };
        if row.is_none() {
            self.observe(context);
        }
        self.begin_averages();
        if context.statistics.totals_at_start.is_empty() || row.is_some() {
            context.statistics.totals_at_start = self.totals();
            let start = |state: &BodyState| BodyRecord::start(state, self.state().time);
            context.statistics.bodies = self.march.bodies().iter().map(start).collect();
        }
        Ok(row)
    }

    fn enter(&mut self, context: &mut RunContext) -> Vec<f64> {
        let Some(report) = &self.report.take() else { return Vec::new() };
        let loads = wall_loads(&self.flow, report);
        context.statistics.add(report, &loads);
        self.observe(context);
        context.observer.slab(&SlabDone {
            number: report.slab,
            time: self.state().time,
            newton: report.newton.steps.len(),
            krylov: report.newton.krylov_iterations,
            residual: report.relative_residual(),
        });
        let bodies = self.march.bodies();
        add_slab(self.case, &self.flow, &self.march, &mut self.averages);
        context.statistics.add_bodies::<D, M>(&bodies, self.state().time, &report.totals, &self.walls_of_bodies());
        let row = history::row(&self.flow, report, &loads, &bodies, &context.statistics);
        [row, self.observed(context)].concat()
    }

    fn counts(&self) -> Counts {
        self.march.solver.system.counts()
    }

    fn store(&self) -> Stored<'_> {
        let mut stored = self.crew.store(self.own());
        checkpoint::store_attempts(&mut stored.state, self.counts());
        stored
    }

    fn restore(&mut self, stored: &Checkpoint) -> Result<(), Failure> {
        self.crew.restore(self.case, &mut self.flow, stored, (&mut self.march, &mut self.averages))?;
        // The system may be another one now.
        if let Some(counts) = checkpoint::attempts(&stored.state) {
            self.march.solver.system.set_counts(counts);
        }
        Ok(())
    }

    fn summary(&mut self, context: &RunContext, stop: Option<&Stop>) -> Summary {
        let FlowRun { case, flow, march, crew, .. } = self;
        let errors = match errors::are_known(flow) {
            true => crew.all(Order::Measure, || errors::of_cells(flow, march)),
            false => Vec::new(),
        };
        let mut summary = summary::of_flow(case, flow, (march, &errors), context, stop);
        summary.cost.peak_memory_of_processes = crew.peak_memories();
        // Attempts at a slab that was never solved are not in the statistics.
        let attempts = self.counts();
        summary.cost.residual_evaluations += attempts.residuals as u64;
        summary.cost.jacobian_products += (attempts.products + attempts.mesh_products) as u64;
        summary
    }

    fn examine(&self, error: &anyhow::Error, statistics: &RunStatistics) -> Finding {
        let last = self.state_in((0..self.layout().cells).collect());
        Failed::new((self.case, &self.flow), (&self.march, &last), error, statistics).examine()
    }

    fn cut(&self, directory: &Path, due: Due) -> Result<(), OutputError> {
        let _timed = tracing::trace_span!(target: "cost", "output").entered();
        let source = |cells| self.state_in(cells);
        cuts::write::<D, M>(self.case, (&self.at_points(), &source), directory, (self.state().slab, due))
    }

    fn leave(&self, directory: &Path) -> anyhow::Result<()> {
        self.write_averages(directory)?;
        self.write_surfaces(directory, !self.averages.is_empty())
    }

    fn surfaces(&self) -> Vec<(ArraySpec, Vec<f64>)> {
        if self.listed_walls().next().is_none() {
            return Vec::new();
        }
        let mover = &self.march.solver.system.mesh.mover;
        let (top, within) = self.slab_at(|boundary| self.listed_walls().any(|wall| wall.boundary == boundary));
        let surfaces = SurfaceFlow { flow: &self.flow, mover, rule: &self.surface_rule, top, within };
        self.listed_walls().map(|wall| surfaces.of_wall::<M>(wall)).collect()
    }

    fn judge(&self, context: &RunContext, session: &Session) -> Result<(), Failure> {
        context.say_done(self.state().time, session);
        Ok(())
    }
}
