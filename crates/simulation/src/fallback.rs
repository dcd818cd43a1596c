//! What a run does when a slab of the flow could not be solved after all halvings: it goes on in a split form.
//!
//! 1. Before the first half of a slab that could not be solved, the run writes a checkpoint, and no other one until that slab is done.
//! 2. If no half can be solved either, it goes back to this checkpoint. What was written since is dropped.
//! 3. It solves the same slab in a split form, and so all that follow. The checkpoints say so, for runs that are resumed.
//!
//! Where the mesh does not resolve the flow at the start of the slab, there are no halves, see [`coupled::CoupledSlab::gives_way`].
//!
//! The state before the halvings matters: in our tests a flow that had gone on by short slabs was lost in any form.

use super::{build, checkpoint};
use case::{Case, Fallback, Flow};
use coupled::{Counts, FlowMarch};
use elasticity::ElasticityError;
use navier_stokes::{Compiled, NavierStokes};
use output::{Arrays, Checkpoint, SolverState};
use std::borrow::Cow;

/// The array of a checkpoint with the time from which the flow is in a split form.
pub const SINCE: &str = "statistics.split_form_since";

/// The time from which the flow of a checkpoint is in a split form.
pub fn since(arrays: &Arrays) -> Option<f64> {
    arrays.get(SINCE)?.first().copied()
}

/// The `flow` of `case` in a split form, if the run may go on in it.
pub fn split_form<const D: usize>(case: &Case<D>, flow: &Flow<D>) -> Option<Flow<D>> {
    flow.in_split_form(&case.mesh).filter(|_| case.solver.fallback == Fallback::SplitForm)
}

/// `stored`, the state before a slab that could not be solved, as one from which the flow goes on in a split form. The attempts since then were
/// `rejected` so often, and have cost `counts`.
pub fn in_split_form(mut stored: Checkpoint, rejected: usize, counts: Counts) -> Checkpoint {
    let time = stored.state.arrays.get("time").cloned().unwrap_or_default();
    stored.state.arrays.insert(SINCE.into(), time);
    // The whole slab is tried again; the carried determinants and the preconditioner were those of another quadrature.
    let goes = |name: &str| name.starts_with("frozen.") || ["failed", "determinants"].contains(&name);
    stored.retain_arrays(|name| !goes(name));
    checkpoint::store_attempts(&mut stored.state, counts);
    stored.state.arrays.insert("pending".into(), Vec::new().into());
    stored.state.integers.extend([("stale".into(), 1), ("rejected".into(), rejected as i64)]);
    stored
}

/// Gives `march` and `flow` the split form, if the `stored` state asks for it and they do not have it.
///
/// # Errors
/// As [`build::march_of`].
pub fn follow<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &mut Cow<'_, Flow<D>>,
    march: &mut FlowMarch<D, M>,
    stored: &SolverState,
) -> Result<bool, ElasticityError>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let Some(split) = since(&stored.arrays).and_then(|_| flow.in_split_form(&case.mesh)) else { return Ok(false) };
    build::discretise_anew(case, &split, march)?;
    *flow = Cow::Owned(split);
    Ok(true)
}
