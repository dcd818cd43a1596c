//! Sums over the blocks of the mesh, with the same bits on any number of ranks.

use crate::{Alone, Communicator};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// The blocks of the mesh that this rank owns, and sums over all blocks in a fixed order.
///
/// The order is that of a binary tree over the blocks. The sum of the blocks a..b is that of a..m plus that of m..b, m = (a + b) / 2. A
/// rank adds up the largest nodes of the tree that hold its own blocks only; these sums go to all ranks, and each adds up the rest.
#[derive(Clone)]
pub struct Sums {
    communicator: Arc<dyn Communicator>,
    /// Contiguous, in the order of ranks.
    blocks_of_rank: Vec<Range<usize>>,
    /// The number of sums that each rank contributes to a total.
    nodes_of_rank: Vec<usize>,
}

impl Sums {
    /// One block, one rank.
    pub fn alone() -> Self {
        Self::new(Arc::new(Alone), 1)
    }

    /// Distributes the blocks evenly: rank r of P owns the blocks r B / P .. (r + 1) B / P.
    ///
    /// # Panics
    ///
    /// If there are fewer blocks than ranks.
    pub fn new(communicator: Arc<dyn Communicator>, blocks: usize) -> Self {
        let size = communicator.size();
        assert!(blocks >= size, "{blocks} blocks are too few for {size} ranks");
        let blocks_of_rank: Vec<_> = (0..size).map(|rank| rank * blocks / size..(rank + 1) * blocks / size).collect();
        let nodes_of_rank = blocks_of_rank.iter().map(|own| nodes(blocks, own).len()).collect();
        Self { communicator, blocks_of_rank, nodes_of_rank }
    }

    /// The blocks of this rank.
    pub fn own(&self) -> Range<usize> {
        self.blocks_of_rank[self.communicator.rank()].clone()
    }

    /// The number of all blocks.
    pub fn blocks(&self) -> usize {
        self.blocks_of_rank.last().map_or(0, |range| range.end)
    }

    /// The blocks of every rank, in the order of ranks.
    pub fn blocks_of_rank(&self) -> &[Range<usize>] {
        &self.blocks_of_rank
    }

    /// The group of ranks.
    pub fn communicator(&self) -> &Arc<dyn Communicator> {
        &self.communicator
    }

    /// The sum over all blocks of `parts[own block][k]`, k = 0..`count` fastest: the same bits on any number of ranks. With one block it
    /// is `parts`; one rank communicates nothing.
    pub fn total(&self, parts: &[f64], count: usize) -> Vec<f64> {
        let own = self.own();
        assert_eq!(parts.len(), own.len() * count, "one part for each own block");
        let part = |block: usize| parts[(block - own.start) * count..][..count].to_vec();
        let of_node = |node| add(node, &mut |range| (range.len() == 1).then(|| part(range.start)));
        let mut sums: Vec<Vec<f64>> = nodes(self.blocks(), &own).into_iter().map(of_node).collect();
        if self.communicator.size() == 1 {
            return sums.swap_remove(0);
        }
        let lengths: Vec<usize> = self.nodes_of_rank.iter().map(|nodes| nodes * count).collect();
        self.top(&self.communicator.all_gather_known(&sums.concat(), &lengths), count)
    }

    /// The sum over all blocks from the sums of the nodes of all ranks, which are in the order of blocks.
    fn top(&self, sums: &[f64], count: usize) -> Vec<f64> {
        let mut place = 0;
        add(0..self.blocks(), &mut |range| {
            self.blocks_of_rank.iter().any(|blocks| holds(blocks, range)).then(|| {
                place += count;
                sums[place - count..place].to_vec()
            })
        })
    }

    /// The largest value of all ranks; NaN if one of them is NaN.
    pub fn largest(&self, value: f64) -> f64 {
        if self.communicator.size() == 1 {
            return value;
        }
        let values = self.communicator.all_gather_known(&[value], &vec![1; self.blocks_of_rank.len()]);
        let larger = |a: f64, b: f64| if a.is_nan() || (!b.is_nan() && a.total_cmp(&b).is_ge()) { a } else { b };
        values.into_iter().fold(f64::NEG_INFINITY, larger)
    }
}

impl fmt::Debug for Sums {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rank = self.communicator.rank();
        formatter.debug_struct("Sums").field("rank", &rank).field("blocks_of_rank", &self.blocks_of_rank).finish()
    }
}

