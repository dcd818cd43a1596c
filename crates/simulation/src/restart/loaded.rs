//! The state of the other run. In the same orders, on the same mesh, its numbers of cells stay in the file: the ranks read them in parts.

use super::{Origin, RestartError};
use crate::averages::is_of_averages;
use crate::checkpoint;
use crate::crew::{BLOCKS, OfCells};
use case::{Case, Time};
use coupled::{Linearisation, State};
use fem::Orders;
use output::{Checkpoint, SolverState};
use std::sync::Arc;

/// A state, the linearisation of its preconditioner, and whether that is stale.
pub(super) struct Loaded {
    pub(super) state: State,
    pub(super) frozen: Option<Linearisation>,
    pub(super) stale: bool,
    pub(super) orders: Orders,
}

impl Origin {
    /// Its orders. The mesh has that of `case`.
    pub(super) fn orders<const D: usize>(&self, case: &Case<D>) -> Orders {
        let metadata = &self.result.metadata;
        Orders { flow: metadata.space_nodes.len(), mesh: case.mesh.order(), time: metadata.time_nodes.len() }
    }

    /// The stored numbers; those of cells are none where they stay in the file.
    fn stored_state(&self, keeps_cells: bool) -> Result<SolverState, RestartError> {
        if !keeps_cells {
            return Ok(self.stored.whole()?);
        }
        let mut state = self.stored.state.clone();
        let in_file = OfCells::names().into_iter().filter(|name| self.stored.len_of(name).is_some());
        state.arrays.extend(in_file.map(|name| (name.to_owned(), Arc::default())));
        Ok(state)
    }

    /// `state` with the numbers of cells that stay in the file.
    pub(super) fn with_numbers_of_cells(
        &self,
        mut state: SolverState,
        keeps_cells: bool,
        keeps_averages: bool,
    ) -> Checkpoint {
        // The preconditioner refers to the blocks of the run.
        let blocks = self.stored.state.integers.get_key_value(BLOCKS).filter(|_| keeps_cells);
        state.integers.extend(blocks.map(|(name, blocks)| (name.clone(), *blocks)));
        let mut checkpoint = self.stored.clone();
        checkpoint.replace_state(state, |name| if is_of_averages(name) { keeps_averages } else { keeps_cells });
        checkpoint
    }

    /// The state of the run.
    pub(super) fn loaded<const D: usize, const M: usize>(
        &self,
        case: &Case<D>,
        keeps_cells: bool,
    ) -> Result<Loaded, RestartError> {
        let orders = self.orders(case);
        let length = self.cells_of_flow() * M * orders.flow.pow(D as u32);
        let fits = |name: &str, times: usize| self.stored.len_of(name).is_none_or(|found| found == times * length);
        let of_slabs = [checkpoint::PAST_FLOW, checkpoint::FROZEN_FLOW];
        if self.stored.len_of(checkpoint::FLOW) != Some(length) || !of_slabs.iter().all(|name| fits(name, orders.time))
        {
            return Err(self.incomplete());
        }
        let loaded = checkpoint::load(&self.stored_state(keeps_cells)?, &Time { order: orders.time, ..case.time });
        let (state, frozen, stale) = loaded.ok_or_else(|| self.incomplete())?;
        Ok(Loaded { state, frozen, stale, orders })
    }
}
