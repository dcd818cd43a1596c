//! The part of a rank of a state, and the whole from all parts.

use coupled::preconditioner::Ordering;
use coupled::{FlowMarch, Linearisation, Past, State};
use fem::Share;
use std::sync::Arc;

/// The own part of the state of the whole flow.
pub fn own_state(whole: State, share: &Share) -> State {
    let past = whole.past.map(|past| Past { u: Arc::new(share.own_part(&past.u)), ..past });
    State { u: share.own_part(&whole.u), determinants: share.own_part(&whole.determinants), past, ..whole }
}

/// The own part of a linearisation of the whole flow.
pub fn own_linearisation(whole: Linearisation, share: &Share) -> Linearisation {
    let state = Arc::new(share.own_part(&whole.state));
    if whole.ordering.cells.is_empty() {
        return Linearisation { state, ..whole };
    }
    let mut local = vec![None; whole.ordering.cells.len()];
    share.own.iter().enumerate().for_each(|(number, &cell)| local[cell] = Some(number));
    let own: Vec<usize> = whole.ordering.own().filter_map(|cell| local[cell]).collect();
    let (of_whole, count) = (whole.ordering.stages_of_cells(), whole.ordering.stages.len());
    let stages: Vec<usize> = share.cells().map(|cell| of_whole[cell]).collect();
    Linearisation { state, ordering: Ordering::of_own(&own, vec![own.len()], &stages, count), ..whole }
}

/// Replaces `whole` on rank 0 by the state of all ranks. A collective call.
pub(super) fn join_state<const D: usize, const M: usize>(march: &FlowMarch<D, M>, whole: &mut State) {
    let (state, share) = (&march.state, &march.solver.system.flow.operator.share);
    // The memory of the old one serves the new one.
    *whole = State::new(whole.time, Vec::new(), Vec::new());
    let past = state.past.as_ref().map(|past| Past { u: Arc::new(share.join(&past.u)), ..past.clone() });
    let (u, determinants) = (share.join(&state.u), share.join(&state.determinants));
    *whole = State { u, determinants, past, ..state.clone() };
}

/// The linearisations of all ranks on rank 0, if there are any: the flow, and the stage and the position of every cell on its rank. A
/// collective call.
pub(super) fn join_linearisation<const D: usize, const M: usize>(
    march: &FlowMarch<D, M>,
) -> Option<(Linearisation, Vec<f64>)> {
    let share = &march.solver.system.flow.operator.share;
    let frozen = march.solver.system.flow.preconditioner.frozen()?;
    let place = |&position: &usize| [frozen.ordering.stage(position) as f64, position as f64];
    let places: Vec<f64> = frozen.ordering.positions.iter().take(share.own.len()).flat_map(place).collect();
    let state = Arc::new(share.join(&frozen.state));
    let places = if places.is_empty() { places } else { share.join(&places) };
    Some((Linearisation { state, ordering: Ordering::none(), ..frozen.clone() }, places))
}

/// The joined linearisation with one order of all cells: stage by stage, in each block by block as on its rank.
pub(super) fn in_whole((joined, places): (Linearisation, Vec<f64>), blocks: &[usize]) -> Linearisation {
    if places.is_empty() {
        return joined;
    }
    let (places, _) = places.as_chunks::<2>();
    let stages: Vec<usize> = places.iter().map(|[stage, _]| *stage as usize).collect();
    let mut cells: Vec<usize> = (0..places.len()).collect();
    cells.sort_by(|&a, &b| blocks[a].cmp(&blocks[b]).then(places[a][1].total_cmp(&places[b][1])));
    let count = stages.iter().max().map_or(1, |stage| stage + 1);
    let ordering = Ordering::of_own(&cells, vec![cells.len()], &stages, count);
    Linearisation { ordering, ..joined }
}
