//! A flow on several ranks. Rank 0 runs the case and writes the files. The others own a share of the flow, and do what rank 0 orders:
//!
//! | order | what all ranks do |
//! |---|---|
//! | build | make the march of their share |
//! | restore | take their part of a state, and of what the preconditioner is made of |
//! | search the steady flow | do so, and let bodies go from it |
//! | advance | attempt to solve a slab |
//! | send | send numbers of cells to rank 0 |
//! | send places | send the order of elimination to rank 0 |
//! | integrate, add up, measure | send integrals, sums, errors of the flow to rank 0 |
//! | begin averages | drop averages that the run does not continue |
//! | write a step, a state | write a part of the cells to the result, where all ranks write it |
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
mod serve;
mod stored;
mod together;

pub use agreement::agree;
pub use orders::{Order, Orders};
pub use parts::{OfCells, Own};
pub use serve::serve;
pub use stored::BLOCKS;
pub use together::{LongArray, Together};

use super::history::require_distinct_columns;
use super::memory_estimate::require_memory;
use super::{Failure, build, controls};
use crate::averages::AverageSums;
use agreement::{digest, first_other};
use case::{Averages, Case, Flow};
use coupled::{FlowMarch, SlabReport};
use fem::{Blocks, Bottom, Share};
use mesh::MeshError;
use navier_stokes::{Compiled, NavierStokes};
use ranks::{Communicator, Sums};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// Sends the commands of rank 0 to the other ranks. With one rank it sends nothing.
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
pub fn start<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    orders: &Arc<Orders>,
) -> Result<(FlowMarch<D, M>, Crew), Failure>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    orders.give(Order::Build, None);
    let march = march::<D, M>(case, flow, orders.communicator())?;
    let blocks = if case.blocks == 1 { Vec::new() } else { blocks(case).map_err(Failure::bad_input)?.of_cell };
    Ok((march, Crew { blocks, orders: orders.clone() }))
}

impl Crew {
    /// Has all ranks attempt the next slab.
    ///
    /// # Errors
    /// As [`coupled::March::attempt`], alike on all ranks; other bits of the mesh on another rank.
    pub fn advance<const D: usize, const M: usize>(
        &self,
        case: &Case<D>,
        march: &mut FlowMarch<D, M>,
    ) -> anyhow::Result<Option<SlabReport<M>>> {
        self.orders.give(Order::Advance, controls::message(case).as_ref());
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
    other.map_or(Ok(report), |rank| Err(OtherMesh { rank, time: state.time }.into()))
}

/// A rank has found another mesh. The slab is done, and nothing of it is recorded.
#[derive(Debug, thiserror::Error)]
#[error(
    "process {rank} has found another mesh than process 0 at t = {time}: every process solves for the mesh, and processors of different types round \
     differently; start all processes on machines of one type, and resume the run"
)]
pub struct OtherMesh {
    rank: usize,
    time: f64,
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
{
    require_one_case(case, &**communicator)?;
    agree(&**communicator, require_memory(case, communicator.size()))?;
    agree(&**communicator, require_distinct_columns(case))?;
    agree(&**communicator, march_of_share(case, flow, communicator).map_err(Failure::BadInput))
}

/// A rank has read another case or mesh file.
#[derive(Debug, thiserror::Error)]
#[error(
    "process {rank} has another {what} than process 0: every process needs the same arguments, and the same files of the case, its tables and its \
     mesh; and processors of different types may round a mesh differently"
)]
pub struct OtherCase {
    rank: usize,
    what: &'static str,
}

/// Refuses ranks whose case or mesh is not that of rank 0: each would solve other equations for its cells. A collective call.
fn require_one_case<const D: usize>(case: &Case<D>, communicator: &dyn Communicator) -> Result<(), Failure> {
    if communicator.size() == 1 {
        return Ok(());
    }
    let mesh = &case.mesh;
    let text = case.about.resolved.bytes().map(f64::from);
    let boundaries = mesh.boundary_facets().iter().flat_map(|facet| [facet.side.cell, facet.side.face, facet.boundary]);
    let joined = mesh.interior_facets().iter().flat_map(|facet| [facet.minus, facet.plus]);
    let joined = joined.flat_map(|side| [side.cell, side.face]);
    let regions = mesh.regions().iter().flat_map(|region| region.cells.iter().copied());
    let names = mesh.boundary_names().iter().flat_map(|name| name.bytes()).map(f64::from);
    let positions = (0..mesh.n_cells()).flat_map(|cell| mesh.cell_coordinates(cell).iter().copied());
    let numbers = boundaries.chain(joined).chain(regions).map(|number| number as f64);
    let mesh = digest(positions.chain(numbers).chain(names));
    for (what, digest) in [("case", digest(text)), ("mesh", mesh)] {
        if let Some(rank) = first_other(communicator, digest) {
            return Err(Failure::BadInput(OtherCase { rank, what }.into()));
        }
    }
    Ok(())
}

/// The march of the share of this rank.
fn march_of_share<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    communicator: &Arc<dyn Communicator>,
) -> anyhow::Result<FlowMarch<D, M>>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let sums = Arc::new(Sums::new(communicator.clone(), case.blocks));
    let mover = build::mover_of(case, sums.clone())?;
    let mut march = build::march_of(case, flow, mover, Share::new(&case.mesh, &blocks(case)?, sums))?;
    march.solver.gives_way = build::gives_way(case, flow);
    Ok(march)
}

/// The largest memory of all ranks in bytes, 0 where it is not known; empty for one rank. A collective call.
fn peak_memories(communicator: &dyn Communicator) -> Vec<u64> {
    if communicator.size() == 1 {
        return Vec::new();
    }
    let peak = case::memory::peak().unwrap_or_default();
    communicator.all_gather(&[peak as f64]).into_iter().flatten().map(|peak| peak as u64).collect()
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
    let (operator, coupled::State { time, u, d, determinants, .. }) = (&mut solver.system.flow.operator, state);
    operator.begin_slab(*time, 0.0, Bottom { state: u, displacement: d, determinants });
    coupled::totals(operator, u)
}
