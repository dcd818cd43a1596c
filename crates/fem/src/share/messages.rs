//! What ranks send each other of a flow. Every call is collective.

use super::{Cut, Share, numbers_of};
use crate::batches::Permutation;
use crate::traces::{Traced, Traces};
use std::ops::Range;

/// The traces of own faces at the cuts, and room for those of ghosts, cut by cut.
pub(crate) struct TraceMessages {
    sent: Vec<Vec<f64>>,
    received: Vec<Vec<f64>>,
}

impl Share {
    /// Whether facets lead to other ranks.
    pub(crate) fn has_cuts(&self) -> bool {
        !self.cuts.is_empty()
    }

    /// The traces of own faces at the cuts: for each face the values in its own `lattice`, and the derivatives, if the layout has any.
    pub(crate) fn trace_messages(&self, traced: Traced, lattice: &Permutation) -> TraceMessages {
        let of_faces = |cut: &Cut| {
            let mut numbers = Vec::with_capacity(cut.own.len() * traced.traces.layout.face_len());
            for side in &cut.own {
                numbers.extend(traced.values_on(side.cell, &lattice.flow_of_cell[side.face]));
                numbers.extend(traced.traces.derivatives_on(*side));
            }
            numbers
        };
        let sent: Vec<Vec<f64>> = self.cuts.iter().map(of_faces).collect();
        let received = sent.iter().map(|numbers| vec![0.0; numbers.len()]).collect();
        TraceMessages { sent, received }
    }

    /// Sends and receives traces, and does `work` meanwhile. A collective call.
    pub(crate) fn exchange_while(&self, messages: &mut TraceMessages, work: &mut dyn FnMut()) {
        let sends: Vec<(usize, &[f64])> =
            self.cuts.iter().zip(&messages.sent).map(|(cut, numbers)| (cut.rank, &numbers[..])).collect();
        let mut receives: Vec<(usize, &mut [f64])> =
            self.cuts.iter().zip(&mut messages.received).map(|(cut, numbers)| (cut.rank, &mut numbers[..])).collect();
        self.sums.communicator().exchange_while(&sends, &mut receives, work);
    }

    /// Puts the traces that were received on the faces of ghosts: the values to the nodes of the faces in the `coefficients` of ghosts, the
    /// derivatives to `traces`.
    pub(crate) fn put_traces(
        &self,
        messages: &TraceMessages,
        lattice: &Permutation,
        coefficients: &mut [f64],
        traces: &mut Traces,
    ) {
        let layout = traces.layout;
        for (cut, numbers) in self.cuts.iter().zip(&messages.received) {
            for (side, numbers) in cut.ghosts.iter().zip(numbers.chunks_exact(layout.face_len())) {
                let (values, derivatives) = numbers.split_at(layout.kind_len());
                let ghost = &mut coefficients[(side.cell - self.own.len()) * layout.coefficients()..];
                for (tensor, values) in ghost.chunks_exact_mut(layout.nodes).zip(values.chunks_exact(layout.face_nodes))
                {
                    let nodes = lattice.flow_of_cell[side.face].iter();
                    nodes.zip(values).for_each(|(&node, value)| tensor[node] = *value);
                }
                traces.derivatives_on_mut(*side).copy_from_slice(derivatives);
            }
        }
    }

    /// Fills `all` with `of_own`, `len` numbers for every own cell, and after them those of the ghosts, from their owners.
    pub fn with_ghosts(&self, of_own: &[f64], len: usize, all: &mut Vec<f64>) {
        all.resize((self.own.len() + self.ghosts.len()) * len, 0.0);
        let (own, ghosts) = all.split_at_mut(of_own.len());
        own.copy_from_slice(of_own);
        if !(self.ghosts.is_empty() && self.sends.is_empty()) {
            self.exchange(of_own, len, ghosts);
        }
    }

