//! Nested dissection: in which order nodes are eliminated.
//!
//! The cells are cut into two halves of equal number, these again, down to single cells. **A node is eliminated with the smallest part
//! of the mesh that holds all its cells**: by then no other part needs it. Of several cuts (halves along each axis, halves of the list
//! of cells) the one that the fewest nodes lie on is taken.

use std::ops::Range;

/// A part of the mesh: one cell, or two smaller parts.
#[derive(Debug)]
pub(crate) struct Part {
    pub(crate) members: Members,
    /// What is eliminated here, in numbers of the order of elimination.
    pub(crate) eliminated: Range<usize>,
    /// The nodes that other parts hold as well, in the same numbers, increasing. All of them are eliminated later.
    pub(crate) boundary: Vec<usize>,
}

/// What a part consists of.
#[derive(Debug)]
pub(crate) enum Members {
    /// One cell.
    Cell(usize),
    /// Two parts: the second one is listed just before their union, the first one just before the `second` parts of that.
    Parts {
        /// The number of parts in the second half, with itself.
        second: usize,
    },
}

/// The tree of parts, each part behind those that it consists of; the last one is the whole mesh.
pub(crate) struct Dissection {
    pub(crate) parts: Vec<Part>,
    /// The node of each number.
    pub(crate) order: Vec<usize>,
}

impl Dissection {
    /// Dissects the cells with the nodes `cells[cell]`, in which a node may occur twice, around `centres`. Nodes are below `count`.
    pub(crate) fn new<const D: usize>(cells: &[Vec<usize>], centres: &[[f64; D]], count: usize) -> Self {
        let mut multiplicity = vec![0; count];
        cells.iter().flatten().for_each(|&node| multiplicity[node] += 1);
        let by_axis = (0..D).map(|axis| centres.iter().map(|centre| centre[axis]).collect());
        let by_number = (0..cells.len()).map(|cell| cell as f64).collect();
        let keys = by_axis.chain([by_number]).collect();
        let (seen, dissection) = (vec![0; count], Dissection { parts: Vec::new(), order: Vec::new() });
        let mut cutter = Cutter { cells, multiplicity, keys, seen, marks: 0, dissection };
        cutter.dissect(&mut (0..cells.len()).collect::<Vec<_>>());
        cutter.dissection.numbered(count)
    }

    /// The same with boundaries by the numbers of their nodes.
    fn numbered(mut self, count: usize) -> Self {
        let mut numbers = vec![0; count];
        self.order.iter().enumerate().for_each(|(number, &node)| numbers[node] = number);
        for part in &mut self.parts {
            part.boundary.iter_mut().for_each(|node| *node = numbers[*node]);
            part.boundary.sort_unstable();
        }
        self
    }

    /// Stored entries of the triangular factor, for `dimension` unknowns per node.
    pub(crate) fn factor_entries(&self, dimension: usize) -> usize {
        let entries = |part: &Part| (part.eliminated.len() + part.boundary.len()) * part.eliminated.len();
        self.parts.iter().map(entries).sum::<usize>() * dimension.pow(2)
    }
}

/// Work space of the recursion.
struct Cutter<'a> {
    cells: &'a [Vec<usize>],
    /// In how many places of cells each node lies.
    multiplicity: Vec<usize>,
    /// By what cells may be sorted before the cut through the middle.
    keys: Vec<Vec<f64>>,
    /// The mark that a node has got last.
    seen: Vec<usize>,
    marks: usize,
    dissection: Dissection,
}

