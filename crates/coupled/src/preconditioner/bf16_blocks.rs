//! Blocks in half of single precision, as pairs of numbers in 32 bits, and their products with vectors in SIMD.
//!
//! Most of the cost of a preconditioner is reading its blocks from memory. They are rounded to the 8 bits of bfloat16, which has the
//! exponents of single precision. The iteration around it works in double precision and loses no accuracy. Its number of steps changes by
//! one in a hundred at most in an airfoil's thin boundary layer. Blocks that are worse conditioned are the sums of two or three such terms, with 16 or 24 bits.
//!
//! ```text
//! y += A_low x_low + A_high x_high                                                                                    (bf16)
//! ```
//!
//! For a real block A_low is the first half of its columns and A_high the second half; a column of zeros makes their number even. For a
//! complex block they are the real and the imaginary part. Sums are done in single precision. Pairs lie in [`Panels`].

use super::inverse::Shape;
use super::panel::{ByTiles, Panels, TilePosition, by_tiles, padded};
use half::bf16;
use tensor::pulp::{Simd, WithSimd};

/// How a block of `shape` is stored.
pub fn panels(shape: Shape) -> Panels {
    Panels { rows: padded(shape.n), columns: (shape.n * shape.parts).div_ceil(2) }
}

/// A further term rounds so many times less.
const OF_A_TERM: f64 = 256.0;
/// Together they have the digits of single precision.
const MAX_TERMS: usize = 3;

/// The terms of numbers for which one term loses `loss` times as many digits as it may.
pub fn terms(loss: f64) -> usize {
    (1..MAX_TERMS).find(|terms| loss <= OF_A_TERM.powi(*terms as i32 - 1)).unwrap_or(MAX_TERMS)
}

/// Stores a block, `[column][part][row]` with rows padded, as a sum of `terms`. Of more than one, it leaves what they lack in `block`.
pub fn store_in_terms<'a>(shape: Shape, block: &mut [f32], terms: impl Iterator<Item = &'a mut [u32]>) {
    for (number, term) in terms.enumerate() {
        if number > 0 {
            block.iter_mut().for_each(|number| *number = lost(*number));
        }
        store(shape, block, term);
    }
}

/// What rounding takes.
fn lost(number: f32) -> f32 {
    let lost = number - bf16::from_f32(number).to_f32();
    if lost.is_finite() { lost } else { 0.0 }
}

/// Rounds a block.
fn store(shape: Shape, block: &[f32], stored: &mut [u32]) {
    let panels = panels(shape);
    let (zeros, mut bf16_blocks) = (vec![0.0; panels.rows], vec![0; panels.rows]);
    let column = |number: usize| block.get(number * panels.rows..(number + 1) * panels.rows).unwrap_or(&zeros);
    for j in 0..panels.columns {
        let numbers = if shape.parts == 2 { [2 * j, 2 * j + 1] } else { [j, j + panels.columns] };
        let [low, high] = numbers.map(column);
        for (pair, (low, high)) in bf16_blocks.iter_mut().zip(low.iter().zip(high)) {
            *pair = rounded(*low) | rounded(*high) << 16;
        }
        panels.put(stored, j, &bf16_blocks);
    }
}

fn rounded(number: f32) -> u32 {
    u32::from(bf16::from_f32(number).to_bits())
}

/// (bf16) for `columns` columns of x and y, x_high of each `half` numbers behind its x_low.
///
/// For a real block of n columns, `half` is (n + 1) / 2, and x ends with a zero if n is odd. For a complex block x has the two columns
/// (re, -im) and (im, re), and y has the columns (re) and (im).
pub struct MultiplyBf16<'a> {
    /// A.
    pub matrix: &'a [u32],
    /// Columns of x and y.
    pub columns: usize,
    /// Where x_high begins.
    pub half: usize,
    /// x, `[column][..]`.
    pub x: &'a [f32],
    /// y, `[column][padded row]`.
    pub y: &'a mut [f32],
}

impl WithSimd for MultiplyBf16<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let MultiplyBf16 { matrix, columns, half, x, y } = self;
        let (x_len, rows) = (x.len() / columns, y.len() / columns);
        let ((matrix, _), (y, _)) = (S::as_simd_u32s(matrix), S::as_mut_simd_f32s(y));
        by_tiles::<S>(columns, rows, &mut Product { simd, rows: rows / S::F32_LANES, matrix, half, x_len, x, y });
    }
}

/// [`MultiplyBf16`] in registers.
struct Product<'a, S: Simd> {
    simd: S,
    rows: usize,
    matrix: &'a [S::u32s],
    half: usize,
    x_len: usize,
    x: &'a [f32],
    y: &'a mut [S::f32s],
}

