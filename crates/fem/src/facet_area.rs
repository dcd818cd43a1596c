//! The area vectors of facets in collocated rules, (metric) and (grid flux) of [`crate::collocation`] on a face.
//!
//! The normal component of A on a face follows from the positions on that face. So both sides have the same one, and it is that of the
//! volume terms.

use crate::collocation::{self, Collocation};
use crate::facet_geometry::FacetGeometry;
use crate::fields::Fields;
use crate::mode::Mode;
use crate::scratch::{FaceNodes, FacetScratch};
use crate::tensor_product::{AtPoints, Lattice, evaluate};
use crate::time_points::TimePointIndex;
use tensor::pulp::Simd;
use tensor::{LaneNumber, Lanes, Pack, Real, cofactor, dot};

impl<const D: usize, K: Mode, S: Simd> FacetGeometry<'_, D, K, S> {
    /// Replaces the area vectors at the points, and the normal component of the velocity there by that of the grid flux.
    #[inline(always)]
    pub(crate) fn area_of_grid_flux(&self, of: TimePointIndex, scratch: &mut FacetScratch, out: &mut [Pack]) {
        let Some(collocation) = &self.tables.collocation else { return };
        self.mesh_on_face(collocation, of, scratch);
        if D == 2 {
            self.turned_tangents(&mut scratch.on_nodes);
        } else {
            self.curls_on_face(collocation, scratch);
        }
        self.grid_flux_on_face(&mut scratch.on_nodes);
        let (lattice, len) = (Lattice::whole(&self.tables.flow, D - 1, D + 1), self.face_nodes());
        let FacetScratch { on_nodes: FaceNodes { area, area_at_points, .. }, scratch: room, .. } = &mut *scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let start = b * (D + 1) * len;
            evaluate(self.simd, lattice, &area[start..], AtPoints::Values(&mut area_at_points[start..]), room);
        }
        self.normal_velocities(scratch, out);
    }

    #[inline(always)]
    fn face_nodes(&self) -> usize {
        self.tables.orders.flow.pow(D as u32 - 1)
    }

    /// Position, tangents and velocity at the nodes.
    #[inline(always)]
    fn mesh_on_face(&self, collocation: &Collocation, of: TimePointIndex, scratch: &mut FacetScratch) {
        let (lattice, len) = (Lattice::whole(&collocation.mesh, D - 1, D), self.face_nodes());
        let FacetScratch { sides: [minus, _], velocity_at, on_nodes, scratch: room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let to = AtPoints::Both(&mut on_nodes.x[b * D * len..], &mut on_nodes.tangents[b * D * D * len..]);
            evaluate(self.simd, lattice, of.block(&minus.position_at, b, lattice.len()), to, room);
            let to = AtPoints::Values(&mut on_nodes.v[b * D * len..]);
            evaluate(self.simd, lattice, of.block(velocity_at, b, lattice.len()), to, room);
        }
    }

    /// The area vector in 2-D: the last column of the cofactors, which depends on the tangents only.
    #[inline(always)]
    fn turned_tangents(&self, on_nodes: &mut FaceNodes) {
        let len = self.face_nodes();
        for i in 0..len {
            for part in 0..Lanes::<S>::PARTS {
                let tangents = Fields::new(D * D, len);
                let tangent: [K::Geometry<S>; D] = tangents.vector(self.simd, &on_nodes.tangents, i, part);
                let area = cofactor(&[tangent; D]);
                for d in 0..D {
                    Fields::new(D + 1, len).store(d, area[D - 1][d], &mut on_nodes.area, i, part);
                }
            }
        }
    }

    /// The area vector in 3-D: the component of the curl along the axis that leaves the face.
    #[inline(always)]
    fn curls_on_face(&self, collocation: &Collocation, scratch: &mut FacetScratch) {
        let (len, lattice) = (self.face_nodes(), Lattice::whole(&self.tables.flow, D - 1, D));
        let FacetScratch { on_nodes, scratch: room, .. } = scratch;
        let FaceNodes { x, tangents, curled, area, .. } = on_nodes;
        for i in 0..len {
            for part in 0..Lanes::<S>::PARTS {
                let x: [K::Geometry<S>; D] = Fields::new(D, len).vector(self.simd, x, i, part);
                for k in 0..D - 1 {
                    let matrix = Fields::new(D * D, len);
                    let slope: [K::Geometry<S>; D] = matrix.from(k * D).vector(self.simd, tangents, i, part);
                    let f = collocation::curled(&x, &slope);
                    for n in 0..D {
                        matrix.store(k * D + n, f[n], curled, i, part);
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
    fn grid_flux_on_face(&self, on_nodes: &mut FaceNodes) {
        let len = self.face_nodes();
        for i in 0..len {
            for part in 0..Lanes::<S>::PARTS {
                let fields = Fields::new(D + 1, len);
                let area: [K::Geometry<S>; D] = fields.vector(self.simd, &on_nodes.area, i, part);
                let v = Fields::new(D, len).vector(self.simd, &on_nodes.v, i, part);
                fields.store(D, dot(&area, &v), &mut on_nodes.area, i, part);
            }
        }
    }

    /// v + ( g - S . v ) S / |S|^2 at the points, with the area vector S.
    #[inline(always)]
    fn normal_velocities(&self, scratch: &FacetScratch, out: &mut [Pack]) {
        let (points, geometry) = (self.tables.facet_points(), self.fields());
        let fields = Fields::new(D + 1, points);
        for p in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let sign = Lanes::read(self.simd, &scratch.normal_sign, part);
                let array = &scratch.on_nodes.area_at_points;
                let area: [K::Geometry<S>; D] = fields.vector(self.simd, array, p, part);
                let flux: K::Geometry<S> = fields.from(D).one(self.simd, array, p, part);
                let v: [K::Geometry<S>; D] = geometry.from(D).vector(self.simd, out, p, part);
                let missing = (flux - dot(&area, &v)) * dot(&area, &area).recip();
                for d in 0..D {
                    geometry.store(d, area[d].times(sign), out, p, part);
                    geometry.store(D + d, v[d] + area[d] * missing, out, p, part);
                }
            }
        }
    }
}
