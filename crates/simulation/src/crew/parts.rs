//! What ranks have of the flow: each of its own cells.

use crate::averages::{AverageSums, MOMENTS, OFFSETS};
use crate::{cells, checkpoint};
use coupled::preconditioner::Ordering;
use coupled::{FlowMarch, Linearisation, Past, State};
use fem::Share;
use output::{Checkpoint, SolverState};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// An array with numbers of every cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfCells {
    /// The state at the end of the last slab, `[component][node]`.
    State,
    /// The determinants that slabs carry on.
    Determinants,
    /// The flow in the last slab, `[time node][component][node]`.
    Slab,
    /// The flow that the preconditioner is made of.
    Linearised,
    /// The offsets of averages, `[quantity][node]`.
    AverageOffsets,
    /// The sums of averages, `[phase][sum][node]`.
    AverageMoments,
}

/// What a rank has of the run.
pub struct Own<'a, const D: usize, const M: usize> {
    /// Its march.
    pub march: &'a FlowMarch<D, M>,
    /// Its sums of averages.
    pub averages: &'a AverageSums,
}

impl<const D: usize, const M: usize> Clone for Own<'_, D, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<const D: usize, const M: usize> Copy for Own<'_, D, M> {}

impl OfCells {
    /// All, with the names of their arrays in a checkpoint.
    pub const ALL: [(OfCells, &str); 6] = [
        (OfCells::State, checkpoint::FLOW),
        (OfCells::Determinants, checkpoint::DETERMINANTS),
        (OfCells::Slab, checkpoint::PAST_FLOW),
        (OfCells::Linearised, checkpoint::FROZEN_FLOW),
        (OfCells::AverageOffsets, OFFSETS),
        (OfCells::AverageMoments, MOMENTS),
    ];

    /// The names of all in a checkpoint.
    pub fn names() -> [&'static str; 6] {
        Self::ALL.map(|(_, name)| name)
    }

    /// Of the own cells of this rank; empty if there is no such array.
    pub fn own<const D: usize, const M: usize>(self, Own { march, averages }: Own<'_, D, M>) -> &[f64] {
        let State { u, determinants, past, .. } = &march.state;
        match self {
            OfCells::State => u,
            OfCells::Determinants => determinants,
            OfCells::Slab => past.as_ref().map_or(&[][..], |past| &past.u[..]),
            OfCells::Linearised => {
                let frozen = march.solver.system.flow.preconditioner.frozen();
                frozen.map_or(&[][..], |frozen| &frozen.state[..])
            }
            OfCells::AverageOffsets => &averages.offsets,
            OfCells::AverageMoments => &averages.moments,
        }
    }
}

impl<'a, const D: usize, const M: usize> Own<'a, D, M> {
    /// The arrays with numbers of cells that a checkpoint has besides the state that all ranks have: averages, and all others where there are several
    /// blocks. The same on all ranks.
    pub(super) fn long_arrays(self) -> impl Iterator<Item = (OfCells, &'static str)> {
        let (whole, march) = (self.march.solver.system.flow.operator.share.is_whole(), self.march);
        let is_long = move |(of, _): &(OfCells, &str)| match of {
            OfCells::State | OfCells::Determinants => !whole,
            OfCells::Slab => !whole && march.state.past.is_some(),
            OfCells::Linearised => !whole && march.solver.system.flow.preconditioner.frozen().is_some(),
            OfCells::AverageOffsets | OfCells::AverageMoments => !self.averages.is_empty(),
        };
        OfCells::ALL.into_iter().filter(is_long)
    }

    /// The flow of the last slab in some cells, `[cell][time node][component][node]`, from the `numbers` there; at the start the initial state at
    /// every time node.
    pub fn flow_of_slab<'b>(self, numbers: impl FnOnce(OfCells) -> Cow<'b, [f64]>) -> Cow<'b, [f64]> {
        if self.march.state.past.is_some() {
            return numbers(OfCells::Slab);
        }
        let layout = self.march.solver.system.flow.operator.layout;
        let state = numbers(OfCells::State);
        state.chunks_exact(layout.time_len()).flat_map(|cell| cell.repeat(layout.time_order)).collect()
    }

    /// The averages in some cells, from the `numbers` there.
    pub fn averages_in<'b>(self, numbers: impl Fn(OfCells) -> Cow<'b, [f64]>) -> AverageSums {
        let [offsets, moments] = [OfCells::AverageOffsets, OfCells::AverageMoments].map(|of| numbers(of).into_owned());
        self.averages.with_cells(offsets, moments)
    }
}

/// `state` without the arrays of [`OfCells`].
pub fn without_flow(state: &State) -> State {
    let past = state.past.as_ref().map(|past| Past { u: Arc::default(), ..past.clone() });
    State {
        u: Vec::new(),
        determinants: Vec::new(),
        past,
        d: state.d.clone(),
        bodies: state.bodies.clone(),
        pending: state.pending.clone(),
        eased: state.eased.clone(),
        ..*state
    }
}

