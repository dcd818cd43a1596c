//! Traces at the points of a batch of facets: steps 1 and 2 of its kernel.

use crate::instants::{InTime, TimePointIndex};
use crate::mode::Mode;
use crate::point::{PointIndex, load, metric};
use crate::scratch::{FacetScratch, SideScratch};
use crate::tables::Tables;
use crate::tensor_product::{EvaluationFlags, Lattice, Scratch, evaluate};
use tensor::pulp::Simd;
use tensor::{LaneNumber, Lanes, Real, norm};

/// Step 1: traces at all times, from those at time nodes and slots.
#[inline(always)]
pub(crate) fn to_instants<const D: usize, const M: usize, K: Mode, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    InTime { values, velocities, positions }: InTime,
    viscous: bool,
    used: usize,
    scratch: &mut FacetScratch,
) {
    let (b, g, kinds) = (K::STATE_BLOCKS, K::GEOMETRY_BLOCKS, if viscous { 2 } else { 1 });
    let len = M * tables.orders.flow.pow(D as u32 - 1);
    let mesh_len = D * tables.orders.mesh.pow(D as u32 - 1);
    let FacetScratch { sides, velocity_at, scratch: room, .. } = scratch;
    room.contract(simd, velocities, g, mesh_len, &sides[0].mesh, velocity_at, false);
    for (number, SideScratch { state, state_at, mesh, position_at, .. }) in sides[..used].iter_mut().enumerate() {
        room.contract(simd, values, kinds * b, len, state, state_at, false);
        // Position and tangents come from minus; of the plus side only derivatives along its leaving axis are stored.
        let start = |slots: usize| number * g * slots * mesh_len;
        let (mesh, position_at) = (&mesh[start(positions.cols())..], &mut position_at[start(positions.rows())..]);
        room.contract(simd, positions, kinds.saturating_sub(number) * g, mesh_len, mesh, position_at, false);
    }
}

/// Step 2: state and gradients of one side at the points.
#[inline(always)]
pub(crate) fn state_to_points<const D: usize, const M: usize, K: Mode, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    of: TimePointIndex,
    viscous: bool,
    side: &mut SideScratch,
    room: &mut Scratch,
) {
    let (lattice, points) = (Lattice::whole(&tables.flow, D - 1), tables.facet_points());
    let SideScratch { state_at, u, gradient, .. } = side;
    let (parts, len) = (if viscous { EvaluationFlags::Both } else { EvaluationFlags::Values }, M * lattice.nodes());
    for b in 0..K::STATE_BLOCKS {
        let (u, gradient) = (&mut u[b * M * points..], &mut gradient[b * D * M * points..]);
        evaluate(simd, lattice, M, parts, of.block(state_at, b, len), u, gradient, room);
        if viscous {
            let (kind, leaving) = (of.block(state_at, K::STATE_BLOCKS + b, len), &mut gradient[(D - 1) * M * points..]);
            evaluate(simd, lattice, M, EvaluationFlags::Values, kind, leaving, &mut [], room);
        }
    }
}

/// Step 2 as well: mesh velocity at the points, and the Jacobian matrices of the `used` sides. Velocity and tangents belong to the facet
/// and are the same from both sides. Only viscous terms read the derivative along the leaving axis.
#[inline(always)]
pub(crate) fn geometry_to_points<const D: usize, const M: usize, K: Mode, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    of: TimePointIndex,
    viscous: bool,
    used: usize,
    scratch: &mut FacetScratch,
) {
    let (lattice, points) = (Lattice::whole(&tables.mesh, D - 1), tables.facet_points());
    let (len, tangents, matrices) = (D * lattice.nodes(), (D - 1) * D * points, D * D * points);
    let FacetScratch { sides: [minus, plus], velocity_at, v, scratch: room, .. } = scratch;
    for b in 0..K::GEOMETRY_BLOCKS {
        let (velocity, v) = (of.block(velocity_at, b, len), &mut v[b * D * points..]);
        evaluate(simd, lattice, D, EvaluationFlags::Values, velocity, v, &mut [], room);
        let (position, jacobian) = (of.block(&minus.position_at, b, len), &mut minus.jacobian[b * matrices..]);
        evaluate(simd, lattice, D, EvaluationFlags::Gradients, position, &mut [], jacobian, room);
        if viscous {
            plus.jacobian[b * matrices..][..tangents].copy_from_slice(&jacobian[..tangents]);
        }
    }
    if viscous {
        for SideScratch { position_at, jacobian, .. } in [minus, plus].into_iter().take(used) {
            for b in 0..K::GEOMETRY_BLOCKS {
                let kind = of.block(position_at, K::GEOMETRY_BLOCKS + b, len);
                let leaving = &mut jacobian[b * matrices + tangents..];
                evaluate(simd, lattice, D, EvaluationFlags::Values, kind, leaving, &mut [], room);
            }
        }
    }
}

/// The geometry of a facet point, for one side.
pub(crate) struct FacetPoint<G, const D: usize> {
    /// Cofactors of the side's Jacobian matrix, columns ordered tangential first.
    pub(crate) cof: [[G; D]; D],
    /// Its determinant, of either sign: the facet's frame need not be right-handed.
    pub(crate) det: G,
    /// Area per reference area, |S|.
    pub(crate) area: G,
    /// Unit normal, from minus to plus.
    pub(crate) n: [G; D],
    /// Mesh velocity.
    pub(crate) v: [G; D],
}

#[inline(always)]
pub(crate) fn facet_point<const D: usize, K: Mode, S: Simd>(
    simd: S,
    scratch: &FacetScratch,
    at: PointIndex,
) -> FacetPoint<K::Geometry<S>, D> {
    let (cof, det) = metric::<D, K::Geometry<S>, S>(simd, &scratch.sides[0].jacobian, at);
    let sign = Lanes::read(simd, &scratch.normal_sign, at.part);
    let v = load::<D, K::Geometry<S>, S>(simd, &scratch.v, at);
    let mut n = v;
    for d in 0..D {
        n[d] = cof[d][D - 1].times(sign);
    }
    let area = norm(&n);
    let inverse = area.recip();
    for d in 0..D {
        n[d] = n[d] * inverse;
    }
    FacetPoint { cof, det, area, n, v }
}
