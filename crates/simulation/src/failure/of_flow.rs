//! The examination of a failed run of mesh and flow.

use super::super::openings::Record;
use super::super::statistics::RunStatistics;
use super::data::{Attempt, Bodies, FailureData, FlowStart, Gas, GaveUp, Newton, OpeningMisuse, Settling};
use super::finding::{Finding, WorstCell, WorstCellCause};
use super::gas::{CellGas, Measured, Then, measure};
use super::grid::Grid;
use super::of_bodies;
use super::of_mesh::{self, inverted};
use crate::body_checks::unheld;
use crate::boundary_values::{not_positive, without_value};
use crate::build::nodes_of_driven_bodies;
use crate::cells::StateInCells;
use case::{Case, Flow, Preconditioner, State, Steady, SteadyBodies};
use coupled::{
    FlowMarch, Interval, MarchError, MeshMover, RELATIVE_DETERMINANT, ResidualBreakdown, SlabError, SteadyError,
};
use elasticity::{ElasticityError, VOLUME_RATIO};
use navier_stokes::ExactState;
use newton_krylov::newton;
use newton_krylov::problem::Inadmissible;
use std::error::Error;

/// A failed run of mesh and flow.
pub struct Failed<'a, const D: usize, const M: usize> {
    case: &'a Case<D>,
    flow: &'a Flow<D>,
    march: &'a FlowMarch<D, M>,
    /// The last good state, and the flow in all cells then.
    state: &'a coupled::State,
    last: &'a StateInCells<'a>,
    error: Option<&'a SlabError>,
    /// The failed search for a steady flow, if it was that.
    steady: Option<&'a SteadyError>,
    interval: Interval,
    statistics: &'a RunStatistics,
}

/// The gas at the start, by the case, and in the last good state.
struct Gases {
    start: Measured,
    last: Measured,
}

impl<'a, const D: usize, const M: usize> Failed<'a, D, M> {
    /// The run of `case` that stopped with `error`.
    pub fn new(
        (case, flow): (&'a Case<D>, &'a Flow<D>),
        (march, last): (&'a FlowMarch<D, M>, &'a StateInCells<'a>),
        error: &'a anyhow::Error,
        statistics: &'a RunStatistics,
    ) -> Self {
        let state = &march.state;
        let here = Interval { start: state.time, end: state.time, halvings: 0 };
        let failed =
            |error, steady, interval| Failed { case, flow, march, state, last, error, steady, interval, statistics };
        match (error.downcast_ref::<MarchError>(), error.downcast_ref::<SteadyError>()) {
            (Some(march), _) => failed(Some(&march.source), None, march.interval),
            (None, Some(steady)) => failed(Some(&steady.source), Some(steady), here),
            (None, None) => failed(None, None, here),
        }
    }

    /// Examines the failure.
    pub fn examine(&self) -> Finding {
        let grid = Grid::new(&self.mover().reference, &self.mover().numbering, self.flow.order);
        let (gases, d) = (self.gases(&grid), &self.state.d);
        let Interval { start, end, halvings } = self.interval;
        let attempt = Attempt {
            steady: self.steady.is_some(),
            released: self.is_released(),
            slabs_done: self.state.slab,
            start,
            length: end - start,
            halvings,
            halvings_used_up: halvings as usize >= self.case.solver.slab_halvings,
        };
        let mut mesh = of_mesh::mesh(self.case, self.mover(), &grid, d, self.interval);
        if let Some(SlabError::Invalid { quality }) = self.error {
            mesh.smallest_det_j = quality.sampled_min;
        }
        if let Some(value) = self.inadmissible(RELATIVE_DETERMINANT) {
            mesh.smallest_det_j = value;
        }
        Finding {
            cell: self.worst_cell(&grid, &gases),
            residuals: self.residual_breakdown().map_or_else(Vec::new, per_equation::<D>),
            data: FailureData {
                gave_up: self.gave_up(),
                attempt,
                newton: self.newton_error().map(|error| self.newton(error)),
                mesh,
                gas: Some(self.gas(&grid, &gases)),
                structure: None,
                bodies: self.bodies(&grid),
            },
        }
    }

    /// Whether the steady flow with bodies held was found, but not yet their equilibrium.
    fn is_released(&self) -> bool {
        let releases = |steady: &Steady| steady.bodies == SteadyBodies::Equilibrium;
        let is_before_slabs = self.steady.is_none() && self.statistics.steady.is_none() && self.state.slab == 0;
        is_before_slabs && self.case.solver.steady.as_ref().is_some_and(releases)
    }

    fn bodies(&self, grid: &Grid<D>) -> Option<Bodies> {
        let dt = self.interval.length();
        let bodies = of_bodies::measure(self.case, self.flow, grid, self.state, dt)?;
        let unheld = if self.is_released() { unheld(self.case) } else { None };
        Some(Bodies { unheld, inverted: self.inadmissible(VOLUME_RATIO), ..bodies })
    }

    /// The value of `quantity` in the state without a residual at which the solve ended, if it was that.
    fn inadmissible(&self, quantity: &str) -> Option<f64> {
        let first: &(dyn Error + 'static) = self.error?;
        let mut chain = anyhow::Chain::new(first);
        let found = chain.find_map(|error| error.downcast_ref::<Inadmissible>())?;
        (found.quantity == quantity).then_some(found.value)
    }

    fn mover(&self) -> &'a MeshMover<D> {
        &self.march.solver.system.mesh.mover
    }

    fn newton_error(&self) -> Option<&'a newton::Error> {
        match self.error {
            Some(SlabError::Newton { source, .. }) => Some(source),
            _ => None,
        }
    }

