//! Fronts by nested dissection of a mesh (George 1973).
//!
//! The cells are cut into two halves of equal number, and these again, down to single cells. **A node is eliminated with the smallest part
//! of the mesh that holds all its cells**, because no other part needs it. Several cuts are tried: halves along each axis and halves of the
//! list of cells. The cut with the fewest nodes on it is taken.

use crate::elimination_tree::Front;

/// The node at each position, and the fronts: one for each part, after the fronts of its halves. The nodes `kept`, increasing, have the last
/// positions, and no front eliminates them. See [`crate::EliminationTree::by_dissection`].
pub(crate) fn fronts<const D: usize>(
    cells: &[Vec<usize>],
    centres: &[[f64; D]],
    count: usize,
    kept: &[usize],
) -> (Vec<usize>, Vec<Front>) {
    let mut multiplicity = vec![0; count];
    cells.iter().flatten().for_each(|&node| multiplicity[node] += 1);
    // More places than any part has.
    kept.iter().for_each(|&node| multiplicity[node] = usize::MAX);
    let by_axis = (0..D).map(|axis| centres.iter().map(|centre| centre[axis]).collect());
    let by_number = (0..cells.len()).map(|cell| cell as f64).collect();
    let keys = by_axis.chain([by_number]).collect();
    let seen = vec![0; count];
    let mut cutter = Cutter { cells, multiplicity, keys, seen, marks: 0, order: Vec::new(), fronts: Vec::new() };
    if !cells.is_empty() {
        cutter.dissect(&mut (0..cells.len()).collect::<Vec<_>>());
    }
    let Cutter { mut order, mut fronts, .. } = cutter;
    order.extend(kept);
    to_positions(&mut fronts, &order, count);
    (order, fronts)
}

/// Replaces the nodes of boundaries by their positions.
fn to_positions(fronts: &mut [Front], order: &[usize], count: usize) {
    let mut positions = vec![0; count];
    order.iter().enumerate().for_each(|(position, &node)| positions[node] = position);
    for front in fronts {
        front.boundary.iter_mut().for_each(|node| *node = positions[*node]);
        front.boundary.sort_unstable();
    }
}

/// The work space of the recursion.
struct Cutter<'a> {
    cells: &'a [Vec<usize>],
    /// The number of places of cells in which each node lies.
    multiplicity: Vec<usize>,
    /// Sort keys of the cells for the cut through the middle.
    keys: Vec<Vec<f64>>,
    /// The last mark of each node.
    seen: Vec<usize>,
    marks: usize,
    order: Vec<usize>,
    fronts: Vec<Front>,
}

impl Cutter<'_> {
    /// Dissects a part. Returns its boundary, with the number of places of each node in the part, sorted by nodes.
    fn dissect(&mut self, part: &mut [usize]) -> Vec<(usize, usize)> {
        let (cell, children, nodes) = match part {
            [cell] => (Some(*cell), vec![], merged(self.cells[*cell].iter().map(|&node| (node, 1)).collect())),
            _ => {
                self.cut(part);
                let (first, second) = part.split_at_mut(part.len() / 2);
                let mut nodes = self.dissect(first);
                let last_of_first = self.fronts.len() - 1;
                nodes.extend(self.dissect(second));
                (None, vec![last_of_first, self.fronts.len() - 1], merged(nodes))
            }
        };
        let is_complete = |&(node, places): &(usize, usize)| places == self.multiplicity[node];
        let (complete, boundary): (Vec<_>, Vec<_>) = nodes.into_iter().partition(is_complete);
        let start = self.order.len();
        self.order.extend(complete.iter().map(|(node, _)| node));
        let (eliminated, nodes) = (start..self.order.len(), boundary.iter().map(|(node, _)| *node).collect());
        self.fronts.push(Front { eliminated, boundary: nodes, children, cell });
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

    /// Moves the half of the part with the smaller keys to the front; equal keys in the order of the cells.
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
