//! What a run observes of its flow: inflows and outflows, points, integrals.

use super::FlowRun;
use crate::cells::{Combination, StateInCells};
use crate::context::RunContext;
use crate::crew::{OfCells, Order};
use crate::drive::Run;
use crate::failure::{Grid, Then, by_point};
use crate::opening_states::OpeningStates;
use crate::probes::FlowAtPoints;
use crate::record::top;
use crate::surfaces::FlowAt;
use crate::{history, integrals, openings};
use coupled::Past;
use fem::{Clock, ConservationLaw, TimePoint};
use navier_stokes::{Compiled, NavierStokes};

impl<const D: usize, const M: usize> FlowRun<'_, D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    /// The present state in `cells`, which may be listed twice.
    pub(super) fn state_in(&self, mut cells: Vec<usize>) -> StateInCells<'_> {
        let operator = &self.march.solver.system.flow.operator;
        let len = operator.layout.time_len();
        if operator.share.is_whole() {
            return StateInCells::whole(&self.march.state.u, len);
        }
        cells.sort_unstable();
        cells.dedup();
        StateInCells::some(&cells, self.crew.gather(self.own(), OfCells::State, &cells), len)
    }

    /// The flow of the last slab, `past`, in `cells`, which may be listed twice: `[time node][component][node]`.
    fn slab_in(&self, past: &Past, mut cells: Vec<usize>) -> StateInCells<'static> {
        let layout = self.layout();
        cells.sort_unstable();
        cells.dedup();
        let values = if self.march.solver.system.flow.operator.share.is_whole() {
            cells.iter().flat_map(|&cell| &past.u[layout.cell(cell)]).copied().collect()
        } else {
            self.crew.gather(self.own(), OfCells::Slab, &cells)
        };
        StateInCells::some(&cells, values, layout.cell_len())
    }

    /// The present state in the cells at some boundaries.
    pub(super) fn state_at(&self, is_wanted: impl Fn(usize) -> bool) -> StateInCells<'_> {
        self.state_in(self.cells_at(is_wanted))
    }

    /// The cells at some boundaries, each for every facet.
    fn cells_at(&self, is_wanted: impl Fn(usize) -> bool) -> Vec<usize> {
        let facets = self.case.mesh.boundary_facets().iter().filter(|facet| is_wanted(facet.boundary));
        facets.map(|facet| facet.side.cell).collect()
    }

    /// The present state in the cells at inflows and outflows.
    pub(super) fn state_at_openings(&self) -> StateInCells<'_> {
        self.state_at(|boundary| openings::is_opening(&self.flow.boundary[boundary].condition))
    }

    /// The flow at the end of the slab, to be observed at points.
    pub(super) fn at_points(&self) -> FlowAtPoints<'_, D> {
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

    /// Flow and mesh at some boundaries at the end of the last slab; and at the times of the slab with a share in (penalty at top), with these shares.
    pub(super) fn slab_at(&self, is_wanted: impl Fn(usize) -> bool) -> (FlowAt<'_>, Vec<(f64, FlowAt<'_>)>) {
        let state = self.state();
        let velocity = match &state.past {
            Some(past) => Combination::of_one(top(&past.v, &state.d)),
            None => Combination { factors: Vec::new(), fields: Vec::new() },
        };
        let displacement = Combination::of_one(&state.d);
        let at_top = FlowAt { time: state.time, displacement, velocity, state: self.state_at(&is_wanted) };
        // Without viscosity there is no penalty.
        let Some(past) = state.past.as_ref().filter(|_| self.flow.law.is_viscous()) else {
            return (at_top, Vec::new());
        };
        let operator = &self.march.solver.system.flow.operator;
        let clock = Clock::of_slab(past.interval.start, past.dt, operator.held_time());
        let flow = self.slab_in(past, self.cells_at(is_wanted));
        let motion: Vec<&[f64]> =
            [&past.bottom[..]].into_iter().chain(past.v.chunks_exact(past.bottom.len())).collect();
        let at = |(share, point): (f64, &TimePoint)| {
            let of_motion = |row: &[f64]| Combination { factors: row.to_vec(), fields: motion.clone() };
            let displacement = of_motion(point.position_row(past.dt).row(0));
            let (velocity, state) = (of_motion(point.velocities.row(0)), flow.at_time(point.values.row(0)));
            (share, FlowAt { time: clock.time(point.s), displacement, velocity, state })
        };
        let shares = operator.tables.shares_at_top().into_iter().zip(&operator.tables.time_points);
        (at_top, shares.filter(|(share, _)| *share != 0.0).map(at).collect())
    }

    /// The mean states at openings, the flow at the points of the case, and its integrals.
    pub(super) fn observed(&self, context: &mut RunContext) -> Vec<f64> {
        let (state, mover) = (self.state(), &self.march.solver.system.mesh.mover);
        let velocity = state.past.as_ref().map_or(&[][..], |past| top(&past.v, &state.d));
        let at_openings = match history::openings(&self.flow).next() {
            Some(_) => {
                let (motion, state) = ([&state.d[..], velocity], &self.state_at_openings());
                OpeningStates { flow: &self.flow, mover, motion, state }.row::<M>()
            }
            None => Vec::new(),
        };
        [at_openings, self.observed_at_points(context), self.integrals()].concat()
    }

    /// The flow at the points of the case. Warns of each one that the mesh has left.
    fn observed_at_points(&self, context: &mut RunContext) -> Vec<f64> {
        let (probes, flow) = (&self.case.observed.probes, self.at_points());
        if probes.is_empty() {
            return Vec::new();
        }
        let places = flow.places(probes);
        let outside = probes.iter().zip(&places).filter(|(_, place)| place.is_none());
        outside.for_each(|(probe, _)| context.warn_once_of_point(&probe.name, flow.time));
        flow.row::<M>(probes, &places, &|cells| self.state_in(cells))
    }

    /// The integrals that the case asks for.
    pub(super) fn integrals(&self) -> Vec<f64> {
        let count = self.case.output.integrals.len();
        if count == 0 {
            return Vec::new();
        }
        let of_cells = || integrals::of_run(self.case, &self.flow, &self.march);
        integrals::sums(&self.crew.all(Order::Integrate, of_cells), count)
    }

    /// Measures inflows and outflows, and reports each observation once.
    pub(super) fn observe(&self, context: &mut RunContext) {
        let is_opening = |boundary: usize| openings::is_opening(&self.flow.boundary[boundary].condition);
        // Of an earlier run with other conditions.
        context.statistics.openings.retain(|record| is_opening(record.now.boundary));
        if !(0..self.flow.boundary.len()).any(is_opening) {
            return;
        }
        let (state, mover, there) = (self.state(), &self.march.solver.system.mesh.mover, self.state_at_openings());
        let grid = Grid::new(&mover.reference, &mover.numbering, self.flow.order);
        let still = vec![0.0; state.d.len()];
        let then = Then {
            time: state.time,
            displacement: &state.d,
            velocity: state.past.as_ref().map_or(&still[..], |past| top(&past.v, &state.d)),
            state: &|cell, _| by_point::<M>(&grid.sampler.state(there.of(cell))),
        };
        let seen = openings::measure(&self.flow, &mover.reference, &grid, &then);
        for record in openings::enter(&mut context.statistics.openings, &seen, state.time) {
            let name = &self.case.mesh.boundary_names()[record.now.boundary];
            tracing::warn!("{}; {}", record.told(name), record.now.misuse.remedy(name));
        }
    }
}
