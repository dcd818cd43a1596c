//! A flow on several ranks. Rank 0 runs the case and writes the files. The others own a share of the flow, and do what rank 0 orders:
//!
//! | order | what all ranks do |
//! |---|---|
//! | build | make the march of their share |
//! | restore | take their part of a state, and of what the preconditioner is made of |
//! | search the steady flow | do so; rank 0 receives the flow of all |
//! | release bodies | let bodies go from the steady flow; rank 0 receives the state of all |
//! | advance | attempt to solve a slab; rank 0 receives the flow of all |
//! | store | send what the preconditioner is made of to rank 0 |
//! | finish | end |
//!
//! The mesh, its motion, bodies and structures are on all ranks: each solves for them alike, to the same bits. After every slab the ranks
//! compare these.

mod agreement;
mod orders;
mod parts;

pub use agreement::agree;
pub use orders::Orders;

use super::history::require_distinct_columns;
use super::memory_estimate::require_memory;
use super::{Failure, build, checkpoint, controls, fallback, steady_search};
use agreement::{digest, first_other};
use case::{AnyCase, Case, Flow, State, Steady};
use coupled::{Equilibrium, FlowMarch, MeshMover, SlabReport, SteadyError, SteadyFlow};
use fem::{Blocks, Bottom, Share, SlabOperator, StateField};
use mesh::MeshError;
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};
use orders::Order;
use output::SolverState;
use parts::{own_linearisation, own_state};
use ranks::{Communicator, Sums};
use std::borrow::Cow;
use std::mem::take;
use std::sync::Arc;

/// The number of blocks among the stored numbers.
const BLOCKS: &str = "blocks";

/// What rank 0 has of the whole flow.
pub struct Crew<const D: usize, const M: usize> {
    /// The state of the whole flow.
    pub state: coupled::State,
    /// The operator on all cells, for measurements of the flow. It solves nothing.
    pub operator: SlabOperator<D, M>,
    /// The block of every cell.
    blocks: Vec<usize>,
    orders: Arc<Orders>,
}

/// The blocks into which `case` cuts its cells.
fn blocks<const D: usize>(case: &Case<D>) -> Result<Blocks, MeshError> {
    if case.blocks == 1 {
        return Ok(Blocks::one(case.mesh.n_cells()));
    }
    let of_cell = mesh::blocks(&case.mesh, case.blocks)?;
    Ok(Blocks { of_cell, groups: case.stages })
}

