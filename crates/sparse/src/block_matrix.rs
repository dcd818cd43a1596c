//! A sparse matrix of square blocks.

use crate::elimination_tree::EliminationTree;
use crate::factorisation::{Factorisation, FrontMatrix};
use crate::{Error, Kind, Scalar};
use faer::traits::math_utils::{conj, mul};
use std::sync::Arc;

/// A matrix with one square block for every pair of coupled nodes. For [`Kind::Cholesky`] only blocks on and below the diagonal are stored.
#[derive(Clone, Debug)]
pub struct BlockMatrix<T> {
    kind: Kind,
    block: usize,
    /// For each column its stored rows, increasing.
    rows: Vec<Vec<usize>>,
    /// The number of the first block of each column.
    first: Vec<usize>,
    /// Blocks by columns, each by its columns.
    values: Vec<T>,
}

impl<T: Scalar> BlockMatrix<T> {
    /// The zero matrix with `block` rows per node and the couplings `neighbours`. For each node these are the nodes coupled with it, in
    /// any order; repetitions and the node itself may be included. For [`Kind::Cholesky`] nodes of smaller number may be missing.
    pub fn new(kind: Kind, block: usize, mut neighbours: Vec<Vec<usize>>) -> Self {
        for (node, rows) in neighbours.iter_mut().enumerate() {
            rows.push(node);
            rows.retain(|&row| kind == Kind::Lu || row >= node);
            rows.sort_unstable();
            rows.dedup();
        }
        let starts = neighbours.iter().scan(0, |sum, rows| Some(std::mem::replace(sum, *sum + rows.len())));
        let first: Vec<usize> = starts.collect();
        let blocks = neighbours.iter().map(Vec::len).sum::<usize>();
        BlockMatrix { kind, block, rows: neighbours, first, values: vec![T::zero_impl(); blocks * block * block] }
    }

    /// The number of nodes.
    pub fn nodes(&self) -> usize {
        self.rows.len()
    }

    /// Makes every entry zero.
    pub fn clear(&mut self) {
        self.values.fill(T::zero_impl());
    }

    /// Adds `entry(i, j)` to the block of two coupled nodes. If only the lower triangle is stored, a block above the diagonal is ignored.
    ///
    /// # Panics
    /// If the nodes are not coupled.
    pub fn add(&mut self, row: usize, column: usize, entry: impl Fn(usize, usize) -> T) {
        if self.kind == Kind::Cholesky && row < column {
            return;
        }
        let place = self.rows[column].binary_search(&row).expect("the pattern holds every pair of coupled nodes");
        let (n, start) = (self.block, (self.first[column] + place) * self.block.pow(2));
        for j in 0..n {
            let values = &mut self.values[start + j * n..][..n];
            values.iter_mut().enumerate().for_each(|(i, value)| *value += entry(i, j));
        }
    }

    /// The stored rows and blocks of a column; each block is stored by columns.
    pub fn column(&self, column: usize) -> impl Iterator<Item = (usize, &[T])> {
        let length = self.block.pow(2);
        let blocks = self.values[self.first[column] * length..].chunks_exact(length);
        self.rows[column].iter().copied().zip(blocks)
    }

