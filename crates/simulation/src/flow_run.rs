//! Mesh and flow.

mod steady_start;

use super::averages::{AlongFiles, AverageSums, PhaseFile, add_slab};
use super::bodies::is_of_body;
use super::body_record::BodyRecord;
use super::cells::StateInCells;
use super::context::{RunContext, Stop};
use super::crew::{self, Crew, OfCells, Order, Orders, Own, begin_averages};
use super::drive::{Call, Run, drive};
use super::failure::{Failed, Finding, Grid, Then, by_point};
use super::opening_states::OpeningStates;
use super::openings;
use super::probes::FlowAtPoints;
use super::record::{MeshView, Stored, top};
use super::statistics::RunStatistics;
use super::surfaces::{self, SurfaceFlow};
use super::walls::wall_loads;
use super::{checkpoint, controls, cuts, errors, fallback, history, integrals, restart, summary};
use crate::destination::Destination;
use crate::error::Failure;
use crate::observer::{Observer, SlabDone};
use crate::session::Session;
use basis::Rule;
use case::{Averages, Case, Flow, State, Wall};
use coupled::block::BodyState;
use coupled::{FlowMarch, MarchError, SlabError, SlabReport};
use fem::{Layout, StateField};
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};
use output::{ArraySpec, OutputError, RESULT_FILE, ResultReader, Series, SolverState, Summary};
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
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let begun = Instant::now();
    controls::check(case)?;
    let (march, crew) = crew::build::<D, M>(case, flow, orders)?;
    let origin = match destination.is_resumed() {
        true => None,
        false => restart::read::<D, M>(case, flow, &march.solver.system.mesh.mover)?,
    };
    let call = Call { destination, observer, begun, origin: origin.as_ref() };
    let mover = &march.solver.system.mesh.mover;
    let mesh = Arc::new(MeshView::new(&mover.reference, &mover.numbering));
    let (flow, surface_rule) = (Cow::Borrowed(flow), march.solver.system.flow.operator.tables.rule.clone());
    drive::<D, M, _>(
        case,
        FlowRun { case, flow, march, averages: AverageSums::default(), crew, surface_rule },
        &mesh,
        call,
    )
}

