//! The state of all ranks in a checkpoint, and back.

use super::parts::{self, own_linearisation};
use super::{Crew, OfCells, Order, Own, agree};
use crate::averages::AverageSums;
use crate::error::Failure;
use crate::record::Stored;
use crate::{cells, checkpoint, fallback};
use case::{Case, Flow};
use coupled::{FlowMarch, Linearisation};
use fem::Share;
use navier_stokes::{Compiled, NavierStokes};
use output::{ArrayInParts, Checkpoint, Parts, SolverState};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// The number of blocks among the stored numbers.
pub const BLOCKS: &str = "blocks";

impl Crew {
    /// Has all ranks take their parts of the state, and of a linearisation if there is one. A `flow` that the state has in a split form
    /// becomes that one. With several blocks no rank has the long arrays of all cells in memory.
    ///
    /// # Errors
    /// An array that cannot be read, or a state that this rank cannot take.
    pub fn restore<const D: usize, const M: usize>(
        &self,
        case: &Case<D>,
        flow: &mut Cow<'_, Flow<D>>,
        stored: &Checkpoint,
        (march, averages): (&mut FlowMarch<D, M>, &mut AverageSums),
    ) -> Result<(), Failure>
    where
        NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    {
        let share = &march.solver.system.flow.operator.share;
        let own = match share.is_whole() {
            true => stored.whole()?,
            false => self.own_of(stored, share, case.mesh.n_cells())?,
        };
        restore(case, flow, &own, (march, averages)).ok_or_else(checkpoint::incomplete)
    }

    /// What all ranks have of a state `stored` on a mesh of so many `cells`, and the own part of the rest.
    fn own_of(&self, stored: &Checkpoint, share: &Share, cells: usize) -> Result<SolverState, Failure> {
        let common = parts::without_arrays(stored, cells).ok_or_else(checkpoint::incomplete)?;
        self.orders.give(Order::Restore, Some(&common));
        // All ranks go on to the end: an error must not leave them waiting.
        let mut failed = None;
        let own = parts::with_own_arrays(common, share, |name, range| {
            stored.part(name, range.clone()).unwrap_or_else(|error| {
                failed.get_or_insert(error);
                vec![0.0; range.len()]
            })
        });
        let own = failed.map_or(Ok(own), |error| Err(Failure::from(error)));
        agree(&**self.orders.communicator(), own)
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
            let parts = Parts::InOrder(Box::new(cells::ranges(share.whole_cells(), len).map(part)));
            ArrayInParts { name: name.to_owned(), len: len * share.whole_cells(), parts }
        };
        Stored { state, long: own.long_arrays().map(array).collect(), together: self.together(own) }
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

/// Takes a `stored` state of the own cells. A `flow` that it has in a split form becomes that one. `None` if the state does not fit.
pub fn restore<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &mut Cow<'_, Flow<D>>,
    stored: &SolverState,
    (march, averages): (&mut FlowMarch<D, M>, &mut AverageSums),
) -> Option<()>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let (state, frozen, stale) = checkpoint::load(stored, &case.time)?;
    if state.u.len() != march.state.u.len() || state.d.len() != march.state.d.len() || !march.has_bodies_of(&state) {
        return None;
    }
    *averages = AverageSums::from_arrays(&stored.arrays)?;
    fallback::follow(case, flow, march, stored).ok()?;
    let initial = std::mem::replace(&mut march.state, state);
    if march.state.eased.is_some() && march.solver.start_layer.given.is_empty() {
        march.solver.start_layer.given = initial.u;
    }
    // The stages of another partition may join neighbours.
    let blocks = stored.integers.get(BLOCKS).map_or(1, |&blocks| blocks as usize);
    if let Some(frozen) = frozen.filter(|_| blocks == case.blocks) {
        let share = march.solver.system.flow.operator.share.clone();
        march.solver.system.rebuild(own_linearisation(frozen, &share));
    }
    march.solver.system.flow.preconditioner.stale = stale;
    Some(())
}
