//! The map x(xi) of a cell and its Jacobian, in plain numbers: for set-up and for checks.

use crate::lattice::Lattice;
use crate::mesh::point;
use crate::{Mesh, MeshError};
use basis::{Lagrange, Matrix, gauss, gauss_lobatto};
use std::array::from_fn;
use tensor::{cofactor, determinant};

/// The map of cells of one order to a tensor grid of points:
///
/// ```text
/// x(xi) = sum_k x_k prod_a l_{k_a}(xi_a),     J_ij = d x_i / d xi_j                                         (map)
/// ```
#[derive(Clone, Debug)]
pub struct CellMap<const D: usize> {
    order: usize,
    /// l_k(xi_a), `[point][node]`, for each axis.
    values: [Matrix; D],
    /// l_k'(xi_a).
    derivatives: [Matrix; D],
}

impl<const D: usize> CellMap<D> {
    /// The map to the grid of all points whose reference coordinates along axis a are in `points[a]`.
    pub fn new(order: usize, points: [&[f64]; D]) -> Self {
        let lagrange = Lagrange::gauss_lobatto(order);
        let values = from_fn(|axis| lagrange.value_matrix(points[axis]));
        let derivatives = from_fn(|axis| lagrange.derivative_matrix(points[axis]));
        CellMap { order, values, derivatives }
    }

    /// The map to the grid with the same points along every axis.
    pub fn on_grid(order: usize, points: &[f64]) -> Self {
        Self::new(order, [points; D])
    }

    /// The map to one point.
    pub fn at(order: usize, xi: &[f64; D]) -> Self {
        Self::new(order, from_fn(|axis| &xi[axis..=axis]))
    }

    /// x at the points, axis 0 fastest; `nodes` are the positions of one cell, `[node][D]`.
    pub fn positions(&self, nodes: &[f64]) -> Vec<[f64; D]> {
        let x = self.apply(self.lattice(nodes), |axis| &self.values[axis]);
        (0..x.values.len() / D).map(|q| point(&x.values, q)).collect()
    }

    /// J at the points, axis 0 fastest.
    pub fn jacobians(&self, nodes: &[f64]) -> Vec<[[f64; D]; D]> {
        self.lattice_jacobians(self.lattice(nodes))
    }

    /// det J at the points, axis 0 fastest.
    pub fn determinants(&self, nodes: &[f64]) -> Vec<f64> {
        self.jacobians(nodes).iter().map(|m| determinant(m, &cofactor(m))).collect()
    }

    /// J at the points for positions with the axes (component, D axes of space, any further axes).
    pub(crate) fn lattice_jacobians(&self, positions: Lattice) -> Vec<[[f64; D]; D]> {
        let column = |j: usize| {
            let matrix = |axis: usize| if axis == j { &self.derivatives[axis] } else { &self.values[axis] };
            self.apply(positions.clone(), matrix).values
        };
        let columns: [Vec<f64>; D] = from_fn(column);
        (0..columns[0].len() / D).map(|q| from_fn(|i| from_fn(|j| columns[j][q * D + i]))).collect()
    }

    fn lattice(&self, nodes: &[f64]) -> Lattice {
        let shape = std::iter::once(D).chain([self.order; D]).collect();
        Lattice::new(shape, nodes.to_vec())
    }

    fn apply<'a>(&self, x: Lattice, matrix: impl Fn(usize) -> &'a Matrix) -> Lattice {
        (0..D).fold(x, |x, axis| x.apply(axis + 1, matrix(axis)))
    }
}

impl<const D: usize> Mesh<D> {
    /// The position of reference point `xi` of `cell`.
    pub fn position(&self, cell: usize, xi: &[f64; D]) -> [f64; D] {
        CellMap::at(self.order, xi).positions(self.cell_coordinates(cell))[0]
    }

    /// J_ij = d x_i / d xi_j at reference point `xi` of `cell`.
    pub fn jacobian(&self, cell: usize, xi: &[f64; D]) -> [[f64; D]; D] {
        CellMap::at(self.order, xi).jacobians(self.cell_coordinates(cell))[0]
    }

    /// Volume (area) and centroid of every cell, exact: det J has degree D (N-1) - 1 per direction, x det J N - 1 more.
    pub fn volumes_and_centroids(&self) -> Vec<(f64, [f64; D])> {
        let n = ((D + 1) * (self.order - 1)).div_ceil(2);
        let rule = gauss(n);
        let map = CellMap::on_grid(self.order, &rule.points);
        let weight = |q: usize| (0..D as u32).map(|axis| rule.weights[q / n.pow(axis) % n]).product::<f64>();
        let weights: Vec<f64> = (0..n.pow(D as u32)).map(weight).collect();
        (0..self.n_cells()).map(|cell| volume_and_centroid(&map, &weights, self.cell_coordinates(cell))).collect()
    }

    /// The volume (area) of the domain.
    pub fn volume(&self) -> f64 {
        self.volumes_and_centroids().iter().map(|(volume, _)| volume).sum()
    }

    /// The box along the axes that contains the nodes of `cell`: its lower and upper corner.
    pub fn cell_box(&self, cell: usize) -> ([f64; D], [f64; D]) {
        bounding_box(self.cell_coordinates(cell))
    }
}

/// V = int det J dxi and int x det J dxi / V.
fn volume_and_centroid<const D: usize>(map: &CellMap<D>, weights: &[f64], nodes: &[f64]) -> (f64, [f64; D]) {
    let (mut volume, mut moment) = (0.0, [0.0; D]);
    for ((w, x), det) in weights.iter().zip(map.positions(nodes)).zip(map.determinants(nodes)) {
        volume += w * det;
        for i in 0..D {
            moment[i] += w * det * x[i];
        }
    }
    (volume, moment.map(|m| m / volume))
}

/// The smallest box along the axes around the points of a `[point][D]` array.
pub(crate) fn bounding_box<const D: usize>(points: &[f64]) -> ([f64; D], [f64; D]) {
    let (mut lower, mut upper) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for x in points.chunks_exact(D) {
        for i in 0..D {
            lower[i] = lower[i].min(x[i]);
            upper[i] = upper[i].max(x[i]);
        }
    }
    (lower, upper)
}

/// The geometry of `mesh` at the Gauss-Lobatto nodes of another order.
pub(crate) fn interpolated_coordinates<const D: usize>(mesh: &Mesh<D>, order: usize) -> Vec<f64> {
    let map = CellMap::<D>::on_grid(mesh.order, &gauss_lobatto(order).points);
    (0..mesh.n_cells()).flat_map(|cell| map.positions(mesh.cell_coordinates(cell))).flatten().collect()
}

/// The error that names where a cell is inverted.
pub(crate) fn inverted<const D: usize>(mesh: &Mesh<D>, cell: usize, xi: &[f64; D], determinant: f64) -> MeshError {
    MeshError::Inverted { cell, reference: xi.to_vec(), position: mesh.position(cell, xi).to_vec(), determinant }
}