    /// A x.
    pub fn product(&self, x: &[T]) -> Vec<T> {
        let (n, mut y) = (self.block, vec![T::zero_impl(); x.len()]);
        for column in 0..self.nodes() {
            for (row, block) in self.column(column) {
                for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
                    let (entry, i, j) = (block[j * n + i], row * n + i, column * n + j);
                    y[i] += mul(&entry, &x[j]);
                    if self.kind == Kind::Cholesky && row != column {
                        y[j] += mul(&conj(&entry), &x[i]);
                    }
                }
            }
        }
        y
    }

    /// The minimum degree ordering of its pattern.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn elimination_tree(&self) -> Result<EliminationTree, Error> {
        let mut neighbours = self.rows.clone();
        if self.kind == Kind::Cholesky {
            for (column, rows) in self.rows.iter().enumerate() {
                rows.iter().filter(|&&row| row > column).for_each(|&row| neighbours[row].push(column));
            }
        }
        neighbours.iter_mut().enumerate().for_each(|(node, others)| others.retain(|&other| other != node));
        EliminationTree::by_minimum_degree(&neighbours, self.block)
    }

    /// The factors along `tree`.
    ///
    /// # Errors
    /// As [`Factorisation::new`].
    pub fn factor(&self, tree: Arc<EliminationTree>) -> Result<Factorisation<T>, Error> {
        let (order, by_rows) = (tree.clone(), self.columns_of_rows());
        Factorisation::new(tree, self.block, self.kind, |front| self.assemble(&order, &by_rows, front))
    }

    /// For every row, the columns that store a block of it.
    fn columns_of_rows(&self) -> Vec<Vec<usize>> {
        let mut columns = vec![Vec::new(); self.nodes()];
        for (column, rows) in self.rows.iter().enumerate() {
            rows.iter().for_each(|&row| columns[row].push(column));
        }
        columns
    }

    /// Adds the entries in the rows and columns that a front eliminates.
    fn assemble(&self, tree: &EliminationTree, columns_of_rows: &[Vec<usize>], front: &mut FrontMatrix<'_, T>) {
        let eliminated = front.front.eliminated.clone();
        let position = |node: usize| tree.positions[node].expect("every node has a position");
        for node in eliminated.clone().map(|position| tree.nodes[position]) {
            for (row, block) in self.column(node).filter(|(row, _)| position(*row) >= eliminated.start) {
                self.place(front, [position(row), position(node)], block);
            }
            let others = columns_of_rows[node].iter().filter(|&&column| position(column) >= eliminated.end);
            for &column in others {
                let block = self.column(column).find(|(row, _)| *row == node).map(|(_, block)| block);
                block.into_iter().for_each(|block| self.place(front, [position(node), position(column)], block));
            }
        }
    }

    /// Adds a stored block at two positions. In a Cholesky factorisation the later position is the row's.
    fn place(&self, front: &mut FrontMatrix<'_, T>, [row, column]: [usize; 2], block: &[T]) {
        if self.kind == Kind::Lu || row >= column {
            return front.add_block(row, column, block);
        }
        let n = self.block;
        let adjoint: Vec<T> = (0..n * n).map(|k| conj(&block[k % n * n + k / n])).collect();
        front.add_block(column, row, &adjoint);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::elimination_tree::tests::square;
    use faer::{c32, c64};

    const BLOCK: usize = 3;
    const SIDE: usize = 8;

    /// A matrix on the nodes of a square with the global entries `entry(row, column)`, and its product with a vector.
    fn matrix<T: Scalar>(kind: Kind, entry: impl Fn(usize, usize) -> T) -> BlockMatrix<T> {
        let neighbours = square(SIDE);
        let mut matrix = BlockMatrix::new(kind, BLOCK, neighbours.clone());
        for (column, rows) in neighbours.iter().enumerate() {
            for &row in rows.iter().chain([&column]) {
                matrix.add(row, column, |i, j| entry(row * BLOCK + i, column * BLOCK + j));
            }
        }
        matrix
    }

    /// The largest error of two right-hand sides, solved on one thread and on four; the bits must agree.
    fn error<T: Scalar>(kind: Kind, entry: impl Fn(usize, usize) -> T + Sync, number: impl Fn(f64) -> T) -> f64 {
        let len = BLOCK * SIDE * SIDE;
        let x: Vec<T> = (0..2 * len).map(|i| number((i as f64).cos())).collect();
        let matrix = matrix(kind, &entry);
        let b: Vec<T> = x.chunks_exact(len).flat_map(|x| matrix.product(x)).collect();
        let solved = [1, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut y = b.clone();
            let tree = Arc::new(matrix.elimination_tree().unwrap());
            pool.install(|| matrix.factor(tree).unwrap()).solve(&mut y, 2, &mut Vec::new());
            y
        });
        assert!(solved[0] == solved[1]);
        let distance = |(a, b): (&T, &T)| faer::traits::math_utils::abs1(&faer::traits::math_utils::sub(a, b));
        let distances = solved[0].iter().zip(&x).map(distance);
        distances.map(|d| format!("{d:?}").parse::<f64>().unwrap()).fold(0.0, f64::max)
    }

    /// No symmetry; the first diagonal entry of every block is zero, so that rows must be interchanged.
    fn general(i: usize, j: usize) -> f64 {
        let own = i / BLOCK == j / BLOCK;
        let diagonal =
            if own && i == j { -((i + 2 * j) as f64).sin() } else { 9.0 * (1.0 + ((i + 2 * j) as f64).cos()) };
        ((i + 2 * j) as f64).sin() + if own { diagonal } else { 0.0 }
    }

    fn symmetric(i: usize, j: usize) -> f64 {
        ((i + j) as f64).sin() + if i == j { 20.0 } else { 0.0 }
    }

    #[test]
    fn blocks_lie_where_their_nodes_are() {
        let x: Vec<f64> = (0..BLOCK * SIDE * SIDE).map(|i| (i * i % 7) as f64).collect();
        for kind in [Kind::Lu, Kind::Cholesky] {
            let (i, node) = (BLOCK * 9 + 1, 9);
            let coupled =
                square(SIDE)[node].iter().chain([&node]).flat_map(|k| k * BLOCK..(k + 1) * BLOCK).collect::<Vec<_>>();
            let expected: f64 = coupled.iter().map(|&j| symmetric(i, j) * x[j]).sum();
            assert!((matrix(kind, symmetric).product(&x)[i] - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn a_solve_undoes_the_product_with_the_same_bits_on_any_number_of_threads() {
        let skew = |i: usize, j: usize| (i as f64).sin() - (j as f64).sin();
        assert!(error(Kind::Lu, general, |x| x) < 1e-11);
        assert!(error(Kind::Cholesky, symmetric, |x| x) < 1e-13);
        assert!(error(Kind::Lu, |i, j| general(i, j) as f32, |x| x as f32) < 1e-2);
        assert!(error(Kind::Cholesky, |i, j| symmetric(i, j) as f32, |x| x as f32) < 1e-5);
        assert!(error(Kind::Lu, |i, j| c64::new(general(i, j), skew(i, j)), |x| c64::new(x, 1.0 - x)) < 1e-10);
        assert!(error(Kind::Cholesky, |i, j| c64::new(symmetric(i, j), skew(i, j)), |x| c64::new(x, 1.0)) < 1e-13);
        let single = |i: usize, j: usize| c32::new(symmetric(i, j) as f32, skew(i, j) as f32);
        assert!(error(Kind::Cholesky, single, |x| c32::new(x as f32, 1.0)) < 1e-4);
    }

    #[test]
    fn matrices_that_have_no_factors_are_errors() {
        let singular: BlockMatrix<f64> = matrix(Kind::Lu, |_, _| 0.0);
        let tree = Arc::new(singular.elimination_tree().unwrap());
        assert_eq!(singular.factor(tree).err(), Some(Error::Singular));
        // The last pivot of a front without a boundary is zero.
        let mut dependent = BlockMatrix::<f64>::new(Kind::Lu, 1, vec![vec![1], vec![0]]);
        for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            dependent.add(row, column, |_, _| 1.0);
        }
        let tree = Arc::new(dependent.elimination_tree().unwrap());
        assert_eq!(dependent.factor(tree).err(), Some(Error::Singular));
        let indefinite = matrix(Kind::Cholesky, |i, j| symmetric(i, j) - if i == j { 19.0 } else { 0.0 });
        let tree = Arc::new(indefinite.elimination_tree().unwrap());
        assert!(matches!(indefinite.factor(tree), Err(Error::NotDefinite { .. })));
    }
}
