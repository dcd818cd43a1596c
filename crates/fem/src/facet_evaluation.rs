//! State and geometry at the points of a batch of facets: steps 1 and 2 of its kernel.

use crate::conservation_law::ConservationLaw;
use crate::facet_geometry::{FacetGeometry, map_len};
use crate::point::{Kernel, KernelTypes, Metric, PointIndex};
use crate::scratch::{FacetScratch, SideScratch};
use crate::tensor_product::{AtPoints, Lattice, Scratch, evaluate};
use crate::time_points::TimePointIndex;
use basis::{AlongAxis, Matrix};
use std::marker::PhantomData;
use tensor::{Pack, Real, norm};

/// The geometry of a facet at a point.
pub(crate) struct FacetPoint<G, const D: usize> {
    /// Area per reference area, |S|.
    pub(crate) area: G,
    /// Unit normal, from minus to plus.
    pub(crate) n: [G; D],
    /// Mesh velocity.
    pub(crate) v: [G; D],
    /// Quadrature weight.
    pub(crate) weight: f64,
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> Kernel<'_, D, M, T> {
    /// The steps of the geometry, for the same numbers.
    #[inline(always)]
    pub(crate) fn facet_geometry(&self) -> FacetGeometry<'_, D, T::Mode, T::Simd> {
        FacetGeometry { simd: self.simd, tables: self.tables, viscous: self.law.is_viscous(), mode: PhantomData }
    }

    /// The geometry at one of the times that is not known, `geometry[b][number][p]` of the scratch.
    #[inline(always)]
    pub(crate) fn facet_geometry_to_points(self, of: TimePointIndex, used: usize, scratch: &mut FacetScratch) {
        let mut geometry = std::mem::take(&mut scratch.geometry);
        self.facet_geometry().at_points(of, used, scratch, &mut geometry);
        scratch.geometry = geometry;
    }

    /// Step 1: traces of the state on the `used` sides at all times, from those at the time nodes.
    #[inline(always)]
    pub(crate) fn states_to_time_points(self, values: &Matrix, used: usize, scratch: &mut FacetScratch) {
        let len = M * self.tables.orders.flow.pow(D as u32 - 1);
        let outer = T::STATE_BLOCKS * if self.law.is_viscous() { 2 } else { 1 };
        let FacetScratch { sides, scratch: room, .. } = scratch;
        for SideScratch { state, state_at, .. } in &mut sides[..used] {
            room.contract(self.simd, AlongAxis { matrix: values, outer, inner: len }, state, state_at, false);
        }
    }

    /// Step 2: state and gradients of one side at the points.
    #[inline(always)]
    pub(crate) fn trace_to_points(self, of: TimePointIndex, side: &mut SideScratch, room: &mut Scratch) {
        let (lattice, points) = (Lattice::whole(&self.tables.flow, D - 1, M), self.tables.facet_points());
        let SideScratch { state_at, u, gradient, .. } = side;
        let (viscous, len) = (self.law.is_viscous(), lattice.len());
        for b in 0..T::STATE_BLOCKS {
            let (u, gradient) = (&mut u[b * M * points..], &mut gradient[b * D * M * points..]);
            let state = of.block(state_at, b, len);
            evaluate(self.simd, lattice, state, AtPoints::new(u, &mut gradient[..], viscous), room);
            if viscous {
                let kind = of.block(state_at, T::STATE_BLOCKS + b, len);
                let leaving = AtPoints::Values(&mut gradient[(D - 1) * M * points..]);
                evaluate(self.simd, lattice, kind, leaving, room);
            }
        }
    }

    /// Area, normal and velocity at a point, of `geometry[b][number][p]`; `weight` is that of the facet.
    #[inline(always)]
    pub(crate) fn facet_point(self, geometry: &[Pack], at: PointIndex, weight: f64) -> FacetPoint<T::Geometry, D> {
        let fields = self.facet_geometry().fields();
        let mut n: [T::Geometry; D] = fields.vector(self.simd, geometry, at.p, at.part);
        let v = fields.from(D).vector(self.simd, geometry, at.p, at.part);
        let area = norm(&n);
        let inverse = area.recip();
        for d in 0..D {
            n[d] = n[d] * inverse;
        }
        FacetPoint { area, n, v, weight: weight * self.tables.facet_weights[at.p] }
    }

    /// The map of the cell on a `side`, columns ordered tangential first. Its determinant has either sign: the facet's frame need not be
    /// right-handed. Viscous laws only.
    #[inline(always)]
    pub(crate) fn map_of_side(self, geometry: &[Pack], side: usize, at: PointIndex) -> Metric<T::Geometry, D> {
        let first = 2 * D + side * map_len(D);
        self.metric(geometry, self.facet_geometry().fields(), [first, first + D * D], at)
    }
}
