//! The factors of a sparse matrix, and solutions with them.

use crate::elimination_tree::{EliminationTree, Front};
use crate::front::{Factors, Kind};
use crate::{Error, Scalar, dependency_schedule};
use faer::{Mat, MatMut};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The matrix of a front while it is assembled.
pub struct FrontMatrix<'a, T> {
    /// The front.
    pub front: &'a Front,
    matrix: Mat<T>,
    block: usize,
    kind: Kind,
}

impl<T: Scalar> FrontMatrix<'_, T> {
    /// Adds a matrix of blocks whose node k is at `positions[k]`. Rows and columns without a position are left out. A Cholesky
    /// factorisation uses only the lower triangle.
    pub fn add(&mut self, positions: impl Iterator<Item = Option<usize>>, matrix: &Mat<T>) {
        let n = self.block;
        let places: Vec<_> = positions.map(|position| position.map(|p| self.front.place(p) * n)).collect();
        for (l, column) in places.iter().enumerate().filter_map(|(l, place)| place.map(|place| (l, place))) {
            for j in 0..n {
                let (to, from) = (self.matrix.col_as_slice_mut(column + j), matrix.col_as_slice(l * n + j));
                for (from, row) in from.chunks_exact(n).zip(&places) {
                    if let Some(row) = row.filter(|row| self.kind == Kind::Lu || *row >= column) {
                        to[row..row + n].iter_mut().zip(from).for_each(|(to, from)| *to += *from);
                    }
                }
            }
        }
    }

    /// Adds `block`, stored by columns, at the rows of the node at position `row` and the columns of the node at position
    /// `column`.
    pub fn add_block(&mut self, row: usize, column: usize, block: &[T]) {
        let n = self.block;
        let (row, column) = (self.front.place(row) * n, self.front.place(column) * n);
        for (j, from) in block.chunks_exact(n).enumerate() {
            let to = &mut self.matrix.col_as_slice_mut(column + j)[row..row + n];
            to.iter_mut().zip(from).for_each(|(to, from)| *to += *from);
        }
    }
}

/// Adds the entries that belong to a front.
pub type Assembly<'a, T> = dyn Fn(&mut FrontMatrix<'_, T>) + Sync + 'a;

/// The factors of a matrix of square blocks.
pub struct Factorisation<T> {
    tree: Arc<EliminationTree>,
    block: usize,
    factors: Vec<Factors<T>>,
    /// Nodes of the largest front.
    largest: usize,
    /// What the last front leaves.
    complement: Mat<T>,
}

impl<T: Scalar> Factorisation<T> {
    /// Factors the matrix with `block` rows per node of `tree`. `assemble` adds the entries that belong to each front.
    ///
    /// # Errors
    /// [`Error::NotDefinite`] or [`Error::Singular`] of the first front that fails.
    pub fn new(
        tree: Arc<EliminationTree>,
        block: usize,
        kind: Kind,
        assemble: impl Fn(&mut FrontMatrix<'_, T>) + Sync,
    ) -> Result<Self, Error> {
        T::factor(tree, block, kind, &assemble)
    }

    pub(crate) fn factored(
        tree: Arc<EliminationTree>,
        block: usize,
        kind: Kind,
        assemble: &Assembly<T>,
    ) -> Result<Self, Error> {
        let fronts = &tree.fronts;
        let complements: Vec<Mutex<Mat<T>>> = fronts.iter().map(|_| Mutex::new(Mat::new())).collect();
        let factors: Vec<OnceLock<Result<Factors<T>, Error>>> = fronts.iter().map(|_| OnceLock::new()).collect();
        let exchange = |number: usize, complement| {
            std::mem::replace(&mut *complements[number].lock().unwrap_or_else(PoisonError::into_inner), complement)
        };
        let children = |number: usize| fronts[number].children.iter().copied();
        dependency_schedule(fronts.len(), fronts.len(), children, |number| {
            let front = &fronts[number];
            let size = front.len() * block;
            let mut f = FrontMatrix { front, matrix: Mat::zeros(size, size), block, kind };
            assemble(&mut f);
            for child in children(number) {
                let complement = exchange(child, Mat::new());
                // A child that has failed leaves no complement.
                if complement.nrows() > 0 {
                    f.add(fronts[child].boundary.iter().map(|&position| Some(position)), &complement);
                }
            }
            let eliminated = Factors::new(kind, f.matrix, front.eliminated.len() * block);
            let own = eliminated.map(|(own, complement)| {
                exchange(number, complement);
                own
            });
            let _ = factors[number].set(own);
        });
        let factors = factors.into_iter().filter_map(OnceLock::into_inner).collect::<Result<Vec<_>, _>>()?;
        let largest = fronts.iter().map(Front::len).max().unwrap_or(0);
        let complement = fronts.len().checked_sub(1).map_or_else(Mat::new, |last| exchange(last, Mat::new()));
        Ok(Factorisation { tree, block, factors, largest, complement })
    }

    /// The order of elimination, for another matrix of the same pattern.
    pub fn tree(&self) -> &Arc<EliminationTree> {
        &self.tree
    }

    /// Memory of the factors in bytes.
    pub fn bytes(&self) -> usize {
        self.factors.iter().map(Factors::bytes).sum()
    }

    /// Takes the Schur complement S of the nodes that are kept, see [`EliminationTree::by_dissection`]. Of a Cholesky factorisation only
    /// its lower triangle is set.
    pub fn take_complement(&mut self) -> Mat<T> {
        std::mem::replace(&mut self.complement, Mat::new())
    }

    /// x := A^{-1} x for `count` right-hand sides, `[right-hand side][node][row of the block]`. Entries of nodes without a position
    /// are neither read nor written. After a first call with the same `count` and `work` nothing is allocated.
    pub fn solve(&self, x: &mut [T], count: usize, work: &mut Vec<T>) {
        self.eliminate(x, count, work);
        self.substitute(x, count, work);
    }

    /// The first half of [`Self::solve`]. For nodes that are kept it subtracts from x what the elimination of all others leaves there: the
    /// right-hand side of S.
    pub fn eliminate(&self, x: &mut [T], count: usize, work: &mut Vec<T>) {
        T::eliminate(self, x, count, work);
    }

    pub(crate) fn forward_sweep(&self, x: &mut [T], count: usize, work: &mut Vec<T>) {
        let (mut x, (work, scratch)) = (RightHandSides { entries: x, count }, self.work_space(count, work));
        let fronts = self.tree.fronts.iter().zip(&self.factors);
        fronts.for_each(|(front, factors)| self.forward(front, factors, &mut x, work, scratch));
    }

    /// The second half of [`Self::solve`]. It reads the solution at nodes that are kept.
    pub fn substitute(&self, x: &mut [T], count: usize, work: &mut Vec<T>) {
        T::substitute(self, x, count, work);
    }

    pub(crate) fn backward_sweep(&self, x: &mut [T], count: usize, work: &mut Vec<T>) {
        let (mut x, (work, _)) = (RightHandSides { entries: x, count }, self.work_space(count, work));
        let fronts = self.tree.fronts.iter().zip(&self.factors);
        fronts.rev().for_each(|(front, factors)| self.backward(front, factors, &mut x, work));
    }

    /// Space for the rows of the largest front, twice.
    fn work_space<'a>(&self, count: usize, work: &'a mut Vec<T>) -> (&'a mut [T], &'a mut [T]) {
        let local = self.largest * self.block * count;
        work.resize(2 * local, T::zero_impl());
        work.split_at_mut(local)
    }

