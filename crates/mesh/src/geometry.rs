//! The map x(xi) of a cell and its Jacobian, in plain numbers: for set-up and for checks.

use crate::facet::{axis_and_side, outward_sign};
use crate::lattice::{Lattice, digit};
use crate::mesh::point;
use crate::periodic::{LAST_PLACES, TOLERANCE, last_place};
use crate::{Mesh, MeshError};
use basis::{Lagrange, Matrix, gauss, gauss_lobatto};
use std::array::from_fn;
use tensor::{det, norm};

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
    /// The map to a grid of points, with the reference coordinates `points[a]` along axis a.
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

    /// The map to the grid on `face` with the same points along every axis of the face.
    pub fn on_face(order: usize, face: usize, points: &[f64]) -> Self {
        let ((axis, _), end) = (axis_and_side(face), [outward_sign(face)]);
        Self::new(order, from_fn(|along| if along == axis { &end[..] } else { points }))
    }

    /// The map to one point.
    pub fn at(order: usize, xi: &[f64; D]) -> Self {
        Self::new(order, from_fn(|axis| &xi[axis..=axis]))
    }

    /// x at the points, axis 0 fastest; `nodes` are the positions of one cell, `[node][D]`.
    pub fn positions(&self, nodes: &[f64]) -> Vec<[f64; D]> {
        self.relative_positions(nodes).into_iter().map(|x| from_fn(|i| nodes[i] + x[i])).collect()
    }

    /// x - x_0 at the points, with the position x_0 of the first node: full accuracy at any distance from the origin.
    pub fn relative_positions(&self, nodes: &[f64]) -> Vec<[f64; D]> {
        let x = self.apply(self.lattice(nodes), |axis| &self.values[axis]);
        (0..x.values.len() / D).map(|q| point(&x.values, q)).collect()
    }

    /// J at the points, axis 0 fastest.
    pub fn jacobians(&self, nodes: &[f64]) -> Vec<[[f64; D]; D]> {
        self.lattice_jacobians(self.lattice(nodes))
    }

    /// det J at the points, axis 0 fastest.
    pub fn determinants(&self, nodes: &[f64]) -> Vec<f64> {
        self.jacobians(nodes).iter().map(det).collect()
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

    /// The positions relative to the first node: a common offset would cost digits of the derivatives.
    fn lattice(&self, nodes: &[f64]) -> Lattice {
        let shape = std::iter::once(D).chain([self.order; D]).collect();
        Lattice::new(shape, nodes.iter().enumerate().map(|(i, x)| x - nodes[i % D]).collect())
    }

    fn apply<'a>(&self, x: Lattice, matrix: impl Fn(usize) -> &'a Matrix) -> Lattice {
        (0..D).fold(x, |x, axis| x.apply(axis + 1, matrix(axis)))
    }
}

/// Positions are one if they are closer than this part of the extent of a cell. Even of 16 nodes in a row the first two are 0.016 apart.
const SAME_IN_CELL: f64 = 1e-4;

impl<const D: usize> Mesh<D> {
    /// The position of reference point `xi` of `cell`.
    pub fn position(&self, cell: usize, xi: &[f64; D]) -> [f64; D] {
        CellMap::at(self.order, xi).positions(self.cell_coordinates(cell))[0]
    }

    /// J_ij = d x_i / d xi_j at reference point `xi` of `cell`.
    pub fn jacobian(&self, cell: usize, xi: &[f64; D]) -> [[f64; D]; D] {
        CellMap::at(self.order, xi).jacobians(self.cell_coordinates(cell))[0]
    }

    /// Volume (area) and centroid of every cell, exact: det J has degree D (N-1) - 1 per direction, x det J has N - 1
    /// more.
    pub fn volumes_and_centroids(&self) -> Vec<(f64, [f64; D])> {
        let n = ((D + 1) * (self.order - 1)).div_ceil(2);
        let rule = gauss(n);
        let map = CellMap::on_grid(self.order, &rule.points);
        let weight = |q: usize| (0..D).map(|axis| rule.weights[digit(q, n, axis)]).product::<f64>();
        let weights: Vec<f64> = (0..n.pow(D as u32)).map(weight).collect();
        (0..self.n_cells()).map(|cell| volume_and_centroid(&map, &weights, self.cell_coordinates(cell))).collect()
    }

    /// The volume (area) of the domain.
    pub fn volume(&self) -> f64 {
        self.volumes_and_centroids().iter().map(|(volume, _)| volume).sum()
    }

