//! The geometry of facets at the points: area vector, velocity of the mesh, and for viscous terms the maps of both cells.
//!
//! Position, tangents and velocity are those of the facet, the same from both sides. The derivative along the axis that leaves the facet
//! is that of each cell.

use crate::fields::Fields;
use crate::mode::Mode;
use crate::scratch::{FacetScratch, SideScratch};
use crate::tables::Tables;
use crate::tensor_product::{AtPoints, Lattice, evaluate};
use crate::time_points::{InTime, TimePointIndex};
use basis::AlongAxis;
use std::marker::PhantomData;
use tensor::pulp::{Simd, WithSimd};
use tensor::{LaneNumber, Lanes, Pack, cofactor, determinant};

/// Numbers of the geometry of a facet at a point: area vector from minus to plus `[d]`, velocity `[d]`. With viscous terms the maps of minus
/// and plus follow: A `[direction][d]`, tangential directions first, and the determinant.
pub(crate) const fn facet_geometry_len(dimension: usize, viscous: bool) -> usize {
    2 * dimension + if viscous { 2 * map_len(dimension) } else { 0 }
}

/// Numbers of the map of one side.
pub(crate) const fn map_len(dimension: usize) -> usize {
    dimension * dimension + 1
}

/// The steps of the geometry of facets.
pub(crate) struct FacetGeometry<'a, const D: usize, K, S> {
    pub(crate) simd: S,
    pub(crate) tables: &'a Tables<D>,
    /// Whether the law is viscous.
    pub(crate) viscous: bool,
    pub(crate) mode: PhantomData<K>,
}

/// The geometry of a batch of facets at some times: reads mesh traces, overwrites `out[time][b][number][p]`.
pub(crate) struct GeometryOfFacets<'c, const D: usize> {
    pub(crate) tables: &'c Tables<D>,
    pub(crate) viscous: bool,
    /// Sides in use: 2 between cells, 1 on a boundary.
    pub(crate) used: usize,
    pub(crate) in_time: InTime<'c>,
    pub(crate) scratch: &'c mut FacetScratch,
    pub(crate) out: &'c mut [Pack],
}

impl<const D: usize> WithSimd for GeometryOfFacets<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let GeometryOfFacets { tables, viscous, used, in_time, scratch, out } = self;
        let kernel = FacetGeometry { simd, tables, viscous, mode: PhantomData::<crate::mode::Values> };
        kernel.mesh_at_times(in_time, used, scratch);
        let (len, count) = (facet_geometry_len(D, viscous) * tables.facet_points(), in_time.positions.rows());
        for (number, out) in out.chunks_exact_mut(len).take(count).enumerate() {
            kernel.at_points(TimePointIndex { number, count }, used, scratch, out);
        }
    }
}

