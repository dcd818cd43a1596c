//! Traces at the points of a batch of facets: steps 1 and 2 of its kernel.

use crate::conservation_law::ConservationLaw;
use crate::instants::{InTime, TimePointIndex};
use crate::mode::Mode;
use crate::point::{Kernel, Metric, PointIndex};
use crate::scratch::{FacetScratch, SideScratch};
use crate::tensor_product::{AlongAxis, AtPoints, Lattice, Scratch, evaluate};
use tensor::pulp::Simd;
use tensor::{LaneNumber, Lanes, Real, norm};

/// The geometry of a facet point, for one side.
pub(crate) struct FacetPoint<G, const D: usize> {
    /// The side's map, columns ordered tangential first. Its determinant has either sign: the facet's frame need not be right-handed.
    pub(crate) metric: Metric<G, D>,
    /// Area per reference area, |S|.
    pub(crate) area: G,
    /// Unit normal, from minus to plus.
    pub(crate) n: [G; D],
    /// Mesh velocity.
    pub(crate) v: [G; D],
    /// Quadrature weight.
    pub(crate) weight: f64,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd> Kernel<'_, D, M, L, K, S> {
    /// Step 1: traces of the `used` sides at all times, from those at time nodes and slots.
    #[inline(always)]
    pub(crate) fn traces_to_instants(self, in_time: InTime, used: usize, scratch: &mut FacetScratch) {
        let (simd, orders) = (self.simd, self.tables.orders);
        let (b, g, kinds) = (K::STATE_BLOCKS, K::GEOMETRY_BLOCKS, if self.law.is_viscous() { 2 } else { 1 });
        let (len, mesh_len) = (M * orders.flow.pow(D as u32 - 1), D * orders.mesh.pow(D as u32 - 1));
        let InTime { values, velocities, positions } = in_time;
        let FacetScratch { sides, velocity_at, scratch: room, .. } = scratch;
        let velocity = AlongAxis { matrix: velocities, outer: g, inner: mesh_len };
        room.contract(simd, velocity, &sides[0].mesh, velocity_at, false);
        for (number, SideScratch { state, state_at, mesh, position_at, .. }) in sides[..used].iter_mut().enumerate() {
            room.contract(simd, AlongAxis { matrix: values, outer: kinds * b, inner: len }, state, state_at, false);
            // Position and tangents come from minus; of the plus side only derivatives along its leaving axis are stored.
            let start = |slots: usize| number * g * slots * mesh_len;
            let (mesh, position_at) = (&mesh[start(positions.cols())..], &mut position_at[start(positions.rows())..]);
            let position = AlongAxis { matrix: positions, outer: kinds.saturating_sub(number) * g, inner: mesh_len };
            room.contract(simd, position, mesh, position_at, false);
        }
    }

    /// Step 2: state, gradients and geometry at the points, of the `used` sides.
    #[inline(always)]
    pub(crate) fn traces_to_points(self, of: TimePointIndex, used: usize, scratch: &mut FacetScratch) {
        for side in &mut scratch.sides[..used] {
            self.state_to_points(of, side, &mut scratch.scratch);
        }
        self.geometry_to_points(of, used, scratch);
        self.area_to_points(of, scratch);
    }

    /// State and gradients of one side at the points.
    #[inline(always)]
    fn state_to_points(self, of: TimePointIndex, side: &mut SideScratch, room: &mut Scratch) {
        let (lattice, points) = (Lattice::whole(&self.tables.flow, D - 1, M), self.tables.facet_points());
        let SideScratch { state_at, u, gradient, .. } = side;
        let (viscous, len) = (self.law.is_viscous(), lattice.len());
        for b in 0..K::STATE_BLOCKS {
            let (u, gradient) = (&mut u[b * M * points..], &mut gradient[b * D * M * points..]);
            let state = of.block(state_at, b, len);
            evaluate(self.simd, lattice, state, AtPoints::new(u, &mut gradient[..], viscous), room);
            if viscous {
                let kind = of.block(state_at, K::STATE_BLOCKS + b, len);
                let leaving = AtPoints::Values(&mut gradient[(D - 1) * M * points..]);
                evaluate(self.simd, lattice, kind, leaving, room);
            }
        }
    }

    /// Mesh velocity at the points, and the Jacobian matrices of the `used` sides. Velocity and tangents are those of the facet, the same
    /// from both sides; the derivative along the axis that leaves is read by viscous terms only.
    #[inline(always)]
    fn geometry_to_points(self, of: TimePointIndex, used: usize, scratch: &mut FacetScratch) {
        let (lattice, points) = (Lattice::whole(&self.tables.mesh, D - 1, D), self.tables.facet_points());
        let (simd, viscous, len) = (self.simd, self.law.is_viscous(), lattice.len());
        let (tangents, matrices) = ((D - 1) * D * points, D * D * points);
        let FacetScratch { sides: [minus, plus], velocity_at, v, scratch: room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let (velocity, v) = (of.block(velocity_at, b, len), AtPoints::Values(&mut v[b * D * points..]));
            evaluate(simd, lattice, velocity, v, room);
            let (position, jacobian) = (of.block(&minus.position_at, b, len), &mut minus.jacobian[b * matrices..]);
            evaluate(simd, lattice, position, AtPoints::Gradients(&mut jacobian[..]), room);
            if viscous {
                plus.jacobian[b * matrices..][..tangents].copy_from_slice(&jacobian[..tangents]);
            }
        }
        if viscous {
            for SideScratch { position_at, jacobian, .. } in [minus, plus].into_iter().take(used) {
                for b in 0..K::GEOMETRY_BLOCKS {
                    let kind = of.block(position_at, K::GEOMETRY_BLOCKS + b, len);
                    let leaving = AtPoints::Values(&mut jacobian[b * matrices + tangents..]);
                    evaluate(simd, lattice, kind, leaving, room);
                }
            }
        }
    }

    /// The geometry of a facet at a point, from the minus side; `weight` is that of the facet.
    #[inline(always)]
    pub(crate) fn facet_point(
        self,
        scratch: &FacetScratch,
        at: PointIndex,
        weight: f64,
    ) -> FacetPoint<K::Geometry<S>, D> {
        let metric = self.metric(&scratch.sides[0].jacobian, at);
        let sign = Lanes::read(self.simd, &scratch.normal_sign, at.part);
        let v = self.geometry(&scratch.v, at);
        let mut n = v;
        if self.tables.collocation.is_some() {
            n = self.geometry(&scratch.area, at);
        } else {
            for d in 0..D {
                n[d] = metric.cof[d][D - 1];
            }
        }
        for d in 0..D {
            n[d] = n[d].times(sign);
        }
        let area = norm(&n);
        let inverse = area.recip();
        for d in 0..D {
            n[d] = n[d] * inverse;
        }
        FacetPoint { metric, area, n, v, weight: weight * self.tables.facet_weights[at.p] }
    }
}