    fn forward(
        &self,
        front: &Front,
        factors: &Factors<T>,
        x: &mut RightHandSides<T>,
        work: &mut [T],
        scratch: &mut [T],
    ) {
        let ([e, b], count) = (self.rows(front), x.count);
        let (x_e, change) = work[..(e + b) * count].split_at_mut(e * count);
        self.gather(front.eliminated.clone(), x, x_e);
        factors.forward(columns(x_e, e, count), columns(change, b, count), &mut scratch[..e * count]);
        self.scatter(front.eliminated.clone(), x_e, x, |x, new| *x = new);
        self.scatter(front.boundary.iter().copied(), change, x, |x, change| *x -= change);
    }

    fn backward(&self, front: &Front, factors: &Factors<T>, x: &mut RightHandSides<T>, work: &mut [T]) {
        let ([e, b], count) = (self.rows(front), x.count);
        let (x_e, x_b) = work[..(e + b) * count].split_at_mut(e * count);
        self.gather(front.eliminated.clone(), x, x_e);
        self.gather(front.boundary.iter().copied(), x, x_b);
        factors.backward(columns(x_e, e, count), columns(x_b, b, count));
        self.scatter(front.eliminated.clone(), x_e, x, |x, new| *x = new);
    }

    /// The numbers of rows that a front eliminates and of rows of its boundary.
    fn rows(&self, front: &Front) -> [usize; 2] {
        [front.eliminated.len(), front.boundary.len()].map(|nodes| nodes * self.block)
    }

    /// The first entry of the node at `position` in a vector.
    fn start(&self, position: usize) -> usize {
        self.tree.nodes[position] * self.block
    }

    /// Copies the entries of the nodes at `positions` of every right-hand side to `local`.
    fn gather(&self, positions: impl Iterator<Item = usize> + Clone, x: &RightHandSides<T>, local: &mut [T]) {
        let mut local = local.chunks_exact_mut(self.block);
        for x in x.entries.chunks_exact(x.length()) {
            for (position, local) in positions.clone().zip(&mut local) {
                local.copy_from_slice(&x[self.start(position)..][..self.block]);
            }
        }
    }

    /// Changes the entries of the nodes at `positions` of every right-hand side by the entries of `local`.
    fn scatter(
        &self,
        positions: impl Iterator<Item = usize> + Clone,
        local: &[T],
        x: &mut RightHandSides<T>,
        change: impl Fn(&mut T, T),
    ) {
        let (length, mut local) = (x.length(), local.chunks_exact(self.block));
        for x in x.entries.chunks_exact_mut(length) {
            for (position, local) in positions.clone().zip(&mut local) {
                let x = &mut x[self.start(position)..][..self.block];
                x.iter_mut().zip(local).for_each(|(x, local)| change(x, *local));
            }
        }
    }
}

/// The entries of `count` right-hand sides, `[right-hand side][node][row of the block]`.
struct RightHandSides<'a, T> {
    entries: &'a mut [T],
    count: usize,
}

impl<T> RightHandSides<'_, T> {
    /// The length of one, at least 1 so that it can be the length of chunks.
    fn length(&self) -> usize {
        (self.entries.len() / self.count).max(1)
    }
}

/// A matrix of `rows` rows and `count` columns.
fn columns<T>(entries: &mut [T], rows: usize, count: usize) -> MatMut<'_, T> {
    MatMut::from_column_major_slice_mut(entries, rows, count)
}
