//! A sparse matrix of square blocks, one for every pair of linked cells, and its factors.
//!
//! With the rows that a front eliminates (e) and those that it changes (b),
//!
//! ```text
//! Z = F_ee^{-1} F_eb,      F_bb - F_be Z                                                                          (front-lu)
//! ```
//!
//! the last being what it leaves to a later one. Rows are interchanged within F_ee alone, as in the factors of the sweeps.

use super::blocks::Link;
use super::fronts::{Front, Fronts};
use super::wavefront::wavefront;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::lu::partial_pivoting::solve::{solve_in_place, solve_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::perm::PermRef;
use faer::reborrow::ReborrowMut;
use faer::sparse::FaerError;
use faer::{Accum, Mat, MatMut, Par, Spec};
use std::sync::{Mutex, OnceLock, PoisonError};

/// The matrix.
pub struct BlockMatrix {
    block: usize,
    /// For each cell, itself and the cells linked to it, increasing.
    linked: Vec<Vec<usize>>,
    /// The number of the first block of each column.
    first: Vec<usize>,
    /// Blocks by columns, in each the rows as they are linked.
    values: Vec<f64>,
}

impl BlockMatrix {
    /// The zero matrix with `block` rows for each cell and the couplings of `links`.
    pub fn new(block: usize, links: &[Vec<Link>]) -> Self {
        let linked_to = |(cell, links): (usize, &Vec<Link>)| {
            let mut cells: Vec<usize> = links.iter().map(|link| link.cell).chain([cell]).collect();
            cells.sort_unstable();
            cells.dedup();
            cells
        };
        let linked: Vec<Vec<usize>> = links.iter().enumerate().map(linked_to).collect();
        let first: Vec<usize> =
            linked.iter().scan(0, |sum, cells| Some(std::mem::replace(sum, *sum + cells.len()))).collect();
        let blocks = linked.iter().map(Vec::len).sum::<usize>();
        BlockMatrix { block, linked, first, values: vec![0.0; blocks * block * block] }
    }

    /// Makes it zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Adds `block` to the block of cell `row` and cell `column`, which are linked.
    pub fn add(&mut self, row: usize, column: usize, block: &Mat<f64>) {
        let (len, number) = (self.block * self.block, self.number(row, column));
        let target =
            MatMut::from_column_major_slice_mut(&mut self.values[number * len..][..len], self.block, self.block);
        faer::zip!(target, block).for_each(|faer::unzip!(sum, entry)| *sum += entry);
    }

    fn number(&self, row: usize, column: usize) -> usize {
        let place = self.linked[column].binary_search(&row).expect("the pattern holds every pair of linked cells");
        self.first[column] + place
    }

    /// The block of two linked cells, by columns.
    fn block(&self, row: usize, column: usize) -> &[f64] {
        let len = self.block * self.block;
        &self.values[self.number(row, column) * len..][..len]
    }
}

/// What is kept of a front.
struct Factors {
    /// L and U of F_ee, in place, above F_be.
    eliminated: Mat<f64>,
    /// The order of the rows of F_ee, and its inverse.
    pivots: [Vec<usize>; 2],
    /// Z.
    z: Mat<f64>,
}

/// The factors of a [`BlockMatrix`].
pub struct SparseLu {
    block: usize,
    order: Fronts,
    factors: Vec<Factors>,
}

impl SparseLu {
    /// Finds the order of elimination for matrices with the pattern of `matrix`. Nothing is factored.
    ///
    /// # Errors
    /// If memory runs out.
    pub fn new(matrix: &BlockMatrix) -> Result<Self, FaerError> {
        let order = Fronts::new(&matrix.linked)?;
        Ok(SparseLu { block: matrix.block, order, factors: Vec::new() })
    }

    /// Factors `matrix`. Returns whether it is regular.
    #[must_use]
    pub fn factor(&mut self, matrix: &BlockMatrix) -> bool {
        let fronts = &self.order.fronts;
        let left: Vec<Mutex<Mat<f64>>> = fronts.iter().map(|_| Mutex::new(Mat::new())).collect();
        let factors: Vec<OnceLock<Factors>> = fronts.iter().map(|_| OnceLock::new()).collect();
        let leave = |number: usize, matrix| {
            std::mem::replace(&mut *left[number].lock().unwrap_or_else(PoisonError::into_inner), matrix)
        };
        let children = |number: usize| fronts[number].children.iter().copied();
        wavefront(fronts.len(), fronts.len(), children, |number| {
            let front = &fronts[number];
            let mut f = self.assemble(matrix, front);
            for child in children(number) {
                add(&mut f, front, &fronts[child].changed, &leave(child, Mat::new()), self.block);
            }
            let (own, rest) = eliminate(f, front.eliminated.len() * self.block);
            leave(number, rest);
            let _ = factors[number].set(own);
        });
        self.factors = factors.into_iter().filter_map(OnceLock::into_inner).collect();
        self.factors.iter().all(|factors| factors.eliminated.is_all_finite() && factors.z.is_all_finite())
    }

    /// The entries of the matrix in the rows and columns that a front eliminates.
    fn assemble(&self, matrix: &BlockMatrix, front: &Front) -> Mat<f64> {
        let (n, Fronts { rows, positions, .. }) = (self.block, &self.order);
        let mut f = Mat::zeros(front.len() * n, front.len() * n);
        let mut put = |row: usize, column: usize| {
            let block = matrix.block(row, column);
            let (row, column) = (front.place(positions[row]) * n, front.place(positions[column]) * n);
            for (j, values) in block.chunks_exact(n).enumerate() {
                f.col_as_slice_mut(column + j)[row..row + n].copy_from_slice(values);
            }
        };
        for cell in front.eliminated.clone().map(|position| rows[position]) {
            for &other in matrix.linked[cell].iter().filter(|&&other| positions[other] >= front.eliminated.start) {
                put(other, cell);
                if positions[other] >= front.eliminated.end {
                    put(cell, other);
                }
            }
        }
        f
    }

    /// x = A^{-1} x.
    pub fn solve(&self, x: &mut [f64]) {
        let fronts = || self.order.fronts.iter().zip(&self.factors);
        fronts().for_each(|(front, factors)| self.forward(front, factors, x));
        fronts().rev().for_each(|(front, factors)| self.backward(front, factors, x));
    }

    /// x_e := F_ee^{-1} x_e,  x_b := x_b - F_be x_e.
    fn forward(&self, front: &Front, factors: &Factors, x: &mut [f64]) {
        let mut local = self.taken(front.eliminated.clone(), x);
        let e = local.nrows();
        let (f_ee, f_be) = factors.eliminated.split_at_row(e);
        solve(f_ee, &factors.pivots, local.as_mut());
        self.put(front.eliminated.clone(), &local, x);
        let mut rest = self.taken(front.changed.iter().copied(), x);
        matmul(rest.as_mut(), Accum::Add, f_be, &local, -1.0, Par::Seq);
        self.put(front.changed.iter().copied(), &rest, x);
    }

    /// x_e := x_e - Z x_b.
    fn backward(&self, front: &Front, factors: &Factors, x: &mut [f64]) {
        let known = self.taken(front.changed.iter().copied(), x);
        let mut local = self.taken(front.eliminated.clone(), x);
        matmul(local.as_mut(), Accum::Add, &factors.z, &known, -1.0, Par::Seq);
        self.put(front.eliminated.clone(), &local, x);
    }

    /// The entries of x at some positions, as a column.
    fn taken(&self, positions: impl ExactSizeIterator<Item = usize>, x: &[f64]) -> Mat<f64> {
        let mut local = Mat::zeros(positions.len() * self.block, 1);
        let parts = local.col_as_slice_mut(0).chunks_exact_mut(self.block);
        parts.zip(positions).for_each(|(part, position)| part.copy_from_slice(self.part(x, position)));
        local
    }

    /// Puts a column there.
    fn put(&self, positions: impl ExactSizeIterator<Item = usize>, local: &Mat<f64>, x: &mut [f64]) {
        let parts = local.col_as_slice(0).chunks_exact(self.block);
        for (part, position) in parts.zip(positions) {
            let start = self.order.rows[position] * self.block;
            x[start..start + self.block].copy_from_slice(part);
        }
    }

    fn part<'x>(&self, x: &'x [f64], position: usize) -> &'x [f64] {
        &x[self.order.rows[position] * self.block..][..self.block]
    }
}

