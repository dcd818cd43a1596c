//! The symmetric matrix of a level, and sweeps of block Gauss-Seidel with it.

use super::blocks::{Block, add_block_vector};
use super::colouring::{Colouring, Couplings};
use rayon::prelude::*;
use std::ops::Range;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};

/// A column of a block is read with this many numbers, at least R: those beyond it belong to the next columns, and their sums are dropped.
const LANES: usize = 8;

/// The rows of a product that a thread takes at a time.
const ROWS: usize = 64;

/// A matrix of R x R blocks with both triangles, in the order of a [`Colouring`].
///
/// Blocks are stored by columns: a product adds columns times numbers, without sums across lanes.
pub(crate) struct BlockRows<const R: usize> {
    /// The first block of each block row.
    starts: Vec<usize>,
    /// The columns of the blocks, increasing in every row.
    columns: Vec<u32>,
    /// `[block][column][row]`, with [`LANES`] zeros at the end.
    entries: Vec<f64>,
    colours: Vec<Range<usize>>,
    chunk: usize,
}

impl<const R: usize> BlockRows<R> {
    /// The zero matrix for the couplings of nodes as they were before reordering, and the places of the nodes since.
    pub(crate) fn zero(couplings: Couplings, colouring: &Colouring, places: &[usize]) -> Self {
        let (mut starts, mut columns) = (vec![0], Vec::with_capacity(couplings.total()));
        for &node in &colouring.order {
            columns.extend(couplings.of(node).iter().map(|&other| places[other as usize] as u32));
            columns[starts[starts.len() - 1]..].sort_unstable();
            starts.push(columns.len());
        }
        drop(couplings);
        let entries = vec![0.0; columns.len() * R * R + LANES];
        BlockRows { starts, columns, entries, colours: colouring.colours.clone(), chunk: colouring.chunk }
    }

    /// The rows of a chunk.
    pub(crate) fn chunk(&self) -> usize {
        self.chunk
    }

    /// The number of block rows.
    pub(crate) fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// The columns of the blocks of a row.
    #[inline(always)]
    pub(crate) fn columns(&self, row: usize) -> &[u32] {
        &self.columns[self.starts[row]..self.starts[row + 1]]
    }

    /// The columns and blocks of a row.
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = (usize, Block<R, R>)> {
        self.columns(row).iter().enumerate().map(move |(place, &column)| (column as usize, self.block(row, place)))
    }

    /// The block on the diagonal.
    pub(crate) fn diagonal(&self, row: usize) -> Block<R, R> {
        self.block(row, self.place(row, row))
    }

    fn block(&self, row: usize, place: usize) -> Block<R, R> {
        let mut block = [[0.0; R]; R];
        for (j, column) in self.entries[self.entry(row, place)..][..R * R].chunks_exact(R).enumerate() {
            (0..R).for_each(|i| block[i][j] = column[i]);
        }
        block
    }

    /// The index of the first entry of a block.
    fn entry(&self, row: usize, place: usize) -> usize {
        (self.starts[row] + place) * R * R
    }

    /// The place of the diagonal in a row.
    #[inline(always)]
    fn place_of_diagonal(&self, row: usize) -> usize {
        let (columns, mut place) = (self.columns(row), 0);
        while (columns[place] as usize) < row {
            place += 1;
        }
        place
    }

    /// The place of a coupled node in the row of another.
    fn place(&self, row: usize, column: usize) -> usize {
        self.columns(row).binary_search(&(column as u32)).expect("the pattern holds every pair of coupled nodes")
    }

    /// Adds to the block of two coupled nodes.
    pub(crate) fn add(&mut self, row: usize, column: usize, block: &Block<R, R>) {
        let at = self.entry(row, self.place(row, column));
        for (j, column) in self.entries[at..at + R * R].chunks_exact_mut(R).enumerate() {
            (0..R).for_each(|i| column[i] += block[i][j]);
        }
    }

    /// Sets ones on the diagonal of rows that are zero: the modes that vanish on an aggregate.
    pub(crate) fn make_regular(&mut self) {
        for row in 0..self.rows() {
            let at = self.entry(row, self.place(row, row));
            let diagonal = self.entries[at..at + R * R].iter_mut().step_by(R + 1);
            diagonal.filter(|entry| **entry == 0.0).for_each(|entry| *entry = 1.0);
        }
    }