    fn residual_breakdown(&self) -> Option<&'a ResidualBreakdown> {
        match self.error {
            Some(SlabError::Newton { residual_breakdown, .. }) => residual_breakdown.as_deref(),
            _ => None,
        }
    }

    fn gave_up(&self) -> GaveUp {
        match self.error {
            None | Some(SlabError::FullTurn { .. } | SlabError::EnergyGain { .. } | SlabError::Stopped) => {
                GaveUp::Other
            }
            Some(SlabError::Mesh(_)) => GaveUp::Equilibrium,
            Some(SlabError::Structure(ElasticityError::Load { .. })) => GaveUp::Load,
            Some(SlabError::Structure(_)) => GaveUp::Structure,
            Some(SlabError::Invalid { .. }) => GaveUp::InvertedCell,
            Some(SlabError::Guess(_) | SlabError::Top(_)) => GaveUp::Inadmissible,
            Some(SlabError::Newton { source, .. }) => match **source {
                newton::Error::Inadmissible { .. } => GaveUp::Inadmissible,
                newton::Error::Krylov { .. } => GaveUp::LinearSolver,
                _ => GaveUp::Newton,
            },
        }
    }

    fn newton(&self, error: &newton::Error) -> Newton {
        let (solver, report) = (&self.case.solver, error.report());
        let (steps_allowed, krylov_allowed) = match solver.steady.as_ref().filter(|_| self.steady.is_some()) {
            Some(steady) => (steady.steps, steady.krylov_iterations),
            None => (solver.newton_steps, solver.krylov_iterations),
        };
        let unfinished = report.steps.iter().filter(|step| step.krylov_iterations >= krylov_allowed).count();
        Newton {
            residuals: report.residual_history(),
            round_off: report.round_off,
            steps_allowed,
            steps_used_up: matches!(error, newton::Error::MaxSteps { .. }),
            unfinished_linear_solves: unfinished as f64 / report.steps.len().max(1) as f64,
            krylov_allowed,
            has_blocks: self.case.preconditioner() == Preconditioner::Blocks,
            settling: self.steady.and_then(|steady| steady.settling.as_ref()).map(seen),
        }
    }

    fn gases(&self, grid: &Grid<D>) -> Gases {
        let time = self.case.time.start;
        let displacement = self.mover().displacement_at_start(time);
        let start = Then {
            time,
            displacement: &displacement,
            velocity: &self.velocity_of_walls(time),
            state: &|_, x| x.iter().map(|x| self.flow.initial.state(x, time)).collect(),
        };
        let measured = |then: &Then<D, M>| measure(self.flow, &self.case.mesh, grid, then);
        Gases { start: measured(&start), last: self.with_last(grid, measured) }
    }

    /// Evaluates `question` for the last good state.
    fn with_last<T>(&self, grid: &Grid<D>, question: impl Fn(&Then<D, M>) -> T) -> T {
        let state = self.state;
        question(&Then {
            time: state.time,
            displacement: &state.d,
            velocity: &self.velocity_of_walls(state.time),
            state: &|cell, _| by_point(&grid.sampler.state(self.last.of(cell))),
        })
    }

    /// The velocity at time `t`, `[C0 node][component]`, that prescribed motions give the walls, those of bodies included.
    fn velocity_of_walls(&self, t: f64) -> Vec<f64> {
        let mut v = rate(self.mover(), t, self.case.time.step);
        for (node, x, field) in nodes_of_driven_bodies(self.case) {
            v[node * D..(node + 1) * D].copy_from_slice(&field.velocity(node, &x, t));
        }
        v
    }

    fn gas(&self, grid: &Grid<D>, gases: &Gases) -> Gas {
        let (flow, law) = (self.flow, &self.flow.law);
        let orders = fem::Orders { flow: flow.order, mesh: self.case.mesh.order(), time: self.case.time.order };
        let dt = self.interval.length();
        let nodes = |cell: usize| grid.thickness(cell, &self.state.d) / (flow.order - 1) as f64;
        let most = |value: &dyn Fn(&CellGas, f64) -> f64| {
            let cells = gases.last.cells.iter().enumerate();
            cells.map(|(cell, gas)| value(gas, nodes(cell))).fold(0.0, f64::max)
        };
        let viscous = law.gas.viscosity() != navier_stokes::Viscosity::Inviscid;
        let points = flow.quadrature.space_points(D, orders);
        let needed = match flow.quadrature.conserves(D, orders) {
            true => points,
            false => fem::Quadrature::Conserving.space_points(D, orders),
        };
        Gas {
            at_start: gases.start.moment.clone(),
            last: gases.last.moment.clone(),
            waves_per_slab: most(&|gas, distance| gas.fastest * dt / distance),
            cell_reynolds: viscous.then(|| most(&|gas, distance| gas.reynolds * distance)),
            quadrature: [points, needed],
            mach: most(&|gas, _| gas.mach),
            captures_shocks: law.shock_capturing.is_some(),
            order: self.flow.order,
            is_split: law.volume_flux.is_split(),
            openings: self.statistics.openings.iter().map(|record| self.opening(record)).collect(),
            kick: gases.start.kick,
            start: self.flow_start(),
            not_positive: not_positive((self.case, flow), self.mover(), &self.state.d, self.interval),
            without_value: without_value((self.case, flow), self.mover(), &self.state.d, self.interval),
        }
    }

    fn flow_start(&self) -> FlowStart {
        match &self.flow.initial {
            _ if self.case.restart.is_some() => FlowStart::OtherRun,
            _ if self.case.solver.steady.is_some() => FlowStart::SteadyFlow,
            State::Uniform(_) => FlowStart::UniformStream,
            _ => FlowStart::OtherState,
        }
    }

    fn opening(&self, record: &Record) -> OpeningMisuse {
        let boundary = self.case.mesh.boundary_names()[record.now.boundary].clone();
        OpeningMisuse { record: *record, told: record.told(&boundary).to_string(), boundary }
    }

    /// The inverted cell, or else the cell with the largest residual, or else the cell with the lowest density.
    fn worst_cell(&self, grid: &Grid<D>, gases: &Gases) -> Option<WorstCell> {
        match self.error? {
            SlabError::Mesh(_) | SlabError::Structure(_) => None,
            SlabError::FullTurn { .. } | SlabError::EnergyGain { .. } | SlabError::Stopped => None,
            SlabError::Invalid { quality } => Some(inverted(grid, &self.displacement_at(quality.time), quality)),
            SlabError::Newton { residual_breakdown: Some(residual_breakdown), .. } => {
                self.unsolved_cell(grid, residual_breakdown)
            }
            SlabError::Newton { .. } | SlabError::Guess(_) | SlabError::Top(_) => Some(self.thinnest_cell(grid, gases)),
        }
    }

    fn unsolved_cell(&self, grid: &Grid<D>, residual_breakdown: &ResidualBreakdown) -> Option<WorstCell> {
        let cell = residual_breakdown.worst_cell()?;
        let because = format!("its residual is {:.3e}, the largest", residual_breakdown.cells[cell]);
        let values = |cell: usize| vec![residual_breakdown.cells[cell].log10(); grid.points.pow(D as u32)];
        let cause = WorstCellCause { cell, because, quantity: "log10 of the residual of the flow", values: &values };
        Some(WorstCell::new(grid, &self.state.d, cause))
    }

    fn thinnest_cell(&self, grid: &Grid<D>, gases: &Gases) -> WorstCell {
        let lowest = gases.last.moment.lowest;
        let because = format!("the {} is lowest there, {:.3e} of its mean", lowest.quantity, lowest.value);
        let pressure = |then: &Then<D, M>, cell| {
            then.gas(&self.flow.law.gas, grid, cell).iter().map(|state| state.pressure).collect()
        };
        let values = |cell: usize| self.with_last(grid, |then| pressure(then, cell));
        let cause = WorstCellCause { cell: lowest.cell, because, quantity: "pressure", values: &values };
        WorstCell::new(grid, &self.state.d, cause)
    }

    /// The displacement of the last attempt at time `t`.
    fn displacement_at(&self, t: f64) -> Vec<f64> {
        let (bottom, v) = (&self.state.d, self.march.solver.system.mesh.velocities());
        let mut d = bottom.clone();
        let dt = self.interval.length();
        if v.iter().all(|v| v.is_finite()) && dt > 0.0 {
            self.mover().slab_motion.displacement(dt, bottom, v, (t - self.interval.start) / dt, &mut d);
        }
        d
    }
}

