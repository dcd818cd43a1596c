//! The part of a rank of a state, and the whole from all parts.

use coupled::preconditioner::Ordering;
use coupled::{FlowMarch, Linearisation, Past, State};
use fem::Share;

/// The own part of the state of the whole flow.
pub fn own_state(whole: State, share: &Share) -> State {
    let past = whole.past.map(|past| Past { u: share.own_part(&past.u), ..past });
    State { u: share.own_part(&whole.u), determinants: share.own_part(&whole.determinants), past, ..whole }
}

/// The own part of a linearisation of the whole flow.
pub fn own_linearisation(whole: Linearisation, share: &Share) -> Linearisation {
    let mut local = vec![None; whole.ordering.cells.len()];
    if !local.is_empty() {
        share.own.iter().enumerate().for_each(|(number, &cell)| local[cell] = Some(number));
    }
    let own: Vec<usize> = whole.ordering.own().filter_map(|cell| local[cell]).collect();
    let ordering = if own.is_empty() { Ordering::none() } else { Ordering::of_own(&own, vec![own.len()], share) };
    Linearisation { state: share.own_part(&whole.state), ordering, ..whole }
}

/// Replaces `whole` on rank 0 by the state of all ranks. A collective call.
pub(super) fn join_state<const D: usize, const M: usize>(march: &FlowMarch<D, M>, whole: &mut State) {
    let (state, share) = (&march.state, &march.solver.system.flow.operator.share);
    let past = state.past.as_ref().map(|past| Past { u: share.join(&past.u), ..past.clone() });
    let (u, determinants) = (share.join(&state.u), share.join(&state.determinants));
    *whole = State { u, determinants, past, ..state.clone() };
}

/// The linearisations of all ranks on rank 0, if there are any: the flow, and the position of every cell on its rank. A collective call.
pub(super) fn join_linearisation<const D: usize, const M: usize>(
    march: &FlowMarch<D, M>,
) -> Option<(Linearisation, Vec<f64>)> {
    let share = &march.solver.system.flow.operator.share;
    let frozen = march.solver.system.flow.preconditioner.frozen()?;
    let positions: Vec<f64> = frozen.ordering.positions.iter().take(share.own.len()).map(|&p| p as f64).collect();
    let state = share.join(&frozen.state);
    let positions = if positions.is_empty() { positions } else { share.join(&positions) };
    Some((Linearisation { state, ordering: Ordering::none(), ..frozen.clone() }, positions))
}

/// The joined linearisation with one order of all cells: block by block, in each as on its rank.
pub(super) fn in_whole(
    (joined, positions): (Linearisation, Vec<f64>),
    blocks: &[usize],
    whole: &Share,
) -> Linearisation {
    if positions.is_empty() {
        return joined;
    }
    let mut cells: Vec<usize> = (0..positions.len()).collect();
    cells.sort_by(|&a, &b| blocks[a].cmp(&blocks[b]).then(positions[a].total_cmp(&positions[b])));
    let ordering = Ordering::of_own(&cells, vec![cells.len()], whole);
    Linearisation { ordering, ..joined }
}