impl<S: Simd> ByTiles for Product<'_, S> {
    #[inline(always)]
    fn tile<const C: usize, const R: usize>(&mut self, TilePosition { column, first, row, height }: TilePosition) {
        let Product { simd, rows, matrix, half, x_len, x, ref mut y } = *self;
        let columns = matrix.len() / rows;
        let (x, y) = (&x[column * x_len..][..C * x_len], &mut y[column * rows..][..C * rows]);
        let (sixteen, upper) = (simd.splat_u32s(16), simd.splat_u32s(0xffff_0000));
        // One sum for the low numbers, one for the high ones: a chain of additions would wait for its own last one.
        let mut sums = [[[simd.splat_f32s(0.0); R]; 2]; C];
        for c in 0..C {
            sums[c][0].copy_from_slice(&y[c * rows + first + row..][..R]);
        }
        for (j, bf16_blocks) in matrix[first * columns..(first + height) * columns].chunks_exact(height).enumerate() {
            let bf16_blocks = &bf16_blocks[row..row + R];
            for r in 0..R {
                let low = simd.transmute_f32s_u32s(simd.wrapping_dyn_shl_u32s(bf16_blocks[r], sixteen));
                let high = simd.transmute_f32s_u32s(simd.and_u32s(bf16_blocks[r], upper));
                for c in 0..C {
                    let x = &x[c * x_len + j..];
                    sums[c][0][r] = simd.mul_add_f32s(low, simd.splat_f32s(x[0]), sums[c][0][r]);
                    sums[c][1][r] = simd.mul_add_f32s(high, simd.splat_f32s(x[half]), sums[c][1][r]);
                }
            }
        }
        for c in 0..C {
            for r in 0..R {
                y[c * rows + first + row + r] = simd.add_f32s(sums[c][0][r], sums[c][1][r]);
            }
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
        for (n, columns) in [(1, 1), (16, 2), (20, 3), (64, 4), (37, 4), (100, 5), (101, 9)] {
            let matrix = stored(Shape { n, parts: 1 });
            let x: Vec<f32> = (0..columns).flat_map(|c| vector(n, 3 * c)).collect();
            let mut y: Vec<f32> = (0..columns).flat_map(|c| vector(n, c + 1)).collect();
            let rows = padded(n);
            let expected = (0..y.len()).map(|i| y[i] + product(0, i % rows, n, &x[i / rows * rows..]));
            let expected: Vec<f32> = expected.collect();
            let half = n.div_ceil(2);
            Arch::new().dispatch(MultiplyBf16 { matrix: &matrix, columns, half, x: &x, y: &mut y });
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
            let x = [&re[..], &minus_im, &im, &re].concat();
            Arch::new().dispatch(MultiplyBf16 { matrix: &matrix, columns: 2, half: padded(n), x: &x, y: &mut y });
            for row in 0..n {
                let expected = [
                    product(0, row, n, &re) - product(1, row, n, &im),
                    product(0, row, n, &im) + product(1, row, n, &re),
                ];
                assert_eq!([y[row], y[padded(n) + row]], expected, "order {n}, row {row}");
            }
        }
    }

    /// Of a complex number of order one.
    fn stored_and_read(re: f32, im: f32) -> [f32; 2] {
        let shape = Shape { n: 1, parts: 2 };
        let (mut block, mut bf16_blocks) = (vec![0.0; shape.len()], vec![0; panels(shape).len()]);
        (block[0], block[padded(1)]) = (re, im);
        store(shape, &block, &mut bf16_blocks);
        [bf16_blocks[0] << 16, bf16_blocks[0] & 0xffff_0000].map(f32::from_bits)
    }

    #[test]
    fn terms_follow_from_what_one_of_them_loses() {
        for (loss, expected) in [(0.0, 1), (1.0, 1), (1.1, 2), (256.0, 2), (257.0, 3), (1e9, 3), (f64::INFINITY, 3)] {
            assert_eq!(terms(loss), expected, "{loss}");
        }
    }

    #[test]
    fn two_terms_have_sixteen_bits() {
        let shape = Shape { n: 1, parts: 2 };
        let (mut block, mut terms) = (vec![0.0; shape.len()], vec![vec![0; panels(shape).len()]; 2]);
        (block[0], block[padded(1)]) = (std::f32::consts::PI, -1e-20);
        store_in_terms(shape, &mut block, terms.iter_mut().map(Vec::as_mut_slice));
        let sum = |shift: u32| -> f32 { terms.iter().map(|term| f32::from_bits(term[0] << shift & 0xffff_0000)).sum() };
        for (sum, number) in [(sum(16), std::f32::consts::PI), (sum(0), -1e-20)] {
            assert!((sum / number - 1.0).abs() < 2.0_f32.powi(-16), "{sum} for {number}");
        }
        assert!((f32::from_bits(terms[0][0] << 16) / std::f32::consts::PI - 1.0).abs() > 2.0_f32.powi(-12));
    }

    #[test]
    fn numbers_are_rounded_to_eight_bits_and_ties_to_even() {
        let bit = 1.0 / 128.0;
        assert_eq!(stored_and_read(1.0 + 0.75 * bit, 1.0 + 0.25 * bit), [1.0 + bit, 1.0]);
        assert_eq!(stored_and_read(1.0 + 0.5 * bit, 1.0 + 1.5 * bit), [1.0, 1.0 + 2.0 * bit]);
        let large = stored_and_read(-1e30, 1e-30);
        assert!((large[0] / -1e30 - 1.0).abs() < 0.5 * bit && (large[1] / 1e-30 - 1.0).abs() < 0.5 * bit);
    }

    /// A block that has no inverse is to be seen by the iteration.
    #[test]
    fn what_is_no_number_stays_none() {
        let [nan, infinite] = stored_and_read(f32::NAN, f32::NEG_INFINITY);
        assert!(nan.is_nan() && infinite == f32::NEG_INFINITY);
    }
}