/// As failure data.
fn seen(settling: &coupled::Settling) -> Settling {
    let coupled::Settling { early, late, duration } = *settling;
    Settling { early, late, duration, calms_down: settling.calms_down(), is_unsteady: settling.is_unsteady() }
}

/// The rate of the prescribed displacement at time `t`, by a forward difference over a millionth of a `step`.
fn rate<const D: usize>(mover: &MeshMover<D>, t: f64, step: f64) -> Vec<f64> {
    let ahead = 1e-6 * step;
    let (mut now, mut then) = (vec![0.0; mover.field_len()], vec![0.0; mover.field_len()]);
    mover.prescribed(t, &mut now);
    mover.prescribed(t + ahead, &mut then);
    then.iter().zip(&now).map(|(then, now)| (then - now) / ahead).collect()
}

/// `[component][point]` as `[point][component]`.
pub fn by_point<const M: usize>(state: &[f64]) -> Vec<[f64; M]> {
    let points = state.len() / M;
    (0..points).map(|p| std::array::from_fn(|m| state[m * points + p])).collect()
}

/// The equations and their residuals.
fn per_equation<const D: usize>(residual_breakdown: &ResidualBreakdown) -> Vec<(&'static str, f64)> {
    let momentum = ["momentum along x", "momentum along y", "momentum along z"];
    let names = ["mass"].into_iter().chain(momentum.into_iter().take(D)).chain(["energy"]);
    let mesh = residual_breakdown.mesh.map(|norm| ("equilibrium of the mesh", norm));
    mesh.into_iter().chain(names.zip(residual_breakdown.equations.iter().copied())).collect()
}