struct FlowRun<'a, const D: usize, const M: usize> {
    case: &'a Case<D>,
    /// In a split form, once a slab could not be solved without.
    flow: Cow<'a, Flow<D>>,
    /// Of the share of this rank.
    march: FlowMarch<D, M>,
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
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
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

    /// The present state in some `cells`.
    fn state_in(&self, cells: &[usize]) -> StateInCells<'_> {
        let operator = &self.march.solver.system.flow.operator;
        let len = operator.layout.time_len();
        if operator.share.is_whole() {
            return StateInCells::whole(&self.march.state.u, len);
        }
        StateInCells::some(cells, self.crew.gather(self.own(), OfCells::State, cells), len)
    }

    /// The present state in the cells at some boundaries.
    fn state_at(&self, is_wanted: impl Fn(usize) -> bool) -> StateInCells<'_> {
        let facets = self.case.mesh.boundary_facets().iter().filter(|facet| is_wanted(facet.boundary));
        let mut cells: Vec<usize> = facets.map(|facet| facet.side.cell).collect();
        cells.sort_unstable();
        cells.dedup();
        self.state_in(&cells)
    }

    /// The present state in the cells at inflows and outflows.
    fn state_at_openings(&self) -> StateInCells<'_> {
        self.state_at(|boundary| openings::is_opening(&self.flow.boundary[boundary].condition))
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

    /// The flow at the end of the slab, to be observed at points.
    fn at_points(&self) -> FlowAtPoints<'_, D> {
        let (state, mover) = (self.state(), &self.march.solver.system.mesh.mover);
        FlowAtPoints {
            flow: &self.flow,
            formulas: &self.case.observed.formulas,
            mover,
            displacement: &state.d,
            velocity: state.past.as_ref().map_or(&[][..], |past| top(&past.v, &state.d)),
            time: state.time,
        }
    }

    /// The mean states at openings, the flow at the points of the case, and its integrals.
    fn observed(&self) -> Vec<f64> {
        let (state, mover) = (self.state(), &self.march.solver.system.mesh.mover);
        let velocity = state.past.as_ref().map_or(&[][..], |past| top(&past.v, &state.d));
        let at_openings = match history::openings(&self.flow).next() {
            Some(_) => {
                let (motion, state) = ([&state.d[..], velocity], &self.state_at_openings());
                OpeningStates { flow: &self.flow, mover, motion, state }.row::<M>()
            }
            None => Vec::new(),
        };
        let at_points = match &self.case.observed.probes[..] {
            [] => Vec::new(),
            probes => self.at_points().row::<M>(probes, &|cells| self.state_in(&cells)),
        };
        [at_openings, at_points, self.integrals()].concat()
    }

    /// The integrals that the case asks for.
    fn integrals(&self) -> Vec<f64> {
        let count = self.case.output.integrals.len();
        if count == 0 {
            return Vec::new();
        }
        let of_cells = || integrals::of_run(self.case, &self.flow, &self.march);
        integrals::sums(&self.crew.all(Order::Integrate, of_cells), count)
    }

    /// Measures inflows and outflows, and reports each observation once.
    fn observe(&self, context: &mut RunContext) {
        if !self.flow.boundary.iter().any(|data| openings::is_opening(&data.condition)) {
            return;
        }
        let (state, mover, there) = (self.state(), &self.march.solver.system.mesh.mover, self.state_at_openings());
        let grid = Grid::new(&mover.reference, &mover.numbering, self.flow.order);
        let still = vec![0.0; state.d.len()];
        let then = Then {
            time: state.time,
            displacement: &state.d,
            velocity: state.past.as_ref().map_or(&still[..], |past| top(&past.v, &state.d)),
            state: &|cell, _| by_point(&grid.sampler.state(there.of(cell))),
        };
        let seen = openings::measure(&self.flow, &mover.reference, &grid, &then);
        for record in openings::enter(&mut context.statistics.openings, &seen, state.time) {
            let name = &self.case.mesh.boundary_names()[record.now.boundary];
            context.observer.say(&format!("warning: {}; {}", record.told(name), record.now.misuse.remedy(name)));
        }
    }

    /// Drops the averages of a run that this one continues, if their settings or orders differ.
    fn begin_averages(&mut self) {
        let FlowRun { case, march, averages, crew, .. } = self;
        let are_other = crew.all(Order::BeginAverages, || begin_averages(case, march, averages));
        if are_other && case.averages.is_some() {
            tracing::warn!("the averages of the earlier run are others or in other orders; they begin anew");
        }
    }

    /// The sums of averages over all cells, if something of them is written at the end.
    fn whole_averages(&self) -> Cow<'_, AverageSums> {
        if self.march.solver.system.flow.operator.share.is_whole() {
            return Cow::Borrowed(&self.averages);
        }
        Cow::Owned(self.averages(0..self.layout().cells))
    }

    /// Writes the averages over phases and along axes, if the case asks for them.
    fn write_averages(&self, directory: &Path) -> anyhow::Result<()> {
        let asked = |wanted: &&Averages| wanted.phases.is_some() || !wanted.along.is_empty();
        let Some(wanted) = self.case.averages.as_ref().filter(asked) else { return Ok(()) };
        let sums = &*self.whole_averages();
        let (mover, order) = (&self.march.solver.system.mesh.mover, self.flow.order);
        if let Some(phases) = wanted.phases {
            PhaseFile { wanted, sums, mover, order }.write(directory, phases)?;
        }
        if let Some(files) = AlongFiles::new(wanted, sums, &mover.reference, order) {
            files.write(directory)?;
        }
        Ok(())
    }

    /// Writes the distributions along walls: those of the series in the result, and last that of the present state.
    fn write_surfaces(&self, directory: &Path) -> anyhow::Result<()> {
        let (present, time) = (self.surfaces(), self.state().time);
        if present.is_empty() {
            return Ok(());
        }
        let reader = ResultReader::open(&directory.join(RESULT_FILE))?;
        let (order, rule) = (self.flow.order, &self.surface_rule);
        for (wall, (array, values)) in self.listed_walls().zip(present) {
            let stored = reader.series(&array.name)?.filter(|series| series.array == array);
            let mut series = stored.unwrap_or_else(|| Series { array, times: Vec::new(), values: Vec::new() });
            if series.times.last() != Some(&time) {
                series.times.push(time);
                series.values.extend(values);
            }
            surfaces::write(directory, D, &series, rule, order.max(self.case.mesh.order()))?;
            self.write_means(directory, wall, &series)?;
        }
        Ok(())
    }

    /// Writes the means along a wall, if the case averages over time and has distributions at several times: one alone has no mean.
    fn write_means(&self, directory: &Path, wall: &Wall<D>, series: &Series) -> anyhow::Result<()> {
        let (Some(averages), Some(_)) = (&self.case.averages, self.case.output.surfaces_every) else { return Ok(()) };
        let interval = [averages.from, averages.to.unwrap_or(f64::INFINITY)];
        let mover = &self.march.solver.system.mesh.mover;
        let curves = surfaces::curves_of(&mover.reference, &mover.numbering, wall.boundary);
        Ok(surfaces::write_means(directory, D, series, interval, &curves)?)
    }

    /// The walls with distributions.
    fn listed_walls(&self) -> impl Iterator<Item = &Wall<D>> {
        self.flow.walls.iter().filter(|wall| self.case.output.surfaces.contains(&wall.name))
    }
}

