//! Operations of the cell and facet kernels at one point.

use crate::conservation_law::ConservationLaw;
use crate::fields::Fields;
use crate::mode::Mode;
use crate::tables::Tables;
use std::marker::PhantomData;
use tensor::pulp::Simd;
use tensor::{LaneNumber, Lanes, Over, Pack, Real};

/// The types of a run of the kernels: law, derivative, instruction set, and the numbers that follow from them.
pub(crate) trait KernelTypes<const D: usize, const M: usize> {
    type Law: ConservationLaw<D, M>;
    type Mode: Mode;
    type Simd: Simd;
    /// Numbers of the geometry.
    type Geometry: LaneNumber<Self::Simd>;
    /// Numbers of the state.
    type State: LaneNumber<Self::Simd> + Over<Self::Geometry>;
    /// See [`Mode::GEOMETRY_BLOCKS`].
    const GEOMETRY_BLOCKS: usize = <Self::Mode as Mode>::GEOMETRY_BLOCKS;
    /// See [`Mode::STATE_BLOCKS`].
    const STATE_BLOCKS: usize = <Self::Mode as Mode>::STATE_BLOCKS;
}

/// [`KernelTypes`] of law, mode and instruction set.
pub(crate) struct Types<L, K, S>(PhantomData<(L, K, S)>);

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd> KernelTypes<D, M> for Types<L, K, S> {
    type Law = L;
    type Mode = K;
    type Simd = S;
    type Geometry = K::Geometry<S>;
    type State = K::State<S>;
}

/// The boundary conditions of the law.
pub(crate) type Condition<const D: usize, const M: usize, T> =
    <<T as KernelTypes<D, M>>::Law as ConservationLaw<D, M>>::Boundary;

/// A run of the kernels. Its methods are the steps of the kernels.
///
/// It holds two references only, so that it is passed in registers.
pub(crate) struct Kernel<'a, const D: usize, const M: usize, T: KernelTypes<D, M>> {
    pub(crate) simd: T::Simd,
    pub(crate) law: &'a T::Law,
    pub(crate) tables: &'a Tables<D>,
    pub(crate) mode: PhantomData<T::Mode>,
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> Clone for Kernel<'_, D, M, T> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> Copy for Kernel<'_, D, M, T> {}

impl<'a, const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd> Kernel<'a, D, M, Types<L, K, S>> {
    #[inline(always)]
    pub(crate) fn new(simd: S, law: &'a L, tables: &'a Tables<D>, mode: PhantomData<K>) -> Self {
        Kernel { simd, law, tables, mode }
    }
}

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

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> Kernel<'_, D, M, T> {
    /// The map at a point, from `geometry[b][number][p]`: A `[direction][d]` and J begin at the given `numbers`.
    #[inline(always)]
    pub(crate) fn metric(
        self,
        geometry: &[Pack],
        fields: Fields,
        [area, det]: [usize; 2],
        at: PointIndex,
    ) -> Metric<T::Geometry, D> {
        let rows = fields.from(area).rows::<D, T::Geometry, T::Simd>(self.simd, geometry, at.p, at.part);
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
    pub(crate) fn state(self, u: &[Pack], at: PointIndex) -> [T::State; M] {
        load(self.simd, u, at)
    }

    /// C components of the geometry, or of data that vary with the geometry alone: a velocity, a position, a source; `x[b][c][p]`.
    #[inline(always)]
    pub(crate) fn geometry<const C: usize>(self, x: &[Pack], at: PointIndex) -> [T::Geometry; C] {
        load(self.simd, x, at)
    }

    /// grad_xi u, `gradient[b][direction][m][p]`.
    #[inline(always)]
    pub(crate) fn reference_gradient(self, gradient: &[Pack], at: PointIndex) -> [[T::State; M]; D] {
        let (simd, block) = (self.simd, D * M * at.points);
        let mut reference = [[T::State::load(simd, gradient, block, at.p, at.part); M]; D];
        for j in 0..D {
            for m in 0..M {
                reference[j][m] = T::State::load(simd, gradient, block, at.index(j * M + m), at.part);
            }
        }
        reference
    }

    /// grad_x u = J^{-T} grad_xi u = cof . grad_xi u / det; `gradient[b][direction][m][p]`.
    #[inline(always)]
    pub(crate) fn physical_gradient(
        self,
        gradient: &[Pack],
        at: PointIndex,
        metric: &Metric<T::Geometry, D>,
    ) -> [[T::State; M]; D] {
        let (reference, inverse) = (self.reference_gradient(gradient, at), metric.det.recip());
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

    /// sum += term
    #[inline(always)]
    pub(crate) fn add_to(self, term: Lanes<T::Simd>, sum: &mut Pack, part: usize) {
        (Lanes::read(self.simd, sum, part) + term).write(sum, part);
    }

    /// Marks the lanes where `admissibility` is not positive, or NaN.
    #[inline(always)]
    pub(crate) fn flag(self, admissibility: T::State, violated: &mut Pack, part: usize) {
        let (so_far, one) = (Lanes::read(self.simd, violated, part), Lanes::<T::Simd>::splat(self.simd, 1.0));
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
