//! Small dense blocks.

/// A block, `[row][column]`.
pub(crate) type Block<const R: usize, const C: usize> = [[f64; C]; R];

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

/// A^T
#[inline(always)]
pub(crate) fn transposed<const R: usize, const C: usize>(block: &Block<R, C>) -> Block<C, R> {
    let mut transposed = [[0.0; R]; C];
    for i in 0..R {
        for j in 0..C {
            transposed[j][i] = block[i][j];
        }
    }
    transposed
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
