//! A flow on several ranks. Rank 0 runs the case and writes the files. The others own a share of the flow, and do what rank 0 orders:
//!
//! | order | what all ranks do |
//! |---|---|
//! | build | make the march of their share |
//! | restore | take their part of a state, and of what the preconditioner is made of |
//! | search the steady flow | do so |
//! | release bodies | let bodies go from the steady flow |
//! | advance | attempt to solve a slab |
//! | send | send numbers of cells to rank 0 |
//! | send places | send the order of elimination to rank 0 |
//! | integrate, add up, measure | send integrals, sums, errors of the flow to rank 0 |
//! | begin averages | drop averages that the run does not continue |
//! | tell memory | send their largest memory |
//! | finish | end |
//!
//! No rank has the whole flow. Rank 0 receives the cells that it observes, and for files one part of all cells after the other.
//!
//! The mesh, its motion, bodies and structures are on all ranks: each solves for them alike, to the same bits. After every slab the ranks
//! compare these.

mod agreement;
mod orders;
mod parts;

pub use agreement::agree;
pub use orders::{Order, Orders};
pub use parts::{OfCells, Own};

use super::history::require_distinct_columns;
use super::memory_estimate::require_memory;
use super::record::Stored;
use super::{Failure, build as building, cells, checkpoint, controls, errors, fallback, integrals, steady_search};
use crate::averages::{AverageSums, add_slab};
use agreement::{digest, first_other};
use case::{AnyCase, Averages, Case, Flow, State};
use coupled::{FlowMarch, Linearisation, SlabReport};
use fem::{Blocks, Bottom, Share, StateField};
use mesh::MeshError;
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};
use output::{ArrayInParts, SolverState};
use parts::own_linearisation;
use ranks::{Communicator, Sums};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// The number of blocks among the stored numbers.
const BLOCKS: &str = "blocks";

/// What rank 0 orders. On one rank nobody listens.
pub struct Crew {
    /// The block of every cell; empty where the mesh is one block.
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

/// Has all ranks build the march of their share.
///
/// # Errors
/// Those of the mesh, and a shortage of memory, of any rank.
pub fn build<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    orders: &Arc<Orders>,
) -> Result<(FlowMarch<D, M>, Crew), Failure>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    orders.give(Order::Build, None);
    let march = march::<D, M>(case, flow, orders.communicator())?;
    let blocks = if case.blocks == 1 { Vec::new() } else { blocks(case).map_err(Failure::bad_input)?.of_cell };
    Ok((march, Crew { blocks, orders: orders.clone() }))
}

impl Crew {
    /// Has all ranks take their parts of the state, and of a linearisation if there is one. A `flow` that the state has in a split form
    /// becomes that one. `None` if this rank cannot take it.
    pub fn restore<const D: usize, const M: usize>(
        &self,
        case: &Case<D>,
        flow: &mut Cow<'_, Flow<D>>,
        stored: &SolverState,
        (march, averages): (&mut FlowMarch<D, M>, &mut AverageSums),
    ) -> Option<()>
    where
        NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
        Exact<State<D>>: StateField<D, M>,
        Manufactured<State<D>, D>: StateField<D, M>,
    {
        if march.solver.system.flow.operator.share.is_whole() {
            return restore(case, flow, stored, (march, averages));
        }
        let common = parts::without_arrays(stored, case.mesh.n_cells())?;
        self.orders.give(Order::Restore, Some(&common));
        let own = parts::with_own_arrays(common, Some(stored), &march.solver.system.flow.operator.share);
        restore(case, flow, &own, (march, averages))
    }

    /// Has all ranks attempt the next slab.
    ///
    /// # Errors
    /// As [`coupled::March::attempt`], alike on all ranks; other bits of the mesh on another rank.
    pub fn advance<const D: usize, const M: usize>(
        &self,
        case: &Case<D>,
        march: &mut FlowMarch<D, M>,
    ) -> anyhow::Result<Option<SlabReport<M>>> {
        self.orders.give(Order::Advance, controls::told(case).as_ref());
        advance(march)
    }

    /// Has all ranks do `work` for `order`, and does it.
    pub fn all<R>(&self, order: Order, work: impl FnOnce() -> R) -> R {
        self.orders.give(order, None);
        work()
    }