/// Adds what a front with the rows `changed` has left.
fn add(f: &mut Mat<f64>, front: &Front, changed: &[usize], left: &Mat<f64>, block: usize) {
    let places: Vec<usize> = changed.iter().map(|&position| front.place(position) * block).collect();
    for (j, column) in
        places.iter().enumerate().flat_map(|(j, &place)| (0..block).map(move |k| (j * block + k, place + k)))
    {
        let (from, to) = (left.col_as_slice(j), f.col_as_slice_mut(column));
        for (from, &row) in from.chunks_exact(block).zip(&places) {
            to[row..row + block].iter_mut().zip(from).for_each(|(to, from)| *to += from);
        }
    }
}

/// Eliminates the first `e` rows of F: the factors, and what is left.
fn eliminate(mut f: Mat<f64>, e: usize) -> (Factors, Mat<f64>) {
    let mut pivots = [vec![0_usize; e], vec![0; e]];
    let [order, inverse] = &mut pivots;
    let mut memory = MemBuffer::new(lu_in_place_scratch::<usize, f64>(e, e, Par::Seq, Spec::default()));
    lu_in_place(
        f.as_mut().submatrix_mut(0, 0, e, e),
        order,
        inverse,
        Par::Seq,
        MemStack::new(&mut memory),
        Spec::default(),
    );
    let (left, mut right) = f.as_mut().split_at_col_mut(e);
    let (f_ee, f_be) = left.as_ref().split_at_row(e);
    let (mut z, mut rest) = right.rb_mut().split_at_row_mut(e);
    solve(f_ee, &pivots, z.rb_mut());
    matmul(rest.rb_mut(), Accum::Add, f_be, z.as_ref(), -1.0, Par::Seq);
    let (z, rest) = (z.to_owned(), rest.to_owned());
    (Factors { eliminated: left.to_owned(), pivots, z }, rest)
}