impl Cutter<'_> {
    /// Dissects a part; returns its boundary, with the number of places of each node in the part, sorted by nodes.
    fn dissect(&mut self, part: &mut [usize]) -> Vec<(usize, usize)> {
        let (members, nodes) = match part {
            [cell] => (Members::Cell(*cell), merged(self.cells[*cell].iter().map(|&node| (node, 1)).collect())),
            _ => {
                self.cut(part);
                let (first, second) = part.split_at_mut(part.len() / 2);
                let mut nodes = self.dissect(first);
                let before = self.dissection.parts.len();
                nodes.extend(self.dissect(second));
                (Members::Parts { second: self.dissection.parts.len() - before }, merged(nodes))
            }
        };
        let is_complete = |&(node, places): &(usize, usize)| places == self.multiplicity[node];
        let (complete, boundary): (Vec<_>, Vec<_>) = nodes.into_iter().partition(is_complete);
        let start = self.dissection.order.len();
        self.dissection.order.extend(complete.iter().map(|(node, _)| node));
        let eliminated = start..self.dissection.order.len();
        self.dissection.parts.push(Part {
            members,
            eliminated,
            boundary: boundary.iter().map(|(node, _)| *node).collect(),
        });
        boundary
    }

    /// Sorts a part so that its halves have the fewest nodes in common.
    fn cut(&mut self, part: &mut [usize]) {
        let mut best = (usize::MAX, 0);
        for key in 0..self.keys.len() {
            self.halve(part, key);
            best = best.min((self.common_nodes(part), key));
        }
        self.halve(part, best.1);
    }

    /// Brings the half of the part with the smaller keys to the front; equal keys in the order of the cells.
    fn halve(&self, part: &mut [usize], key: usize) {
        let key = &self.keys[key];
        part.select_nth_unstable_by(part.len() / 2, |a, b| key[*a].total_cmp(&key[*b]).then(a.cmp(b)));
    }

    /// The number of nodes in both halves of the part.
    fn common_nodes(&mut self, part: &[usize]) -> usize {
        let (first, second) = part.split_at(part.len() / 2);
        self.marks += 2;
        first.iter().flat_map(|&cell| &self.cells[cell]).for_each(|&node| self.seen[node] = self.marks);
        let mut common = 0;
        for &node in second.iter().flat_map(|&cell| &self.cells[cell]) {
            if self.seen[node] == self.marks {
                common += 1;
                self.seen[node] = self.marks + 1;
            }
        }
        common
    }
}

/// The sum of places of each node, sorted by nodes.
fn merged(mut nodes: Vec<(usize, usize)>) -> Vec<(usize, usize)> {
    nodes.sort_unstable();
    nodes.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        kept.1 += if same { next.1 } else { 0 };
        same
    });
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quadrilaterals with a node at every corner, `n` per direction.
    fn square(n: usize) -> Dissection {
        let corners = |x: usize, y: usize| [0, 1, n + 1, n + 2].map(|offset| y * (n + 1) + x + offset).to_vec();
        let cells: Vec<_> = (0..n * n).map(|cell| corners(cell % n, cell / n)).collect();
        let centres: Vec<_> = (0..n * n).map(|cell| [(cell % n) as f64, (cell / n) as f64]).collect();
        Dissection::new(&cells, &centres, (n + 1).pow(2))
    }

    #[test]
    fn every_node_is_eliminated_once_and_before_it_is_a_boundary_of_nothing() {
        let dissection = square(7);
        let mut nodes = dissection.order.clone();
        nodes.sort_unstable();
        assert_eq!(nodes, (0..64).collect::<Vec<_>>());
        let mut next = 0;
        for part in &dissection.parts {
            assert_eq!(part.eliminated.start, next);
            next = part.eliminated.end;
            assert!(part.boundary.windows(2).all(|pair| pair[0] < pair[1]));
            assert!(part.boundary.first().is_none_or(|&first| first >= next));
        }
        assert_eq!(next, 64);
        assert!(dissection.parts.last().is_some_and(|whole| whole.boundary.is_empty()));
    }

    /// The last part of a square of 2^k cells per direction eliminates one line of nodes.
    #[test]
    fn halves_of_a_square_share_one_line() {
        let dissection = square(8);
        assert_eq!(dissection.parts.last().map(|whole| whole.eliminated.len()), Some(9));
    }

    /// O(n^2 log n) entries: 31/4 n^2 log2 n of George (1973) for n^2 nodes; his method knows the best cuts.
    #[test]
    fn the_factor_is_as_small_as_theory_says() {
        let entries = square(64).factor_entries(1) as f64;
        assert!(entries < 31.0 / 4.0 * 65.0_f64.powi(2) * 65.0_f64.log2(), "{entries}");
    }
}