    /// The largest memory of all ranks in bytes, if there are several.
    pub fn peak_memories(&self) -> Vec<u64> {
        self.all(Order::TellMemory, || peak_memories(&**self.orders.communicator()))
    }

    /// The numbers of some cells, from the blocks that have them.
    pub fn gather<const D: usize, const M: usize>(&self, own: Own<D, M>, of: OfCells, cells: &[usize]) -> Vec<f64> {
        self.orders.give(Order::Send, Some(&parts::request(of, cells)));
        parts::send(own, of, cells)
    }

    /// The numbers of a range of cells.
    pub fn numbers<'a, const D: usize, const M: usize>(
        &self,
        own: Own<'a, D, M>,
        of: OfCells,
        cells: Range<usize>,
    ) -> Cow<'a, [f64]> {
        let (share, all) = (&own.march.solver.system.flow.operator.share, of.own(own));
        if !share.is_whole() {
            return self.gather(own, of, &cells.collect::<Vec<usize>>()).into();
        }
        let len = all.len() / share.own.len();
        Cow::Borrowed(&all[cells.start * len..cells.end * len])
    }

    /// The state with what the preconditioners of all ranks are made of. Averages, and where there are several blocks all numbers of cells, are
    /// long arrays.
    pub fn store<'a, const D: usize, const M: usize>(&'a self, own: Own<'a, D, M>) -> Stored<'a> {
        let (march, share) = (own.march, &own.march.solver.system.flow.operator.share);
        let preconditioner = &march.solver.system.flow.preconditioner;
        let mut state = match share.is_whole() {
            true => checkpoint::store(&march.state, preconditioner.frozen(), preconditioner.stale),
            false => self.without_cells(march),
        };
        state.arrays.extend(own.averages.to_arrays());
        let array = |(of, name): (OfCells, &'static str)| {
            let len = of.own(own).len() / share.own.len();
            let part = move |cells: Range<usize>| self.numbers(own, of, cells).into_owned();
            let parts = Box::new(cells::ranges(share.whole_cells(), len).map(part));
            ArrayInParts { name: name.to_owned(), len: len * share.whole_cells(), parts }
        };
        let is_long = |(of, _): &(OfCells, &str)| match of {
            OfCells::State | OfCells::Determinants => !share.is_whole(),
            OfCells::Slab => !share.is_whole() && march.state.past.is_some(),
            OfCells::Linearised => !share.is_whole() && preconditioner.frozen().is_some(),
            OfCells::AverageOffsets | OfCells::AverageMoments => !own.averages.is_empty(),
        };
        Stored { state, long: OfCells::ALL.into_iter().filter(is_long).map(array).collect() }
    }

    /// The state to store without the numbers of cells.
    fn without_cells<const D: usize, const M: usize>(&self, march: &FlowMarch<D, M>) -> SolverState {
        let places = self.all(Order::SendPlaces, || parts::join_places(march));
        let preconditioner = &march.solver.system.flow.preconditioner;
        let ordering = || parts::whole_ordering(&places, &self.blocks);
        let frozen = preconditioner.frozen().map(|frozen| Linearisation {
            state: Arc::default(),
            ordering: ordering(),
            ..frozen.clone()
        });
        let mut stored = checkpoint::store(&parts::without_flow(&march.state), frozen.as_ref(), preconditioner.stale);
        OfCells::ALL.iter().for_each(|(_, name)| drop(stored.arrays.remove(*name)));
        stored.integers.insert(BLOCKS.to_owned(), march.solver.system.flow.operator.share.sums.blocks() as i64);
        stored
    }
}