impl<const D: usize, const M: usize> Crew<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    /// Has all ranks build the march of their share. No crew where the mesh is one block.
    ///
    /// # Errors
    /// Those of the mesh, and a shortage of memory, of any rank.
    pub fn build(
        case: &Case<D>,
        flow: &Flow<D>,
        orders: &Arc<Orders>,
    ) -> Result<(FlowMarch<D, M>, Option<Self>), Failure> {
        orders.give(Order::Build, None);
        let march = march::<D, M>(case, flow, orders.communicator())?;
        if case.blocks == 1 {
            return Ok((march, None));
        }
        let mover: &MeshMover<D> = &march.solver.system.mesh.mover;
        let operator = build::measuring_operator::<D, M>(case, flow, mover);
        let u = build::initial(case, flow, &operator, mover);
        let state = coupled::State { u, ..march.state.clone() };
        let blocks = blocks(case).map_err(Failure::bad_input)?.of_cell;
        Ok((march, Some(Crew { state, operator, blocks, orders: orders.clone() })))
    }

    /// Has all ranks take their parts of the state, and of a linearisation if there is one. A `flow` that the state has in a split form
    /// becomes that one. `None` if this rank cannot take it.
    pub fn restore(
        &mut self,
        case: &Case<D>,
        flow: &mut Cow<'_, Flow<D>>,
        stored: &SolverState,
        march: &mut FlowMarch<D, M>,
    ) -> Option<()> {
        self.orders.give(Order::Restore, Some(stored));
        if restore(case, flow, stored, march)? {
            self.operator = build::measuring_operator::<D, M>(case, flow, &march.solver.system.mesh.mover);
        }
        Some(())
    }

    /// Has all ranks attempt the next slab.
    ///
    /// # Errors
    /// As [`coupled::March::attempt`], alike on all ranks; other bits of the mesh on another rank.
    pub fn advance(&mut self, case: &Case<D>, march: &mut FlowMarch<D, M>) -> anyhow::Result<Option<SlabReport<M>>> {
        self.orders.give(Order::Advance, controls::told(case).as_ref());
        let report = advance(march);
        if matches!(report, Ok(Some(_))) {
            parts::join_state(march, &mut self.state);
        } else {
            let coupled::State { u, past, determinants, .. } = &mut self.state;
            let (u, past, determinants) = (take(u), take(past), take(determinants));
            self.state = coupled::State { u, past, determinants, ..march.state.clone() };
        }
        report
    }

    /// Has all ranks search the steady flow.
    ///
    /// # Errors
    /// As [`steady_search::search`], alike on all ranks.
    pub fn search_steady_flow(
        &mut self,
        case: &Case<D>,
        flow: &Flow<D>,
        steady: &Steady,
        march: &mut FlowMarch<D, M>,
    ) -> Result<SteadyFlow<M>, SteadyError> {
        self.search(Order::SearchSteadyFlow, march, |march| steady_search::search(case, flow, steady, march))
    }

    /// Has all ranks let bodies go from the steady flow.
    ///
    /// # Errors
    /// As [`steady_search::release_bodies`], alike on all ranks.
    pub fn release_bodies(
        &mut self,
        case: &Case<D>,
        flow: &Flow<D>,
        steady: &Steady,
        march: &mut FlowMarch<D, M>,
    ) -> anyhow::Result<Equilibrium<M>> {
        let release = |march: &mut _| steady_search::release_bodies(case, flow, steady, march);
        let found = self.search(Order::ReleaseBodies, march, release);
        self.operator.set_displacement(&self.state.d);
        found
    }

    /// Has all ranks take part in a search, and joins the state that it leaves.
    fn search<R>(
        &mut self,
        order: Order,
        march: &mut FlowMarch<D, M>,
        find: impl FnOnce(&mut FlowMarch<D, M>) -> R,
    ) -> R {
        self.orders.give(order, None);
        let found = find(march);
        parts::join_state(march, &mut self.state);
        found
    }

    /// The state with what the preconditioners of all ranks are made of.
    pub fn store(&self, march: &FlowMarch<D, M>) -> SolverState {
        self.orders.give(Order::Store, None);
        let preconditioner = &march.solver.system.flow.preconditioner;
        let frozen = parts::join_linearisation(march).map(|frozen| parts::in_whole(frozen, &self.blocks));
        let mut stored = checkpoint::store(&self.state, frozen.as_ref(), preconditioner.stale);
        stored.integers.insert(BLOCKS.to_owned(), march.solver.system.flow.operator.share.sums.blocks() as i64);
        stored
    }

    /// Puts the operator on the mesh of the last slab, so that the flow can be measured.
    pub fn look_at_last_slab(&mut self) {
        look_at_last_slab(&mut self.operator, &self.state);
    }
}

/// Puts `operator` on the mesh of the last slab of `state`.
pub fn look_at_last_slab<const D: usize, const M: usize>(operator: &mut SlabOperator<D, M>, state: &coupled::State) {
    if let Some(past) = &state.past {
        let nothing = vec![0.0; operator.layout.at_one_time().len()];
        operator.begin_slab(past.interval.start, past.dt, Bottom::new(&nothing, &past.bottom));
        operator.set_mesh(&past.v);
    }
}

/// Attempts to solve a slab. A collective call.
///
/// # Errors
/// That of the slab; a rank whose mesh, bodies or times have other bits than those of rank 0.
fn advance<const D: usize, const M: usize>(march: &mut FlowMarch<D, M>) -> anyhow::Result<Option<SlabReport<M>>> {
    let report = march.attempt()?;
    let state = &march.state;
    let bodies = state.bodies.iter().flatten();
    let numbers = [state.time, state.step].into_iter().chain(state.d.iter().chain(bodies).copied());
    let communicator = march.solver.system.flow.operator.share.sums.communicator();
    let other = if communicator.size() > 1 { first_other(&**communicator, digest(numbers)) } else { None };
    other.map_or(Ok(report), |rank| {
        Err(anyhow::anyhow!(
            "process {rank} has found another mesh than process 0 at t = {}: every process solves for the mesh, and processors of different \
             types round differently; start all processes on machines of one type, and resume the run",
            state.time
        ))
    })
}