    /// Memory of the matrix.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.entries[..]) + size_of_val(&self.columns[..]) + size_of_val(&self.starts[..])
    }

    /// A sweep of Gauss-Seidel, for the inverse blocks of D: forward x = (D + L)^{-1} r, backward x = (D + U)^{-1} (r - L x).
    pub(crate) fn sweep(&self, direction: Direction, inverses: &[Block<R, R>], r: &[[f64; R]], x: &mut [[f64; R]]) {
        for colour in direction.order(self.colours.len()).map(|index| self.colours[index].clone()) {
            let (before, rest) = x.split_at_mut(colour.start);
            let (own, after) = rest.split_at_mut(colour.len());
            own.par_chunks_mut(self.chunk).enumerate().for_each(|(chunk, own)| {
                let (start, end) = (colour.start + chunk * self.chunk, colour.end);
                Arch::new().dispatch(Sweep { matrix: self, direction, inverses, r, before, own, after, start, end });
            });
        }
    }

    /// r = -U x: the residual after a forward [`Self::sweep`] from x = 0.
    pub(crate) fn residual_after_forward(&self, x: &[[f64; R]], r: &mut [[f64; R]]) {
        r.par_chunks_mut(ROWS).enumerate().for_each(|(chunk, r)| {
            Arch::new().dispatch(UpperProduct { matrix: self, start: chunk * ROWS, x, r });
        });
    }

    /// The sum of A_ik x_k over some blocks of row i.
    #[inline(always)]
    fn product(&self, row: usize, blocks: Range<usize>, x: &Values<R>) -> [f64; R] {
        let columns = &self.columns(row)[blocks.start..blocks.end];
        let begin = (self.starts[row] + blocks.start) * R * R;
        let entries = &self.entries[begin..begin + columns.len() * R * R + LANES];
        // One sum for every column of the blocks: they do not wait for each other.
        let mut sums = [[0.0; LANES]; R];
        for k in 0..columns.len() {
            let (x, block) = (x.at(columns[k] as usize), &entries[k * R * R..][..R * R - R + LANES]);
            for j in 0..R {
                let column = &block[j * R..][..LANES];
                for i in 0..LANES {
                    sums[j][i] += column[i] * x[j];
                }
            }
        }
        let mut product = [0.0; R];
        for j in 0..R {
            for i in 0..R {
                product[i] += sums[j][i];
            }
        }
        product
    }
}

/// A vector of which a chunk is being changed: the nodes before its colour, those of the chunk from `start` on, and those from `end` on, where
/// its colour ends.
struct Values<'a, const R: usize> {
    before: &'a [[f64; R]],
    own: &'a [[f64; R]],
    after: &'a [[f64; R]],
    start: usize,
    end: usize,
}

impl<const R: usize> Values<'_, R> {
    #[inline(always)]
    fn at(&self, node: usize) -> &[f64; R] {
        if node < self.before.len() {
            &self.before[node]
        } else if node >= self.end {
            &self.after[node - self.end]
        } else {
            &self.own[node - self.start]
        }
    }
}

/// The order of the rows in a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    Forward,
    Backward,
}

impl Direction {
    #[inline(always)]
    fn order(self, count: usize) -> impl Iterator<Item = usize> {
        (0..count).map(move |step| if self == Direction::Forward { step } else { count - 1 - step })
    }
}

/// A sweep over the chunk `own` of a colour. The chunk begins at the node `start`, and its colour ends at `end`.
struct Sweep<'a, const R: usize> {
    matrix: &'a BlockRows<R>,
    direction: Direction,
    inverses: &'a [Block<R, R>],
    r: &'a [[f64; R]],
    before: &'a [[f64; R]],
    own: &'a mut [[f64; R]],
    after: &'a [[f64; R]],
    start: usize,
    end: usize,
}

impl<const R: usize> Sweep<'_, R> {
    /// The blocks of a row that are multiplied: L forward, all backward.
    #[inline(always)]
    fn blocks(&self, row: usize) -> Range<usize> {
        match self.direction {
            Direction::Forward => 0..self.matrix.place_of_diagonal(row),
            Direction::Backward => 0..self.matrix.columns(row).len(),
        }
    }

    #[inline(always)]
    fn product(&self, row: usize) -> [f64; R] {
        let Sweep { before, after, start, end, .. } = *self;
        self.matrix.product(row, self.blocks(row), &Values { before, own: &*self.own, after, start, end })
    }

    /// D^{-1} (r - product).
    #[inline(always)]
    fn solved(&self, row: usize, product: &[f64; R]) -> [f64; R] {
        let (mut rest, mut x) = (self.r[row], [0.0; R]);
        for i in 0..R {
            rest[i] -= product[i];
        }
        add_block_vector(&self.inverses[row], &rest, &mut x);
        x
    }
}

