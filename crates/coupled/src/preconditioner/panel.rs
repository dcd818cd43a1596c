//! Products of stored single-precision blocks with vectors, in SIMD.

use tensor::pulp::{Simd, WithSimd};

/// Rows are padded to a multiple of this.
pub const ALIGNMENT: usize = 16;

/// `n` rounded up to whole registers of any machine.
pub fn padded(n: usize) -> usize {
    n.div_ceil(ALIGNMENT) * ALIGNMENT
}

/// Columns of a panel that are multiplied in one go, at most.
const COLUMNS: usize = 4;

/// y_c += A x_c for the columns c of a panel: A column-major with `rows` rows (a multiple of [`ALIGNMENT`]), x
/// `[column][..]` with room for `x.len() / columns` numbers each, of which A takes the first, and y `[column][row]`.
pub struct Multiply<'a> {
    /// A.
    pub matrix: &'a [f32],
    /// Rows of A.
    pub rows: usize,
    /// Columns of the panel.
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
                1 => multiply::<1, 4, S>(simd, matrix, x, y),
                2 => multiply::<2, 4, S>(simd, matrix, x, y),
                3 => multiply::<3, 2, S>(simd, matrix, x, y),
                _ => multiply::<COLUMNS, 2, S>(simd, matrix, x, y),
            }
            first += count;
        }
    }
}

/// [`Multiply`] for C columns, R registers of rows at a time, then one at a time.
#[inline(always)]
fn multiply<const C: usize, const R: usize, S: Simd>(simd: S, matrix: &[f32], x: &[f32], y: &mut [f32]) {
    let (registers, _) = S::as_simd_f32s(matrix);
    let (y, _) = S::as_mut_simd_f32s(y);
    let height = y.len() / C;
    let mut row = 0;
    while row + R <= height {
        multiply_rows::<C, R, S>(simd, registers, row, x, y);
        row += R;
    }
    while row < height {
        multiply_rows::<C, 1, S>(simd, registers, row, x, y);
        row += 1;
    }
}

/// The same for registers `row` to `row + R`, which stay in registers: each of A is read once for all columns.
#[inline(always)]
fn multiply_rows<const C: usize, const R: usize, S: Simd>(
    simd: S,
    registers: &[S::f32s],
    row: usize,
    x: &[f32],
    y: &mut [S::f32s],
) {
    let (height, x_len) = (y.len() / C, x.len() / C);
    let mut sums = [[simd.splat_f32s(0.0); R]; C];
    for c in 0..C {
        sums[c].copy_from_slice(&y[c * height + row..c * height + row + R]);
    }
    for (column, a) in registers.chunks_exact(height).enumerate() {
        let a = &a[row..row + R];
        for c in 0..C {
            let x = simd.splat_f32s(x[c * x_len + column]);
            for r in 0..R {
                sums[c][r] = simd.mul_add_f32s(a[r], x, sums[c][r]);
            }
        }
    }
    for c in 0..C {
        y[c * height + row..c * height + row + R].copy_from_slice(&sums[c]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tensor::Arch;

    #[test]
    fn panels_of_any_width_are_multiplied_column_by_column() {
        let number = |i: usize| ((7 * i + 3) % 11) as f32 - 5.0;
        for (n, columns) in [(1, 1), (16, 2), (20, 3), (64, 4), (100, 5), (37, 9)] {
            let rows = padded(n);
            let matrix: Vec<f32> = (0..rows * n).map(|i| if i % rows < n { number(i) } else { 0.0 }).collect();
            let x: Vec<f32> = (0..rows * columns).map(|i| number(i + 1)).collect();
            let mut y: Vec<f32> = (0..rows * columns).map(|i| number(i + 2)).collect();
            let expected: Vec<f32> = (0..rows * columns)
                .map(|i| {
                    let (column, row) = (i / rows, i % rows);
                    // Whole numbers: exact in any order.
                    y[i] + (0..n).map(|k| matrix[k * rows + row] * x[column * rows + k]).sum::<f32>()
                })
                .collect();
            Arch::new().dispatch(Multiply { matrix: &matrix, rows, columns, x: &x, y: &mut y });
            assert_eq!(y, expected, "{n} x {columns}");
        }
    }
}
