//! Mesh and flow.

mod steady_start;

use super::averages::{AlongFiles, AverageSums, FlowAverages, PhaseFile};
use super::bodies::is_of_body;
use super::body_record::BodyRecord;
use super::context::{RunContext, Stop};
use super::crew::{Crew, Orders, look_at_last_slab};
use super::drive::{Call, Run, drive};
use super::failure::{Failed, Finding, Grid, Then, by_point};
use super::integrals::FlowIntegrals;
use super::opening_states::OpeningStates;
use super::openings;
use super::probes::FlowAtPoints;
use super::record::{MeshView, top};
use super::statistics::RunStatistics;
use super::surfaces::{self, SurfaceFlow};
use super::walls::wall_loads;
use super::{checkpoint, controls, cuts, fallback, history, restart, summary};
use crate::destination::Destination;
use crate::error::Failure;
use crate::observer::{Observer, SlabDone};
use crate::session::Session;
use basis::Rule;
use case::{Averages, Case, Flow, State, Wall};
use coupled::block::BodyState;
use coupled::{FlowMarch, MarchError, SlabError, SlabReport};
use fem::{SlabOperator, StateField};
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};
use output::{ArraySpec, OutputError, RESULT_FILE, ResultReader, Series, SolverState, Summary};
use std::borrow::Cow;
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
    let (march, crew) = Crew::<D, M>::build(case, flow, orders)?;
    let origin = match destination.is_resumed() {
        true => None,
        false => restart::read::<D, M>(case, flow, &march.solver.system.mesh.mover)?,
    };
    let call = Call { destination, observer, begun, origin: origin.as_ref() };
    let mover = &march.solver.system.mesh.mover;
    let mesh = Arc::new(MeshView::new(&mover.reference, &mover.numbering));
    let (flow, surface_rule) = (Cow::Borrowed(flow), march.solver.system.flow.operator.tables.rule.clone());
    drive::<D, M, _>(case, FlowRun { case, flow, march, crew, surface_rule }, &mesh, call)
}

