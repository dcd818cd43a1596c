//! The order of elimination as a tree of fronts (the multifrontal method, Duff & Reid 1983).
//!
//! A front is a set of nodes that are eliminated together, and the later nodes that their elimination changes. It needs the
//! Schur complements of its children, and passes its own to its parent.

use crate::{Error, dissection, minimum_degree};
use std::ops::Range;

/// Nodes that are eliminated together, by their positions in the order of elimination.
#[derive(Clone, Debug)]
pub struct Front {
    /// The nodes that are eliminated.
    pub eliminated: Range<usize>,
    /// The later nodes that their elimination changes, increasing.
    pub boundary: Vec<usize>,
    /// The fronts whose Schur complements are added here. All of them come earlier.
    pub children: Vec<usize>,
    /// The cell whose matrix is added here, for a leaf of a dissection.
    pub cell: Option<usize>,
}

impl Front {
    /// The number of nodes.
    pub fn len(&self) -> usize {
        self.eliminated.len() + self.boundary.len()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The index in this front of the node at `position`.
    pub fn place(&self, position: usize) -> usize {
        match position.checked_sub(self.eliminated.end) {
            None => position - self.eliminated.start,
            Some(_) => self.eliminated.len() + self.boundary.partition_point(|&other| other < position),
        }
    }
}

/// The order of elimination.
#[derive(Clone, Debug)]
pub struct EliminationTree {
    /// The node at each position.
    pub nodes: Vec<usize>,
    /// The position of each node; `None` for a node that is not in the matrix.
    pub positions: Vec<Option<usize>>,
    /// The fronts, children before parents.
    pub fronts: Vec<Front>,
}

impl EliminationTree {
    /// The approximate minimum degree ordering for a matrix whose node i is coupled with the nodes `neighbours[i]`, symmetrically. A
    /// node stands for `block` rows.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn by_minimum_degree(neighbours: &[Vec<usize>], block: usize) -> Result<Self, Error> {
        let (nodes, fronts) = minimum_degree::fronts(neighbours, block)?;
        Ok(Self::new(nodes, neighbours.len(), fronts))
    }

    /// Nested dissection of a mesh whose cells hold the nodes `cells[cell]`. A list may name a node twice. `centres` are the centres of the
    /// cells. Nodes are below `count`; nodes without a cell are not in the matrix. Every leaf is the front of one cell. The nodes `kept`,
    /// increasing, are not eliminated: they have the last positions, and the last front leaves their Schur complement.
    pub fn by_dissection<const D: usize>(
        cells: &[Vec<usize>],
        centres: &[[f64; D]],
        count: usize,
        kept: &[usize],
    ) -> Self {
        let (nodes, fronts) = dissection::fronts(cells, centres, count, kept);
        Self::new(nodes, count, fronts)
    }

    fn new(nodes: Vec<usize>, count: usize, fronts: Vec<Front>) -> Self {
        let mut positions = vec![None; count];
        nodes.iter().enumerate().for_each(|(position, &node)| positions[node] = Some(position));
        EliminationTree { nodes, positions, fronts }
    }

    /// Entries of the triangular factor, for `block` rows per node.
    pub fn factor_entries(&self, block: usize) -> usize {
        self.fronts.iter().map(|front| front.len() * front.eliminated.len()).sum::<usize>() * block.pow(2)
    }

    /// Multiplications of a Cholesky factorisation, for `block` rows per node.
    pub fn operations(&self, block: usize) -> f64 {
        let of_front = |front: &Front| eliminations(front.len() * block, front.eliminated.len() * block);
        self.fronts.iter().map(of_front).sum()
    }
}

/// The number of multiplications to eliminate `count` of `rows` rows of a symmetric matrix, one after the other.
pub fn eliminations(rows: usize, count: usize) -> f64 {
    (rows - count..rows).map(|left| 0.5 * (left as f64).powi(2)).sum()
}

/// Adds every front to the children of the front that eliminates the first node of its boundary.
pub(crate) fn connect_to_parents(fronts: &mut [Front]) {
    let parent = |front: &Front| {
        let first = *front.boundary.first()?;
        Some(fronts.partition_point(|other| other.eliminated.end <= first))
    };
    let parents: Vec<Option<usize>> = fronts.iter().map(parent).collect();
    fronts.iter_mut().for_each(|front| front.children.clear());
    for (child, parent) in parents.into_iter().enumerate() {
        parent.into_iter().for_each(|parent| fronts[parent].children.push(child));
    }
}

