//! The geometry of cells in collocated rules: (metric), (grid flux) and (carried) of [`crate::collocation`].

use crate::collocation::{Collocation, geometry_len};
use crate::instants::TimePointIndex;
use crate::mode::Mode;
use crate::tables::Tables;
use crate::tensor_product::{AlongAxis, AtPoints, Lattice, Scratch, evaluate};
use basis::Matrix;
use std::marker::PhantomData;
use tensor::pulp::{Simd, WithSimd};
use tensor::{LaneNumber, Lanes, Pack, Real, cofactor, determinant, dot, zeroed};

/// Packs of the geometry of a batch of cells. `b` counts blocks (values, derivatives), `i` the nodes of the flow.
#[derive(Default)]
pub struct GeometryScratch {
    /// Position and velocity at the instants, `[b][instant][d][mesh node]`.
    pub position_at: Vec<Pack>,
    /// See `position_at`.
    pub velocity_at: Vec<Pack>,
    /// Position, `[b][d][i]`, and its derivatives, `[b][direction][d][i]`.
    x: Vec<Pack>,
    jacobian: Vec<Pack>,
    /// F of (metric), `[b][direction][d][i]`.
    curled: Vec<Pack>,
    /// A and the velocity, `[b][direction][d][i]` and `[b][d][i]`.
    area: Vec<Pack>,
    v: Vec<Pack>,
    /// g at the nodes and at the points, `[b][direction][i]`.
    grid_flux: Vec<Pack>,
    grid_flux_at_points: Vec<Pack>,
    /// sum_i d_i g_i, `[b][instant][i]`.
    divergence: Vec<Pack>,
    /// J at the nodes, `[b][instant][i]`.
    determinant: Vec<Pack>,
    /// The geometry at the points, `[instant][b][number][p]`: A `[direction][d]`, velocity `[d]`, J.
    pub(crate) at_points: Vec<Pack>,
    room: Scratch,
}

impl GeometryScratch {
    /// Memory for any mode; none where the rule is not collocated.
    pub fn new<const D: usize>(tables: &Tables<D>) -> Self {
        if tables.collocation.is_none() {
            return GeometryScratch::default();
        }
        let (nodes, mesh_nodes) = (tables.orders.flow.pow(D as u32), tables.orders.mesh.pow(D as u32));
        let instants = tables.instants.len();
        let vectors = |count: usize| zeroed(2 * count * D * nodes);
        GeometryScratch {
            position_at: zeroed(2 * instants * D * mesh_nodes),
            velocity_at: zeroed(2 * instants * D * mesh_nodes),
            x: vectors(1),
            jacobian: vectors(D),
            curled: vectors(D),
            area: vectors(D),
            v: vectors(1),
            grid_flux: vectors(1),
            grid_flux_at_points: vectors(1),
            divergence: zeroed(2 * instants * nodes),
            determinant: zeroed(2 * instants * nodes),
            at_points: zeroed(2 * instants * geometry_len(D) * nodes),
            room: Scratch::new(D, D * D, tables.orders.flow.max(tables.orders.mesh)),
        }
    }

    /// The geometry of a batch at all instants, `[instant][b][number][p]`.
    pub(crate) fn of_slab<const D: usize>(&self, tables: &Tables<D>, blocks: usize) -> &[Pack] {
        &self.at_points[..tables.instants.len() * blocks * geometry_len(D) * tables.volume_points()]
    }

    /// J at the nodes at the last instant, the top of the slab.
    pub(crate) fn determinant_at_top<const D: usize>(&self, tables: &Tables<D>) -> &[Pack] {
        let nodes = tables.orders.flow.pow(D as u32);
        &self.determinant[(tables.instants.len() - 1) * nodes..][..nodes]
    }

    /// det dx/dxi at the nodes, after [`DeterminantOfCells`].
    pub(crate) fn determinant_at_nodes<const D: usize>(&self, tables: &Tables<D>) -> &[Pack] {
        &self.determinant[..tables.orders.flow.pow(D as u32)]
    }
}