struct FlowRun<'a, const D: usize, const M: usize> {
    case: &'a Case<D>,
    /// In a split form, once a slab could not be solved without.
    flow: Cow<'a, Flow<D>>,
    /// Of all cells, or of the share of this rank.
    march: FlowMarch<D, M>,
    /// The whole flow, where the mesh is cut into blocks.
    crew: Option<Crew<D, M>>,
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
    /// The operator on all cells.
    fn operator(&self) -> &SlabOperator<D, M> {
        self.crew.as_ref().map_or(&self.march.solver.system.flow.operator, |crew| &crew.operator)
    }

    /// The integrals of the present flow, between two slabs.
    fn totals(&mut self) -> Vec<f64> {
        let d = self.state().d.clone();
        let operator =
            self.crew.as_mut().map_or(&mut self.march.solver.system.flow.operator, |crew| &mut crew.operator);
        operator.set_displacement(&d);
        coupled::totals(self.operator(), &self.state().u)
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
            state: &state.u,
            time: state.time,
        }
    }

    /// The mean states at openings, the flow at the points of the case, and its integrals.
    fn observed(&self) -> Vec<f64> {
        let (state, mover) = (self.state(), &self.march.solver.system.mesh.mover);
        let (order, gas) = (self.flow.order, &self.flow.law.gas);
        let one = self.operator().layout.at_one_time();
        let integrals = FlowIntegrals::<D> {
            orders: [order, self.case.mesh.order()],
            cells: one.cells,
            positions: &|cell| mover.cell_positions(cell, &state.d),
            state: &|cell| &state.u[one.cell(cell)],
            gas,
        };
        let velocity = state.past.as_ref().map_or(&[][..], |past| top(&past.v, &state.d));
        let motion = [&state.d[..], velocity];
        let at_openings = OpeningStates { flow: &self.flow, mover, motion, state: &|cell| &state.u[one.cell(cell)] };
        let (at_openings, at_points) = (at_openings.row::<M>(), self.at_points().row::<M>(&self.case.observed.probes));
        [at_openings, at_points, integrals.values::<M>(&self.case.output.integrals)].concat()
    }

    /// Measures inflows and outflows, and reports each observation once.
    fn observe(&self, context: &mut RunContext) {
        if !self.flow.boundary.iter().any(|data| openings::is_opening(&data.condition)) {
            return;
        }
        let (state, mover, one) =
            (self.state(), &self.march.solver.system.mesh.mover, self.operator().layout.at_one_time());
        let grid = Grid::new(&mover.reference, &mover.numbering, self.flow.order);
        let still = vec![0.0; state.d.len()];
        let then = Then {
            time: state.time,
            displacement: &state.d,
            velocity: state.past.as_ref().map_or(&still[..], |past| top(&past.v, &state.d)),
            state: &|cell, _| by_point(&grid.sampler.state(&state.u[one.cell(cell)])),
        };
        let seen = openings::measure(&self.flow, &mover.reference, &grid, &then);
        for record in openings::enter(&mut context.statistics.openings, &seen, state.time) {
            let name = &self.case.mesh.boundary_names()[record.now.boundary];
            context.observer.say(&format!("warning: {}; {}", record.told(name), record.now.misuse.remedy(name)));
        }
    }

    /// Drops the averages of a run that this one continues, if their settings or orders differ.
    fn begin_averages(&self, sums: &mut AverageSums) {
        let layout = self.operator().layout;
        let fits = |wanted: &Averages| sums.fits::<D>(wanted, layout.cells, layout.nodes);
        if self.case.averages.as_ref().is_some_and(fits) {
            return;
        }
        if self.case.averages.is_some() {
            tracing::warn!("the averages of the earlier run are others or in other orders; they begin anew");
        }
        *sums = AverageSums::default();
    }

    /// Adds the last slab to the averages.
    fn average(&self, sums: &mut AverageSums) {
        if let (Some(wanted), Some(past)) = (&self.case.averages, &self.state().past) {
            let (layout, gas) = (self.operator().layout, &self.flow.law.gas);
            let mover = &self.march.solver.system.mesh.mover;
            FlowAverages { wanted, mover, layout, order: self.flow.order, gas }.add::<M>(past, sums);
        }
    }

    /// Writes the averages over phases and along axes, if the case asks for them.
    fn write_averages(&self, directory: &Path, sums: &AverageSums) -> anyhow::Result<()> {
        let Some(wanted) = &self.case.averages else { return Ok(()) };
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
        self.crew.as_ref().map_or(&self.march.state, |crew| &crew.state)
    }
    fn is_done(&self) -> bool {
        self.march.is_done()
    }
    fn advance(&mut self) -> anyhow::Result<Option<SlabReport<M>>> {
        Ok(match &mut self.crew {
            None => self.march.attempt()?,
            Some(crew) => crew.advance(self.case, &mut self.march)?,
        })
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

    fn slab_at_start(&self) -> [Vec<f64>; 2] {
        let (layout, state) = (self.operator().layout, self.state());
        let one = layout.at_one_time();
        let cell = |cell| (0..layout.time_order).flat_map(move |_| state.u[one.cell(cell)].iter().copied());
        [vec![0.0; state.d.len() * layout.time_order], (0..layout.cells).flat_map(cell).collect()]
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
        self.begin_averages(&mut context.statistics.averages);
        if context.statistics.totals_at_start.is_empty() || row.is_some() {
            context.statistics.totals_at_start = self.totals();
            let start = |state: &BodyState| BodyRecord::start(state, self.state().time);
            context.statistics.bodies = self.march.bodies().iter().map(start).collect();
        }
        Ok(row)
    }

    fn enter(&self, report: &SlabReport<M>, context: &mut RunContext) -> Vec<f64> {
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
        self.average(&mut context.statistics.averages);
        context.statistics.add_bodies::<D, M>(&bodies, self.state().time, &report.totals, &self.walls_of_bodies());
        let row = history::row(&self.flow, report, &loads, &bodies, &context.statistics);
        [row, self.observed()].concat()
    }

    fn store(&self) -> SolverState {
        let system = &self.march.solver.system;
        let preconditioner = &system.flow.preconditioner;
        let mut stored = match &self.crew {
            Some(crew) => crew.store(&self.march),
            None => checkpoint::store(&self.march.state, preconditioner.frozen(), preconditioner.stale),
        };
        checkpoint::store_attempts(&mut stored, system.counts());
        stored
    }

    fn restore(&mut self, stored: &SolverState) -> Option<()> {
        let (state, frozen, stale) = checkpoint::load(stored, &self.case.time)?;
        let (cells, march) = (self.state().u.len(), &mut self.march);
        if let Some(counts) = checkpoint::attempts(stored) {
            march.solver.system.set_counts(counts);
        }
        if state.u.len() != cells || state.d.len() != march.state.d.len() || !march.has_bodies_of(&state) {
            return None;
        }
        if let Some(crew) = &mut self.crew {
            crew.restore(self.case, &mut self.flow, stored, march)?;
            crew.state = state;
            return Some(());
        }
        fallback::follow(self.case, &mut self.flow, march, stored).ok()?;
        march.state = state;
        if let Some(frozen) = frozen {
            march.solver.system.rebuild(frozen);
        }
        march.solver.system.flow.preconditioner.stale = stale;
        Some(())
    }

    fn summary(&mut self, context: &RunContext, stop: Option<&Stop>) -> Summary {
        match &mut self.crew {
            Some(crew) => crew.look_at_last_slab(),
            // A resumed run that has nothing left to do has not been on that mesh.
            None if context.slabs == 0 => {
                look_at_last_slab(&mut self.march.solver.system.flow.operator, &self.march.state);
            }
            None => {}
        }
        let whole = summary::WholeFlow { operator: self.operator(), state: self.state(), march: &self.march };
        summary::of_flow(self.case, &self.flow, &whole, context, stop)
    }

    fn examine(&self, error: &anyhow::Error, statistics: &RunStatistics) -> Finding {
        Failed::new((self.case, &self.flow), &self.march, self.state(), error, &statistics.openings).examine()
    }

    fn cut(&self, directory: &Path, at_end: bool) -> Result<(), OutputError> {
        let _timed = tracing::trace_span!(target: "cost", "output").entered();
        cuts::write::<D, M>(self.case, &self.at_points(), directory, (self.state().slab, at_end))
    }

    fn leave(&self, directory: &Path, statistics: &RunStatistics) -> anyhow::Result<()> {
        self.write_averages(directory, &statistics.averages)?;
        self.write_surfaces(directory)
    }

    fn surfaces(&self) -> Vec<(ArraySpec, Vec<f64>)> {
        let operator = self.operator();
        let (state, one) = (self.state(), operator.layout.at_one_time());
        let still = vec![0.0; state.d.len()];
        let surfaces = SurfaceFlow {
            flow: &self.flow,
            time: state.time,
            mover: &self.march.solver.system.mesh.mover,
            displacement: &state.d,
            velocity: state.past.as_ref().map_or(&still[..], |past| top(&past.v, &state.d)),
            state: &|cell| &state.u[one.cell(cell)],
            rule: &self.surface_rule,
        };
        self.listed_walls().map(|wall| surfaces.of_wall::<M>(wall)).collect()
    }

    fn judge(&self, context: &RunContext, session: &Session) -> Result<(), Failure> {
        context.say_done(self.state().time, session);
        Ok(())
    }
}
