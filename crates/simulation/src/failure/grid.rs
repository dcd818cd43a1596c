//! Cells on a grid of points that contains their corners, the centres of their faces and their centres.

use fem::Sampler;
use mesh::{CellMap, Mesh, NodeNumbering};

/// The grid, the same in every cell.
pub struct Grid<'a, const D: usize> {
    /// The mesh at rest.
    pub mesh: &'a Mesh<D>,
    numbering: &'a NodeNumbering,
    map: CellMap<D>,
    /// Values of flow and mesh at the points.
    pub sampler: Sampler<D>,
    /// Points per direction, an odd number.
    pub points: usize,
}

impl<'a, const D: usize> Grid<'a, D> {
    /// A grid that is finer than the nodes of the flow, if there is one, and of the mesh.
    pub fn new(mesh: &'a Mesh<D>, numbering: &'a NodeNumbering, flow_order: usize) -> Self {
        let order = mesh.order();
        let points = 2 * (flow_order.max(order) / 2) + 3;
        let line = basis::equidistant_points(points);
        Grid {
            mesh,
            numbering,
            map: CellMap::on_grid(order, &line),
            sampler: Sampler::new(flow_order, order, &line),
            points,
        }
    }

    /// Cells of the mesh.
    pub fn cells(&self) -> usize {
        self.mesh.n_cells()
    }

    /// The length of a field `[C0 node][component]`.
    pub fn field_len(&self) -> usize {
        D * self.numbering.count
    }

    /// A field `[C0 node][component]` at the nodes of a cell.
    fn on_cell(&self, cell: usize, field: &[f64]) -> Vec<f64> {
        self.numbering.cell(cell).iter().flat_map(|node| &field[node * D..(node + 1) * D]).copied().collect()
    }

    /// The nodes of a cell displaced by `d`.
    fn displaced(&self, cell: usize, d: &[f64]) -> Vec<f64> {
        let rest = self.mesh.cell_coordinates(cell);
        rest.iter().zip(self.on_cell(cell, d)).map(|(x, d)| x + d).collect()
    }

    /// A field `[C0 node][component]` at the points of a cell.
    pub fn vectors(&self, cell: usize, field: &[f64]) -> Vec<[f64; D]> {
        self.map.positions(&self.on_cell(cell, field))
    }

    /// The points of a cell displaced by `d`.
    pub fn positions(&self, cell: usize, d: &[f64]) -> Vec<[f64; D]> {
        self.map.positions(&self.displaced(cell, d))
    }

    /// dx/dxi at the points.
    pub fn jacobians(&self, cell: usize, d: &[f64]) -> Vec<[[f64; D]; D]> {
        self.map.jacobians(&self.displaced(cell, d))
    }

    /// det J / det J_0 at the points.
    pub fn volume_ratios(&self, cell: usize, d: &[f64]) -> Vec<f64> {
        let rest = self.map.determinants(self.mesh.cell_coordinates(cell));
        self.map.determinants(&self.displaced(cell, d)).iter().zip(rest).map(|(j, j_0)| j / j_0).collect()
    }

    /// The smallest over the largest det J in a cell at rest.
    pub fn evenness(&self, cell: usize) -> f64 {
        let rest = self.map.determinants(self.mesh.cell_coordinates(cell));
        let (smallest, largest) = rest.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), j| (a.min(*j), b.max(*j)));
        smallest / largest
    }

    /// The smallest distance between the centres of opposite faces.
    pub fn thickness(&self, cell: usize, d: &[f64]) -> f64 {
        let x = self.positions(cell, d);
        let stride = |axis: usize| self.points.pow(axis as u32);
        let middle = |axis: usize, side: usize| -> usize {
            let digit = |a: usize| if a == axis { side * (self.points - 1) } else { self.points / 2 };
            (0..D).map(|a| digit(a) * stride(a)).sum()
        };
        let distance = |axis: usize| tensor::norm(&difference(&x[middle(axis, 1)], &x[middle(axis, 0)]));
        (0..D).map(distance).fold(f64::INFINITY, f64::min)
    }

    /// The longest vector of the C0 field `path`, in thicknesses of its cell as displaced by `d`.
    pub fn longest_path(&self, path: &[f64], d: &[f64]) -> f64 {
        let of_cell = |cell: usize| {
            let longest = self.vectors(cell, path).iter().map(tensor::norm).fold(0.0, f64::max);
            longest / self.thickness(cell, d).max(f64::MIN_POSITIVE)
        };
        (0..self.cells()).map(of_cell).fold(0.0, f64::max)
    }
}

/// a - b
pub fn difference<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|i| a[i] - b[i])
}
