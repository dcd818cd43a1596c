//! Blocks in half of single precision, two numbers in 32 bits, and their products with vectors in SIMD.
//!
//! What a preconditioner reads from memory is most of what it costs. It may be rounded to the 8 bits of bfloat16 (the exponents are
//! those of single precision): iterations in double precision, around it, lose nothing, and their number stays what it was to within
//! one in a hundred, from an airfoil's thin boundary layer to cells of order 8.
//!
//! ```text
//! y += A_low x_low + A_high x_high                                                                                   (halves)
//! ```
//!
//! For a real block A_low are the first half of its columns and A_high the second, for a complex one they are the real and the
//! imaginary part. Sums are done in single precision. Blocks lie in [`Panels`], one number for each pair.

use super::inverse::Shape;
use super::panel::{PANEL, Panels, padded};
use half::bf16;
use tensor::pulp::{Simd, WithSimd};

/// Columns of y that are made in one go, at most.
pub const COLUMNS: usize = 4;

/// The columns of a block of `shape` as pairs.
pub fn panels(shape: Shape) -> Panels {
    Panels { rows: padded(shape.n), columns: (shape.n * shape.parts).div_ceil(2), parts: 1 }
}

/// Rounds a block, `[column][part][row]` with rows padded.
pub fn store(shape: Shape, block: &[f32], stored: &mut [u32]) {
    let panels = panels(shape);
    let column = |number: usize| block.get(number * panels.rows..(number + 1) * panels.rows);
    let zeros = vec![0.0; panels.rows];
    let mut pairs = vec![0; panels.rows];
    for j in 0..panels.columns {
        let [low, high] = if shape.parts == 2 { [2 * j, 2 * j + 1] } else { [j, j + panels.columns] };
        let columns = [low, high].map(|number| column(number).unwrap_or(&zeros));
        pairs.iter_mut().zip(columns[0].iter().zip(columns[1])).for_each(|(pair, (low, high))| {
            *pair = u32::from(bf16::from_f32(*low).to_bits()) | u32::from(bf16::from_f32(*high).to_bits()) << 16;
        });
        panels.put(stored, j, 0, &pairs);
    }
}

/// x_low and x_high for a real block of `columns` columns; x has room for an even number of them, zeros behind the last.
pub fn of_real(x: &[f32], columns: usize) -> [&[f32]; 2] {
    let half = columns.div_ceil(2);
    [&x[..half], &x[half..2 * half]]
}

/// (halves) for up to [`COLUMNS`] columns of x and y.
pub struct MultiplyHalves<'a> {
    /// A.
    pub matrix: &'a [u32],
    /// x_low and x_high of every column.
    pub x: &'a [[&'a [f32]; 2]],
    /// y, `[column][padded row]`.
    pub y: &'a mut [f32],
}

impl WithSimd for MultiplyHalves<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let MultiplyHalves { matrix, x, y } = self;
        match *x {
            [] => (),
            [a] => multiply(simd, matrix, [a], y),
            [a, b] => multiply(simd, matrix, [a, b], y),
            [a, b, c] => multiply(simd, matrix, [a, b, c], y),
            [a, b, c, d, ..] => multiply(simd, matrix, [a, b, c, d], y),
        }
    }
}