/// x := F_ee^{-1} x.
fn solve(f_ee: faer::MatRef<'_, f64>, [order, inverse]: &[Vec<usize>; 2], x: MatMut<'_, f64>) {
    let rows = PermRef::new_checked(order, inverse, order.len());
    let mut memory = MemBuffer::new(solve_in_place_scratch::<usize, f64>(order.len(), x.ncols(), Par::Seq));
    solve_in_place(f_ee, f_ee, rows, x, Par::Seq, MemStack::new(&mut memory));
}

#[cfg(test)]
mod tests {
    use super::super::fronts::tests::square;
    use super::*;

    const BLOCK: usize = 3;
    const SIDE: usize = 8;

    /// A matrix on the cells of a square; the first diagonal entry of every block is zero, so that rows must be interchanged.
    fn matrix(diagonal: f64) -> BlockMatrix {
        let link = |cell: usize| Link { cell, coupling: 0, side: 0, face: 0, other_face: 0 };
        let links: Vec<Vec<Link>> =
            square(SIDE).iter().map(|cells| cells.iter().map(|&cell| link(cell)).collect()).collect();
        let mut matrix = BlockMatrix::new(BLOCK, &links);
        for (column, row) in
            links.iter().enumerate().flat_map(|(i, links)| links.iter().map(move |link| (i, link.cell)))
        {
            matrix.add(
                row,
                column,
                &Mat::from_fn(BLOCK, BLOCK, |i, j| ((row + 2 * column + 3 * i + 5 * j) as f64).sin()),
            );
        }
        for cell in 0..links.len() {
            let entry =
                |i: usize, j: usize| if i == j { 0.0 } else { diagonal * (1.0 + ((cell + i + 2 * j) as f64).cos()) };
            matrix.add(cell, cell, &Mat::from_fn(BLOCK, BLOCK, entry));
        }
        matrix
    }

    fn product(matrix: &BlockMatrix, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for (column, rows) in matrix.linked.iter().enumerate() {
            for (row, (i, j)) in
                rows.iter().flat_map(|row| (0..BLOCK * BLOCK).map(move |k| (row, (k % BLOCK, k / BLOCK))))
            {
                y[row * BLOCK + i] += matrix.block(*row, column)[j * BLOCK + i] * x[column * BLOCK + j];
            }
        }
        y
    }

    #[test]
    fn a_solve_undoes_the_product_on_any_number_of_threads() {
        let matrix = matrix(9.0);
        let x: Vec<f64> = (0..BLOCK * SIDE * SIDE).map(|i| (i as f64).cos()).collect();
        let solved = [1, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let mut factors = SparseLu::new(&matrix).expect("memory suffices");
            assert!(pool.install(|| factors.factor(&matrix)));
            let mut y = product(&matrix, &x);
            factors.solve(&mut y);
            y
        });
        let error = solved[0].iter().zip(&x).map(|(y, x)| (y - x).abs()).fold(0.0, f64::max);
        assert!(error < 1e-11, "{error:.1e}");
        assert_eq!(solved[0], solved[1]);
    }

    #[test]
    fn a_singular_matrix_is_found_out() {
        let mut matrix = matrix(9.0);
        matrix.clear();
        assert!(!SparseLu::new(&matrix).expect("memory suffices").factor(&matrix));
    }
}
