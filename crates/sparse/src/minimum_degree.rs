//! Fronts by the approximate minimum degree ordering (Amestoy, Davis & Duff 1996).
//!
//! Nodes that change the same later nodes form a front. A front joins its parent if the dense kernels gain more than the additional
//! stored zeros cost (relaxed supernodes, Ashcraft & Grimes 1989).

use crate::Error;
use crate::elimination_tree::{Front, connect_to_parents};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;
use faer::sparse::{Pair, SymbolicSparseColMat};

/// Two fronts are joined if they eliminate fewer rows than the first number, and the fraction of zeros in their factor
/// is below the second.
const RELAXED: [(usize, f64); 4] = [(4, 1.0), (16, 0.8), (48, 0.1), (usize::MAX, 0.05)];

/// The node at each position, and the fronts.
pub(crate) fn fronts(neighbours: &[Vec<usize>], block: usize) -> Result<(Vec<usize>, Vec<Front>), Error> {
    let nodes = order(neighbours)?;
    // Nodes of one front must be consecutive: each node comes just after all its children.
    let sorted = postorder(&later_nodes(neighbours, &nodes));
    let nodes: Vec<usize> = sorted.into_iter().map(|position| nodes[position]).collect();
    let mut fronts = relaxed(equal_columns(later_nodes(neighbours, &nodes)), block);
    connect_to_parents(&mut fronts);
    Ok((nodes, fronts))
}

fn order(neighbours: &[Vec<usize>]) -> Result<Vec<usize>, Error> {
    let n = neighbours.len();
    let pair = |row: usize| neighbours[row].iter().map(move |&col| Pair { row, col });
    let pairs: Vec<_> = (0..n).flat_map(pair).collect();
    let (pattern, _) =
        SymbolicSparseColMat::<usize>::try_new_from_indices(n, n, &pairs).map_err(|_| Error::OutOfMemory)?;
    let (mut order, mut positions) = (vec![0; n], vec![0; n]);
    let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<usize>(n, pattern.compute_nnz()));
    let stack = MemStack::new(&mut memory);
    amd::order_maybe_unsorted(&mut order, &mut positions, pattern.as_ref(), amd::Control::default(), stack)
        .map_err(|_| Error::OutOfMemory)?;
    Ok(order)
}

/// For every position the later positions that its elimination changes: its neighbours, and those of the nodes eliminated
/// before it.
fn later_nodes(neighbours: &[Vec<usize>], order: &[usize]) -> Vec<Vec<usize>> {
    let mut positions = vec![0; order.len()];
    order.iter().enumerate().for_each(|(position, &node)| positions[node] = position);
    let mut later_nodes: Vec<Vec<usize>> = Vec::with_capacity(order.len());
    let mut children = vec![Vec::new(); order.len()];
    for (k, &node) in order.iter().enumerate() {
        let inherited = children[k].iter().flat_map(|&child: &usize| later_nodes[child].iter().copied());
        let own = neighbours[node].iter().map(|&other| positions[other]);
        let mut later: Vec<usize> = own.chain(inherited).filter(|&position| position > k).collect();
        later.sort_unstable();
        later.dedup();
        later.first().into_iter().for_each(|&parent| children[parent].push(k));
        later_nodes.push(later);
    }
    later_nodes
}

/// The positions in an order in which each comes just after its children. The parent of a position is the first one that it
/// changes.
fn postorder(later_nodes: &[Vec<usize>]) -> Vec<usize> {
    let mut children = vec![Vec::new(); later_nodes.len()];
    let mut open: Vec<usize> = Vec::new();
    for (k, later) in later_nodes.iter().enumerate() {
        match later.first() {
            Some(&parent) => children[parent].push(k),
            None => open.push(k),
        }
    }
    // From the last to the first: parents before their children.
    let mut order = Vec::with_capacity(later_nodes.len());
    while let Some(k) = open.pop() {
        order.push(k);
        open.extend(&children[k]);
    }
    order.reverse();
    order
}

/// Joins consecutive positions that change the same later ones.
fn equal_columns(later_nodes: Vec<Vec<usize>>) -> Vec<Front> {
    let mut fronts: Vec<Front> = Vec::new();
    for (k, later) in later_nodes.into_iter().enumerate() {
        match fronts.last_mut() {
            Some(last) if last.boundary.first() == Some(&k) && last.boundary[1..] == later => {
                last.eliminated.end = k + 1;
                last.boundary = later;
            }
            _ => fronts.push(Front { eliminated: k..k + 1, boundary: later, children: Vec::new(), cell: None }),
        }
    }
    fronts
}

/// Joins a front with the child just before it, repeatedly, while [`RELAXED`] allows it. A node stands for `block` rows.
fn relaxed(fronts: Vec<Front>, block: usize) -> Vec<Front> {
    let mut joined: Vec<(Front, usize)> = Vec::with_capacity(fronts.len());
    for mut front in fronts {
        let mut zeros = 0;
        while let Some((child, zeros_of_child)) = joined.last() {
            if !child.boundary.first().is_some_and(|first| front.eliminated.contains(first)) {
                break;
            }
            let added = child.eliminated.len() * (front.len() - child.boundary.len());
            let zeros_of_both = zeros + zeros_of_child + added;
            if !pays(&front, child, zeros_of_both, block) {
                break;
            }
            (front.eliminated.start, zeros) = (child.eliminated.start, zeros_of_both);
            joined.pop();
        }
        joined.push((front, zeros));
    }
    joined.into_iter().map(|(front, _)| front).collect()
}

/// Whether it pays to join two fronts into one that stores the given number of `zeros`.
fn pays(front: &Front, child: &Front, zeros: usize, block: usize) -> bool {
    let eliminated = front.eliminated.len() + child.eliminated.len();
    let share = zeros as f64 / (eliminated * (eliminated + front.boundary.len())) as f64;
    RELAXED.iter().any(|(rows, most)| eliminated * block < *rows && share < *most)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A front comes after one that is not its child and has the longer boundary. The count of zeros for such a pair was below zero.
    #[test]
    fn a_front_may_follow_one_that_is_not_its_child() {
        let neighbours: [&[usize]; 12] = [
            &[6, 7, 9, 10, 11],
            &[],
            &[],
            &[4, 6],
            &[3, 6, 7, 8, 11],
            &[],
            &[0, 3, 4, 7, 10, 11],
            &[0, 4, 6, 8, 10, 11],
            &[4, 7, 11],
            &[0],
            &[0, 6, 7, 11],
            &[0, 4, 6, 7, 8, 10],
        ];
        let neighbours: Vec<Vec<usize>> = neighbours.iter().map(|others| others.to_vec()).collect();
        let (nodes, fronts) = fronts(&neighbours, 1).unwrap();
        assert_eq!(nodes.len(), fronts.iter().map(|front| front.eliminated.len()).sum());
    }
}