/// The geometry of a batch of cells in a slab, with J carried from its bottom.
pub(crate) struct GeometryOfSlab<'c, const D: usize, K> {
    pub(crate) tables: &'c Tables<D>,
    /// Positions at the instants, `[instant][slot]`.
    pub(crate) positions: &'c Matrix,
    /// Bottom position and velocities of the mesh, a block of packs for each of the mode, `[slot][d][mesh node]`.
    pub(crate) mesh: &'c [&'c [Pack]],
    /// J_n at the nodes.
    pub(crate) bottom: &'c [Pack],
    pub(crate) scratch: &'c mut GeometryScratch,
    pub(crate) mode: PhantomData<K>,
}

impl<const D: usize, K: Mode> WithSimd for GeometryOfSlab<'_, D, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let GeometryOfSlab { tables, positions, mesh, bottom, scratch, mode } = self;
        let Some(collocation) = &tables.collocation else { return };
        let kernel = Geometry { simd, tables, collocation, mode };
        kernel.mesh_at_instants(positions, mesh, scratch); // 1.
        for number in 0..tables.instants.len() {
            let of = TimePointIndex { number, count: tables.instants.len() };
            kernel.area_vectors(of, scratch); // 2. (metric)
            kernel.grid_flux(of, scratch); // 3. (grid flux)
            kernel.divergence(of, scratch);
            kernel.vectors_to_points(number, scratch); // 4.
        }
        kernel.carry_determinant(positions, bottom, scratch); // 5. (carried)
        (0..tables.instants.len()).for_each(|number| kernel.determinant_to_points(number, scratch));
    }
}

/// The geometry at one time without a slab, with J = I(det dx/dxi). Reads `position_at` and `velocity_at` of one time.
pub(crate) struct GeometryOfSpace<'c, const D: usize, K> {
    pub(crate) tables: &'c Tables<D>,
    pub(crate) scratch: &'c mut GeometryScratch,
    pub(crate) mode: PhantomData<K>,
}

impl<const D: usize, K: Mode> WithSimd for GeometryOfSpace<'_, D, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let GeometryOfSpace { tables, scratch, mode } = self;
        let Some(collocation) = &tables.collocation else { return };
        let kernel = Geometry { simd, tables, collocation, mode };
        kernel.area_vectors(TimePointIndex::ALONE, scratch);
        kernel.grid_flux(TimePointIndex::ALONE, scratch);
        kernel.vectors_to_points(0, scratch);
        kernel.determinants_of_map(scratch);
        kernel.determinant_to_points(0, scratch);
    }
}

/// The steps of the geometry.
struct Geometry<'a, const D: usize, K, S> {
    simd: S,
    tables: &'a Tables<D>,
    collocation: &'a Collocation,
    mode: PhantomData<K>,
}

