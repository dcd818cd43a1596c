//! Products of stored single-precision blocks with vectors, in SIMD.

use tensor::pulp::{Simd, WithSimd};

/// Rows are padded to a multiple of this.
pub const ALIGNMENT: usize = 16;

/// `n` rounded up to whole registers of any machine.
pub fn padded(n: usize) -> usize {
    n.div_ceil(ALIGNMENT) * ALIGNMENT
}

/// y += A x, A column-major with `y.len()` rows (a multiple of [`ALIGNMENT`]) and `x.len()` columns.
pub struct Multiply<'a> {
    /// A.
    pub matrix: &'a [f32],
    /// x.
    pub x: &'a [f32],
    /// y.
    pub y: &'a mut [f32],
}

impl WithSimd for Multiply<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Multiply { matrix, x, y } = self;
        let rows = y.len();
        let (y, _) = S::as_mut_simd_f32s(y);
        let width = rows / y.len().max(1);
        let mut row = 0;
        // Four registers of y at a time: each column of A is read once, in passing.
        while row < y.len() {
            let count = (y.len() - row).min(4);
            let mut sums = [simd.splat_f32s(0.0); 4];
            sums[..count].copy_from_slice(&y[row..row + count]);
            for (column, &x) in x.iter().enumerate() {
                let start = column * rows + row * width;
                let (a, _) = S::as_simd_f32s(&matrix[start..start + count * width]);
                let x = simd.splat_f32s(x);
                for r in 0..count {
                    sums[r] = simd.mul_add_f32s(a[r], x, sums[r]);
                }
            }
            y[row..row + count].copy_from_slice(&sums[..count]);
            row += count;
        }
    }
}

/// y += A x for complex A, x and y given as real and imaginary parts.
pub struct MultiplyComplex<'a> {
    /// Real part of A, column-major.
    pub re: &'a [f32],
    /// Imaginary part of A.
    pub im: &'a [f32],
    /// x, real part.
    pub x_re: &'a [f32],
    /// x, imaginary part.
    pub x_im: &'a [f32],
    /// y, real part.
    pub y_re: &'a mut [f32],
    /// y, imaginary part.
    pub y_im: &'a mut [f32],
}

impl WithSimd for MultiplyComplex<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let MultiplyComplex { re, im, x_re, x_im, y_re, y_im } = self;
        let rows = y_re.len();
        let (y_re, _) = S::as_mut_simd_f32s(y_re);
        let (y_im, _) = S::as_mut_simd_f32s(y_im);
        let width = rows / y_re.len().max(1);
        for row in 0..y_re.len() {
            let (mut sum_re, mut sum_im) = (y_re[row], y_im[row]);
            for column in 0..x_re.len() {
                let start = column * rows + row * width;
                let a_re = S::as_simd_f32s(&re[start..start + width]).0[0];
                let a_im = S::as_simd_f32s(&im[start..start + width]).0[0];
                let (b_re, b_im) = (simd.splat_f32s(x_re[column]), simd.splat_f32s(x_im[column]));
                sum_re = simd.mul_add_f32s(a_re, b_re, sum_re);
                sum_re = simd.negate_mul_add_f32s(a_im, b_im, sum_re);
                sum_im = simd.mul_add_f32s(a_re, b_im, sum_im);
                sum_im = simd.mul_add_f32s(a_im, b_re, sum_im);
            }
            (y_re[row], y_im[row]) = (sum_re, sum_im);
        }
    }
}