/// The name of the cells that are listed.
const CELLS: &str = "cells";
/// The name of the place of the array in [`OfCells::ALL`].
const OF: &str = "of";

/// The request for numbers of `cells`, for [`serve`].
pub(super) fn request(of: OfCells, cells: &[usize]) -> SolverState {
    let mut request = SolverState::default();
    request.integers.insert(OF.to_owned(), of as i64);
    request.arrays.insert(CELLS.to_owned(), cells.iter().map(|&cell| cell as f64).collect::<Vec<f64>>().into());
    request
}

/// The numbers of `cells` on rank 0, nothing elsewhere. A collective call.
pub(super) fn send<const D: usize, const M: usize>(own: Own<D, M>, of: OfCells, cells: &[usize]) -> Vec<f64> {
    own.march.solver.system.flow.operator.share.gather(of.own(own), cells)
}

/// Does what a [`request`] asks for.
pub(super) fn serve<const D: usize, const M: usize>(own: Own<D, M>, request: &SolverState) {
    let of = request.integers.get(OF).and_then(|&of| OfCells::ALL.get(of as usize));
    if let Some((of, _)) = of {
        let cells = request.arrays.get(CELLS).map_or(&[][..], |cells| &cells[..]);
        send(own, *of, &cells.iter().map(|&cell| cell as usize).collect::<Vec<usize>>());
    }
}

/// The integer with the length in a cell of the array `name`.
fn length_of(name: &str) -> String {
    format!("length.{name}")
}

/// `stored` without the arrays of [`OfCells`], with their lengths in each of so many `cells`. `None` if they do not fit the cells.
pub(super) fn without_arrays(stored: &Checkpoint, cells: usize) -> Option<SolverState> {
    let mut out = stored.state.clone();
    for name in OfCells::names() {
        out.arrays.remove(name);
        if let Some(len) = stored.len_of(name) {
            len.is_multiple_of(cells).then_some(())?;
            out.integers.insert(length_of(name), (len / cells) as i64);
        }
    }
    Some(out)
}

/// `common`, which all ranks have, with the arrays of the own cells. On rank 0 `part` gives a range of the values of an array of all cells. A
/// collective call.
pub(super) fn with_own_arrays(
    mut common: SolverState,
    share: &Share,
    mut part: impl FnMut(&str, Range<usize>) -> Vec<f64>,
) -> SolverState {
    for name in OfCells::names() {
        if let Some(length) = common.integers.remove(&length_of(name)) {
            let len = length as usize;
            let of_cells = |cells: Range<usize>| part(name, cells.start * len..cells.end * len);
            let own = share.scatter(len, cells::ranges(share.whole_cells(), len), of_cells);
            common.arrays.insert(name.to_owned(), own.into());
        }
    }
    common
}

/// A linearisation with the own part of an order of all cells.
pub fn own_linearisation(read: Linearisation, share: &Share) -> Linearisation {
    if read.ordering.cells.is_empty() || share.is_whole() {
        return read;
    }
    let mut local = vec![None; read.ordering.cells.len()];
    share.own.iter().enumerate().for_each(|(number, &cell)| local[cell] = Some(number));
    let own: Vec<usize> = read.ordering.own().filter_map(|cell| local[cell]).collect();
    let (of_whole, count) = (read.ordering.stages_of_cells(), read.ordering.stages.len());
    let stages: Vec<usize> = share.cells().map(|cell| of_whole[cell]).collect();
    Linearisation { ordering: Ordering::of_own(&own, vec![own.len()], &stages, count), ..read }
}

/// The stage and the position of every cell in the order of elimination of its rank, on rank 0; nothing elsewhere, or if there is no order. A
/// collective call.
pub(super) fn join_places<const D: usize, const M: usize>(march: &FlowMarch<D, M>) -> Vec<f64> {
    let share = &march.solver.system.flow.operator.share;
    let Some(frozen) = march.solver.system.flow.preconditioner.frozen() else { return Vec::new() };
    let place = |&position: &usize| [frozen.ordering.stage(position) as f64, position as f64];
    let places: Vec<f64> = frozen.ordering.positions.iter().take(share.own.len()).flat_map(place).collect();
    if frozen.ordering.positions.is_empty() { Vec::new() } else { share.join(&places) }
}

/// One order of all cells: stage by stage, in each block by block as on its rank.
pub(super) fn whole_ordering(places: &[f64], blocks: &[usize]) -> Ordering {
    if places.is_empty() {
        return Ordering::none();
    }
    let (places, _) = places.as_chunks::<2>();
    let stages: Vec<usize> = places.iter().map(|[stage, _]| *stage as usize).collect();
    let mut cells: Vec<usize> = (0..places.len()).collect();
    cells.sort_by(|&a, &b| blocks[a].cmp(&blocks[b]).then(places[a][1].total_cmp(&places[b][1])));
    let count = stages.iter().max().map_or(1, |stage| stage + 1);
    Ordering::of_own(&cells, vec![cells.len()], &stages, count)
}