    /// The aspect ratio of `cell`: the longest over the shortest of its [`Self::extents`].
    pub fn aspect_ratio(&self, cell: usize) -> f64 {
        let lengths = self.extents(cell);
        lengths.iter().fold(0.0, |m: f64, l| m.max(*l)) / lengths.iter().fold(f64::INFINITY, |m, l| m.min(*l))
    }

    /// The distances of the centres of opposite faces of `cell`, in any direction of space.
    pub fn extents(&self, cell: usize) -> [f64; D] {
        let centre = |axis: usize, side: f64| self.position(cell, &from_fn(|a| if a == axis { side } else { 0.0 }));
        let length = |axis: usize| {
            let (low, high) = (centre(axis, -1.0), centre(axis, 1.0));
            norm(&from_fn::<f64, D, _>(|i| high[i] - low[i]))
        };
        from_fn(length)
    }

    /// Positions that are closer than this are one: by the diameter of the mesh, since files have about ten digits, and by the smallest extent of
    /// a cell, where cells are thin. It is never below the rounding of coordinates.
    pub fn same_place(&self) -> f64 {
        let smallest = (0..self.n_cells()).flat_map(|cell| self.extents(cell)).fold(f64::INFINITY, f64::min);
        let rounding = LAST_PLACES * last_place::<D>(&self.coordinates);
        (TOLERANCE * self.diameter()).min(SAME_IN_CELL * smallest).max(rounding)
    }

    /// The box along the axes that contains the nodes of `cell`: its lower and upper corner.
    pub fn cell_box(&self, cell: usize) -> ([f64; D], [f64; D]) {
        bounding_box(self.cell_coordinates(cell))
    }
}

/// V = int det J dxi and int x det J dxi / V.
fn volume_and_centroid<const D: usize>(map: &CellMap<D>, weights: &[f64], nodes: &[f64]) -> (f64, [f64; D]) {
    let (mut volume, mut moment) = (0.0, [0.0; D]);
    for ((w, x), det) in weights.iter().zip(map.relative_positions(nodes)).zip(map.determinants(nodes)) {
        volume += w * det;
        for i in 0..D {
            moment[i] += w * det * x[i];
        }
    }
    (volume, from_fn(|i| nodes[i] + moment[i] / volume))
}

