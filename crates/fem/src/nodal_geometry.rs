//! The geometry of cells in collocated rules: (metric), (grid flux) and (carried) of [`crate::collocation`].

use crate::cell_geometry::{CellGeometry, CellMotion, GeometryScratch, geometry_len};
use crate::collocation::{self, Collocation};
use crate::fields::Fields;
use crate::mode::Mode;
use crate::tables::Tables;
use crate::tensor_product::{AtPoints, Lattice, evaluate};
use crate::time_points::TimePointIndex;
use basis::Matrix;
use tensor::pulp::Simd;
use tensor::{LaneNumber, Lanes, Pack, Real, cofactor, det, determinant, dot, zeroed};

/// Packs at the nodes of the flow of a batch of cells; all start with the block, `[b]`.
#[derive(Default)]
pub struct NodalScratch {
    /// Position and velocity, `[d][i]`.
    x: Vec<Pack>,
    v: Vec<Pack>,
    /// dx/dxi, F of (metric) and A, `[direction][d][i]`.
    jacobian: Vec<Pack>,
    curled: Vec<Pack>,
    area: Vec<Pack>,
    /// g at the nodes and at the points, `[direction][i]`.
    grid_flux: Vec<Pack>,
    grid_flux_at_points: Vec<Pack>,
    /// sum_i d_i g_i, `[time point][i]`.
    divergence: Vec<Pack>,
    /// J, `[time point][i]`.
    determinant: Vec<Pack>,
}

impl NodalScratch {
    /// Memory for any mode; none where the rule is not collocated.
    pub(crate) fn new<const D: usize>(tables: &Tables<D>) -> Self {
        if tables.collocation.is_none() {
            return NodalScratch::default();
        }
        let fields = |count: usize| zeroed(2 * count * tables.orders.flow.pow(D as u32));
        let time_points = tables.time_points.len();
        NodalScratch {
            x: fields(D),
            v: fields(D),
            jacobian: fields(D * D),
            curled: fields(D * D),
            area: fields(D * D),
            grid_flux: fields(D),
            grid_flux_at_points: fields(D),
            divergence: fields(time_points),
            determinant: fields(time_points),
        }
    }

    /// J of the values at time point `number`.
    pub(crate) fn determinants(&self, number: usize, nodes: usize) -> &[Pack] {
        &self.determinant[number * nodes..][..nodes]
    }
}

