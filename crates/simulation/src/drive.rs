//! A run, slab by slab: the same for flow, mesh and structure.

mod begin;
mod end;
mod fall_back;
mod run;
mod slabs;

pub(super) use run::Run;

use super::context::RunContext;
use super::crew::Orders;
use super::flow_run::run_flow;
use super::mesh_run::move_mesh;
use super::occupied::{self, Beginning};
use super::record::{MeshView, Recorder};
use super::restart;
use super::structure_run::run_structure;
use crate::destination::Destination;
use crate::error::Failure;
use crate::observer::Observer;
use crate::session::Session;
use begin::{
    begin, continue_surfaces, cut_files, open_files, restore, take_over, warn_of_averages, warn_of_end, warn_of_frame,
};
use case::{AnyCase, Case};
use end::{close, verdict};
use navier_stokes::{Compiled, NavierStokes};
use output::Summary;
use ranks::{Alone, Communicator};
use slabs::run_slabs;
use std::sync::Arc;
use std::time::Instant;

/// Runs a case: mesh and flow, or the mesh or a structure alone where there is no flow. Returns the contents of summary.json.
///
/// # Errors
/// Bad input before anything is written; a slab that cannot be solved after the last good state is written.
pub fn run(case: &AnyCase, destination: &Destination, observer: &dyn Observer) -> Result<Summary, Failure> {
    run_on(Arc::new(Alone), case, destination, observer)
}

/// The same on all ranks of `communicator`, of which this is rank 0. The others call [`crate::serve`].
///
/// # Errors
/// As [`run`]; more ranks than blocks.
pub fn run_on(
    communicator: Arc<dyn Communicator>,
    case: &AnyCase,
    destination: &Destination,
    observer: &dyn Observer,
) -> Result<Summary, Failure> {
    let orders = Arc::new(Orders::new(communicator));
    check_ranks(case, orders.communicator().size())?;
    occupied::check_unless_held(destination, observer, Beginning::of_run(case))?;
    // Inside the pool, so that every parallel loop starts without waking the pool.
    rayon::scope(|_| match case {
        AnyCase::Plane(case) => run_in::<2, 4>(case, destination, observer, &orders),
        AnyCase::Space(case) => run_in::<3, 5>(case, destination, observer, &orders),
    })
}

/// Moves the mesh of a case alone, over the whole run.
///
/// # Errors
/// As [`run`]; an invalid mesh is a failed solve.
pub fn motion(case: &AnyCase, destination: &Destination, observer: &dyn Observer) -> Result<Summary, Failure> {
    let beginning = Beginning { is_mesh_alone: true, ..Beginning::of_run(case) };
    occupied::check_unless_held(destination, observer, beginning)?;
    rayon::scope(|_| match case {
        AnyCase::Plane(case) => move_mesh::<2, 4>(case, destination, observer),
        AnyCase::Space(case) => move_mesh::<3, 5>(case, destination, observer),
    })
}

/// Whether every rank has a block.
fn check_ranks(case: &AnyCase, ranks: usize) -> Result<(), Failure> {
    let (blocks, has_flow) = match case {
        AnyCase::Plane(case) => (case.blocks, case.flow.is_some()),
        AnyCase::Space(case) => (case.blocks, case.flow.is_some()),
    };
    if ranks > 1 && !has_flow {
        return Err(Failure::bad_input(anyhow::anyhow!("a case without a flow runs in one process, not in {ranks}")));
    }
    if ranks > blocks {
        let problem = format!("{ranks} processes for {blocks} blocks: each process needs a block");
        let remedy = format!("`parallel.blocks` = {ranks} or more, or fewer processes");
        return Err(Failure::bad_input(anyhow::anyhow!("{problem}; {remedy}")));
    }
    Ok(())
}