/// The smallest box along the axes around the points of a `[point][D]` array.
pub fn bounding_box<const D: usize>(points: &[f64]) -> ([f64; D], [f64; D]) {
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

/// The error that names the place where a cell is inverted.
pub(crate) fn inverted<const D: usize>(mesh: &Mesh<D>, cell: usize, xi: &[f64; D], determinant: f64) -> MeshError {
    MeshError::Inverted { cell, reference: xi.to_vec(), position: mesh.position(cell, xi).to_vec(), determinant }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::random::SplitMix64;
    use crate::{BoxMesh, Curving};

    fn curved<const D: usize>(order: usize, curving: Curving) -> Mesh<D> {
        BoxMesh { lower: [-1.0; D], upper: [1.0; D], cells: [2; D], order, curving, periodic: [false; D] }
            .build()
            .unwrap()
    }

    #[test]
    fn jacobian_is_the_derivative_of_the_position() {
        let mut random = SplitMix64::new(1);
        let mesh = curved::<3>(5, Curving::Wavy { amplitude: 0.04 });
        for cell in 0..mesh.n_cells() {
            let xi: [f64; 3] = from_fn(|_| 0.9 * random.symmetric());
            let jacobian = mesh.jacobian(cell, &xi);
            for j in 0..3 {
                let step = |h: f64| mesh.position(cell, &from_fn(|a| xi[a] + if a == j { h } else { 0.0 }));
                let (high, low) = (step(1e-5), step(-1e-5));
                for i in 0..3 {
                    assert!(((high[i] - low[i]) / 2e-5 - jacobian[i][j]).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn grids_agree_with_points() {
        let mesh = curved::<2>(4, Curving::Smooth { amplitude: 0.04 });
        let points = [-0.7, 0.1, 0.6];
        let map = CellMap::<2>::on_grid(4, &points);
        let (x, det) = (map.positions(mesh.cell_coordinates(3)), map.determinants(mesh.cell_coordinates(3)));
        for q in 0..9 {
            let xi = [points[q % 3], points[q / 3]];
            assert!((0..2).all(|i| (x[q][i] - mesh.position(3, &xi)[i]).abs() < 1e-14));
            let m = mesh.jacobian(3, &xi);
            assert!((det[q] - (m[0][0] * m[1][1] - m[0][1] * m[1][0])).abs() < 1e-14);
        }
    }

    /// The nodes of both boxes are exact, so their Jacobians must have the same bits. A common offset once cost six
    /// digits.
    #[test]
    fn jacobians_lose_nothing_far_from_the_origin() {
        let at = |lower: f64| -> Mesh<3> {
            let (curving, periodic) = (Curving::None, [false; 3]);
            BoxMesh { lower: [lower; 3], upper: [lower + 1.0; 3], cells: [2; 3], order: 3, curving, periodic }
                .build()
                .unwrap()
        };
        let (near, far) = (at(0.0), at(f64::from(1 << 20)));
        for cell in 0..near.n_cells() {
            let xi = [0.3, -0.7, 0.9];
            assert_eq!(near.jacobian(cell, &xi), far.jacobian(cell, &xi));
            assert_eq!(near.volumes_and_centroids()[cell].0, far.volumes_and_centroids()[cell].0);
        }
    }

    #[test]
    fn curving_inside_a_box_keeps_its_volume() {
        for curving in
            [Curving::None, Curving::Smooth { amplitude: 0.04 }, Curving::Random { amplitude: 0.04, seed: 2 }]
        {
            for order in [2, 3, 6] {
                assert!((curved::<2>(order, curving).volume() - 4.0).abs() < 1e-13);
                assert!((curved::<3>(order, curving).volume() - 8.0).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn aspect_ratio_of_a_brick() {
        let curving = Curving::None;
        let brick =
            BoxMesh { lower: [0.0; 3], upper: [2.0, 3.0, 9.0], cells: [2; 3], order: 3, curving, periodic: [false; 3] };
        assert!((brick.build().unwrap().scrambled(1).aspect_ratio(5) - 4.5).abs() < 1e-14);
    }

    /// Boxes around cells along the axes told 0.0714 for cells of 0.1 by 0.001 that lie across.
    #[test]
    fn extents_do_not_depend_on_the_direction_of_a_cell() {
        let c = 0.5_f64.sqrt();
        let turned = |[x, y]: [f64; 2]| [c * (x - y), c * (x + y)];
        let corners = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.001], [0.1, 0.001]].map(turned).concat();
        let sides = (0..4).map(|face| crate::Side { cell: 0, face }).collect();
        let mesh = Mesh::<2>::new(2, vec![0, 1, 2, 3], corners, vec![("wall".to_owned(), sides)], vec![]).unwrap();
        let [along, across] = mesh.extents(0);
        assert!((along - 0.1).abs() < 1e-15 && (across - 0.001).abs() < 1e-15, "{along} {across}");
    }

    #[test]
    fn volume_and_centroid_of_a_quadrilateral_by_hand() {
        // The trapezium (0,0) (3,0) (0,2) (1,2): area 4, centroid (13/12, 5/6).
        let coordinates = vec![0.0, 0.0, 3.0, 0.0, 0.0, 2.0, 1.0, 2.0];
        let sides = (0..4).map(|face| crate::Side { cell: 0, face }).collect();
        let mesh = Mesh::<2>::new(2, vec![0, 1, 2, 3], coordinates, vec![("wall".to_owned(), sides)], vec![]).unwrap();
        let (volume, centroid) = mesh.volumes_and_centroids()[0];
        assert!((volume - 4.0).abs() < 1e-14);
        assert!((centroid[0] - 13.0 / 12.0).abs() < 1e-14 && (centroid[1] - 5.0 / 6.0).abs() < 1e-14);
        assert_eq!(mesh.cell_box(0), ([0.0, 0.0], [3.0, 2.0]));
        assert_eq!(mesh.diameter(), 13.0_f64.sqrt());
    }

    #[test]
    fn a_higher_order_keeps_the_geometry() {
        let mesh = curved::<3>(3, Curving::Random { amplitude: 0.04, seed: 3 });
        let back = mesh.with_order(7).with_order(3);
        assert_eq!((mesh.with_order(7).order(), mesh.with_order(7).nodes_per_cell()), (7, 343));
        let distance =
            mesh.coordinates().iter().zip(back.coordinates()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(distance < 1e-14, "{distance}");
    }
}