impl<const D: usize, K: Mode, S: Simd> CellGeometry<'_, D, K, S> {
    /// The geometry of a slab from position and velocity at its time points. Overwrites `out[time point][b][number][p]`.
    #[inline(always)]
    pub(crate) fn collocated(&self, motion: CellMotion<D>, scratch: &mut GeometryScratch, out: &mut [Pack]) {
        let Some(collocation) = &self.tables.collocation else { return };
        let (count, len) = (self.tables.time_points.len(), K::GEOMETRY_BLOCKS * geometry_len(D) * self.nodes());
        for (number, out) in out.chunks_exact_mut(len).take(count).enumerate() {
            let of = TimePointIndex { number, count };
            self.area_vectors(collocation, of, scratch); // 1. (metric)
            self.grid_flux(collocation, of, scratch); // 2. (grid flux)
            self.divergence(collocation, of, scratch);
            self.vectors_to_points(collocation, scratch, out); // 3.
        }
        self.carry_determinant(motion.positions, motion.bottom, scratch); // 4. (carried)
        for (number, out) in out.chunks_exact_mut(len).take(count).enumerate() {
            self.determinant_to_points(number, scratch, out);
        }
    }

    /// The geometry at one time without a slab, with J = I(det dx/dxi).
    #[inline(always)]
    pub(crate) fn collocated_at_one_time(&self, scratch: &mut GeometryScratch, out: &mut [Pack]) {
        let Some(collocation) = &self.tables.collocation else { return };
        self.area_vectors(collocation, TimePointIndex::ALONE, scratch);
        self.grid_flux(collocation, TimePointIndex::ALONE, scratch);
        self.vectors_to_points(collocation, scratch, out);
        self.determinants_at_nodes(&mut scratch.nodal);
        self.determinant_to_points(0, scratch, out);
    }

    #[inline(always)]
    fn nodes(&self) -> usize {
        self.tables.orders.flow.pow(D as u32)
    }

    /// `count` fields at the nodes.
    #[inline(always)]
    fn fields(&self, count: usize) -> Fields {
        Fields::new(count, self.nodes())
    }

    /// Flow polynomials at the points.
    #[inline(always)]
    fn flow(&self, components: usize) -> Lattice<'_> {
        Lattice::whole(&self.tables.flow, D, components)
    }

    /// (metric) at the nodes.
    #[inline(always)]
    fn area_vectors(&self, collocation: &Collocation, of: TimePointIndex, scratch: &mut GeometryScratch) {
        let (nodes, mesh) = (self.nodes(), Lattice::whole(&collocation.mesh, D, D));
        let GeometryScratch { position_at, nodal, room, .. } = &mut *scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let to = AtPoints::Both(&mut nodal.x[b * D * nodes..], &mut nodal.jacobian[b * D * D * nodes..]);
            evaluate(self.simd, mesh, of.block(position_at, b, mesh.len()), to, room);
        }
        if D == 2 { self.cofactors(nodal) } else { self.curls(collocation, scratch) }
    }

    /// A as the cofactors of dx/dxi.
    #[inline(always)]
    fn cofactors(&self, nodal: &mut NodalScratch) {
        let matrix = self.fields(D * D);
        for p in 0..self.nodes() {
            for part in 0..Lanes::<S>::PARTS {
                let area = cofactor(&matrix.rows::<D, K::Geometry<S>, S>(self.simd, &nodal.jacobian, p, part));
                for j in 0..D {
                    for d in 0..D {
                        matrix.store(j * D + d, area[j][d], &mut nodal.area, p, part);
                    }
                }
            }
        }
    }

    /// A as a curl.
    #[inline(always)]
    fn curls(&self, collocation: &Collocation, scratch: &mut GeometryScratch) {
        let (nodes, lattice, matrix) = (self.nodes(), self.flow(D), self.fields(D * D));
        let GeometryScratch { nodal: NodalScratch { x, jacobian, curled, area, .. }, room, .. } = scratch;
        for p in 0..nodes {
            for part in 0..Lanes::<S>::PARTS {
                let x = self.fields(D).vector::<D, K::Geometry<S>, S>(self.simd, x, p, part);
                let slopes = matrix.rows::<D, K::Geometry<S>, S>(self.simd, jacobian, p, part);
                for k in 0..D {
                    let f = collocation::curled(&x, &slopes[k]);
                    for n in 0..D {
                        matrix.store(k * D + n, f[n], curled, p, part);
                    }
                }
            }
        }
        let [minus, plus] = &collocation.half_derivatives;
        for b in 0..K::GEOMETRY_BLOCKS {
            for i in 0..D {
                let (j, k) = ((i + 1) % D, (i + 2) % D);
                let start = |axis: usize| (b * D + axis) * D * nodes;
                let area = &mut area[start(i)..];
                room.contract(self.simd, lattice.along(j, minus), &curled[start(k)..], area, false);
                room.contract(self.simd, lattice.along(k, plus), &curled[start(j)..], area, true);
            }
        }
    }

    /// (grid flux) at the nodes.
    #[inline(always)]
    fn grid_flux(&self, collocation: &Collocation, of: TimePointIndex, scratch: &mut GeometryScratch) {
        let (nodes, mesh, vectors) = (self.nodes(), Lattice::whole(&collocation.mesh, D, D), self.fields(D));
        let GeometryScratch { velocity_at, nodal: NodalScratch { v, area, grid_flux, .. }, room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let to = AtPoints::Values(&mut v[b * D * nodes..]);
            evaluate(self.simd, mesh, of.block(velocity_at, b, mesh.len()), to, room);
        }
        for p in 0..nodes {
            for part in 0..Lanes::<S>::PARTS {
                let area = self.fields(D * D).rows::<D, K::Geometry<S>, S>(self.simd, area, p, part);
                let v = vectors.vector(self.simd, v, p, part);
                for j in 0..D {
                    vectors.store(j, dot(&area[j], &v), grid_flux, p, part);
                }
            }
        }
    }

    /// sum_i d_i g_i at the nodes.
    #[inline(always)]
    fn divergence(&self, collocation: &Collocation, of: TimePointIndex, scratch: &mut GeometryScratch) {
        let (nodes, lattice) = (self.nodes(), self.flow(1));
        let GeometryScratch { nodal: NodalScratch { grid_flux, divergence, .. }, room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let out = &mut divergence[(b * of.count + of.number) * nodes..];
            for axis in 0..D {
                let along = lattice.along(axis, &collocation.derivative);
                room.contract(self.simd, along, &grid_flux[(b * D + axis) * nodes..], out, axis > 0);
            }
        }
    }

    /// A and the velocity at the points: interpolated, or those at the nodes.
    #[inline(always)]
    fn vectors_to_points(&self, collocation: &Collocation, scratch: &mut GeometryScratch, out: &mut [Pack]) {
        let (nodes, len) = (self.nodes(), geometry_len(D) * self.nodes());
        let GeometryScratch { nodal, room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let (to_area, to_v) = out[b * len..].split_at_mut(D * D * nodes);
            let area = &nodal.area[b * D * D * nodes..];
            evaluate(self.simd, self.flow(D * D), area, AtPoints::Values(to_area), room);
            let vectors = b * D * nodes;
            if collocation.at_nodes {
                to_v[..D * nodes].copy_from_slice(&nodal.v[vectors..][..D * nodes]);
            } else {
                let to = AtPoints::Values(&mut nodal.grid_flux_at_points[vectors..]);
                evaluate(self.simd, self.flow(D), &nodal.grid_flux[vectors..], to, room);
            }
        }
        if !collocation.at_nodes {
            self.velocities_of_grid_flux(&nodal.grid_flux_at_points, out);
        }
    }

    /// The velocity with A_i . v = g_i at the points.
    #[inline(always)]
    fn velocities_of_grid_flux(&self, grid_flux: &[Pack], out: &mut [Pack]) {
        let geometry = self.fields(geometry_len(D));
        for p in 0..self.nodes() {
            for part in 0..Lanes::<S>::PARTS {
                let area = geometry.rows::<D, K::Geometry<S>, S>(self.simd, out, p, part);
                let g = self.fields(D).vector::<D, K::Geometry<S>, S>(self.simd, grid_flux, p, part);
                let cof = cofactor(&area);
                let inverse = determinant(&area, &cof).recip();
                for d in 0..D {
                    let mut sum = cof[0][d] * g[0];
                    for j in 1..D {
                        sum += cof[j][d] * g[j];
                    }
                    geometry.store(D * D + d, sum * inverse, out, p, part);
                }
            }
        }
    }

    /// (carried) at the nodes, at all time points.
    #[inline(always)]
    fn carry_determinant(&self, positions: &Matrix, bottom: &[Pack], scratch: &mut GeometryScratch) {
        let (nodes, count) = (self.nodes(), self.tables.time_points.len());
        let (NodalScratch { divergence, determinant, .. }, fields) = (&mut scratch.nodal, self.fields(count));
        for q in 0..count {
            for p in 0..nodes {
                for part in 0..Lanes::<S>::PARTS {
                    let first = fields.one::<K::Geometry<S>, S>(self.simd, divergence, p, part);
                    let mut sum = first.constant(1.0).times(Lanes::read(self.simd, &bottom[p], part));
                    for r in 0..count {
                        let term = fields.from(r).one::<K::Geometry<S>, S>(self.simd, divergence, p, part);
                        // dt Phi_r(s_q); the first slot is the bottom position.
                        sum += term * positions[(q, r + 1)];
                    }
                    fields.store(q, sum, determinant, p, part);
                }
            }
        }
    }

    /// det dx/dxi at the nodes, in place of the first time point.
    #[inline(always)]
    fn determinants_at_nodes(&self, nodal: &mut NodalScratch) {
        for p in 0..self.nodes() {
            for part in 0..Lanes::<S>::PARTS {
                let slopes = self.fields(D * D).rows::<D, K::Geometry<S>, S>(self.simd, &nodal.jacobian, p, part);
                let det = det(&slopes);
                self.fields(self.tables.time_points.len()).store(0, det, &mut nodal.determinant, p, part);
            }
        }
    }

    /// J at the points, at time point `number`.
    #[inline(always)]
    fn determinant_to_points(&self, number: usize, scratch: &mut GeometryScratch, out: &mut [Pack]) {
        let (nodes, count) = (self.nodes(), self.tables.time_points.len());
        for b in 0..K::GEOMETRY_BLOCKS {
            let out = &mut out[((b + 1) * geometry_len(D) - 1) * nodes..];
            let nodal = &scratch.nodal.determinant[(b * count + number) * nodes..];
            evaluate(self.simd, self.flow(1), nodal, AtPoints::Values(out), &mut scratch.room);
        }
    }
}
