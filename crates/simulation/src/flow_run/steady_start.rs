//! The start of a run from the steady flow, with bodies held or in equilibrium.

use super::FlowRun;
use crate::body_checks::unheld_in_equilibrium;
use crate::context::RunContext;
use crate::crew::Order;
use crate::history;
use crate::steady_search;
use crate::walls::wall_loads;
use case::{State, Steady, SteadyBodies};
use coupled::{Discretisation, Equilibrium, Reliability, SlabReport, Stability, Stage, SteadyFlow};
use fem::StateField;
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};

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
        let (case, flow, march) = (self.case, &*self.flow, &mut self.march);
        let search = || steady_search::search(case, flow, steady, march);
        let found = self.crew.all(Order::SearchSteadyFlow, search);
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
        let (case, flow, march) = (self.case, &*self.flow, &mut self.march);
        unheld_in_equilibrium(case).iter().for_each(|text| context.observer.say(&format!("warning: {text}")));
        let release = || steady_search::release_bodies(case, flow, steady, march);
        let Equilibrium { report, slabs, steps, iterations } = self.crew.all(Order::ReleaseBodies, release)?;
        context
            .observer
            .say(&format!("equilibrium of flow and bodies: {slabs} slabs  newton {steps}  krylov {iterations}"));
        let discretisation = Discretisation { order: flow.order, time_order: 1, dissipative: false };
        found.stages.push(Stage { discretisation, steps, iterations, converged: true });
        // Newton's residual is that of the steady flow: the one of the last slab is relative to a slab that hardly changes anything.
        let (newton, residual_norms) = (std::mem::take(&mut found.report.newton), found.report.residual_norms);
        found.report = SlabReport { newton, residual_norms, ..report };
        Ok(())
    }
}

/// The warning about a steady flow, with the remedy.
fn warning(reliability: &Reliability) -> Option<String> {
    let stability = reliability.stability.filter(Stability::is_unstable)?;
    let seen = match stability.completed {
        true => {
            format!("within {:.2e} its rate of change grew by a factor of {:.1e}", stability.duration, stability.growth)
        }
        false => format!("it failed after {:.2e}, where a slab could not be solved", stability.duration),
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
