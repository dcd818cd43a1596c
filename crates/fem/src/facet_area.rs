//! The area vectors of facets in collocated rules, (metric) and (grid flux) of [`crate::collocation`] on a face.
//!
//! The normal component of A on a face follows from the positions on that face. So both sides have the same one, and it is that of the
//! volume terms.

use crate::collocation::Collocation;
use crate::conservation_law::ConservationLaw;
use crate::instants::TimePointIndex;
use crate::mode::Mode;
use crate::point::Kernel;
use crate::scratch::{FaceNodes, FacetScratch};
use crate::tensor_product::{AtPoints, Lattice, evaluate};
use tensor::pulp::Simd;
use tensor::{LaneNumber, Lanes, Pack, Real, cofactor, dot};

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd> Kernel<'_, D, M, L, K, S> {
    /// The area vectors at the points, and the velocity there: its normal component becomes that of the grid flux.
    #[inline(always)]
    pub(crate) fn area_to_points(self, of: TimePointIndex, scratch: &mut FacetScratch) {
        let Some(collocation) = &self.tables.collocation else { return };
        self.mesh_on_face(collocation, of, scratch);
        if D == 2 {
            self.turned_tangents(&mut scratch.on_nodes);
        } else {
            self.curls_on_face(collocation, scratch);
        }
        self.grid_flux_on_face(&mut scratch.on_nodes);
        let (lattice, len) = (Lattice::whole(&self.tables.flow, D - 1, D + 1), self.face_nodes());
        let FacetScratch { on_nodes: FaceNodes { area, area_at_points, .. }, scratch: room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let start = b * (D + 1) * len;
            evaluate(self.simd, lattice, &area[start..], AtPoints::Values(&mut area_at_points[start..]), room);
        }
        self.normal_velocities(scratch);
    }

    #[inline(always)]
    fn face_nodes(self) -> usize {
        self.tables.orders.flow.pow(D as u32 - 1)
    }

    /// Position, tangents and velocity at the nodes.
    #[inline(always)]
    fn mesh_on_face(self, collocation: &Collocation, of: TimePointIndex, scratch: &mut FacetScratch) {
        let (lattice, len) = (Lattice::whole(&collocation.mesh, D - 1, D), self.face_nodes());
        let FacetScratch { sides: [minus, _], velocity_at, on_nodes, scratch: room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let to = AtPoints::Both(&mut on_nodes.x[b * D * len..], &mut on_nodes.tangents[b * D * D * len..]);
            evaluate(self.simd, lattice, of.block(&minus.position_at, b, lattice.len()), to, room);
            let to = AtPoints::Values(&mut on_nodes.v[b * D * len..]);
            evaluate(self.simd, lattice, of.block(velocity_at, b, lattice.len()), to, room);
        }
    }

    /// The area vector in 2-D: the last column of the cofactors, which depends on the tangent alone.
    #[inline(always)]
    fn turned_tangents(self, on_nodes: &mut FaceNodes) {
        let len = self.face_nodes();
        for i in 0..len {
            for part in 0..Lanes::<S>::PARTS {
                let tangent: [K::Geometry<S>; D] = self.on_node(&on_nodes.tangents, [D * D, 0], i, part);
                let mut dx = [tangent; D];
                for d in 0..D {
                    dx[d] = [tangent[d]; D];
                }
                let cof = cofactor(&dx);
                for d in 0..D {
                    cof[d][D - 1].store(&mut on_nodes.area, (D + 1) * len, d * len + i, part);
                }
            }
        }
    }

    /// The area vector in 3-D: the component of the curl along the axis that leaves the face.
    #[inline(always)]
    fn curls_on_face(self, collocation: &Collocation, scratch: &mut FacetScratch) {
        let (len, lattice) = (self.face_nodes(), Lattice::whole(&self.tables.flow, D - 1, D));
        let FacetScratch { on_nodes, scratch: room, .. } = scratch;
        let FaceNodes { x, tangents, curled, area, .. } = on_nodes;
        for i in 0..len {
            for part in 0..Lanes::<S>::PARTS {
                let x: [K::Geometry<S>; D] = self.on_node(x, [D, 0], i, part);
                for k in 0..D - 1 {
                    let slope: [K::Geometry<S>; D] = self.on_node(tangents, [D * D, k * D], i, part);
                    for n in 0..D {
                        let (m, l) = ((n + 1) % D, (n + 2) % D);
                        let f = x[l] * slope[m] - x[m] * slope[l];
                        f.store(curled, D * D * len, (k * D + n) * len + i, part);
                    }
                }
            }
        }
        let [minus, plus] = &collocation.half_derivatives;
        for b in 0..K::GEOMETRY_BLOCKS {
            let along = |k: usize| (b * D * D + k * D) * len;
            let area = &mut area[b * (D + 1) * len..];
            room.contract(self.simd, lattice.along(0, minus), &curled[along(1)..], area, false);
            room.contract(self.simd, lattice.along(1, plus), &curled[along(0)..], area, true);
        }
    }

    /// The normal velocity times area at the nodes.
    #[inline(always)]
    fn grid_flux_on_face(self, on_nodes: &mut FaceNodes) {
        let len = self.face_nodes();
        for i in 0..len {
            for part in 0..Lanes::<S>::PARTS {
                let area: [K::Geometry<S>; D] = self.on_node(&on_nodes.area, [D + 1, 0], i, part);
                let v = self.on_node(&on_nodes.v, [D, 0], i, part);
                dot(&area, &v).store(&mut on_nodes.area, (D + 1) * len, D * len + i, part);
            }
        }
    }

    /// v + ( g - S . v ) S / |S|^2 at the points, with the area vector S.
    #[inline(always)]
    fn normal_velocities(self, scratch: &mut FacetScratch) {
        let (points, FacetScratch { on_nodes, area: out, v, .. }) = (self.tables.facet_points(), scratch);
        for p in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let area: [K::Geometry<S>; D] = self.on_node(&on_nodes.area_at_points, [D + 1, 0], p, part);
                let [flux] = self.on_node(&on_nodes.area_at_points, [D + 1, D], p, part);
                let velocity: [K::Geometry<S>; D] = self.on_node(v, [D, 0], p, part);
                let missing = (flux - dot(&area, &velocity)) * dot(&area, &area).recip();
                for d in 0..D {
                    area[d].store(out, D * points, d * points + p, part);
                    (velocity[d] + area[d] * missing).store(v, D * points, d * points + p, part);
                }
            }
        }
    }

    /// C fields from number `first` on at a node or point, of blocks of `fields`, `[b][field][i]`.
    #[inline(always)]
    fn on_node<const C: usize>(
        self,
        array: &[Pack],
        [fields, first]: [usize; 2],
        i: usize,
        part: usize,
    ) -> [K::Geometry<S>; C] {
        let len = self.face_nodes();
        let mut values = [K::Geometry::<S>::load(self.simd, array, fields * len, first * len + i, part); C];
        for c in 1..C {
            values[c] = K::Geometry::<S>::load(self.simd, array, fields * len, (first + c) * len + i, part);
        }
        values
    }
}
