//! Operations of the cell and facet kernels at one point.

use crate::conservation_law::ConservationLaw;
use crate::fields::Fields;
use crate::mode::Mode;
use crate::tables::Tables;
use std::marker::PhantomData;
use tensor::pulp::Simd;
use tensor::{LaneNumber, Lanes, Over, Pack, Real};

/// A run of the kernels: the law, and the number types of this run. What kernels do are its methods.
///
/// Two references and nothing else: it is passed in registers.
pub(crate) struct Kernel<'a, const D: usize, const M: usize, L, K, S> {
    pub(crate) simd: S,
    pub(crate) law: &'a L,
    pub(crate) tables: &'a Tables<D>,
    pub(crate) mode: PhantomData<K>,
}

impl<const D: usize, const M: usize, L, K, S: Copy> Clone for Kernel<'_, D, M, L, K, S> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<const D: usize, const M: usize, L, K, S: Copy> Copy for Kernel<'_, D, M, L, K, S> {}

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

/// The map from the reference cell at a point.
#[derive(Clone, Copy)]
pub(crate) struct Metric<G, const D: usize> {
    /// Cofactors of dx/dxi.
    pub(crate) cof: [[G; D]; D],
    /// Its determinant.
    pub(crate) det: G,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd> Kernel<'_, D, M, L, K, S> {
    /// The map at a point, from `geometry[b][number][p]`: A `[direction][d]` and J begin at the given `numbers`.
    #[inline(always)]
    pub(crate) fn metric(
        self,
        geometry: &[Pack],
        fields: Fields,
        [area, det]: [usize; 2],
        at: PointIndex,
    ) -> Metric<K::Geometry<S>, D> {
        let rows = fields.from(area).rows::<D, K::Geometry<S>, S>(self.simd, geometry, at.p, at.part);
        let mut cof = rows;
        for j in 0..D {
            for d in 0..D {
                cof[d][j] = rows[j][d];
            }
        }
        Metric { cof, det: fields.from(det).one(self.simd, geometry, at.p, at.part) }
    }

    /// A state; `u[b][m][p]`.
    #[inline(always)]
    pub(crate) fn state(self, u: &[Pack], at: PointIndex) -> [K::State<S>; M] {
        load(self.simd, u, at)
    }

    /// C components of the geometry, or of data that vary with the geometry alone: a velocity, a position, a source; `x[b][c][p]`.
    #[inline(always)]
    pub(crate) fn geometry<const C: usize>(self, x: &[Pack], at: PointIndex) -> [K::Geometry<S>; C] {
        load(self.simd, x, at)
    }

    /// grad_x u = J^{-T} grad_xi u = cof . grad_xi u / det; `gradient[b][direction][m][p]`.
    #[inline(always)]
    pub(crate) fn physical_gradient(
        self,
        gradient: &[Pack],
        at: PointIndex,
        metric: &Metric<K::Geometry<S>, D>,
    ) -> [[K::State<S>; M]; D] {
        let (simd, block, inverse) = (self.simd, D * M * at.points, metric.det.recip());
        let mut reference = [[K::State::<S>::load(simd, gradient, block, at.p, at.part); M]; D];
        for j in 0..D {
            for m in 0..M {
                reference[j][m] = K::State::<S>::load(simd, gradient, block, at.index(j * M + m), at.part);
            }
        }
        let mut physical = reference;
        for k in 0..D {
            let mut row = metric.cof[k];
            for j in 0..D {
                row[j] = metric.cof[k][j] * inverse;
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

    /// Marks the lanes where `admissibility` is not positive, or NaN.
    #[inline(always)]
    pub(crate) fn flag(self, admissibility: K::State<S>, violated: &mut Pack, part: usize) {
        let (so_far, one) = (Lanes::read(self.simd, violated, part), Lanes::<S>::splat(self.simd, 1.0));
        admissibility.primal().select_ge(one * f64::MIN_POSITIVE, so_far, one).write(violated, part);
    }
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

/// The flux f in reference direction j, component m, for the test grad_x psi . f J: sum_k cof_kj f_k.
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