fn run_in<const D: usize, const M: usize>(
    case: &Case<D>,
    destination: &Destination,
    observer: &dyn Observer,
    orders: &Arc<Orders>,
) -> Result<Summary, Failure>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    match (&case.flow, &case.structure) {
        (Some(flow), _) => run_flow::<D, M>(case, flow, destination, observer, orders),
        (None, Some(structure)) => run_structure::<D, M>(case, structure, destination, observer),
        (None, None) => move_mesh::<D, M>(case, destination, observer),
    }
}

/// The call of a run.
pub(super) struct Call<'a> {
    /// Where it writes.
    pub destination: &'a Destination,
    /// By whom.
    pub observer: &'a dyn Observer,
    /// The time of the call.
    pub begun: Instant,
    /// The state of another run from which this one starts, if any.
    pub origin: Option<restart::Start>,
}

/// Drives `run` from its start or its checkpoint to its end.
pub(super) fn drive<const D: usize, const M: usize>(
    case: &Case<D>,
    run: &mut dyn Run,
    mesh: &Arc<MeshView<D>>,
    call: Call<'_>,
) -> Result<Summary, Failure> {
    let session = Session::start(call.destination, call.observer, call.begun)?;
    session.timed(|| drive_in::<D, M>(&session, case, run, mesh, call))
}

/// [`drive`] in its session:
///
/// 1. Prepare the files and the state.
/// 2. Record the start.
/// 3. March.
/// 4. Write the last state, and give the verdict.
fn drive_in<const D: usize, const M: usize>(
    session: &Session<'_>,
    case: &Case<D>,
    run: &mut dyn Run,
    mesh: &Arc<MeshView<D>>,
    call: Call<'_>,
) -> Result<Summary, Failure> {
    let Prepared { mut recorder, mut context, has_begun } = prepare::<D, M>(session, case, run, mesh, call)?;
    let stop = match has_begun {
        false => begin(run, &mut recorder, &mut context, session.directory.path())?,
        true => None,
    };
    let stop = match stop {
        None => run_slabs(case, run, &mut recorder, &mut context, session)?,
        stop => stop,
    };
    let summary = close(run, &mut recorder, &context, session, stop.as_ref())?;
    verdict(run, case, &context, session, stop).map(|()| summary)
}

/// A run that can be driven on.
struct Prepared<'a, const D: usize, const M: usize> {
    recorder: Recorder<'a, D, M>,
    context: RunContext<'a>,
    /// Whether it goes on from a checkpoint of its own.
    has_begun: bool,
}

/// Prepares `run`. The states that are read, which are as large as the flow, end here:
///
/// 1. Open the files, and find what is to be continued there.
/// 2. Take the state over from a checkpoint, or from another run, or keep that of the start.
/// 3. Cut what was written after that state.
fn prepare<'a, const D: usize, const M: usize>(
    session: &'a Session<'_>,
    case: &'a Case<D>,
    run: &mut dyn Run,
    mesh: &Arc<MeshView<D>>,
    call: Call<'_>,
) -> Result<Prepared<'a, D, M>, Failure> {
    let (mut recorder, resumed) = open_files::<D, M>(session, case, mesh, &call)?;
    let statistics = match (&resumed, &call.origin) {
        (None, Some(start)) => take_over(run, start, case)?,
        _ => restore(run, resumed.as_ref(), case)?,
    };
    // A run whose search for the steady flow has failed has not begun.
    let has_begun = resumed.is_some() && !run.awaits_start(&statistics);
    cut_files(session, &mut recorder, run, has_begun)?;
    let context = RunContext::new(case, run.state().time, session, call.begun, statistics);
    if resumed.is_some() {
        warn_of_end(case, run.state().time);
    }
    warn_of_averages(case);
    warn_of_frame(case);
    let goes_on = has_begun && !run.is_done() && (run.state().slab > 0 || case.solver.steady.is_some());
    if goes_on || call.origin.is_some() {
        continue_surfaces(run, &mut recorder, session, call.origin.as_ref())?;
    }
    Ok(Prepared { recorder, context, has_begun })
}