    /// Fills `ghosts` with `len` numbers for every ghost.
    fn exchange(&self, of_own: &[f64], len: usize, mut ghosts: &mut [f64]) {
        let packed = |cells: &Vec<usize>| numbers_of(cells.iter().copied(), of_own, len);
        let sent: Vec<(usize, Vec<f64>)> = self.sends.iter().map(|(rank, cells)| (*rank, packed(cells))).collect();
        let sends: Vec<(usize, &[f64])> = sent.iter().map(|(rank, numbers)| (*rank, &numbers[..])).collect();
        let mut receives = Vec::with_capacity(self.receives.len());
        for (rank, cells) in &self.receives {
            let (here, rest) = std::mem::take(&mut ghosts).split_at_mut(cells.len() * len);
            receives.push((*rank, here));
            ghosts = rest;
        }
        self.sums.communicator().exchange(&sends, &mut receives);
    }

    /// Sends `len` numbers of every own cell for which `wanted` holds to the ranks where it is a ghost. Passes the numbers of the ghosts
    /// for which `wanted` holds to `put`. A collective call; ranks that have nothing for each other send nothing.
    pub fn exchange_some(
        &self,
        wanted: impl Fn(usize) -> bool,
        len: usize,
        mut get: impl FnMut(usize, &mut Vec<f64>),
        mut put: impl FnMut(usize, &[f64]),
    ) {
        if !self.is_distributed() {
            return;
        }
        let mut sent = Vec::with_capacity(self.sends.len());
        for (rank, cells) in &self.sends {
            let mut numbers = Vec::new();
            cells.iter().filter(|cell| wanted(**cell)).for_each(|&cell| get(cell, &mut numbers));
            sent.push((*rank, numbers));
        }
        let own = self.own.len();
        let ghosts = |range: &Range<usize>| range.clone().map(|ghost| own + ghost).filter(|ghost| wanted(*ghost));
        let received = self.swap(sent, |_, range| ghosts(range).count() * len);
        for ((_, range), numbers) in self.receives.iter().zip(&received) {
            ghosts(range).zip(numbers.chunks_exact(len)).for_each(|(ghost, numbers)| put(ghost, numbers));
        }
    }

    /// Sends `len` numbers for every pair (ghost, item) of `outgoing` to the owner of the ghost. Receives numbers from the owners of the
    /// ghosts `from` and passes them to `put`, with their places in `from`. Both sides have the items in the same order. A collective call.
    pub fn exchange_across(
        &self,
        outgoing: &[(usize, usize)],
        from: &[usize],
        len: usize,
        mut get: impl FnMut(usize, usize, &mut Vec<f64>),
        mut put: impl FnMut(usize, &[f64]),
    ) {
        if !self.is_distributed() {
            return;
        }
        let own = self.own.len();
        let is_of = |range: &Range<usize>, ghost: usize| range.contains(&(ghost - own));
        let mut sent = Vec::with_capacity(self.receives.len());
        for (rank, range) in &self.receives {
            let mut numbers = Vec::new();
            let items = outgoing.iter().filter(|(ghost, _)| is_of(range, *ghost));
            items.for_each(|&(ghost, item)| get(ghost, item, &mut numbers));
            sent.push((*rank, numbers));
        }
        let items = |range: &Range<usize>| {
            let of_rank = from.iter().enumerate().filter(|(_, ghost)| is_of(range, **ghost));
            of_rank.map(|(item, _)| item).collect::<Vec<usize>>()
        };
        let received = self.swap(sent, |_, range| items(range).len() * len);
        for ((_, range), numbers) in self.receives.iter().zip(&received) {
            items(range)
                .into_iter()
                .zip(numbers.chunks_exact(len.max(1)))
                .for_each(|(item, numbers)| put(item, numbers));
        }
    }