#[cfg(test)]
pub(crate) mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Factorisation, Kind};
    use faer::Mat;
    use std::sync::Arc;

    /// The nodes of a square, coupled with their neighbours.
    pub(crate) fn square(n: usize) -> Vec<Vec<usize>> {
        let beside = |a: usize, b: usize| (a % n).abs_diff(b % n) + (a / n).abs_diff(b / n) == 1;
        (0..n * n).map(|a| (0..n * n).filter(|&b| beside(a, b)).collect()).collect()
    }

    /// Quadrilaterals with a node at every corner, `n` per direction.
    fn quadrilaterals(n: usize) -> EliminationTree {
        let corners = |x: usize, y: usize| [0, 1, n + 1, n + 2].map(|offset| y * (n + 1) + x + offset).to_vec();
        let cells: Vec<_> = (0..n * n).map(|cell| corners(cell % n, cell / n)).collect();
        let centres: Vec<_> = (0..n * n).map(|cell| [(cell % n) as f64, (cell / n) as f64]).collect();
        EliminationTree::by_dissection(&cells, &centres, (n + 1).pow(2), &[])
    }

    #[test]
    fn every_node_is_eliminated_once_and_before_all_that_it_changes() {
        for tree in [EliminationTree::by_minimum_degree(&square(9), 1).unwrap(), quadrilaterals(8)] {
            let mut nodes = tree.nodes.clone();
            nodes.sort_unstable();
            assert_eq!(nodes, (0..81).collect::<Vec<_>>());
            let mut next = 0;
            for (number, front) in tree.fronts.iter().enumerate() {
                assert_eq!(front.eliminated.start, next);
                next = front.eliminated.end;
                assert!(front.boundary.windows(2).all(|pair| pair[0] < pair[1]));
                assert!(front.boundary.first().is_none_or(|&first| first >= next));
                let positions = front.eliminated.clone().chain(front.boundary.iter().copied());
                assert!(positions.enumerate().all(|(place, position)| front.place(position) == place));
                assert!(front.children.iter().all(|&child| child < number));
            }
            assert_eq!(next, 81);
            assert_eq!(tree.fronts.iter().map(|front| front.children.len()).sum::<usize>(), tree.fronts.len() - 1);
        }
    }

    /// What the elimination of all other nodes of a square leaves at its first column is the inverse of that block of the inverse.
    #[test]
    fn kept_nodes_leave_their_schur_complement() {
        let (n, count) = (4, 25);
        let corners = |x: usize, y: usize| [0, 1, n + 1, n + 2].map(|offset| y * (n + 1) + x + offset).to_vec();
        let cells: Vec<_> = (0..n * n).map(|cell| corners(cell % n, cell / n)).collect();
        let centres: Vec<_> = (0..n * n).map(|cell| [(cell % n) as f64, (cell / n) as f64]).collect();
        let kept: Vec<usize> = (0..=n).map(|y| y * (n + 1)).collect();
        let of_cell = |cell: usize| Mat::from_fn(4, 4, |i, j| if i == j { 3.0 + cell as f64 } else { -0.5 });
        let factor = |kept: &[usize]| {
            let tree = Arc::new(EliminationTree::by_dissection(&cells, &centres, count, kept));
            let places = tree.clone();
            Factorisation::new(tree, 1, Kind::Cholesky, |front| {
                if let Some(cell) = front.front.cell {
                    front.add(cells[cell].iter().map(|&node| places.positions[node]), &of_cell(cell));
                }
            })
        };
        let (whole, mut part) = (factor(&[]).unwrap(), factor(&kept).unwrap());
        let complement = part.take_complement();
        let mut x: Vec<f64> = (0..count).map(|k| (k * k % 7) as f64).collect();
        let (mut y, mut work) = (x.clone(), Vec::new());
        whole.solve(&mut x, 1, &mut work);
        part.eliminate(&mut y, 1, &mut work);
        for (i, &node) in kept.iter().enumerate() {
            let entry = |j: usize| complement[(i.max(j), i.min(j))];
            let product: f64 = (0..kept.len()).map(|j| entry(j) * x[kept[j]]).sum();
            assert!((product - y[node]).abs() < 1e-13, "{product} {}", y[node]);
        }
        kept.iter().for_each(|&node| y[node] = x[node]);
        part.substitute(&mut y, 1, &mut work);
        assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-13));
    }

    /// The last front of a square of 2^k cells per direction eliminates one line of nodes.
    #[test]
    fn halves_of_a_square_share_one_line() {
        assert_eq!(quadrilaterals(8).fronts.last().map(|whole| whole.eliminated.len()), Some(9));
    }

    /// 31/4 n^2 log2 n entries of George (1973) for n^2 nodes, with the best cuts.
    #[test]
    fn the_factor_is_as_small_as_theory_says() {
        let theory = |n: f64| 31.0 / 4.0 * n.powi(2) * n.log2();
        let entries = quadrilaterals(64).factor_entries(1) as f64;
        assert!(entries < theory(65.0), "{entries}");
        let entries = EliminationTree::by_minimum_degree(&square(32), 8).unwrap().factor_entries(1) as f64;
        assert!(entries < theory(32.0), "{entries}");
    }
}
