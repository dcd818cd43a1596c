//! Symmetric positive definite matrices, sparse and dense, factored by faer.

use crate::ElasticityError;
use crate::pool::Pool;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Accum, Conj, MatMut, Par, Side, Spec};
use std::array::from_fn;

/// A symmetric matrix of D x D blocks, one block per pair of neighbouring nodes. Only the lower triangle is stored, by columns.
pub(crate) struct BlockMatrix<const D: usize> {
    /// For each node, the node itself and its neighbours of larger number, increasing.
    neighbours: Vec<Vec<usize>>,
    columns: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

impl<const D: usize> BlockMatrix<D> {
    /// The zero matrix for the couplings `neighbours`: for each node any nodes that it is coupled with, in any order, with repetitions;
    /// itself and nodes of smaller number may be missing.
    pub(crate) fn new(mut neighbours: Vec<Vec<usize>>) -> Self {
        let (mut columns, mut rows) = (vec![0], Vec::new());
        for (node, list) in neighbours.iter_mut().enumerate() {
            list.retain(|&neighbour| neighbour > node);
            list.push(node);
            list.sort_unstable();
            list.dedup();
            for j in 0..D {
                rows.extend((j..D).map(|i| node * D + i));
                rows.extend(list[1..].iter().flat_map(|&neighbour| (0..D).map(move |i| neighbour * D + i)));
                columns.push(rows.len());
            }
        }
        let values = vec![0.0; rows.len()];
        BlockMatrix { neighbours, columns, rows, values }
    }

    /// Adds `block[i][j]` to row (`row`, i), column (`column`, j). Blocks above the diagonal are the transposes of those below, and are
    /// left out.
    pub(crate) fn add(&mut self, row: usize, column: usize, block: &[[f64; D]; D]) {
        if row < column {
            return;
        }
        let place =
            self.neighbours[column].binary_search(&row).expect("the pattern holds every pair of nodes of a cell");
        for j in 0..D {
            // Column (column, j) begins at row (column, j): its diagonal block has D - j rows.
            let start = self.columns[column * D + j];
            for i in (if place == 0 { j } else { 0 })..D {
                self.values[start + place * D + i - j] += block[i][j];
            }
        }
    }

    /// The number of nodes.
    pub(crate) fn nodes(&self) -> usize {
        self.neighbours.len()
    }

    /// The rows and blocks of a column, from the diagonal on.
    pub(crate) fn column(&self, column: usize) -> impl Iterator<Item = (u32, [[f64; D]; D])> {
        let entry = move |place: usize, i: usize, j: usize| {
            // The diagonal block is symmetric and stored from its diagonal on.
            let (i, j) = if place == 0 { (i.max(j), i.min(j)) } else { (i, j) };
            self.values[self.columns[column * D + j] + place * D + i - j]
        };
        let block = move |place| from_fn(|i| from_fn(|j| entry(place, i, j)));
        self.neighbours[column].iter().enumerate().map(move |(place, &row)| (row as u32, block(place)))
    }

    /// A = L L^T, with the approximate minimum degree ordering.
    pub(crate) fn factor(&self) -> Result<Cholesky, ElasticityError> {
        let n = self.columns.len() - 1;
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.columns, None, &self.rows);
        Cholesky::new(SparseColMatRef::new(pattern, &self.values))
    }
}

#[cfg(test)]
impl<const D: usize> BlockMatrix<D> {
    /// A x, for both triangles.
    pub(crate) fn product(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; x.len()];
        for column in 0..x.len() {
            for entry in self.columns[column]..self.columns[column + 1] {
                let row = self.rows[entry];
                product[row] += self.values[entry] * x[column];
                if row != column {
                    product[column] += self.values[entry] * x[row];
                }
            }
        }
        product
    }
}

/// The factor L of a sparse matrix A = L L^T.
pub(crate) struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    scratch: Pool<MemBuffer>,
}

/// faer's kernels would split their work by the number of threads; on one thread the bits are always the same.
const SEQUENTIAL: Par = Par::Seq;

impl Cholesky {
    fn new(matrix: SparseColMatRef<'_, usize, f64>) -> Result<Self, ElasticityError> {
        let (ordering, parameters) = (SymmetricOrdering::Amd, CholeskySymbolicParams::default());
        let symbolic =
            factorize_symbolic_cholesky(matrix.symbolic(), Side::Lower, ordering, parameters).map_err(not_definite)?;
        let mut values = vec![0.0; symbolic.len_val()];
        let mut memory = MemBuffer::new(symbolic.factorize_numeric_llt_scratch::<f64>(SEQUENTIAL, Spec::default()));
        let (stack, regularization) = (MemStack::new(&mut memory), LltRegularization::default());
        symbolic
            .factorize_numeric_llt(&mut values, matrix, Side::Lower, regularization, SEQUENTIAL, stack, Spec::default())
            .map_err(not_definite)?;
        Ok(Cholesky { symbolic, values, scratch: Pool::new() })
    }

    /// The number of unknowns.
    pub(crate) fn len(&self) -> usize {
        self.symbolic.nrows()
    }