    /// Sends `sent` and receives so many numbers from each rank with ghosts as `length` tells. Nothing is no message.
    fn swap(&self, mut sent: Vec<(usize, Vec<f64>)>, length: impl Fn(usize, &Range<usize>) -> usize) -> Vec<Vec<f64>> {
        sent.retain(|(_, numbers)| !numbers.is_empty());
        let sends: Vec<(usize, &[f64])> = sent.iter().map(|(rank, numbers)| (*rank, &numbers[..])).collect();
        let mut received: Vec<Vec<f64>> =
            self.receives.iter().map(|(rank, range)| vec![0.0; length(*rank, range)]).collect();
        let mut receives: Vec<(usize, &mut [f64])> =
            self.receives.iter().zip(&mut received).map(|((rank, _), numbers)| (*rank, &mut numbers[..])).collect();
        receives.retain(|(_, numbers)| !numbers.is_empty());
        if !(sends.is_empty() && receives.is_empty()) {
            self.sums.communicator().exchange(&sends, &mut receives);
        }
        received
    }

    /// On rank 0 the numbers of `cells`, numbers in the whole mesh, in their order; nothing elsewhere. `of_own` has equally many numbers for every
    /// own cell. A collective call with the same cells.
    pub fn gather(&self, of_own: &[f64], cells: &[usize]) -> Vec<f64> {
        let len = of_own.len() / self.own.len().max(1);
        let own = numbers_of(self.own_among(cells), of_own, len);
        let communicator = self.sums.communicator();
        if communicator.rank() > 0 {
            if !own.is_empty() {
                communicator.exchange(&[(0, &own)], &mut []);
            }
            return Vec::new();
        }
        let of_ranks = self.receive_numbers(own, len, cells);
        self.in_order(&of_ranks, len, cells.iter().copied())
    }

    /// The `len` numbers of each of the `cells`, from the numbers of every rank in the order of its cells.
    fn in_order(&self, of_ranks: &[Vec<f64>], len: usize, cells: impl Iterator<Item = usize>) -> Vec<f64> {
        let mut ends = vec![0; of_ranks.len()];
        let mut next = |cell: usize| {
            let rank = self.rank_of_cell[cell] as usize;
            ends[rank] += len;
            &of_ranks[rank][ends[rank] - len..ends[rank]]
        };
        cells.flat_map(|cell| next(cell).iter().copied()).collect()
    }

    /// On every rank the numbers of a range of cells of the whole mesh: `ranges` has that of each rank. `of_own` has equally many numbers for every
    /// own cell. A collective call with the same ranges.
    pub fn deal(&self, of_own: &[f64], ranges: &[Range<usize>]) -> Vec<f64> {
        let len = of_own.len() / self.own.len().max(1);
        let sent: Vec<Vec<f64>> = ranges.iter().map(|range| numbers_of(self.own_within(range), of_own, len)).collect();
        let cells = ranges[self.sums.communicator().rank()].clone();
        let mut of_ranks = vec![Vec::new(); ranges.len()];
        for cell in cells.clone() {
            let of_rank = &mut of_ranks[self.rank_of_cell[cell] as usize];
            of_rank.resize(of_rank.len() + len, 0.0);
        }
        self.exchange_lists(&sent, &mut of_ranks);
        self.in_order(&of_ranks, len, cells)
    }

    /// `own`, and `len` numbers for each of the `cells` of all other ranks, rank by rank.
    fn receive_numbers(&self, own: Vec<f64>, len: usize, cells: &[usize]) -> Vec<Vec<f64>> {
        let mut counts = vec![0; self.sums.communicator().size()];
        cells.iter().for_each(|&cell| counts[self.rank_of_cell[cell] as usize] += len);
        let mut of_ranks: Vec<Vec<f64>> =
            counts.into_iter().enumerate().map(|(rank, count)| vec![0.0; if rank > 0 { count } else { 0 }]).collect();
        self.exchange_lists(&[], &mut of_ranks);
        of_ranks[0] = own;
        of_ranks
    }

