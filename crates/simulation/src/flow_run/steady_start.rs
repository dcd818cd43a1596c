//! The start of a run from the steady flow, with bodies held or in equilibrium.

use super::FlowRun;
use crate::build;
use crate::context::RunContext;
use crate::crew::{Crew, while_others_wait};
use crate::drive::Run;
use crate::history;
use crate::walls::wall_loads;
use case::{BoundaryData, Case, Flow, State, Steady, SteadyBodies, Time};
use coupled::{
    Discretisation, Equilibrium, NoEquilibrium, Reliability, Search, SlabReport, Stability, Stage, SteadyFlow,
    find_equilibrium,
};
use fem::StateField;
use navier_stokes::{Boundary, Compiled, Exact, ExactState, Manufactured, NavierStokes};
use newton_krylov::newton;

/// The length of the first slab of the search for an equilibrium, in time units of the flow.
const FIRST_SLAB: f64 = 0.1;

/// The change from slab to slab falls at least by this factor as slabs grow, so slabs need not be solved better.
const SLAB_TOLERANCE: f64 = 1e-3;

impl<const D: usize, const M: usize> FlowRun<'_, D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    /// Replaces the initial state by the steady flow; returns its row of history.csv.
    pub(super) fn start_from_steady_flow(
        &mut self,
        steady: &Steady,
        context: &mut RunContext,
    ) -> anyhow::Result<Vec<f64>> {
        let (case, flow): (_, &Flow<D>) = (self.case, &self.flow.clone());
        let ranks = self.crew.as_ref().map_or(1, Crew::ranks);
        let state = self.crew.as_mut().map_or(&mut self.march.state, |crew| {
            crew.in_step = false;
            &mut crew.state
        });
        let search = Search {
            discretise: &|discretisation| build::steady::<D, M>(case, flow, &state.d, discretisation),
            order: flow.order,
            mover: &self.march.solver.system.mesh.mover,
            displacement: &state.d,
            time: case.time.start,
            time_unit: flow.reference_length / flow.reference_speed,
            settings: steady.newton(),
            sequence: steady.sequence,
            closed: is_closed(flow),
            stability_time: steady.stability_time,
        };
        let found = while_others_wait(ranks, || search.find(&mut state.u));
        let stages = found.as_ref().map_or_else(|error| &error.stages, |flow| &flow.stages);
        stages.iter().for_each(|stage| context.observer.say(&told(stage)));
        let mut found = found?;
        if steady.bodies == SteadyBodies::Equilibrium {
            self.release_bodies(steady, context, &mut found)?;
        }
        let loads = wall_loads(&self.flow, &found.report);
        context.statistics.start_from_steady(&found, &loads);
        let SteadyFlow { report, reliability, .. } = found;
        if let Some(warning) = warning(&reliability) {
            context.observer.say(&format!("warning: {warning}"));
        }
        context.statistics.totals_at_start = report.totals.clone();
        self.observe(context);
        context.observer.say(&format!("steady flow: {:.1} s", context.seconds()));
        context.observer.begin_slabs();
        let row = history::row(&self.flow, &report, &loads, &self.march.bodies(), &context.statistics);
        Ok([row, self.observed()].concat())
    }

    /// Lets bodies and the mesh go from the steady flow that was `found` with bodies held, until all are in equilibrium.
    fn release_bodies(
        &mut self,
        steady: &Steady,
        context: &RunContext,
        found: &mut SteadyFlow<M>,
    ) -> anyhow::Result<()> {
        let (case, flow): (_, &Flow<D>) = (self.case, &self.flow.clone());
        let step = FIRST_SLAB * flow.reference_length / flow.reference_speed;
        let time = Time { order: 1, step, control: None, ..case.time };
        let mut march = build::march::<D, M>(&Case { time, ..case.clone() }, flow)?;
        march.solver.newton = newton::Settings { relative_tolerance: SLAB_TOLERANCE, ..case.solver.newton() };
        march.state.u.clone_from(&self.state().u);
        let Equilibrium { report, slabs, steps, iterations } =
            find_equilibrium(&mut march, steady.tolerance, flow.reference_length).map_err(with_cause)?;
        context
            .observer
            .say(&format!("equilibrium of flow and bodies: {slabs} slabs  newton {steps}  krylov {iterations}"));
        let discretisation = Discretisation { order: flow.order, time_order: 1, dissipative: false };
        found.stages.push(Stage { discretisation, steps, iterations, converged: true });
        // Newton's residual is that of the steady flow: the one of the last slab is relative to a slab that hardly changes anything.
        let (newton, residual_norms) = (std::mem::take(&mut found.report.newton), found.report.residual_norms);
        found.report = SlabReport { newton, residual_norms, ..report };
        let coupled::State { u, d, bodies, .. } = march.state;
        let operator =
            self.crew.as_mut().map_or(&mut self.march.solver.system.flow.operator, |crew| &mut crew.operator);
        operator.set_displacement(&d);
        // A crew takes its parts with the first slab. Before it, bodies are told from this march.
        self.march.state.bodies.clone_from(&bodies);
        let state = self.crew.as_mut().map_or(&mut self.march.state, |crew| &mut crew.state);
        (state.u, state.d, state.bodies) = (u, d, bodies);
        Ok(())
    }
}

/// The slab that could not be solved is the cause that the examination of a failure looks for.
fn with_cause(error: NoEquilibrium) -> anyhow::Error {
    let words = error.to_string();
    match error {
        NoEquilibrium::Slab { source, .. } => anyhow::Error::new(source).context(words),
        NoEquilibrium::Moves { .. } => anyhow::Error::new(error),
    }
}

/// Whether no gas can enter or leave: all boundaries are walls, and nothing adds mass.
fn is_closed<const D: usize>(flow: &Flow<D>) -> bool {
    let lets_pass =
        |data: &BoundaryData<D>| !data.condition.is_wall() && !matches!(data.condition, Boundary::Symmetry(_));
    flow.conserves_mass() && !flow.boundary.iter().any(lets_pass)
}

/// The warning about a steady flow, with the remedy.
fn warning(reliability: &Reliability) -> Option<String> {
    let stability = reliability.stability.filter(Stability::is_unstable)?;
    let seen = match stability.completed {
        true => {
            format!("within {:.3} its rate of change grew by a factor of {:.1e}", stability.duration, stability.growth)
        }
        false => format!("it failed after {:.3}, where a slab could not be solved", stability.duration),
    };
    let resolution = match reliability.next_order_residual {
        Some(residual) => format!("its residual at the next higher order is {residual:.1e} of the inertial terms"),
        None => "its residual at the next higher order cannot be evaluated".to_owned(),
    };
    let meaning = match reliability.is_resolved() {
        true => "The flow itself is unsteady: `[time]` for some periods of it",
        false => {
            "It may be a solution of the discrete equations only: a higher `flow.order` or smaller cells, until the forces agree"
        }
    };
    Some(format!("the steady flow is unstable: marched in time, {seen}; {resolution}. {meaning}"))
}

/// A solve for the steady flow, in one line.
fn told(stage: &Stage) -> String {
    let Stage { discretisation: Discretisation { order, dissipative, .. }, steps, iterations, converged } = stage;
    let flux = if *dissipative { ", dissipative flux" } else { "" };
    let end = if *converged { "" } else { "  given up" };
    format!("steady flow of order {order}{flux}: newton {steps}  krylov {iterations}{end}")
}
