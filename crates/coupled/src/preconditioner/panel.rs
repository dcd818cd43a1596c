//! Products of stored blocks with vectors, in SIMD.
//!
//! A block lies in panels of [`PANEL`] rows, `[panel][column][row]`, so that it is read from memory in one stream; its rows are padded to
//! whole registers.

use tensor::pulp::{Simd, WithSimd};

/// Rows are padded to a multiple of this.
pub const ALIGNMENT: usize = 16;

/// Rows of a panel: a few registers of sums for every column that is multiplied.
pub const PANEL: usize = 4 * ALIGNMENT;

/// `n` rounded up to whole registers of any machine.
pub fn padded(n: usize) -> usize {
    n.div_ceil(ALIGNMENT) * ALIGNMENT
}

/// How a block is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Panels {
    /// Its rows, a multiple of [`ALIGNMENT`].
    pub rows: usize,
    /// Its columns.
    pub columns: usize,
}

impl Panels {
    /// Numbers stored.
    pub fn len(self) -> usize {
        self.rows * self.columns
    }

    /// Stores column `j`, all rows of it or the first ones.
    pub fn put<T: Copy>(self, matrix: &mut [T], j: usize, column: &[T]) {
        for (panel, values) in column.chunks(PANEL).enumerate() {
            let first = panel * PANEL;
            let height = PANEL.min(self.rows - first);
            let start = first * self.columns + j * height;
            matrix[start..start + values.len()].copy_from_slice(values);
        }
    }
}

/// Columns that are multiplied in one go, at most.
const COLUMNS: usize = 4;

/// Columns from `column` on, and registers of rows that belong to the panel of `height` registers that begins with register `first`.
#[derive(Clone, Copy)]
pub(super) struct TilePosition {
    pub(super) column: usize,
    pub(super) first: usize,
    pub(super) row: usize,
    pub(super) height: usize,
}

/// A product that is made by a few columns and a few registers of rows at a time.
pub(super) trait ByTiles {
    /// Makes C columns of R registers of rows.
    fn tile<const C: usize, const R: usize>(&mut self, place: TilePosition);
}

/// Makes all of `product`, `columns` columns of `rows` numbers, in tiles for which the machine has registers.
#[inline(always)]
pub(super) fn by_tiles<S: Simd>(columns: usize, rows: usize, product: &mut impl ByTiles) {
    let mut column = 0;
    while column < columns {
        let count = (columns - column).min(COLUMNS);
        match count {
            1 => by_rows::<1, S>(column, rows, product),
            2 => by_rows::<2, S>(column, rows, product),
            3 => by_rows::<3, S>(column, rows, product),
            _ => by_rows::<COLUMNS, S>(column, rows, product),
        }
        column += count;
    }
}

/// [`by_tiles`] for C columns.
#[inline(always)]
fn by_rows<const C: usize, S: Simd>(column: usize, rows: usize, product: &mut impl ByTiles) {
    let (rows, panel) = (rows / S::F32_LANES, PANEL / S::F32_LANES);
    let at_once = if S::F32_LANES >= 16 { 4 } else { 2 };
    let (mut first, mut row) = (0, 0);
    while first < rows {
        let height = panel.min(rows - first);
        let (count, place) = ((height - row).min(at_once), TilePosition { column, first, row, height });
        match count {
            1 => product.tile::<C, 1>(place),
            2 => product.tile::<C, 2>(place),
            3 => product.tile::<C, 3>(place),
            _ => product.tile::<C, 4>(place),
        }
        row += count;
        if row == height {
            (first, row) = (first + height, 0);
        }
    }
}

/// y_c += A x_c for `columns` columns c: A a real block of [`Panels`] with `rows` rows, x `[column][..]` with room for
/// `x.len() / columns` numbers each, of which A takes the first, and y `[column][row]`.
pub struct Multiply<'a> {
    /// A.
    pub matrix: &'a [f32],
    /// Rows of A.
    pub rows: usize,
    /// Columns of x and y.
    pub columns: usize,
    /// x.
    pub x: &'a [f32],
    /// y.
    pub y: &'a mut [f32],
}

impl WithSimd for Multiply<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Multiply { matrix, rows, columns, x, y } = self;
        let (x_len, (matrix, _), (y, _)) = (x.len() / columns, S::as_simd_f32s(matrix), S::as_mut_simd_f32s(y));
        by_tiles::<S>(columns, rows, &mut Product { simd, rows: rows / S::F32_LANES, matrix, x_len, x, y });
    }
}

/// [`Multiply`] in registers.
struct Product<'a, S: Simd> {
    simd: S,
    rows: usize,
    matrix: &'a [S::f32s],
    x_len: usize,
    x: &'a [f32],
    y: &'a mut [S::f32s],
}

impl<S: Simd> ByTiles for Product<'_, S> {
    /// Each register of A is read once for all columns.
    #[inline(always)]
    fn tile<const C: usize, const R: usize>(&mut self, TilePosition { column, first, row, height }: TilePosition) {
        let Product { simd, rows, matrix, x_len, x, ref mut y } = *self;
        let columns = matrix.len() / rows;
        let (x, y) = (&x[column * x_len..][..C * x_len], &mut y[column * rows..][..C * rows]);
        let mut sums = [[simd.splat_f32s(0.0); R]; C];
        for c in 0..C {
            sums[c].copy_from_slice(&y[c * rows + first + row..][..R]);
        }
        for (j, a) in matrix[first * columns..(first + height) * columns].chunks_exact(height).enumerate() {
            let a = &a[row..row + R];
            for c in 0..C {
                let x = simd.splat_f32s(x[c * x_len + j]);
                for r in 0..R {
                    sums[c][r] = simd.mul_add_f32s(a[r], x, sums[c][r]);
                }
            }
        }
        for c in 0..C {
            y[c * rows + first + row..][..R].copy_from_slice(&sums[c]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tensor::Arch;

    /// A whole number, so that sums are exact in any order.
    fn number(i: usize) -> f32 {
        ((7 * i + 3) % 11) as f32 - 5.0
    }

    /// The block with the entries number(i + 3 j).
    fn stored(panels: Panels, n: usize) -> Vec<f32> {
        let mut matrix = vec![0.0; panels.len()];
        for j in 0..panels.columns {
            let column: Vec<f32> = (0..n).map(|i| number(i + 3 * j)).collect();
            panels.put(&mut matrix, j, &column);
        }
        matrix
    }

    #[test]
    fn real_blocks_of_any_width_multiply_column_by_column() {
        for (n, columns) in [(1, 1), (16, 2), (20, 3), (64, 4), (100, 5), (37, 9)] {
            let rows = padded(n);
            let matrix = stored(Panels { rows, columns: n }, n);
            let x: Vec<f32> = (0..rows * columns).map(|i| number(i + 1)).collect();
            let mut y: Vec<f32> = (0..rows * columns).map(|i| number(i + 2)).collect();
            let product = |row: usize, x: &[f32]| (0..n).map(|j| number(row + 3 * j) * x[j]).sum::<f32>();
            let expected = (0..rows * columns).map(|i| {
                let (column, row) = (i / rows, i % rows);
                y[i] + if row < n { product(row, &x[column * rows..]) } else { 0.0 }
            });
            let expected: Vec<f32> = expected.collect();
            Arch::new().dispatch(Multiply { matrix: &matrix, rows, columns, x: &x, y: &mut y });
            assert_eq!(y, expected, "{n} x {columns}");
        }
    }
}