    /// Sends each rank its list of `sent`, and fills the lists of `received` from each. An empty list is no message.
    fn exchange_lists(&self, sent: &[Vec<f64>], received: &mut [Vec<f64>]) {
        let mut sends: Vec<(usize, &[f64])> =
            sent.iter().enumerate().map(|(rank, numbers)| (rank, &numbers[..])).collect();
        let mut receives: Vec<(usize, &mut [f64])> =
            received.iter_mut().enumerate().map(|(rank, numbers)| (rank, &mut numbers[..])).collect();
        sends.retain(|(_, numbers)| !numbers.is_empty());
        receives.retain(|(_, numbers)| !numbers.is_empty());
        if !(sends.is_empty() && receives.is_empty()) {
            self.sums.communicator().exchange(&sends, &mut receives);
        }
    }

    /// [`Self::gather`] of all cells of the mesh.
    pub fn join(&self, of_own: &[f64]) -> Vec<f64> {
        self.gather(of_own, &(0..self.whole).collect::<Vec<usize>>())
    }

    /// The own part of `len` numbers for every cell of the mesh. Rank 0 has them in parts: `part` gives the numbers of a range of cells.
    /// The `ranges` cover all cells. A collective call with the same `len` and `ranges`.
    pub fn scatter(
        &self,
        len: usize,
        ranges: impl Iterator<Item = Range<usize>>,
        mut part: impl FnMut(Range<usize>) -> Vec<f64>,
    ) -> Vec<f64> {
        let mut all = vec![0.0; self.own.len() * len];
        for range in ranges.filter(|_| len > 0) {
            let cells: Vec<usize> = range.clone().collect();
            let own = match self.sums.communicator().rank() {
                0 => self.send_to_owners(&cells, &part(range), len),
                _ => self.receive_own(&cells, len),
            };
            for (place, numbers) in self.own_among(&cells).zip(own.chunks_exact(len)) {
                all[place * len..(place + 1) * len].copy_from_slice(numbers);
            }
        }
        all
    }

    /// Sends all other ranks the `numbers` of their `cells`, `len` for each, and returns the own ones.
    fn send_to_owners(&self, cells: &[usize], numbers: &[f64], len: usize) -> Vec<f64> {
        let mut of_ranks = vec![Vec::new(); self.sums.communicator().size()];
        for (&cell, numbers) in cells.iter().zip(numbers.chunks_exact(len)) {
            of_ranks[self.rank_of_cell[cell] as usize].extend_from_slice(numbers);
        }
        let own = std::mem::take(&mut of_ranks[0]);
        self.exchange_lists(&of_ranks, &mut []);
        own
    }

    /// Receives from rank 0 the numbers of those of `cells` that are own cells, `len` for each.
    fn receive_own(&self, cells: &[usize], len: usize) -> Vec<f64> {
        let mut own = vec![0.0; self.own_among(cells).count() * len];
        if !own.is_empty() {
            self.sums.communicator().exchange(&[], &mut [(0, &mut own)]);
        }
        own
    }

    /// Lists of all ranks with `len` numbers for each item, sorted by the items' `keys`. A collective call.
    pub(crate) fn all_in_order(&self, keys: &[usize], numbers: Vec<f64>, len: usize) -> Vec<f64> {
        if !self.is_distributed() {
            let mut order: Vec<usize> = (0..keys.len()).collect();
            order.sort_by_key(|&item| keys[item]);
            return order.into_iter().flat_map(|item| numbers[item * len..(item + 1) * len].to_vec()).collect();
        }
        let keyed: Vec<f64> = keys
            .iter()
            .zip(numbers.chunks_exact(len))
            .flat_map(|(&key, numbers)| std::iter::once(key as f64).chain(numbers.iter().copied()))
            .collect();
        let mut all: Vec<Vec<f64>> = self.sums.communicator().all_gather(&keyed);
        let mut items: Vec<&mut [f64]> = all.iter_mut().flat_map(|part| part.chunks_exact_mut(len + 1)).collect();
        items.sort_by(|a, b| a[0].total_cmp(&b[0]));
        items.into_iter().flat_map(|item| item[1..].to_vec()).collect()
    }
}
