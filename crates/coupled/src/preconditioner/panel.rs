//! Products of stored single-precision blocks with vectors, in SIMD.
//!
//! A block lies in panels of [`PANEL`] rows, `[panel][column][part][row]`, so that it is read from memory in one stream; its rows
//! are padded to whole registers, and parts are its real and, of a complex block, its imaginary part.

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
    /// 1 if it is real, 2 if it is complex.
    pub parts: usize,
}

impl Panels {
    /// Numbers stored.
    pub fn len(self) -> usize {
        self.rows * self.columns * self.parts
    }

    /// Stores a part of column `j`, all rows of it or the first ones.
    pub fn put<T: Copy>(self, matrix: &mut [T], j: usize, part: usize, column: &[T]) {
        for (panel, values) in column.chunks(PANEL).enumerate() {
            let first = panel * PANEL;
            let height = PANEL.min(self.rows - first);
            let start = (first * self.columns + j * height) * self.parts + part * height;
            matrix[start..start + values.len()].copy_from_slice(values);
        }
    }
}

/// Columns that are multiplied in one go, at most.
const COLUMNS: usize = 4;

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
        let x_len = x.len() / columns;
        let mut first = 0;
        while first < columns {
            let count = (columns - first).min(COLUMNS);
            let (x, y) = (&x[first * x_len..(first + count) * x_len], &mut y[first * rows..(first + count) * rows]);
            match count {
                1 => multiply::<1, S>(simd, matrix, x, y),
                2 => multiply::<2, S>(simd, matrix, x, y),
                3 => multiply::<3, S>(simd, matrix, x, y),
                _ => multiply::<COLUMNS, S>(simd, matrix, x, y),
            }
            first += count;
        }
    }
}

/// [`Multiply`] for C columns, as many registers of rows at a time as the machine has room for.
#[inline(always)]
fn multiply<const C: usize, S: Simd>(simd: S, matrix: &[f32], x: &[f32], y: &mut [f32]) {
    let (matrix, _) = S::as_simd_f32s(matrix);
    let (y, _) = S::as_mut_simd_f32s(y);
    let (rows, panel) = (y.len() / C, PANEL / S::F32_LANES);
    let columns = matrix.len() / rows;
    let at_once = if S::F32_LANES >= 16 { 4 } else { 2 };
    let mut first = 0;
    while first < rows {
        let height = panel.min(rows - first);
        let stored = &matrix[first * columns..(first + height) * columns];
        let mut row = 0;
        while row < height {
            let (count, place) = ((height - row).min(at_once), [first, row, height]);
            match count {
                1 => multiply_rows::<C, 1, S>(simd, stored, place, x, y),
                2 => multiply_rows::<C, 2, S>(simd, stored, place, x, y),
                3 => multiply_rows::<C, 3, S>(simd, stored, place, x, y),
                _ => multiply_rows::<C, 4, S>(simd, stored, place, x, y),
            }
            row += count;
        }
        first += height;
    }
}

/// The same for registers `row` to `row + R` of the panel of `height` that begins with register `first`: each of A is read once for
/// all columns.
#[inline(always)]
fn multiply_rows<const C: usize, const R: usize, S: Simd>(
    simd: S,
    panel: &[S::f32s],
    [first, row, height]: [usize; 3],
    x: &[f32],
    y: &mut [S::f32s],
) {
    let (rows, x_len) = (y.len() / C, x.len() / C);
    let mut sums = [[simd.splat_f32s(0.0); R]; C];
    for c in 0..C {
        sums[c].copy_from_slice(&y[c * rows + first + row..][..R]);
    }
    for (column, a) in panel.chunks_exact(height).enumerate() {
        let a = &a[row..row + R];
        for c in 0..C {
            let x = simd.splat_f32s(x[c * x_len + column]);
            for r in 0..R {
                sums[c][r] = simd.mul_add_f32s(a[r], x, sums[c][r]);
            }
        }
    }
    for c in 0..C {
        y[c * rows + first + row..][..R].copy_from_slice(&sums[c]);
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

    /// The block of which part p has the entries number(i + 3 j + 5 p).
    fn stored(panels: Panels, n: usize) -> Vec<f32> {
        let mut matrix = vec![0.0; panels.len()];
        for (j, part) in (0..panels.columns).flat_map(|j| (0..panels.parts).map(move |part| (j, part))) {
            let column: Vec<f32> = (0..n).map(|i| number(i + 3 * j + 5 * part)).collect();
            panels.put(&mut matrix, j, part, &column);
        }
        matrix
    }

    #[test]
    fn real_blocks_of_any_width_multiply_column_by_column() {
        for (n, columns) in [(1, 1), (16, 2), (20, 3), (64, 4), (100, 5), (37, 9)] {
            let rows = padded(n);
            let matrix = stored(Panels { rows, columns: n, parts: 1 }, n);
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