/// [`MultiplyHalves`] for C columns, as many registers of rows at a time as the machine has room for.
#[inline(always)]
fn multiply<const C: usize, S: Simd>(simd: S, matrix: &[u32], x: [[&[f32]; 2]; C], y: &mut [f32]) {
    let (matrix, _) = S::as_simd_u32s(matrix);
    let (y, _) = S::as_mut_simd_f32s(y);
    let (rows, panel) = (y.len() / C, PANEL / S::F32_LANES);
    let columns = matrix.len() / rows;
    let at_once = if S::F32_LANES >= 16 { 4 } else { 2 };
    let x = x.map(|halves| halves.map(|x| &x[..columns]));
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

/// The same for registers `row` to `row + R` of the panel of `height` that begins with register `first`.
#[inline(always)]
fn multiply_rows<const C: usize, const R: usize, S: Simd>(
    simd: S,
    panel: &[S::u32s],
    [first, row, height]: [usize; 3],
    x: [[&[f32]; 2]; C],
    y: &mut [S::f32s],
) {
    let rows = y.len() / C;
    let (sixteen, upper) = (simd.splat_u32s(16), simd.splat_u32s(0xffff_0000));
    // One sum for each half: a chain of additions would wait for its own last one.
    let mut sums = [[[simd.splat_f32s(0.0); R]; 2]; C];
    for c in 0..C {
        sums[c][0].copy_from_slice(&y[c * rows + first + row..][..R]);
    }
    for (column, pairs) in panel.chunks_exact(height).enumerate() {
        let pairs = &pairs[row..row + R];
        for r in 0..R {
            let low = simd.transmute_f32s_u32s(simd.wrapping_dyn_shl_u32s(pairs[r], sixteen));
            let high = simd.transmute_f32s_u32s(simd.and_u32s(pairs[r], upper));
            for c in 0..C {
                sums[c][0][r] = simd.mul_add_f32s(low, simd.splat_f32s(x[c][0][column]), sums[c][0][r]);
                sums[c][1][r] = simd.mul_add_f32s(high, simd.splat_f32s(x[c][1][column]), sums[c][1][r]);
            }
        }
    }
    for c in 0..C {
        for r in 0..R {
            y[c * rows + first + row + r] = simd.add_f32s(sums[c][0][r], sums[c][1][r]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tensor::Arch;

    /// A whole number below 8 bits, so that it is stored as it is, and sums are exact in any order.
    fn number(i: usize) -> f32 {
        ((7 * i + 3) % 11) as f32 - 5.0
    }

    /// Entry (i, j) of a part.
    fn entry(part: usize, i: usize, j: usize) -> f32 {
        number(i + 3 * j + 5 * part)
    }

    fn stored(shape: Shape) -> Vec<u32> {
        let (mut block, mut stored) = (vec![0.0; shape.len()], vec![0; panels(shape).len()]);
        for (number, column) in block.chunks_exact_mut(padded(shape.n)).enumerate() {
            let (j, part) = (number / shape.parts, number % shape.parts);
            (0..shape.n).for_each(|i| column[i] = entry(part, i, j));
        }
        store(shape, &block, &mut stored);
        stored
    }

    /// Numbers with zeros in the padding.
    fn vector(n: usize, first: usize) -> Vec<f32> {
        (0..padded(n)).map(|i| if i < n { number(i + first) } else { 0.0 }).collect()
    }

    fn product(part: usize, row: usize, n: usize, x: &[f32]) -> f32 {
        if row < n { (0..n).map(|j| entry(part, row, j) * x[j]).sum() } else { 0.0 }
    }

    #[test]
    fn real_blocks_of_any_order_multiply_column_by_column() {
        for (n, columns) in [(1, 1), (16, 2), (20, 3), (64, 4), (37, 4), (100, 1), (101, 2)] {
            let matrix = stored(Shape { n, parts: 1 });
            let x: Vec<Vec<f32>> = (0..columns).map(|c| vector(n, 3 * c)).collect();
            let mut y: Vec<f32> = (0..columns).flat_map(|c| vector(n, c + 1)).collect();
            let rows = padded(n);
            let expected = (0..y.len()).map(|i| y[i] + product(0, i % rows, n, &x[i / rows]));
            let expected: Vec<f32> = expected.collect();
            let x: Vec<_> = x.iter().map(|x| of_real(x, n)).collect();
            Arch::new().dispatch(MultiplyHalves { matrix: &matrix, x: &x, y: &mut y });
            assert_eq!(y, expected, "{n} x {columns}");
        }
    }

    #[test]
    fn complex_blocks_multiply_as_complex_numbers() {
        for n in [1, 20, 64, 100] {
            let matrix = stored(Shape { n, parts: 2 });
            let (re, im) = (vector(n, 1), vector(n, 2));
            let minus_im: Vec<f32> = im.iter().map(|x| -x).collect();
            let mut y = vec![0.0; 2 * padded(n)];
            let x = [[&re[..], &minus_im[..]], [&im[..], &re[..]]];
            Arch::new().dispatch(MultiplyHalves { matrix: &matrix, x: &x, y: &mut y });
            for row in 0..n {
                let expected = [
                    product(0, row, n, &re) - product(1, row, n, &im),
                    product(0, row, n, &im) + product(1, row, n, &re),
                ];
                assert_eq!([y[row], y[padded(n) + row]], expected, "order {n}, row {row}");
            }
        }
    }

    #[test]
    fn numbers_are_rounded_to_eight_bits() {
        let shape = Shape { n: 1, parts: 2 };
        let (mut block, mut pair) = (vec![0.0; shape.len()], vec![0; panels(shape).len()]);
        (block[0], block[padded(1)]) = (1.0 + 3.0 / 512.0, -1e30);
        store(shape, &block, &mut pair);
        let [low, high] = [pair[0] << 16, pair[0] & 0xffff_0000].map(f32::from_bits);
        assert_eq!(low, 1.0 + 1.0 / 128.0);
        assert!((high / -1e30 - 1.0).abs() < 1.0 / 256.0);
    }
}
