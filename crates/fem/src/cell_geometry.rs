//! The geometry of cells at the points: metric A_j = J grad xi_j, velocity of the mesh, J = det dx/dxi.
//!
//! It is computed once for each position of the mesh where that can be kept, and in every evaluation where it cannot.

use crate::fields::Fields;
use crate::mode::Mode;
use crate::nodal_geometry::NodalScratch;
use crate::tables::{Planes, Tables};
use crate::tensor_product::{AtPoints, Lattice, Scratch, evaluate};
use crate::time_points::TimePointIndex;
use basis::{AlongAxis, Matrix};
use std::marker::PhantomData;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack, cofactor, det, determinant, zeroed};

/// Numbers of the geometry of a cell at a point: A `[direction][d]`, velocity `[d]`, J.
pub(crate) const fn geometry_len(dimension: usize) -> usize {
    dimension * dimension + dimension + 1
}

/// Packs of the geometry of a batch of cells. `b` counts blocks (values, derivatives).
#[derive(Default)]
pub struct GeometryScratch {
    /// Position and velocity, `[b][time, last the top][d][mesh node]`; at one time `[d][mesh node]`.
    pub position_at: Vec<Pack>,
    /// See `position_at`; its top is not used.
    pub velocity_at: Vec<Pack>,
    /// dx/dxi at the points of a block of planes, `[b][direction][d][p]`.
    jacobian: Vec<Pack>,
    /// The geometry at a block of planes, where it is not known, `[b][number][p]`.
    pub(crate) at_points: Vec<Pack>,
    /// The geometry at one time, `[block of planes][number][p]`; or that of a slab with derivatives, `[time point][b][number][p]`.
    pub(crate) known: Vec<Pack>,
    pub(crate) nodal: NodalScratch,
    pub(crate) room: Scratch,
}

impl GeometryScratch {
    /// Memory for any mode.
    pub fn new<const D: usize>(tables: &Tables<D>) -> Self {
        let (orders, times) = (tables.orders, tables.time_points.len() + 1);
        let motion = 2 * times * D * orders.mesh.pow(D as u32);
        let known = if tables.collocation.is_some() { 2 * tables.time_points.len() } else { 1 };
        GeometryScratch {
            position_at: zeroed(motion),
            velocity_at: zeroed(motion),
            jacobian: zeroed(2 * D * D * tables.block_points()),
            at_points: zeroed(2 * tables.block_points() * geometry_len(D)),
            known: zeroed(known * tables.volume_points() * geometry_len(D)),
            nodal: NodalScratch::new(tables),
            room: Scratch::new(D, D * D, tables.rule.points.len().max(orders.flow).max(orders.mesh)),
        }
    }
}

/// The motion of a batch of cells in a slab, from which its geometry is computed.
#[derive(Clone, Copy)]
pub(crate) struct CellMotion<'a, const D: usize> {
    pub(crate) tables: &'a Tables<D>,
    /// Positions at the time points and last at the top, `[time point][slot]`.
    pub(crate) positions: &'a Matrix,
    /// Bottom position and velocities of the mesh, a block of packs for each of the mode, `[slot][d][mesh node]`.
    pub(crate) mesh: &'a [&'a [Pack]],
    /// J_n at the nodes, where it is carried.
    pub(crate) bottom: &'a [Pack],
}

/// The length of the geometry that is kept for a slab, `[time point][block of planes][number][p]`. J at the top follows, `[p]`, unless the
/// last time point is the top.
pub(crate) const fn kept_len(dimension: usize, time_points: usize, points: usize, has_top: bool) -> usize {
    (time_points * geometry_len(dimension) + has_top as usize) * points
}

/// The geometry of a batch of cells in a slab.
pub(crate) struct GeometryOfSlab<'c, const D: usize, K> {
    pub(crate) motion: CellMotion<'c, D>,
    pub(crate) scratch: &'c mut GeometryScratch,
    /// Overwritten, see [`kept_len`]; with derivatives `[time point][b][number][p]`, for collocated rules only.
    pub(crate) out: &'c mut [Pack],
    pub(crate) mode: PhantomData<K>,
}

impl<const D: usize, K: Mode> WithSimd for GeometryOfSlab<'_, D, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let GeometryOfSlab { motion, scratch, out, mode } = self;
        let kernel = CellGeometry { simd, tables: motion.tables, mode };
        kernel.mesh_at_times(motion.positions, motion.mesh, scratch);
        if motion.tables.collocation.is_some() {
            return kernel.collocated(motion, scratch, out);
        }
        let (count, mut rest) = (motion.tables.times(), out);
        for number in 0..motion.tables.time_points.len() {
            for planes in &motion.tables.planes {
                let (here, after) = rest.split_at_mut(geometry_len(D) * planes.weights.len());
                kernel.of_map(planes, TimePointIndex { number, count }, scratch, here);
                rest = after;
            }
        }
        for planes in &motion.tables.planes {
            let (here, after) = rest.split_at_mut(planes.weights.len());
            kernel.determinants(planes, TimePointIndex { number: count - 1, count }, scratch, here);
            rest = after;
        }
    }
}

