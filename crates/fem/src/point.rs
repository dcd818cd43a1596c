//! Operations of the cell and facet kernels at one point.

use crate::mode::Mode;
use tensor::pulp::Simd;
use tensor::{LaneNumber, Lanes, Over, Pack, Real, cofactor, determinant};

/// The place of a point function's data: point `p` of `points`, and the part of its packs.
#[derive(Clone, Copy)]
pub(crate) struct PointIndex {
    pub(crate) points: usize,
    pub(crate) p: usize,
    pub(crate) part: usize,
}

impl PointIndex {
    /// Component `c` at this point, in an array `[c][p]`.
    #[inline(always)]
    pub(crate) fn index(&self, c: usize) -> usize {
        c * self.points + self.p
    }
}

/// Cofactors and determinant of dx/dxi; `jacobian[b][direction][d][p]`.
#[inline(always)]
pub(crate) fn metric<const D: usize, G: LaneNumber<S>, S: Simd>(
    simd: S,
    jacobian: &[Pack],
    at: PointIndex,
) -> ([[G; D]; D], G) {
    let block = D * D * at.points;
    let first = G::load(simd, jacobian, block, at.p, at.part);
    let mut dx = [[first; D]; D];
    for j in 0..D {
        for i in 0..D {
            dx[i][j] = G::load(simd, jacobian, block, at.index(j * D + i), at.part);
        }
    }
    let cof = cofactor(&dx);
    (cof, determinant(&dx, &cof))
}

/// The C components of a state, a velocity, ... ; `u[b][c][p]`.
#[inline(always)]
pub(crate) fn load<const C: usize, T: LaneNumber<S>, S: Simd>(simd: S, u: &[Pack], at: PointIndex) -> [T; C] {
    let mut vector = [T::load(simd, u, C * at.points, at.p, at.part); C];
    for c in 1..C {
        vector[c] = T::load(simd, u, C * at.points, at.index(c), at.part);
    }
    vector
}

/// grad_x u = J^{-T} grad_xi u = cof . grad_xi u / det; `gradient[b][direction][m][p]`.
#[inline(always)]
pub(crate) fn physical_gradient<const D: usize, const M: usize, K: Mode, S: Simd>(
    simd: S,
    gradient: &[Pack],
    at: PointIndex,
    cof: &[[K::Geometry<S>; D]; D],
    det: K::Geometry<S>,
) -> [[K::State<S>; M]; D] {
    let (block, inverse) = (D * M * at.points, det.recip());
    let mut reference = [[K::State::<S>::load(simd, gradient, block, at.p, at.part); M]; D];
    for j in 0..D {
        for m in 0..M {
            reference[j][m] = K::State::<S>::load(simd, gradient, block, at.index(j * M + m), at.part);
        }
    }
    let mut physical = reference;
    for k in 0..D {
        let mut row = cof[k];
        for j in 0..D {
            row[j] = cof[k][j] * inverse;
        }
        for m in 0..M {
            let mut sum = reference[0][m].scale(row[0]);
            for j in 1..D {
                sum = reference[j][m].scale_add(row[j], sum);
            }
            physical[k][m] = sum;
        }
    }
    physical
}

/// The flux f in reference direction j, component m, for the test grad_x w . f J: sum_k cof_kj f_k.
#[inline(always)]
pub(crate) fn along_reference<const D: usize, const M: usize, T: Over<G>, G: Real>(
    f: &[[T; M]; D],
    cof: &[[G; D]; D],
    j: usize,
    m: usize,
) -> T {
    let mut sum = f[0][m].scale(cof[0][j]);
    for k in 1..D {
        sum = f[k][m].scale_add(cof[k][j], sum);
    }
    sum
}

/// Marks the lanes where `admissibility` is not positive, or NaN.
#[inline(always)]
pub(crate) fn flag<T: LaneNumber<S>, S: Simd>(
    simd: S,
    admissibility: T,
    one: Lanes<S>,
    violated: &mut Pack,
    part: usize,
) {
    let so_far = Lanes::read(simd, violated, part);
    admissibility.primal().select_ge(one * f64::MIN_POSITIVE, so_far, one).write(violated, part);
}
