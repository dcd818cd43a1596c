//! The control volumes of the nodes of a cell, and the map of the cell at their faces.

use crate::moving_mesh::MovingMesh;
use crate::tables::Orders;
use basis::{AllAxes, Lagrange, Matrix, apply_all_axes, gauss_lobatto, scratch_length};
use tensor::pulp::{Simd, WithSimd};
use tensor::{Arch, Pack, cofactor, determinant, zeroed};

/// One-dimensional tables of the control volumes.
#[derive(Clone)]
pub(crate) struct SubCells {
    /// Nodes of a line of the flow.
    order: usize,
    weights: Vec<f64>,
    /// Distances of neighbouring nodes in the reference cell.
    distances: Vec<f64>,
    /// The nodes on every face of a cell.
    face_nodes: Vec<Vec<usize>>,
    /// Mesh polynomials at the nodes: values and derivatives.
    at_nodes: [Matrix; 2],
    /// The same at the ends of the control volumes.
    at_faces: [Matrix; 2],
}

impl SubCells {
    pub(crate) fn new<const D: usize>(orders: Orders) -> Self {
        let (rule, geometry) = (gauss_lobatto(orders.flow), Lagrange::gauss_lobatto(orders.mesh));
        let mut ends = vec![-1.0];
        ends.extend(rule.weights.iter().scan(-1.0, |end, w| {
            *end += w;
            Some(*end)
        }));
        ends[orders.flow] = 1.0;
        SubCells {
            order: orders.flow,
            face_nodes: (0..2 * D).map(|face| mesh::face_nodes(D, orders.flow, face)).collect(),
            distances: rule.points.windows(2).map(|pair| pair[1] - pair[0]).collect(),
            at_nodes: [geometry.value_matrix(&rule.points), geometry.derivative_matrix(&rule.points)],
            at_faces: [geometry.value_matrix(&ends), geometry.derivative_matrix(&ends)],
            weights: rule.weights,
        }
    }

    /// The product of the weights of `node` along all `D` axes but `without`.
    pub(crate) fn weight<const D: usize>(&self, node: usize, without: Option<usize>) -> f64 {
        let along = |axis: usize| self.weights[node / self.order.pow(axis as u32) % self.order];
        (0..D).filter(|axis| Some(*axis) != without).map(along).product()
    }

    /// The nodes on `face` of a cell, in its lattice.
    pub(crate) fn face_nodes(&self, face: usize) -> &[usize] {
        &self.face_nodes[face]
    }

    /// The distance of node `i` of a line to the next, in the reference cell.
    pub(crate) fn distance(&self, i: usize) -> f64 {
        self.distances[i]
    }

    /// The face of the control volume of `node` on `side` (0 low, 1 high) of `axis`, among the points of
    /// [`CellMap::evaluate_faces`].
    pub(crate) fn face_point(&self, node: usize, axis: usize, side: usize) -> usize {
        let (n, stride) = (self.order, self.order.pow(axis as u32));
        let (inner, i, outer) = (node % stride, node / stride % n, node / stride / n);
        inner + stride * (i + side + (n + 1) * outer)
    }
}

/// Position, velocity and derivatives of the position of a cell at points. Lanes hold the components: position first, then velocity.
pub(crate) struct CellMap {
    /// Nodal values.
    nodal: Vec<Pack>,
    /// At the points: values, and derivatives along each axis.
    values: Vec<Pack>,
    derivatives: [Vec<Pack>; 3],
    room: Vec<Pack>,
    origin: [f64; 3],
    arch: Arch,
}

impl CellMap {
    pub(crate) fn new<const D: usize>(sub_cells: &SubCells) -> Self {
        let [values, _] = &sub_cells.at_faces;
        let (points, nodes) = (values.rows().pow(D as u32), values.cols().pow(D as u32));
        let room = scratch_length(&[values; D], 1);
        let at_points = || zeroed(points);
        CellMap {
            nodal: zeroed(nodes),
            values: at_points(),
            derivatives: [at_points(), at_points(), at_points()],
            room: zeroed(room),
            origin: [0.0; 3],
            arch: Arch::new(),
        }
    }

    /// Takes position and velocity of `cell` by the weights of their `slots`.
    pub(crate) fn place<const D: usize>(&mut self, mesh: &MovingMesh, cell: usize, slots: &[Vec<f64>; 2]) {
        let nodes = self.nodal.len();
        let mut coordinates = vec![0.0; D * nodes];
        for (number, slots) in slots.iter().enumerate() {
            mesh.relative_positions(cell, slots, &mut coordinates);
            for (i, value) in coordinates.iter().enumerate() {
                self.nodal[i % nodes].0[number * D + i / nodes] = *value;
            }
        }
        self.origin[..D].copy_from_slice(mesh.origin(cell));
    }

    /// Evaluates at the nodes of the flow.
    pub(crate) fn evaluate_nodes<const D: usize>(&mut self, sub_cells: &SubCells) {
        self.evaluate::<D>([&sub_cells.at_nodes; D]);
    }

    /// Evaluates at the faces across `axis` of all control volumes.
    pub(crate) fn evaluate_faces<const D: usize>(&mut self, sub_cells: &SubCells, axis: usize) {
        let mut tables = [&sub_cells.at_nodes; D];
        tables[axis] = &sub_cells.at_faces;
        self.evaluate::<D>(tables);
    }

    fn evaluate<const D: usize>(&mut self, tables: [&[Matrix; 2]; D]) {
        let CellMap { nodal, values, derivatives, room, arch, .. } = self;
        for axis in 0..=D {
            let kind = |of: usize| usize::from(of == axis);
            let mut matrices = [&tables[0][0]; D];
            (0..D).for_each(|of| matrices[of] = &tables[of][kind(of)]);
            let out = if axis == D { &mut values[..] } else { &mut derivatives[axis][..] };
            arch.dispatch(Evaluate { matrices: &matrices, nodal, out, room });
        }
    }

    /// The area vector S of `axis` at a point, the cofactors of dx/dxi_axis, and det dx/dxi.
    pub(crate) fn area<const D: usize>(&self, point: usize, axis: usize) -> ([f64; D], f64) {
        let mut dx = [[0.0; D]; D];
        for (i, row) in dx.iter_mut().enumerate() {
            (0..D).for_each(|j| row[j] = self.derivatives[j][point].0[i]);
        }
        let cofactors = cofactor(&dx);
        (std::array::from_fn(|d| cofactors[d][axis]), determinant(&dx, &cofactors))
    }

    /// The velocity of the mesh at a point.
    pub(crate) fn velocity<const D: usize>(&self, point: usize) -> [f64; D] {
        std::array::from_fn(|d| self.values[point].0[D + d])
    }

    /// The position of a point in space.
    pub(crate) fn position<const D: usize>(&self, point: usize) -> [f64; D] {
        std::array::from_fn(|d| self.origin[d] + self.values[point].0[d])
    }
}

struct Evaluate<'a> {
    matrices: &'a [&'a Matrix],
    nodal: &'a [Pack],
    out: &'a mut [Pack],
    room: &'a mut [Pack],
}

impl WithSimd for Evaluate<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let axes = AllAxes { matrices: self.matrices, components: 1 };
        apply_all_axes(simd, axes, self.nodal, self.out, self.room, false);
    }
}