impl<const D: usize, K: Mode, S: Simd> Geometry<'_, D, K, S> {
    #[inline(always)]
    fn nodes(&self) -> usize {
        self.tables.orders.flow.pow(D as u32)
    }

    /// Fields of the flow's order with so many components.
    #[inline(always)]
    fn flow(&self, components: usize) -> Lattice<'_> {
        Lattice::whole(&self.tables.flow, D, components)
    }

    /// Position and velocity at the instants.
    #[inline(always)]
    fn mesh_at_instants(&self, positions: &Matrix, mesh: &[&[Pack]], scratch: &mut GeometryScratch) {
        let (inner, count) = (D * self.tables.orders.mesh.pow(D as u32), self.tables.instants.len());
        let GeometryScratch { position_at, velocity_at, room, .. } = scratch;
        for (b, mesh) in mesh.iter().enumerate() {
            let along = |matrix| AlongAxis { matrix, outer: 1, inner };
            room.contract(self.simd, along(positions), mesh, &mut position_at[b * count * inner..], false);
            room.contract(
                self.simd,
                along(&self.tables.velocities),
                mesh,
                &mut velocity_at[b * count * inner..],
                false,
            );
        }
    }

    /// (metric) at the nodes.
    #[inline(always)]
    fn area_vectors(&self, of: TimePointIndex, scratch: &mut GeometryScratch) {
        let (nodes, mesh) = (self.nodes(), Lattice::whole(&self.collocation.mesh, D, D));
        let GeometryScratch { position_at, x, jacobian, room, .. } = &mut *scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let to = AtPoints::Both(&mut x[b * D * nodes..], &mut jacobian[b * D * D * nodes..]);
            evaluate(self.simd, mesh, of.block(position_at, b, mesh.len()), to, room);
        }
        if D == 2 { self.cofactors(scratch) } else { self.curls(scratch) }
    }

    /// A as the cofactors of dx/dxi.
    #[inline(always)]
    fn cofactors(&self, scratch: &mut GeometryScratch) {
        let nodes = self.nodes();
        let GeometryScratch { jacobian, area, .. } = scratch;
        for p in 0..nodes {
            for part in 0..Lanes::<S>::PARTS {
                let cof = cofactor(&self.rows(jacobian, D * D * nodes, p, part));
                for j in 0..D {
                    for d in 0..D {
                        cof[j][d].store(area, D * D * nodes, (j * D + d) * nodes + p, part);
                    }
                }
            }
        }
    }

    /// A as a curl.
    #[inline(always)]
    fn curls(&self, scratch: &mut GeometryScratch) {
        let (nodes, lattice) = (self.nodes(), self.flow(D));
        let GeometryScratch { x, jacobian, curled, area, room, .. } = scratch;
        for p in 0..nodes {
            for part in 0..Lanes::<S>::PARTS {
                let x = self.vector(x, D * nodes, p, part);
                let slopes = self.rows(jacobian, D * D * nodes, p, part);
                for k in 0..D {
                    for n in 0..D {
                        let (m, l) = ((n + 1) % D, (n + 2) % D);
                        let f = x[l] * slopes[k][m] - x[m] * slopes[k][l];
                        f.store(curled, D * D * nodes, (k * D + n) * nodes + p, part);
                    }
                }
            }
        }
        let [minus, plus] = &self.collocation.half_derivatives;
        for (b, i) in (0..K::GEOMETRY_BLOCKS).flat_map(|b| (0..D).map(move |i| (b, i))) {
            let (j, k) = ((i + 1) % D, (i + 2) % D);
            let start = |axis: usize| (b * D + axis) * D * nodes;
            let area = &mut area[start(i)..];
            room.contract(self.simd, lattice.along(j, minus), &curled[start(k)..], area, false);
            room.contract(self.simd, lattice.along(k, plus), &curled[start(j)..], area, true);
        }
    }

    /// (grid flux) at the nodes.
    #[inline(always)]
    fn grid_flux(&self, of: TimePointIndex, scratch: &mut GeometryScratch) {
        let (nodes, mesh) = (self.nodes(), Lattice::whole(&self.collocation.mesh, D, D));
        let GeometryScratch { velocity_at, v, area, grid_flux, room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let to = AtPoints::Values(&mut v[b * D * nodes..]);
            evaluate(self.simd, mesh, of.block(velocity_at, b, mesh.len()), to, room);
        }
        for p in 0..nodes {
            for part in 0..Lanes::<S>::PARTS {
                let a = self.rows(area, D * D * nodes, p, part);
                let v = self.vector(v, D * nodes, p, part);
                for j in 0..D {
                    dot(&a[j], &v).store(grid_flux, D * nodes, j * nodes + p, part);
                }
            }
        }
    }

    /// sum_i d_i g_i at the nodes.
    #[inline(always)]
    fn divergence(&self, of: TimePointIndex, scratch: &mut GeometryScratch) {
        let (nodes, lattice) = (self.nodes(), self.flow(1));
        let GeometryScratch { grid_flux, divergence, room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let out = &mut divergence[(b * of.count + of.number) * nodes..];
            for axis in 0..D {
                let along = lattice.along(axis, &self.collocation.derivative);
                room.contract(self.simd, along, &grid_flux[(b * D + axis) * nodes..], out, axis > 0);
            }
        }
    }

    /// A and the velocity at the points: interpolated, or those at the nodes.
    #[inline(always)]
    fn vectors_to_points(&self, number: usize, scratch: &mut GeometryScratch) {
        let (nodes, len) = (self.nodes(), geometry_len(D) * self.nodes());
        let GeometryScratch { area, v, grid_flux, grid_flux_at_points, at_points, room, .. } = scratch;
        let at_points = &mut at_points[number * K::GEOMETRY_BLOCKS * len..];
        for b in 0..K::GEOMETRY_BLOCKS {
            let (to_area, to_v) = at_points[b * len..].split_at_mut(D * D * nodes);
            let area = &area[b * D * D * nodes..];
            evaluate(self.simd, self.flow(D * D), area, AtPoints::Values(to_area), room);
            if self.collocation.at_nodes {
                to_v[..D * nodes].copy_from_slice(&v[b * D * nodes..][..D * nodes]);
            } else {
                let to = AtPoints::Values(&mut grid_flux_at_points[b * D * nodes..]);
                evaluate(self.simd, self.flow(D), &grid_flux[b * D * nodes..], to, room);
            }
        }
        if !self.collocation.at_nodes {
            self.velocities_of_grid_flux(grid_flux_at_points, at_points);
        }
    }

    /// The velocity with A_i . v = g_i at the points.
    #[inline(always)]
    fn velocities_of_grid_flux(&self, grid_flux: &[Pack], at_points: &mut [Pack]) {
        let (nodes, len) = (self.nodes(), geometry_len(D) * self.nodes());
        for p in 0..nodes {
            for part in 0..Lanes::<S>::PARTS {
                let a = self.rows(at_points, len, p, part);
                let g = self.vector(grid_flux, D * nodes, p, part);
                let cof = cofactor(&a);
                let inverse = determinant(&a, &cof).recip();
                for d in 0..D {
                    let mut sum = cof[0][d] * g[0];
                    for j in 1..D {
                        sum += cof[j][d] * g[j];
                    }
                    (sum * inverse).store(at_points, len, (D * D + d) * nodes + p, part);
                }
            }
        }
    }

    /// (carried) at the nodes, at all instants.
    #[inline(always)]
    fn carry_determinant(&self, positions: &Matrix, bottom: &[Pack], scratch: &mut GeometryScratch) {
        let (nodes, count) = (self.nodes(), self.tables.instants.len());
        let GeometryScratch { divergence, determinant, .. } = scratch;
        for q in 0..count {
            for p in 0..nodes {
                for part in 0..Lanes::<S>::PARTS {
                    let at =
                        |r: usize| K::Geometry::<S>::load(self.simd, divergence, count * nodes, r * nodes + p, part);
                    let mut sum = at(0).constant(1.0).times(Lanes::read(self.simd, &bottom[p], part));
                    for r in 0..count {
                        // dt Phi_r(s_q); the first slot is the bottom position.
                        sum += at(r) * positions[(q, r + 1)];
                    }
                    sum.store(determinant, count * nodes, q * nodes + p, part);
                }
            }
        }
    }

    /// det dx/dxi at the nodes.
    #[inline(always)]
    fn determinants_of_map(&self, scratch: &mut GeometryScratch) {
        let nodes = self.nodes();
        let GeometryScratch { jacobian, determinant: out, .. } = scratch;
        for p in 0..nodes {
            for part in 0..Lanes::<S>::PARTS {
                let dx = self.rows(jacobian, D * D * nodes, p, part);
                let det = determinant(&dx, &cofactor(&dx));
                det.store(out, self.tables.instants.len() * nodes, p, part);
            }
        }
    }

    /// J at the points.
    #[inline(always)]
    fn determinant_to_points(&self, number: usize, scratch: &mut GeometryScratch) {
        let (nodes, count, len) = (self.nodes(), self.tables.instants.len(), geometry_len(D) * self.nodes());
        let GeometryScratch { determinant, at_points, room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let out = &mut at_points[(number * K::GEOMETRY_BLOCKS + b) * len + (D * D + D) * nodes..];
            let nodal = &determinant[(b * count + number) * nodes..];
            evaluate(self.simd, self.flow(1), nodal, AtPoints::Values(out), room);
        }
    }

    /// The matrix `[direction][d]` at a node, of `array[b][direction][d][i]` with blocks of a given length.
    #[inline(always)]
    fn rows(&self, array: &[Pack], block: usize, p: usize, part: usize) -> [[K::Geometry<S>; D]; D] {
        let nodes = self.nodes();
        let mut rows = [[K::Geometry::<S>::load(self.simd, array, block, p, part); D]; D];
        for j in 0..D {
            for d in 0..D {
                rows[j][d] = K::Geometry::<S>::load(self.simd, array, block, (j * D + d) * nodes + p, part);
            }
        }
        rows
    }

    /// The vector at a node, of `array[b][d][i]` with blocks of a given length.
    #[inline(always)]
    fn vector(&self, array: &[Pack], block: usize, p: usize, part: usize) -> [K::Geometry<S>; D] {
        let mut vector = [K::Geometry::<S>::load(self.simd, array, block, p, part); D];
        for d in 1..D {
            vector[d] = K::Geometry::<S>::load(self.simd, array, block, d * self.nodes() + p, part);
        }
        vector
    }
}