/// The geometry of a batch of cells at one time, in `known` of the scratch. Reads position and velocity there.
pub(crate) struct GeometryOfSpace<'c, const D: usize> {
    pub(crate) tables: &'c Tables<D>,
    pub(crate) scratch: &'c mut GeometryScratch,
}

impl<const D: usize> WithSimd for GeometryOfSpace<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let GeometryOfSpace { tables, scratch } = self;
        let kernel = CellGeometry { simd, tables, mode: PhantomData::<crate::mode::Values> };
        let mut out = std::mem::take(&mut scratch.known);
        if tables.collocation.is_some() {
            kernel.collocated_at_one_time(scratch, &mut out);
        } else {
            let mut rest = &mut out[..];
            for planes in &tables.planes {
                let (here, after) = rest.split_at_mut(geometry_len(D) * planes.weights.len());
                kernel.of_map(planes, TimePointIndex::ALONE, scratch, here);
                rest = after;
            }
        }
        scratch.known = out;
    }
}

/// The steps of the geometry of cells.
pub(crate) struct CellGeometry<'a, const D: usize, K, S> {
    pub(crate) simd: S,
    pub(crate) tables: &'a Tables<D>,
    pub(crate) mode: PhantomData<K>,
}

impl<const D: usize, K: Mode, S: Simd> CellGeometry<'_, D, K, S> {
    /// Interpolates position and velocity from the slots to the times.
    #[inline(always)]
    pub(crate) fn mesh_at_times(&self, positions: &Matrix, mesh: &[&[Pack]], scratch: &mut GeometryScratch) {
        let (inner, count) = (D * self.tables.orders.mesh.pow(D as u32), self.tables.times());
        let GeometryScratch { position_at, velocity_at, room, .. } = scratch;
        for (b, mesh) in mesh.iter().enumerate() {
            let (along, start) = (|matrix| AlongAxis { matrix, outer: 1, inner }, b * count * inner);
            room.contract(self.simd, along(positions), mesh, &mut position_at[start..], false);
            room.contract(self.simd, along(&self.tables.velocities), mesh, &mut velocity_at[start..], false);
        }
    }

    /// The mesh polynomials at some planes of points.
    #[inline(always)]
    fn mesh_lattice<'p>(&'p self, planes: &'p Planes) -> Lattice<'p> {
        Lattice { line: &self.tables.mesh, last: &planes.mesh, dimension: D, components: D }
    }

    /// The geometry from the map, for rules that are not collocated, at some planes of points: A are the cofactors of dx/dxi. Overwrites
    /// `out[b][number][p]`.
    #[inline(always)]
    pub(crate) fn of_map(&self, planes: &Planes, of: TimePointIndex, scratch: &mut GeometryScratch, out: &mut [Pack]) {
        let (points, mesh) = (planes.weights.len(), self.mesh_lattice(planes));
        let (fields, jacobian_fields) = (Fields::new(geometry_len(D), points), Fields::new(D * D, points));
        let GeometryScratch { position_at, velocity_at, jacobian, room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let slopes = AtPoints::Gradients(&mut jacobian[b * D * D * points..]);
            evaluate(self.simd, mesh, of.block(position_at, b, mesh.len()), slopes, room);
            let v = AtPoints::Values(&mut out[(b * geometry_len(D) + D * D) * points..]);
            evaluate(self.simd, mesh, of.block(velocity_at, b, mesh.len()), v, room);
        }
        for p in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let slopes = jacobian_fields.rows::<D, K::Geometry<S>, S>(self.simd, jacobian, p, part);
                let area = cofactor(&slopes);
                for j in 0..D {
                    for d in 0..D {
                        fields.store(j * D + d, area[j][d], out, p, part);
                    }
                }
                fields.store(D * D + D, determinant(&slopes, &area), out, p, part);
            }
        }
    }

    /// det dx/dxi at some planes of points. Overwrites `out[b][p]`.
    #[inline(always)]
    pub(crate) fn determinants(
        &self,
        planes: &Planes,
        of: TimePointIndex,
        scratch: &mut GeometryScratch,
        out: &mut [Pack],
    ) {
        let (points, mesh) = (planes.weights.len(), self.mesh_lattice(planes));
        let GeometryScratch { position_at, jacobian, room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let slopes = AtPoints::Gradients(&mut jacobian[b * D * D * points..]);
            evaluate(self.simd, mesh, of.block(position_at, b, mesh.len()), slopes, room);
        }
        for p in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let slopes = Fields::new(D * D, points).rows::<D, K::Geometry<S>, S>(self.simd, jacobian, p, part);
                Fields::new(1, points).store(0, det(&slopes), out, p, part);
            }
        }
    }
}
