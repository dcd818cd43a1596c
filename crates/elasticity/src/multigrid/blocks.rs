//! Sparse matrices of small dense blocks, by rows.

/// A block, `[row][column]`.
pub(crate) type Block<const R: usize, const C: usize> = [[f64; C]; R];

/// The blocks of row i are those in `starts[i]..starts[i + 1]`, with increasing columns.
#[derive(Clone)]
pub(crate) struct BlockRows<const R: usize, const C: usize> {
    pub(crate) starts: Vec<usize>,
    pub(crate) columns: Vec<u32>,
    pub(crate) blocks: Vec<Block<R, C>>,
}

impl<const R: usize, const C: usize> BlockRows<R, C> {
    /// Without rows.
    pub(crate) fn new() -> Self {
        BlockRows { starts: vec![0], columns: Vec::new(), blocks: Vec::new() }
    }
    /// Appends a row of columns and blocks.
    pub(crate) fn push_row(&mut self, row: impl IntoIterator<Item = (u32, Block<R, C>)>) {
        for (column, block) in row {
            self.columns.push(column);
            self.blocks.push(block);
        }
        self.starts.push(self.columns.len());
    }
    /// The number of block rows.
    pub(crate) fn rows(&self) -> usize {
        self.starts.len() - 1
    }
    /// The columns and blocks of a row.
    #[inline]
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = (usize, &Block<R, C>)> {
        let range = self.starts[row]..self.starts[row + 1];
        self.columns[range.clone()].iter().map(|&column| column as usize).zip(&self.blocks[range])
    }

    /// y = y + scale A x.
    pub(crate) fn add_product(&self, scale: f64, x: &[[f64; C]], y: &mut [[f64; R]]) {
        for (row, y) in y.iter_mut().enumerate() {
            let mut sum = [0.0; R];
            self.row(row).for_each(|(column, block)| add_block_vector(block, &x[column], &mut sum));
            (0..R).for_each(|i| y[i] += scale * sum[i]);
        }
    }

    /// A^T, with `columns` block rows.
    pub(crate) fn transpose(&self, columns: usize) -> BlockRows<C, R> {
        let mut starts = vec![0; columns + 1];
        self.columns.iter().for_each(|&column| starts[column as usize + 1] += 1);
        (0..columns).for_each(|column| starts[column + 1] += starts[column]);
        let mut next = starts.clone();
        let mut transpose =
            BlockRows { starts, columns: vec![0; self.columns.len()], blocks: vec![[[0.0; R]; C]; self.columns.len()] };
        for row in 0..self.rows() {
            for (column, block) in self.row(row) {
                let place = next[column];
                next[column] += 1;
                transpose.columns[place] = row as u32;
                transpose.blocks[place] = transposed(block);
            }
        }
        transpose
    }

    /// A B, where B has `columns` block columns.
    pub(crate) fn product<const K: usize>(&self, right: &BlockRows<C, K>, columns: usize) -> BlockRows<R, K> {
        let mut product = BlockRows::new();
        // The index in the row of the product assigned to a column; it is valid while `owner` is this row.
        let (mut place, mut owner) = (vec![0; columns], vec![usize::MAX; columns]);
        let mut row: Vec<(u32, Block<R, K>)> = Vec::new();
        for i in 0..self.rows() {
            row.clear();
            for (k, left) in self.row(i) {
                for (j, right) in right.row(k) {
                    if owner[j] != i {
                        (owner[j], place[j]) = (i, row.len());
                        row.push((j as u32, [[0.0; K]; R]));
                    }
                    add_block_product(left, right, &mut row[place[j]].1);
                }
            }
            row.sort_unstable_by_key(|(column, _)| *column);
            product.push_row(row.iter().copied());
        }
        product
    }

    /// Memory of the blocks and their columns.
    pub(crate) fn bytes(&self) -> usize {
        self.blocks.len() * (R * C * size_of::<f64>() + size_of::<u32>())
    }
}

/// y = y + A x
#[inline(always)]
pub(crate) fn add_block_vector<const R: usize, const C: usize>(block: &Block<R, C>, x: &[f64; C], y: &mut [f64; R]) {
    for i in 0..R {
        for j in 0..C {
            y[i] += block[i][j] * x[j];
        }
    }
}

/// sum = sum + A B
#[inline(always)]
pub(crate) fn add_block_product<const R: usize, const C: usize, const K: usize>(
    left: &Block<R, C>,
    right: &Block<C, K>,
    sum: &mut Block<R, K>,
) {
    for i in 0..R {
        for j in 0..C {
            for k in 0..K {
                sum[i][k] += left[i][j] * right[j][k];
            }
        }
    }
}

pub(crate) fn transposed<const R: usize, const C: usize>(block: &Block<R, C>) -> Block<C, R> {
    std::array::from_fn(|j| std::array::from_fn(|i| block[i][j]))
}

/// |A|^2, the sum of the squares of all entries.
pub(crate) fn square_norm<const R: usize, const C: usize>(block: &Block<R, C>) -> f64 {
    block.as_flattened().iter().map(|entry| entry * entry).sum()
}

/// The inverse of a symmetric positive definite block, by Gauss-Jordan elimination.
pub(crate) fn inverse<const R: usize>(block: &Block<R, R>) -> Block<R, R> {
    let mut left = *block;
    let mut right = [[0.0; R]; R];
    (0..R).for_each(|i| right[i][i] = 1.0);
    for k in 0..R {
        let pivot = left[k][k];
        for j in 0..R {
            left[k][j] /= pivot;
            right[k][j] /= pivot;
        }
        for i in (0..R).filter(|&i| i != k) {
            let factor = left[i][k];
            for j in 0..R {
                left[i][j] -= factor * left[k][j];
                right[i][j] -= factor * right[k][j];
            }
        }
    }
    right
}
