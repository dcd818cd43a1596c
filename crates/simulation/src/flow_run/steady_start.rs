//! The start of a run from the steady flow, with bodies held or in equilibrium.

use super::FlowRun;
use crate::context::RunContext;
use crate::crew::Order;
use crate::history;
use crate::steady_search::{self, Found};
use crate::walls::wall_loads;
use case::Steady;
use coupled::{Discretisation, Equilibrium, Reliability, SlabReport, Stability, Stage, SteadyFlow};
use navier_stokes::{Compiled, NavierStokes};

impl<const D: usize, const M: usize> FlowRun<'_, D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    /// Replaces the initial state by the steady flow; returns its row of history.csv.
    pub(super) fn start_from_steady_flow(
        &mut self,
        steady: &Steady,
        context: &mut RunContext,
    ) -> anyhow::Result<Vec<f64>> {
        let (case, flow, march) = (self.case, &*self.flow, &mut self.march);
        let search = || steady_search::find(case, flow, steady, march, context.observer);
        let found = self.crew.all(Order::SearchSteadyFlow, search)?;
        let found = self.with_equilibrium(found, context);
        let loads = wall_loads(&self.flow, &found.report);
        context.statistics.start_from_steady(&found, &loads);
        let SteadyFlow { report, reliability, .. } = found;
        if let Some(warning) = warning(&reliability) {
            tracing::warn!("{warning}");
        }
        context.statistics.totals_at_start = report.totals.clone();
        self.observe(context);
        context.observer.say(&format!("steady flow: {:.1} s", context.seconds()));
        context.observer.begin_slabs();
        let row = history::row(&self.flow, &report, &loads, &self.march.bodies(), &context.statistics);
        Ok([row, self.observed(context)].concat())
    }

    /// The steady flow with the loads of the equilibrium, if bodies were released.
    fn with_equilibrium(&self, Found { mut flow, equilibrium }: Found<M>, context: &RunContext) -> SteadyFlow<M> {
        let Some(Equilibrium { report, slabs, steps, iterations }) = equilibrium else { return flow };
        context
            .observer
            .say(&format!("equilibrium of flow and bodies: {slabs} slabs  newton {steps}  krylov {iterations}"));
        let discretisation = Discretisation { order: self.flow.order, time_order: 1, dissipative: false };
        flow.stages.push(Stage { discretisation, steps, iterations, converged: true });
        // Newton's residual is that of the steady flow: the one of the last slab is relative to a slab that hardly changes anything.
        let SlabReport { newton, residual_norms, .. } = flow.report;
        SteadyFlow { report: SlabReport { newton, residual_norms, ..report }, ..flow }
    }
}

/// The warning about a steady flow, with the remedy.
fn warning(reliability: &Reliability) -> Option<String> {
    let Some(stability) = reliability.stability else { return reliability.doubtful_residual().map(doubtful) };
    match (stability.is_unstable(), stability.is_undecided()) {
        (true, _) => Some(unstable(reliability, &stability)),
        (false, true) => Some(format!(
            "the steady flow may be unstable: marched in time, its rate of change grew by a factor of {:.1} within {:.2e}; a longer \
             `solver.steady.stability_time` tells",
            stability.growth, stability.duration
        )),
        (false, false) => None,
    }
}

/// The same where it was not marched in time.
fn doubtful(residual: f64) -> String {
    format!(
        "the steady flow may not be resolved: its residual at the next higher order is {residual:.1e} of the inertial terms; a higher `flow.order` \
         shows whether forces change, `solver.steady.stability_time` whether the flow is stable"
    )
}

/// The same where it is unstable.
fn unstable(reliability: &Reliability, stability: &Stability) -> String {
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
    format!("the steady flow is unstable: marched in time, {seen}; {resolution}. {meaning}")
}