/// The march of the share of this rank. A collective call.
///
/// # Errors
/// Those of any rank.
fn march<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    communicator: &Arc<dyn Communicator>,
) -> Result<FlowMarch<D, M>, Failure>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    agree(&**communicator, require_memory(case, communicator.rank(), communicator.size()))?;
    agree(&**communicator, require_distinct_columns(case))?;
    agree(&**communicator, march_of_share(case, flow, communicator).map_err(Failure::BadInput))
}

/// The march of the share of this rank.
fn march_of_share<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    communicator: &Arc<dyn Communicator>,
) -> anyhow::Result<FlowMarch<D, M>>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let sums = Arc::new(Sums::new(communicator.clone(), case.blocks));
    let mover = build::mover_of(case, sums.clone())?;
    Ok(build::march_of(case, flow, mover, Share::new(&case.mesh, &blocks(case)?, sums))?)
}

/// Takes the own part of a stored state. Returns whether that has the flow in a split form for the first time.
fn restore<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &mut Cow<'_, Flow<D>>,
    stored: &SolverState,
    march: &mut FlowMarch<D, M>,
) -> Option<bool>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let is_other_form = fallback::follow(case, flow, march, stored).ok()?;
    let (state, frozen, stale) = checkpoint::load(stored, &case.time)?;
    // The stages of another partition may join neighbours.
    let frozen = frozen.filter(|_| stored.integers.get(BLOCKS) == Some(&(case.blocks as i64)));
    let share = march.solver.system.flow.operator.share.clone();
    march.state = own_state(state, &share);
    if let Some(frozen) = frozen {
        march.solver.system.rebuild(own_linearisation(frozen, &share));
    }
    march.solver.system.flow.preconditioner.stale = stale;
    Some(is_other_form)
}

/// Executes the orders of rank 0, until it orders to finish.
pub fn serve(case: &AnyCase, communicator: &Arc<dyn Communicator>) {
    rayon::scope(|_| match case {
        AnyCase::Plane(case) => serve_in::<2, 4>(case, communicator),
        AnyCase::Space(case) => serve_in::<3, 5>(case, communicator),
    });
}

fn serve_in<const D: usize, const M: usize>(case: &Case<D>, communicator: &Arc<dyn Communicator>)
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let Some(flow) = &case.flow else { return };
    let mut flow = Cow::Borrowed(flow);
    let mut own: Option<FlowMarch<D, M>> = None;
    loop {
        let (order, state) = orders::receive(&**communicator);
        match (order, &mut own) {
            (Order::Finish, _) => return,
            // An error is that of all ranks; rank 0 tells it.
            (Order::Build, _) => own = march(case, &flow, communicator).ok(),
            (Order::Restore, Some(march)) => {
                let stored = orders::decode(&state);
                controls::set_for_preconditioner(case, Some(&stored));
                restore(case, &mut flow, &stored, march);
            }
            (Order::SearchSteadyFlow | Order::ReleaseBodies, Some(march)) => {
                if let Some(steady) = &case.solver.steady {
                    let _ = match order {
                        Order::ReleaseBodies => steady_search::release_bodies(case, &flow, steady, march).err(),
                        _ => steady_search::search(case, &flow, steady, march).err().map(Into::into),
                    };
                }
                parts::join_state(march, &mut coupled::State::new(0.0, Vec::new(), Vec::new()));
            }
            (Order::Advance, Some(march)) => {
                controls::hear(case, &orders::decode(&state));
                if matches!(advance(march), Ok(Some(_))) {
                    parts::join_state(march, &mut coupled::State::new(0.0, Vec::new(), Vec::new()));
                }
            }
            (Order::Store, Some(march)) => drop(parts::join_linearisation(march)),
            (_, None) => {}
        }
    }
}
