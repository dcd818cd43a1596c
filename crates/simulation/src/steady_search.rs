//! The search for the steady flow, with bodies held and then released. Every rank searches for the flow of its own cells.

use crate::body_checks::unheld_in_equilibrium;
use crate::build;
use crate::observer::Observer;
use crate::steady_warnings::{slides, undetermined};
use case::{BoundaryData, Case, Flow, Steady, SteadyBodies, Time, is_along_axis};
use coupled::{
    Discretisation, Equilibrium, FlowMarch, Invariants, NoEquilibrium, Search, Stage, SteadyError, SteadyFlow,
    find_equilibrium,
};
use navier_stokes::{Boundary, Compiled, NavierStokes};
use ranks::Communicator;
use std::array::from_fn;

/// The length of the first slab of the search for an equilibrium, in time units of the flow.
const FIRST_SLAB: f64 = 0.1;

/// The change from slab to slab falls at least by this factor as slabs grow, so slabs need not be solved better.
const SLAB_TOLERANCE: f64 = 1e-3;

/// The start of a run that was searched for.
pub struct Found<const M: usize> {
    /// The steady flow, with bodies held.
    pub flow: SteadyFlow<M>,
    /// The equilibrium with bodies released, if the case asks for it.
    pub equilibrium: Option<Equilibrium<M>>,
}

/// The observer wants no more of the search.
#[derive(Debug, thiserror::Error)]
#[error("the search for the start was stopped")]
pub struct Stopped;

/// Replaces the flow of `march`, a run at its start, by the steady flow, with bodies released if the case asks for it. A collective call; the
/// first rank has the `observer`.
///
/// # Errors
/// [`Stopped`]: the flow is then the one before, so that a later search finds the same bits. As [`Search::find`]: the flow is then the one
/// with the least residual. [`NoEquilibrium`]; those of the mesh.
pub fn find<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    steady: &Steady,
    march: &mut FlowMarch<D, M>,
    observer: &dyn Observer,
) -> anyhow::Result<Found<M>>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let communicator = march.solver.system.flow.operator.share.sums.communicator().clone();
    let is_stopped = || any(&*communicator, observer.is_stop_requested());
    let before = march.state.u.clone();
    let found = Task { case, flow, steady, march, observer, is_stopped: &is_stopped }.find();
    if found.is_err() && is_stopped() {
        march.state.u = before;
        return Err(Stopped.into());
    }
    found
}

/// What is searched for, until `is_stopped`.
struct Task<'a, const D: usize, const M: usize> {
    case: &'a Case<D>,
    flow: &'a Flow<D>,
    steady: &'a Steady,
    march: &'a mut FlowMarch<D, M>,
    observer: &'a dyn Observer,
    is_stopped: &'a dyn Fn() -> bool,
}

