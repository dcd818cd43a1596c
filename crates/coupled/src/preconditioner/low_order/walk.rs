//! The order in which nodes are eliminated: cell by cell, and in a cell from the side of the neighbour that comes first.
//!
//! Consistent directions across cells keep the iterations low where cells are thin.

use super::matrix::NodeBlocks;
use crate::preconditioner::ordering::Ordering;

/// The order of cells and nodes.
pub(super) struct Walk {
    pub(super) ordering: Ordering,
    /// For every cell: bit a is set where nodes are taken from high to low along axis a.
    descending: Vec<u8>,
    /// Nodes in the order of each combination of directions.
    orders: Vec<Vec<u32>>,
}

impl Walk {
    pub(super) fn new<const D: usize, const M: usize>(matrix: &NodeBlocks<D, M>, ordering: Ordering) -> Self {
        let (n, nodes) = (matrix.order, matrix.layout.nodes);
        let descending = (0..matrix.layout.cells).map(|cell| directions(matrix, &ordering, cell)).collect();
        let turned = |mask: usize, i: usize| {
            let digit = |axis: usize| i / n.pow(axis as u32) % n;
            let place = |axis: usize| if mask >> axis & 1 == 1 { n - 1 - digit(axis) } else { digit(axis) };
            (0..D).map(|axis| place(axis) * n.pow(axis as u32)).sum::<usize>() as u32
        };
        let orders = (0..1 << D).map(|mask| (0..nodes).map(|i| turned(mask, i)).collect()).collect();
        Walk { ordering, descending, orders }
    }

    /// The nodes of a cell in their order.
    pub(super) fn nodes(&self, cell: usize) -> &[u32] {
        &self.orders[self.descending[cell] as usize]
    }

    /// Whether the node of `cell` across `face` of one of its nodes comes before it.
    #[inline(always)]
    pub(super) fn is_earlier_inside(&self, cell: usize, face: usize) -> bool {
        (self.descending[cell] >> (face / 2) & 1 == 1) == (face % 2 == 1)
    }

    /// Whether the first cell comes before the second.
    pub(super) fn is_before(&self, first: usize, second: usize) -> bool {
        self.ordering.positions[first] < self.ordering.positions[second]
    }
}

/// Nodes are taken from the side of the neighbour that is eliminated first; where one is missing, away from an earlier or towards a later one.
fn directions<const D: usize, const M: usize>(matrix: &NodeBlocks<D, M>, ordering: &Ordering, cell: usize) -> u8 {
    let own = ordering.positions[cell];
    let position = |face: usize| matrix.cell_in_block(cell, face).map(|other| ordering.positions[other]);
    let is_descending = |axis: usize| match (position(2 * axis), position(2 * axis + 1)) {
        (None, None) => false,
        (None, Some(high)) => high < own,
        (Some(low), None) => low > own,
        (Some(low), Some(high)) => high < low,
    };
    (0..D).map(|axis| u8::from(is_descending(axis)) << axis).sum()
}