    /// Memory of the factor.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.values[..])
    }

    /// x = A^{-1} x for one right-hand side.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let n = self.len();
        let mut memory =
            self.scratch.take(|| MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(1, SEQUENTIAL)));
        let right_hand_side = MatMut::from_column_major_slice_mut(x, n, 1);
        let factor = LltRef::new(&self.symbolic, &self.values);
        factor.solve_in_place_with_conj(Conj::No, right_hand_side, SEQUENTIAL, MemStack::new(&mut memory));
        self.scratch.give(memory);
    }
}

/// Replaces the lower triangle of a symmetric `matrix`, with its first `count` rows and columns called e and the others b, by that of
///
/// ```text
/// L_ee                       F_ee = L_ee L_ee^T
/// L_be   F_bb - L_be L_be^T  L_be = F_be L_ee^{-T}
/// ```
///
/// A pivot that is round-off of the diagonal of F_ee is refused: whether rounding leaves it positive is chance.
pub(crate) fn eliminate_leading(matrix: MatMut<'_, f64>, count: usize) -> Result<(), ElasticityError> {
    let (mut f_ee, _, f_be, f_bb) = matrix.split_at_mut(count, count);
    let mut memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(count, SEQUENTIAL, Spec::default()));
    let (stack, regularization) = (MemStack::new(&mut memory), LltRegularization::default());
    let largest = (0..count).map(|k| f_ee[(k, k)]).fold(0.0, f64::max);
    cholesky_in_place(f_ee.as_mut(), regularization, SEQUENTIAL, stack, Spec::default()).map_err(not_definite)?;
    let round_off = 10.0 * f64::EPSILON * count as f64 * largest;
    if let Some(pivot) = (0..count).map(|k| f_ee[(k, k)].powi(2)).find(|pivot| *pivot < round_off) {
        return Err(ElasticityError::NotDefinite { cause: format!("a pivot is {pivot:e} beside {largest:e}") });
    }
    let mut l_eb = f_be.transpose_mut();
    solve_lower_triangular_in_place(f_ee.as_ref(), l_eb.as_mut(), SEQUENTIAL);
    let (lower, full, l_be) = (BlockStructure::TriangularLower, BlockStructure::Rectangular, l_eb.as_ref().transpose());
    matmul(f_bb, lower, Accum::Add, l_be, full, l_eb.as_ref(), full, -1.0, SEQUENTIAL);
    Ok(())
}

fn not_definite(cause: impl std::fmt::Debug) -> ElasticityError {
    ElasticityError::NotDefinite { cause: format!("{cause:?}") }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use faer::Mat;

    /// A chain of five nodes with 2 x 2 blocks, every block given in full, in both orders of its nodes.
    fn chain(diagonal: f64) -> BlockMatrix<2> {
        let neighbours = (0..5_usize).map(|i| (0..5_usize).filter(|k| k.abs_diff(i) <= 1).collect()).collect();
        let mut matrix = BlockMatrix::<2>::new(neighbours);
        for node in 0..5 {
            matrix.add(node, node, &[[diagonal, 1.0], [1.0, diagonal]]);
        }
        for node in 1..5 {
            matrix.add(node, node - 1, &[[-1.0, 0.5], [0.25, -1.0]]);
            matrix.add(node - 1, node, &[[-1.0, 0.25], [0.5, -1.0]]);
        }
        matrix
    }

    #[test]
    fn blocks_lie_where_their_nodes_are() {
        let x: Vec<f64> = (0..10).map(|i| (i * i % 7) as f64).collect();
        let product = chain(5.0).product(&x);
        let row_of_node_2 = 0.25 * x[2] - x[3] + x[4] + 5.0 * x[5] + 0.5 * x[6] - x[7];
        assert!((product[5] - row_of_node_2).abs() < 1e-15);
    }

    #[test]
    fn solution_satisfies_the_equations() {
        let b: Vec<f64> = (0..10).map(|i| (i as f64).sin()).collect();
        let mut x = b.clone();
        chain(5.0).factor().unwrap().solve(&mut x);
        assert!(chain(5.0).product(&x).iter().zip(&b).all(|(ax, b)| (ax - b).abs() < 1e-14));
    }

    #[test]
    fn an_indefinite_matrix_is_an_error() {
        assert!(matches!(chain(1.0).factor(), Err(ElasticityError::NotDefinite { .. })));
    }

    /// With the entry 1/3 the matrix is singular, and then round-off decides on the sign of its second pivot.
    #[test]
    fn a_pivot_of_round_off_is_an_error() {
        let matrix = |last: f64| Mat::from_fn(2, 2, |i, j| [[3.0, 1.0], [1.0, last]][i][j]);
        for last in [1.0 / 3.0 - 1e-16, 1.0 / 3.0, 1.0 / 3.0 + 1e-16] {
            assert!(matches!(eliminate_leading(matrix(last).as_mut(), 2), Err(ElasticityError::NotDefinite { .. })));
        }
        assert!(eliminate_leading(matrix(0.34).as_mut(), 2).is_ok());
    }
}