impl<const R: usize> WithSimd for Sweep<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for k in self.direction.order(self.own.len()) {
            // The block on the diagonal is multiplied by zero.
            self.own[k] = [0.0; R];
            let product = self.product(self.start + k);
            self.own[k] = self.solved(self.start + k, &product);
        }
    }
}

/// r = -U x for the rows from `start` on.
struct UpperProduct<'a, const R: usize> {
    matrix: &'a BlockRows<R>,
    start: usize,
    x: &'a [[f64; R]],
    r: &'a mut [[f64; R]],
}

impl<const R: usize> WithSimd for UpperProduct<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let UpperProduct { matrix, start, x, r } = self;
        let x = Values { before: x, own: &[], after: &[], start: x.len(), end: x.len() };
        for k in 0..r.len() {
            let row = start + k;
            let blocks = matrix.place_of_diagonal(row) + 1..matrix.columns(row).len();
            let product = matrix.product(row, blocks, &x);
            for i in 0..R {
                r[k][i] = -product[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::blocks::inverse;
    use super::*;

    const NODES: usize = 700;

    /// A symmetric matrix whose diagonal dominates: every node is coupled with the next ones and with one far away.
    fn matrix(colouring: &mut Colouring) -> BlockRows<3> {
        let coupled = |node: usize| [1, 2, 5, 300].map(|step| (node + step) % NODES);
        let mut neighbours: Vec<Vec<u32>> = (0..NODES).map(|node| vec![node as u32]).collect();
        for node in 0..NODES {
            for other in coupled(node) {
                neighbours[node].push(other as u32);
                neighbours[other].push(node as u32);
            }
        }
        let mut couplings = Couplings::new();
        neighbours.iter().for_each(|neighbours| couplings.push(neighbours));
        *colouring = Colouring::new(&couplings, 40);
        let places = colouring.places();
        let mut matrix = BlockRows::zero(couplings, colouring, &places);
        for node in 0..NODES {
            let own = [[20.0, 1.0, 2.0], [1.0, 25.0, 0.5], [2.0, 0.5, 30.0]];
            matrix.add(places[node], places[node], &own);
            for other in coupled(node) {
                let block = [[-1.0, 0.1, 0.2], [0.3, -1.5, 0.4], [0.5, 0.6, (node as f64).sin()]];
                matrix.add(places[node], places[other], &block);
                matrix.add(places[other], places[node], &super::super::blocks::transposed(&block));
            }
        }
        matrix
    }

    /// The sum of A_ik x_k over the columns that are wanted, one number after the other.
    fn plain(matrix: &BlockRows<3>, row: usize, x: &[[f64; 3]], wanted: impl Fn(usize) -> bool) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let blocks = matrix.row(row).filter(|(column, _)| wanted(*column));
        blocks.for_each(|(column, block)| add_block_vector(&block, &x[column], &mut sum));
        sum
    }

    /// |b - y| of a block row.
    fn distance(b: [f64; 3], y: [f64; 3]) -> f64 {
        (0..3).map(|i| (b[i] - y[i]).abs()).sum()
    }

    #[test]
    fn sweeps_solve_their_triangles_with_the_same_bits_on_any_number_of_threads() {
        let mut colouring = Colouring::new(&Couplings::new(), 1);
        let matrix = matrix(&mut colouring);
        assert!(colouring.colours.len() > 2);
        let inverses: Vec<_> = (0..NODES).map(|row| inverse(&matrix.diagonal(row))).collect();
        let r: Vec<[f64; 3]> = (0..NODES).map(|k| [1, 2, 3].map(|i| ((k * i) as f64).cos())).collect();
        let swept = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let (mut x, mut rest) = (vec![[0.0; 3]; NODES], vec![[0.0; 3]; NODES]);
                matrix.sweep(Direction::Forward, &inverses, &r, &mut x);
                matrix.residual_after_forward(&x, &mut rest);
                let mut y = x.clone();
                matrix.sweep(Direction::Backward, &inverses, &r, &mut y);
                (x, rest, y)
            })
        });
        assert!(swept[0] == swept[1]);
        let [(x, rest, y), _] = swept;
        for row in 0..NODES {
            let sum = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] + b[i]);
            let whole = plain(&matrix, row, &x, |_| true);
            assert!(distance(plain(&matrix, row, &x, |column| column <= row), r[row]) < 1e-13, "(D + L) x = r");
            assert!(distance(sum(whole, rest[row]), r[row]) < 1e-13, "the residual");
            let upper = plain(&matrix, row, &y, |column| column >= row);
            assert!(distance(sum(upper, plain(&matrix, row, &x, |column| column < row)), r[row]) < 1e-13);
        }
    }
}
