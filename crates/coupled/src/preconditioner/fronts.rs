//! In which order the rows of a sparse matrix are eliminated, and which of them together.
//!
//! A row is eliminated when few others are linked to it (approximate minimum degree, Amestoy, Davis & Duff 1996). Rows that change the
//! same later ones make a front (Duff & Reid 1983); it takes what the fronts before it have left in its rows.

use super::ordering::inverse;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;
use faer::sparse::{FaerError, Pair, SymbolicSparseColMat};
use std::ops::Range;

/// Rows that are eliminated together, by their positions in the order of elimination.
#[derive(Debug)]
pub struct Front {
    /// The rows.
    pub eliminated: Range<usize>,
    /// The later rows that their elimination changes, increasing.
    pub changed: Vec<usize>,
    /// The fronts, all of them earlier, that leave to this one what they change.
    pub children: Vec<usize>,
}

impl Front {
    /// Rows in all.
    pub fn len(&self) -> usize {
        self.eliminated.len() + self.changed.len()
    }

    /// Which of its rows is at `position`.
    pub fn place(&self, position: usize) -> usize {
        match position.checked_sub(self.eliminated.end) {
            None => position - self.eliminated.start,
            Some(_) => self.eliminated.len() + self.changed.partition_point(|&other| other < position),
        }
    }
}

/// The order of elimination.
pub struct Fronts {
    /// The row at each position.
    pub rows: Vec<usize>,
    /// The position of each row.
    pub positions: Vec<usize>,
    /// The fronts in their order.
    pub fronts: Vec<Front>,
}

impl Fronts {
    /// The order for a matrix whose row i is linked to the rows `neighbours[i]`, and they to it.
    ///
    /// # Errors
    /// If memory runs out.
    pub fn new(neighbours: &[Vec<usize>]) -> Result<Self, FaerError> {
        let rows = minimum_degree(neighbours)?;
        // Rows that make a front are to follow one another, which is so when each comes after all that it is a parent of.
        let rows: Vec<usize> =
            after_children(&changed_rows(neighbours, &rows)).into_iter().map(|position| rows[position]).collect();
        let changed = changed_rows(neighbours, &rows);
        let positions = inverse(&rows);
        Ok(Fronts { rows, positions, fronts: joined(changed) })
    }
}

fn minimum_degree(neighbours: &[Vec<usize>]) -> Result<Vec<usize>, FaerError> {
    let n = neighbours.len();
    let pair = |row: usize| neighbours[row].iter().map(move |&col| Pair { row, col });
    let pairs: Vec<_> = (0..n).flat_map(pair).collect();
    let (pattern, _) =
        SymbolicSparseColMat::<usize>::try_new_from_indices(n, n, &pairs).map_err(|_| FaerError::OutOfMemory)?;
    let (mut order, mut positions) = (vec![0; n], vec![0; n]);
    let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<usize>(n, pattern.compute_nnz()));
    let stack = MemStack::new(&mut memory);
    amd::order_maybe_unsorted(&mut order, &mut positions, pattern.as_ref(), amd::Control::default(), stack)?;
    Ok(order)
}

/// For every position the later ones that its elimination changes: its neighbours, and those of what was eliminated before it.
fn changed_rows(neighbours: &[Vec<usize>], order: &[usize]) -> Vec<Vec<usize>> {
    let positions = inverse(order);
    let mut changed: Vec<Vec<usize>> = Vec::with_capacity(order.len());
    let mut children = vec![Vec::new(); order.len()];
    for (k, &row) in order.iter().enumerate() {
        let inherited = children[k].iter().flat_map(|&child: &usize| changed[child].iter().copied());
        let own = neighbours[row].iter().map(|&other| positions[other]);
        let mut later: Vec<usize> = own.chain(inherited).filter(|&position| position > k).collect();
        later.sort_unstable();
        later.dedup();
        later.first().into_iter().for_each(|&parent| children[parent].push(k));
        changed.push(later);
    }
    changed
}

/// The positions in an order in which each comes just after its children, the first that it changes being the parent of each.
fn after_children(changed: &[Vec<usize>]) -> Vec<usize> {
    let mut children = vec![Vec::new(); changed.len()];
    let mut open: Vec<usize> = Vec::new();
    for (k, changed) in changed.iter().enumerate() {
        match changed.first() {
            Some(&parent) => children[parent].push(k),
            None => open.push(k),
        }
    }
    // From the last to the first: parents ahead of their children.
    let mut order = Vec::with_capacity(changed.len());
    while let Some(k) = open.pop() {
        order.push(k);
        open.extend(&children[k]);
    }
    order.reverse();
    order
}

/// Joins positions that follow one another and change the same later ones.
fn joined(changed: Vec<Vec<usize>>) -> Vec<Front> {
    let mut fronts: Vec<Front> = Vec::new();
    for (k, changed) in changed.into_iter().enumerate() {
        match fronts.last_mut() {
            Some(last) if last.changed.first() == Some(&k) && last.changed[1..] == changed => {
                last.eliminated.end = k + 1;
                last.changed = changed;
            }
            _ => fronts.push(Front { eliminated: k..k + 1, changed, children: Vec::new() }),
        }
    }
    let parent = |front: &Front| {
        let first = *front.changed.first()?;
        Some(fronts.partition_point(|other| other.eliminated.end <= first))
    };
    let parents: Vec<Option<usize>> = fronts.iter().map(parent).collect();
    for (child, parent) in parents.into_iter().enumerate() {
        parent.into_iter().for_each(|parent| fronts[parent].children.push(child));
    }
    fronts
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Cells of a square, linked to those beside them.
    pub fn square(n: usize) -> Vec<Vec<usize>> {
        let beside = |a: usize, b: usize| (a % n).abs_diff(b % n) + (a / n).abs_diff(b / n) == 1;
        (0..n * n).map(|a| (0..n * n).filter(|&b| beside(a, b)).collect()).collect()
    }

    #[test]
    fn every_row_is_eliminated_once_and_all_that_it_changes_later() {
        let order = Fronts::new(&square(9)).expect("memory suffices");
        let mut rows = order.rows.clone();
        rows.sort_unstable();
        assert_eq!(rows, (0..81).collect::<Vec<_>>());
        let mut next = 0;
        for (number, front) in order.fronts.iter().enumerate() {
            assert_eq!(front.eliminated.start, next);
            next = front.eliminated.end;
            assert!(front.changed.iter().all(|&position| position >= next));
            let positions = front.eliminated.clone().chain(front.changed.iter().copied());
            assert!(positions.enumerate().all(|(place, position)| front.place(position) == place));
            assert!(front.children.iter().all(|&child| child < number));
        }
        assert_eq!(next, 81);
        assert_eq!(order.fronts.iter().map(|front| front.children.len()).sum::<usize>(), order.fronts.len() - 1);
    }

    /// 31/4 n^2 log2 n of George (1973) for the triangular factor of n^2 nodes, each linked to 8 others.
    #[test]
    fn fill_is_as_small_as_by_nested_dissection() {
        let order = Fronts::new(&square(32)).expect("memory suffices");
        let entries: usize = order.fronts.iter().map(|front| front.eliminated.len() * front.len()).sum();
        assert!((entries as f64) < 31.0 / 4.0 * 32.0_f64.powi(2) * 32.0_f64.log2(), "{entries}");
    }
}