impl<const D: usize, const M: usize> Task<'_, D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    fn find(&mut self) -> anyhow::Result<Found<M>> {
        undetermined(self.case).iter().for_each(|text| tracing::warn!("{text}"));
        let found = self.search();
        let stages = found.as_ref().map_or_else(|error| &error.stages, |found| &found.stages);
        stages.iter().for_each(|stage| self.observer.say(&told(stage)));
        let found = found?;
        if self.steady.bodies != SteadyBodies::Equilibrium {
            return Ok(Found { flow: found, equilibrium: None });
        }
        unheld_in_equilibrium(self.case).iter().for_each(|text| tracing::warn!("{text}"));
        let equilibrium = self.release_bodies()?;
        Ok(Found { flow: found, equilibrium: Some(equilibrium) })
    }

    /// Replaces the flow of `march`, a run at its start, by the steady flow. A collective call.
    ///
    /// # Errors
    /// As [`Search::find`]; the flow is then the one with the least residual.
    fn search(&mut self) -> Result<SteadyFlow<M>, SteadyError> {
        let Task { case, flow, steady, is_stopped, .. } = *self;
        let march = &mut *self.march;
        let (system, state) = (&march.solver.system, &mut march.state);
        let (share, displacement) = (&*system.flow.operator.share, &state.d[..]);
        let time_unit = flow.time_unit();
        let search = Search {
            discretise: &|discretisation| build::steady::<D, M>(case, flow, (share, displacement), discretisation),
            order: flow.order,
            mover: system.mover(),
            share,
            displacement,
            time: state.time,
            time_unit,
            settings: steady.newton(time_unit),
            sequence: steady.sequence,
            invariants: invariants(case, flow),
            stability_time: steady.stability_time,
            is_stopped,
        };
        search.find(&mut state.u)
    }

    /// Lets bodies and the mesh of `march` go from the steady flow that was found with bodies held, until all are in equilibrium. A collective
    /// call.
    ///
    /// # Errors
    /// [`NoEquilibrium`]; those of the mesh.
    fn release_bodies(&mut self) -> anyhow::Result<Equilibrium<M>> {
        let Task { case, flow, steady, is_stopped, .. } = *self;
        let march = &mut *self.march;
        // A run that continues another one does not stand at the start of its case.
        let start = march.state.time;
        let time = Time { order: 1, step: FIRST_SLAB * flow.time_unit(), start, control: None, ..case.time };
        let share = &march.solver.system.flow.operator.share;
        let with_one_node = Case { time, ..case.clone() };
        let mover = build::mover_of(&with_one_node, share.sums.clone())?;
        let mut released = build::march_of::<D, M>(&with_one_node, flow, mover, (**share).clone())?;
        released.solver.newton.relative_tolerance = SLAB_TOLERANCE;
        released.state.u.clone_from(&march.state.u);
        let rest = (steady.tolerance, flow.time_length);
        let found = find_equilibrium(&mut released, rest, is_stopped).map_err(with_cause)?;
        let coupled::State { u, d, bodies, .. } = released.state;
        march.solver.system.flow.operator.set_displacement(&d);
        (march.state.u, march.state.d, march.state.bodies) = (u, d, bodies);
        Ok(found)
    }
}

/// Whether one of the ranks says so. A collective call.
fn any(communicator: &dyn Communicator, own: bool) -> bool {
    communicator.all_gather(&[f64::from(u8::from(own))]).concat().contains(&1.0)
}

/// A solve for the steady flow, in one line.
fn told(stage: &Stage) -> String {
    let Stage { discretisation: Discretisation { order, dissipative, .. }, steps, iterations, converged } = stage;
    let flux = if *dissipative { ", dissipative flux" } else { "" };
    let end = if *converged { "" } else { "  given up" };
    format!("steady flow of order {order}{flux}: newton {steps}  krylov {iterations}{end}")
}

/// What to do about flow and bodies that keep moving.
const RESTLESS: &str = "no equilibrium of flow and bodies was found: a march in time shows how they move, with `solver.steady.bodies = \"held\"`; \
                        a larger `solver.steady.tolerance` accepts small motions";

/// The slab that could not be solved is the cause that the examination of a failure looks for.
fn with_cause(error: NoEquilibrium) -> anyhow::Error {
    let words = error.to_string();
    match error {
        NoEquilibrium::Slab { source, .. } => anyhow::Error::new(source).context(words),
        NoEquilibrium::Moves { .. } => anyhow::Error::new(error).context(RESTLESS),
        NoEquilibrium::Stopped { .. } => anyhow::Error::new(error),
    }
}

/// What no boundary and no source can change.
fn invariants<const D: usize>(case: &Case<D>, flow: &Flow<D>) -> Invariants<D> {
    let every = |holds: fn(&BoundaryData<D>) -> bool| flow.boundary.iter().all(holds);
    let mass = flow.conserves_mass() && every(|data| data.condition.is_solid());
    let is_idle = mass && flow.source.is_none();
    let is_smooth = every(|data| matches!(data.condition, Boundary::SlipWall(_) | Boundary::Symmetry(_)));
    let is_free = |axis: usize| (0..flow.boundary.len()).all(|boundary| is_along_axis(&case.mesh, boundary, axis));
    let momentum = from_fn(|axis| is_idle && is_smooth && is_free(axis));
    let is_insulated = every(|data| !matches!(data.condition, Boundary::IsothermalWall(_)));
    Invariants { mass, momentum, energy: is_idle && is_insulated && !flow.boundary.iter().any(slides) }
}
