//! A sparse matrix of square blocks, one for every pair of linked cells, factored by faer.

use super::blocks::Link;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Spec};

/// faer's kernels would split their work by the number of threads; on one thread the bits are always the same.
const SEQUENTIAL: Par = Par::Seq;

/// The matrix, by columns.
pub struct BlockMatrix {
    block: usize,
    /// For each cell, itself and the cells linked to it, increasing.
    rows_of: Vec<Vec<usize>>,
    columns: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

impl BlockMatrix {
    /// The zero matrix with `block` rows for each cell and the couplings of `links`.
    pub fn new(block: usize, links: &[Vec<Link>]) -> Self {
        let rows_of = |(cell, links): (usize, &Vec<Link>)| {
            let mut cells: Vec<usize> = links.iter().map(|link| link.cell).chain([cell]).collect();
            cells.sort_unstable();
            cells.dedup();
            cells
        };
        let rows_of: Vec<Vec<usize>> = links.iter().enumerate().map(rows_of).collect();
        let (mut columns, mut rows) = (vec![0], Vec::new());
        for cells in &rows_of {
            for _ in 0..block {
                rows.extend(cells.iter().flat_map(|cell| cell * block..(cell + 1) * block));
                columns.push(rows.len());
            }
        }
        let values = vec![0.0; rows.len()];
        BlockMatrix { block, rows_of, columns, rows, values }
    }

    /// Adds `entry(i, j)` to row i of cell `row` and column j of cell `column`, which are linked.
    pub fn add(&mut self, row: usize, column: usize, entry: impl Fn(usize, usize) -> f64) {
        let place = self.rows_of[column].binary_search(&row).expect("the pattern holds every pair of linked cells");
        for j in 0..self.block {
            let start = self.columns[column * self.block + j] + place * self.block;
            self.values[start..start + self.block].iter_mut().enumerate().for_each(|(i, value)| *value += entry(i, j));
        }
    }

    /// Makes it zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    fn pattern(&self) -> SymbolicSparseColMatRef<'_, usize> {
        let n = self.columns.len() - 1;
        SymbolicSparseColMatRef::new_checked(n, n, &self.columns, None, &self.rows)
    }
}

/// The factors of a [`BlockMatrix`], A = P L U Q.
pub struct SparseLu {
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    memory: MemBuffer,
}

impl SparseLu {
    /// Finds the order of elimination for matrices with the pattern of `matrix`. Nothing is factored.
    ///
    /// # Errors
    /// If memory runs out.
    pub fn new(matrix: &BlockMatrix) -> Result<Self, LuError> {
        let symbolic = factorize_symbolic_lu(matrix.pattern(), Default::default())?;
        let factoring = symbolic.factorize_numeric_lu_scratch::<f64>(SEQUENTIAL, Spec::default());
        let solving = symbolic.solve_in_place_scratch::<f64>(1, SEQUENTIAL);
        Ok(SparseLu { symbolic, numeric: NumericLu::new(), memory: MemBuffer::new(factoring.or(solving)) })
    }

    /// Factors `matrix`, in the memory of what was factored before.
    ///
    /// # Errors
    /// If it is singular, or memory runs out.
    pub fn factor(&mut self, matrix: &BlockMatrix) -> Result<(), LuError> {
        let values = SparseColMatRef::new(matrix.pattern(), &matrix.values);
        let stack = MemStack::new(&mut self.memory);
        self.symbolic.factorize_numeric_lu(&mut self.numeric, values, SEQUENTIAL, stack, Spec::default())?;
        Ok(())
    }

    /// x = A^{-1} x.
    pub fn solve(&mut self, x: &mut [f64]) {
        let x = MatMut::from_column_major_slice_mut(x, x.len(), 1);
        let factors = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        factors.solve_in_place_with_conj(Conj::No, x, SEQUENTIAL, MemStack::new(&mut self.memory));
    }
}