impl<const D: usize, K: Mode, S: Simd> FacetGeometry<'_, D, K, S> {
    /// Interpolates position, derivatives and velocity from the slots to all times.
    #[inline(always)]
    pub(crate) fn mesh_at_times(&self, in_time: InTime, used: usize, scratch: &mut FacetScratch) {
        let (g, kinds, mesh_len): (usize, usize, usize) =
            (K::GEOMETRY_BLOCKS, if self.viscous { 2 } else { 1 }, D * self.tables.orders.mesh.pow(D as u32 - 1));
        let InTime { velocities, positions, .. } = in_time;
        let FacetScratch { sides, velocity_at, scratch: room, .. } = scratch;
        let velocity = AlongAxis { matrix: velocities, outer: g, inner: mesh_len };
        room.contract(self.simd, velocity, &sides[0].mesh, velocity_at, false);
        for (number, SideScratch { mesh, position_at, .. }) in sides[..used].iter_mut().enumerate() {
            // Position and tangents come from minus; of the plus side only derivatives along its leaving axis are stored.
            let start = |slots: usize| number * g * slots * mesh_len;
            let (mesh, position_at) = (&mesh[start(positions.cols())..], &mut position_at[start(positions.rows())..]);
            let position = AlongAxis { matrix: positions, outer: kinds.saturating_sub(number) * g, inner: mesh_len };
            room.contract(self.simd, position, mesh, position_at, false);
        }
    }

    /// The geometry at the points at one of the times. Overwrites `out[b][number][p]`.
    #[inline(always)]
    pub(crate) fn at_points(&self, of: TimePointIndex, used: usize, scratch: &mut FacetScratch, out: &mut [Pack]) {
        self.derivatives_to_points(of, used, scratch, out);
        self.maps(used, scratch, out);
        if self.tables.collocation.is_some() {
            self.area_of_grid_flux(of, scratch, out);
        }
    }

    #[inline(always)]
    pub(crate) fn fields(&self) -> Fields {
        Fields::new(facet_geometry_len(D, self.viscous), self.tables.facet_points())
    }

    /// Mesh velocity at the points, and the Jacobian matrices of the `used` sides; the derivative along the axis that leaves is read by
    /// viscous terms only.
    #[inline(always)]
    fn derivatives_to_points(&self, of: TimePointIndex, used: usize, scratch: &mut FacetScratch, out: &mut [Pack]) {
        let (lattice, points) = (Lattice::whole(&self.tables.mesh, D - 1, D), self.tables.facet_points());
        let (simd, len, block) = (self.simd, lattice.len(), facet_geometry_len(D, self.viscous) * points);
        let (tangents, matrices) = ((D - 1) * D * points, D * D * points);
        let FacetScratch { sides: [minus, plus], velocity_at, scratch: room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let v = AtPoints::Values(&mut out[b * block + D * points..]);
            evaluate(simd, lattice, of.block(velocity_at, b, len), v, room);
            let (position, jacobian) = (of.block(&minus.position_at, b, len), &mut minus.jacobian[b * matrices..]);
            evaluate(simd, lattice, position, AtPoints::Gradients(&mut jacobian[..]), room);
            if self.viscous {
                plus.jacobian[b * matrices..][..tangents].copy_from_slice(&jacobian[..tangents]);
            }
        }
        if self.viscous {
            for SideScratch { position_at, jacobian, .. } in [minus, plus].into_iter().take(used) {
                for b in 0..K::GEOMETRY_BLOCKS {
                    let kind = of.block(position_at, K::GEOMETRY_BLOCKS + b, len);
                    let leaving = AtPoints::Values(&mut jacobian[b * matrices + tangents..]);
                    evaluate(simd, lattice, kind, leaving, room);
                }
            }
        }
    }

    /// Area vectors and maps from the Jacobian matrices.
    #[inline(always)]
    fn maps(&self, used: usize, scratch: &FacetScratch, out: &mut [Pack]) {
        let (points, fields) = (self.tables.facet_points(), self.fields());
        for p in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                for (number, side) in scratch.sides.iter().enumerate().take(if self.viscous { used } else { 1 }) {
                    let matrix = Fields::new(D * D, points);
                    let slopes = matrix.rows::<D, K::Geometry<S>, S>(self.simd, &side.jacobian, p, part);
                    let area = cofactor(&slopes);
                    if number == 0 {
                        let sign = Lanes::read(self.simd, &scratch.normal_sign, part);
                        for d in 0..D {
                            fields.store(d, area[D - 1][d].times(sign), out, p, part);
                        }
                    }
                    if self.viscous {
                        self.store_map(number, &area, determinant(&slopes, &area), out, [p, part]);
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn store_map(
        &self,
        side: usize,
        area: &[[K::Geometry<S>; D]; D],
        det: K::Geometry<S>,
        out: &mut [Pack],
        [p, part]: [usize; 2],
    ) {
        let map = self.fields().from(2 * D + side * map_len(D));
        for j in 0..D {
            for d in 0..D {
                map.store(j * D + d, area[j][d], out, p, part);
            }
        }
        map.store(D * D, det, out, p, part);
    }
}