/// The sum at a node of the tree: `known`, or that of its lower half plus that of its upper half.
fn add(node: Range<usize>, known: &mut impl FnMut(&Range<usize>) -> Option<Vec<f64>>) -> Vec<f64> {
    known(&node).unwrap_or_else(|| {
        let [lower, upper] = halves(&node);
        let mut sum = add(lower, known);
        let upper = add(upper, known);
        sum.iter_mut().zip(upper).for_each(|(sum, upper)| *sum += upper);
        sum
    })
}

/// The largest nodes of the tree over so many `blocks` that hold `own` blocks only, in their order.
fn nodes(blocks: usize, own: &Range<usize>) -> Vec<Range<usize>> {
    let mut nodes = Vec::new();
    collect_nodes(0..blocks, own, &mut nodes);
    nodes
}

/// The largest nodes of the tree below `node` that hold `own` blocks only, in the order of blocks.
fn collect_nodes(node: Range<usize>, own: &Range<usize>, nodes: &mut Vec<Range<usize>>) {
    if holds(own, &node) {
        nodes.push(node);
    } else if node.start < own.end && own.start < node.end {
        halves(&node).into_iter().for_each(|half| collect_nodes(half, own, nodes));
    }
}

/// The lower and the upper half of a node of two or more blocks.
fn halves(node: &Range<usize>) -> [Range<usize>; 2] {
    let middle = node.start + node.len() / 2;
    [node.start..middle, middle..node.end]
}

/// Whether all blocks of `node` are among `blocks`.
fn holds(blocks: &Range<usize>, node: &Range<usize>) -> bool {
    blocks.start <= node.start && node.end <= blocks.end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Threads;

    /// Numbers of a block whose sum depends on the order.
    fn part(block: usize) -> [f64; 3] {
        [1.0 / (1 + block) as f64, (block as f64).exp(), [1e16, -1.1, 0.3][block % 3]]
    }

    fn bits(sums: &[f64]) -> Vec<u64> {
        sums.iter().map(|sum| sum.to_bits()).collect()
    }

    /// The bits of the total on all of `size` ranks.
    fn totals(size: usize, blocks: usize) -> Vec<Vec<u64>> {
        Threads::run(size, |ranks| {
            let sums = Sums::new(ranks, blocks);
            let parts: Vec<f64> = sums.own().flat_map(part).collect();
            bits(&sums.total(&parts, 3))
        })
    }

    #[test]
    fn a_sum_has_the_same_bits_on_any_number_of_ranks() {
        for blocks in [8, 13] {
            let reference = totals(1, blocks).swap_remove(0);
            for size in 1..=8 {
                assert!(totals(size, blocks).iter().all(|total| *total == reference), "{size} ranks, {blocks} blocks");
            }
        }
    }

    #[test]
    fn a_sum_is_a_tree() {
        let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|block| part(block)[0]);
        let total = Sums::new(Arc::new(Alone), 5).total(&[a, b, c, d, e], 1);
        assert_eq!(total, [(a + b) + (c + (d + e))]);
    }

    #[test]
    fn one_block_is_its_own_sum() {
        let sums = Sums::alone();
        assert_eq!((sums.own(), sums.blocks()), (0..1, 1));
        assert_eq!(bits(&sums.total(&[-0.0, 0.1], 2)), bits(&[-0.0, 0.1]));
        assert!(sums.total(&[], 0).is_empty());
    }

    #[test]
    fn blocks_are_dealt_out_evenly() {
        let own = Threads::run(3, |ranks| Sums::new(ranks, 8).own());
        assert_eq!(own, [0..2, 2..5, 5..8]);
    }

    #[test]
    #[should_panic(expected = "1 blocks are too few for 2 ranks")]
    fn fewer_blocks_than_ranks_are_refused() {
        Threads::run(2, |ranks| Sums::new(ranks, 1));
    }

    #[test]
    fn the_largest_value_wins_unless_one_is_not_a_number() {
        let of_rank =
            |ranks: Arc<dyn Communicator>, values: &[f64]| Sums::new(ranks.clone(), 3).largest(values[ranks.rank()]);
        let largest = |values: &[f64]| Threads::run(3, |ranks| of_rank(ranks, values));
        assert_eq!(largest(&[-3.0, -1.0, -2.0]), [-1.0; 3]);
        assert_eq!(largest(&[f64::NEG_INFINITY; 3]), [f64::NEG_INFINITY; 3]);
        for bad in 0..3 {
            let values: Vec<_> = (0..3).map(|rank| if rank == bad { -f64::NAN } else { f64::INFINITY }).collect();
            assert!(largest(&values).into_iter().all(f64::is_nan));
        }
        assert!(Sums::alone().largest(f64::NAN).is_nan());
    }
}