impl<const D: usize, const M: usize> Run for FlowRun<'_, D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    type Report = SlabReport<M>;

    fn state(&self) -> &coupled::State {
        &self.march.state
    }
    fn is_done(&self) -> bool {
        self.march.is_done()
    }
    fn advance(&mut self) -> anyhow::Result<Option<SlabReport<M>>> {
        self.crew.advance(self.case, &mut self.march)
    }
    fn can_fall_back(&self) -> bool {
        fallback::split_form(self.case, &self.flow).is_some()
    }
    fn falls_back_after(&self, error: &anyhow::Error) -> bool {
        let cause = error.downcast_ref::<MarchError>().map(|error| &error.source);
        let is_of_flow = cause.is_some_and(|cause| cause.is_of_flow() || matches!(cause, SlabError::Guess(_)));
        is_of_flow && self.can_fall_back()
    }
    fn awaits_start(&self, statistics: &RunStatistics) -> bool {
        self.case.solver.steady.is_some() && self.state().slab == 0 && statistics.steady.is_none()
    }
    fn begin_balances(&mut self, statistics: &mut RunStatistics) {
        let totals = self.totals();
        statistics.rebase(totals);
        statistics.rebase_bodies(&self.march.bodies(), &self.walls_of_bodies());
    }

    fn velocities_at_start(&self) -> Vec<f64> {
        vec![0.0; self.state().d.len() * self.case.time.order]
    }

    fn flow_of_slab(&self, cells: Range<usize>) -> Cow<'_, [f64]> {
        if self.state().past.is_some() {
            return self.crew.numbers(self.own(), OfCells::Slab, cells);
        }
        let layout = self.layout();
        let state = self.crew.numbers(self.own(), OfCells::State, cells);
        state.chunks_exact(layout.time_len()).flat_map(|cell| cell.repeat(layout.time_order)).collect()
    }

    fn averages(&self, cells: Range<usize>) -> AverageSums {
        let share = &self.march.solver.system.flow.operator.share;
        if share.is_whole() || self.averages.is_empty() {
            return self.averages.part(&cells, share.own.len());
        }
        let [offsets, moments] = [OfCells::AverageOffsets, OfCells::AverageMoments]
            .map(|of| self.crew.numbers(self.own(), of, cells.clone()).into_owned());
        self.averages.with_cells(offsets, moments)
    }

    fn whole_flow_of_slab(&self) -> Option<Arc<Vec<f64>>> {
        let past = self.state().past.as_ref()?;
        if self.march.solver.system.flow.operator.share.is_whole() {
            return Some(past.u.clone());
        }
        Some(Arc::new(self.crew.numbers(self.own(), OfCells::Slab, 0..self.layout().cells).into_owned()))
    }

    fn open(&mut self, context: &mut RunContext) -> anyhow::Result<Option<Vec<f64>>> {
        // A run that continues another one does not search the steady flow again, unless its orders differ.
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

    fn enter(&mut self, report: &SlabReport<M>, context: &mut RunContext) -> Vec<f64> {
        let loads = wall_loads(&self.flow, report);
        context.statistics.add(report, &loads);
        self.observe(context);
        context.observer.slab(&SlabDone {
            number: report.slab,
            time: self.state().time,
            newton: report.newton.steps.len(),
            krylov: report.newton.krylov_iterations,
            residual: report.residual_norms[1] / report.residual_norms[0].max(f64::MIN_POSITIVE),
        });
        let bodies = self.march.bodies();
        add_slab(self.case, &self.flow, &self.march, &mut self.averages);
        context.statistics.add_bodies::<D, M>(&bodies, self.state().time, &report.totals, &self.walls_of_bodies());
        let row = history::row(&self.flow, report, &loads, &bodies, &context.statistics);
        [row, self.observed()].concat()
    }

    fn store(&self) -> Stored<'_> {
        let mut stored = self.crew.store(self.own());
        checkpoint::store_attempts(&mut stored.state, self.march.solver.system.counts());
        stored
    }

    fn restore(&mut self, stored: &SolverState) -> Option<()> {
        if let Some(counts) = checkpoint::attempts(stored) {
            self.march.solver.system.set_counts(counts);
        }
        self.crew.restore(self.case, &mut self.flow, stored, (&mut self.march, &mut self.averages))
    }

    fn summary(&mut self, context: &RunContext, stop: Option<&Stop>) -> Summary {
        let FlowRun { case, flow, march, crew, .. } = self;
        let errors = match errors::are_known(flow) {
            true => crew.all(Order::Measure, || errors::of_cells(flow, march)),
            false => Vec::new(),
        };
        let mut summary = summary::of_flow(case, flow, (march, &errors), context, stop);
        summary.cost.peak_memory_of_processes = crew.peak_memories();
        summary
    }

    fn examine(&self, error: &anyhow::Error, statistics: &RunStatistics) -> Finding {
        let last = self.state_in(&(0..self.layout().cells).collect::<Vec<usize>>());
        Failed::new((self.case, &self.flow), (&self.march, &last), error, &statistics.openings).examine()
    }

    fn cut(&self, directory: &Path, at_end: bool) -> Result<(), OutputError> {
        let _timed = tracing::trace_span!(target: "cost", "output").entered();
        let source = |cells: Vec<usize>| self.state_in(&cells);
        cuts::write::<D, M>(self.case, (&self.at_points(), &source), directory, (self.state().slab, at_end))
    }

    fn leave(&self, directory: &Path) -> anyhow::Result<()> {
        self.write_averages(directory)?;
        self.write_surfaces(directory)
    }

    fn surfaces(&self) -> Vec<(ArraySpec, Vec<f64>)> {
        if self.listed_walls().next().is_none() {
            return Vec::new();
        }
        let state = self.state();
        let still = vec![0.0; state.d.len()];
        let surfaces = SurfaceFlow {
            flow: &self.flow,
            time: state.time,
            mover: &self.march.solver.system.mesh.mover,
            displacement: &state.d,
            velocity: state.past.as_ref().map_or(&still[..], |past| top(&past.v, &state.d)),
            state: &self.state_at(|boundary| self.listed_walls().any(|wall| wall.boundary == boundary)),
            rule: &self.surface_rule,
        };
        self.listed_walls().map(|wall| surfaces.of_wall::<M>(wall)).collect()
    }

    fn judge(&self, context: &RunContext, session: &Session) -> Result<(), Failure> {
        context.say_done(self.state().time, session);
        Ok(())
    }
}