/// Puts the operator of `march` on the mesh of its last slab.
pub fn look_at_last_slab<const D: usize, const M: usize>(march: &mut FlowMarch<D, M>) {
    let operator = &mut march.solver.system.flow.operator;
    if let Some(past) = &march.state.past {
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
    agree(&**communicator, require_memory(case, communicator.size()))?;
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
    let mover = building::mover_of(case, sums.clone())?;
    Ok(building::march_of(case, flow, mover, Share::new(&case.mesh, &blocks(case)?, sums))?)
}

/// Takes a `stored` state of the own cells. A `flow` that it has in a split form becomes that one. `None` if the state does not fit.
pub fn restore<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &mut Cow<'_, Flow<D>>,
    stored: &SolverState,
    (march, averages): (&mut FlowMarch<D, M>, &mut AverageSums),
) -> Option<()>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let (state, frozen, stale) = checkpoint::load(stored, &case.time)?;
    if state.u.len() != march.state.u.len() || state.d.len() != march.state.d.len() || !march.has_bodies_of(&state) {
        return None;
    }
    *averages = AverageSums::from_arrays(&stored.arrays)?;
    fallback::follow(case, flow, march, stored).ok()?;
    march.state = state;
    // The stages of another partition may join neighbours.
    let blocks = stored.integers.get(BLOCKS).map_or(1, |&blocks| blocks as usize);
    if let Some(frozen) = frozen.filter(|_| blocks == case.blocks) {
        let share = march.solver.system.flow.operator.share.clone();
        march.solver.system.rebuild(own_linearisation(frozen, &share));
    }
    march.solver.system.flow.preconditioner.stale = stale;
    Some(())
}

/// The largest memory of all ranks in bytes, 0 where it is not known; empty for one rank. A collective call.
fn peak_memories(communicator: &dyn Communicator) -> Vec<u64> {
    if communicator.size() == 1 {
        return Vec::new();
    }
    let peak = case::memory::peak().unwrap_or_default();
    communicator.all_gather(&[peak as f64]).into_iter().flatten().map(|peak| peak as u64).collect()
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
    let mut averages = AverageSums::default();
    loop {
        let (order, state) = orders::receive(&**communicator);
        match (order, &mut own) {
            (Order::Finish, _) => return,
            // An error is that of all ranks; rank 0 tells it.
            (Order::Build, _) => own = march(case, &flow, communicator).ok(),
            (Order::Restore, Some(march)) => {
                let common = orders::decode(&state);
                controls::set_for_preconditioner(case, Some(&common));
                let stored = parts::with_own_arrays(common, None, &march.solver.system.flow.operator.share);
                restore(case, &mut flow, &stored, (march, &mut averages));
            }
            (Order::SearchSteadyFlow | Order::ReleaseBodies, Some(march)) => {
                if let Some(steady) = &case.solver.steady {
                    let _ = match order {
                        Order::ReleaseBodies => steady_search::release_bodies(case, &flow, steady, march).err(),
                        _ => steady_search::search(case, &flow, steady, march).err().map(Into::into),
                    };
                }
            }
            (Order::Advance, Some(march)) => {
                controls::hear(case, &orders::decode(&state));
                // An error is that of all ranks.
                if let Ok(Some(_)) = advance(march) {
                    add_slab(case, &flow, march, &mut averages);
                }
            }
            (Order::BeginAverages, Some(march)) => drop(begin_averages(case, march, &mut averages)),
            (Order::Send, Some(march)) => {
                parts::serve(Own { march, averages: &averages }, &orders::decode(&state));
            }
            (Order::SendPlaces, Some(march)) => drop(parts::join_places(march)),
            (Order::Integrate, Some(march)) => drop(integrals::of_run(case, &flow, march)),
            (Order::AddUp, Some(march)) => drop(add_up(march)),
            (Order::Measure, Some(march)) => drop(errors::of_cells(&flow, march)),
            (Order::TellMemory, _) => drop(peak_memories(&**communicator)),
            (_, None) => {}
        }
    }
}

/// Drops averages of a run that this one continues if their settings or orders differ; returns whether it did.
pub fn begin_averages<const D: usize, const M: usize>(
    case: &Case<D>,
    march: &FlowMarch<D, M>,
    averages: &mut AverageSums,
) -> bool {
    let layout = march.solver.system.flow.operator.layout;
    let fits = |wanted: &Averages| averages.fits::<D>(wanted, layout.cells, layout.nodes);
    if case.averages.as_ref().is_some_and(fits) {
        return false;
    }
    *averages = AverageSums::default();
    true
}

/// The integrals of the components of the present flow, between two slabs. A collective call.
pub fn add_up<const D: usize, const M: usize>(march: &mut FlowMarch<D, M>) -> Vec<f64> {
    let FlowMarch { solver, state, .. } = march;
    let operator = &mut solver.system.flow.operator;
    operator.set_displacement(&state.d);
    coupled::totals(operator, &state.u)
}
