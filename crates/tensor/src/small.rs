//! Vectors of length D and D x D matrices, D = 1, 2 or 3, of any number type. Matrices are `m[row][column]`.

use crate::Real;

/// The names of the axes of space.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// a . b
#[inline(always)]
pub fn dot<T: Real, const D: usize>(a: &[T; D], b: &[T; D]) -> T {
    let mut sum = a[0] * b[0];
    for i in 1..D {
        sum = a[i].mul_add(b[i], sum);
    }
    sum
}

/// The Euclidean length of `a`.
#[inline(always)]
pub fn norm<T: Real, const D: usize>(a: &[T; D]) -> T {
    dot(a, a).sqrt()
}

/// a x b; of vectors in the plane only the last component is not zero.
pub fn cross<T: Real, const D: usize>(a: &[T; D], b: &[T; D]) -> [T; 3] {
    let at = |v: &[T; D], i: usize| v.get(i % 3).copied().unwrap_or(a[0].zero());
    std::array::from_fn(|i| at(a, i + 1) * at(b, i + 2) - at(a, i + 2) * at(b, i + 1))
}

/// The matrix whose column j is `columns[j]`.
#[inline(always)]
pub fn matrix_from_columns<T: Real, const D: usize>(columns: &[[T; D]; D]) -> [[T; D]; D] {
    let mut m = *columns;
    for i in 0..D {
        for j in 0..D {
            m[i][j] = columns[j][i];
        }
    }
    m
}

/// The cofactor matrix: `cofactor(m)[i][j]` is the derivative of det(m) by `m[i][j]`, so that m^{-T} = cofactor(m) / det(m).
#[inline(always)]
pub fn cofactor<T: Real, const D: usize>(m: &[[T; D]; D]) -> [[T; D]; D] {
    let mut c = *m;
    match D {
        1 => c[0][0] = m[0][0].constant(1.0),
        2 => {
            c[0][0] = m[1][1];
            c[0][1] = -m[1][0];
            c[1][0] = -m[0][1];
            c[1][1] = m[0][0];
        }
        3 => {
            for i in 0..3 {
                let (p, q) = ((i + 1) % 3, (i + 2) % 3);
                for j in 0..3 {
                    let (r, s) = ((j + 1) % 3, (j + 2) % 3);
                    c[i][j] = m[p][r] * m[q][s] - m[p][s] * m[q][r];
                }
            }
        }
        _ => unreachable!("space has one, two or three dimensions"),
    }
    c
}

/// det(m), from its first row and that row's cofactors.
#[inline(always)]
pub fn determinant<T: Real, const D: usize>(m: &[[T; D]; D], cofactor: &[[T; D]; D]) -> T {
    dot(&m[0], &cofactor[0])
}

/// det(m).
#[inline(always)]
pub fn det<T: Real, const D: usize>(m: &[[T; D]; D]) -> T {
    determinant(m, &cofactor(m))
}

/// q^2 / (q + width) with q = max(x, 0): zero for x <= 0, about x - width for large x, and continuously differentiable.
#[inline(always)]
pub fn smooth_ramp<T: Real>(x: T, width: T) -> T {
    let q = x.max(x.zero());
    q * q / (q + width)
}

/// The sum of the diagonal.
#[inline(always)]
pub fn trace<T: Real, const D: usize>(m: &[[T; D]; D]) -> T {
    let mut sum = m[0][0];
    for k in 1..D {
        sum += m[k][k];
    }
    sum
}
