//! The cells of many points.

use crate::opening_states::by_node;
use crate::stored_field::StoredField;
use basis::{Lagrange, Matrix, gauss};
use mesh::locate_in_cell;

/// Boxes are enlarged by this fraction of their extent, against rounding.
const MARGIN: f64 = 1e-6;

/// Finds the cells of points. A box around each cell excludes nearly all cells, before any equation is solved.
pub struct CellFinder<const D: usize> {
    order: usize,
    /// Positions of the nodes of every cell, `[node][component]`.
    nodes: Vec<Vec<f64>>,
    /// The lower and the upper corner of the box around every cell.
    boxes: Vec<[[f64; D]; 2]>,
}

impl<const D: usize> CellFinder<D> {
    /// The cells with these positions.
    pub fn new(positions: &StoredField<D>) -> Self {
        let (order, cells) = (positions.order(), 0..positions.cells());
        let to_legendre = to_legendre(order);
        let around = |cell: usize| enclosing::<D>(&to_legendre, positions.of_cell(cell));
        let boxes = cells.clone().map(around).collect();
        CellFinder { order, nodes: cells.map(|cell| by_node::<D>(positions.of_cell(cell))).collect(), boxes }
    }

    /// The first cell that contains `x`, boundary included, and the reference point there; `None` outside of the mesh.
    pub fn find(&self, x: &[f64; D]) -> Option<(usize, [f64; D])> {
        self.near(x).find_map(|cell| Some((cell, locate_in_cell(self.order, &self.nodes[cell], x)?)))
    }

    /// The cells whose box contains `x`.
    fn near(&self, x: &[f64; D]) -> impl Iterator<Item = usize> {
        let holds = |[lower, upper]: &[[f64; D]; 2]| (0..D).all(|i| lower[i] <= x[i] && x[i] <= upper[i]);
        self.boxes.iter().enumerate().filter(move |(_, corners)| holds(corners)).map(|(cell, _)| cell)
    }
}

/// A box that contains a cell with the positions `nodal`, `[component][node]`. With Legendre coefficients c_k of the positions
/// |x - c_0| <= sum_{k > 0} |c_k|, as no Legendre polynomial exceeds 1. For a cell with straight parallel edges the box is tight.
fn enclosing<const D: usize>(to_legendre: &Matrix, nodal: &[f64]) -> [[f64; D]; 2] {
    let nodes = nodal.len() / D;
    let mut corners = [[0.0; D]; 2];
    for (i, component) in nodal.chunks_exact(nodes).enumerate() {
        let modal = (0..D).fold(component.to_vec(), |values, axis| along_axis(to_legendre, &values, axis));
        let extent: f64 = (1.0 + MARGIN) * modal[1..].iter().map(|c| c.abs()).sum::<f64>();
        corners[0][i] = modal[0] - extent;
        corners[1][i] = modal[0] + extent;
    }
    corners
}

/// Applies a square matrix along an axis of a lattice of values, axis 0 fastest.
fn along_axis(matrix: &Matrix, values: &[f64], axis: usize) -> Vec<f64> {
    let (n, stride) = (matrix.rows(), matrix.rows().pow(axis as u32));
    let entry = |i: usize| {
        let row = i / stride % n;
        let first = i - row * stride;
        matrix.row(row).iter().enumerate().map(|(k, m)| m * values[first + k * stride]).sum()
    };
    (0..values.len()).map(entry).collect()
}

/// From values at Gauss-Lobatto nodes to Legendre coefficients, `[k][node]`: (2 k + 1) / 2 int l_node P_k, by a rule that is exact.
fn to_legendre(order: usize) -> Matrix {
    let rule = gauss(order);
    let values = Lagrange::gauss_lobatto(order).value_matrix(&rule.points);
    let legendre: Vec<Vec<f64>> = rule.points.iter().map(|&x| legendre_polynomials(order, x)).collect();
    Matrix::from_fn(order, order, |k, node| {
        let at = |q: usize| rule.weights[q] * legendre[q][k] * values.row(q)[node];
        (k as f64 + 0.5) * (0..order).map(at).sum::<f64>()
    })
}

/// P_0(x), P_1(x), ... by (k + 1) P_{k+1} = (2 k + 1) x P_k - k P_{k-1}.
fn legendre_polynomials(count: usize, x: f64) -> Vec<f64> {
    let mut p = vec![1.0, x];
    for k in 1..count.max(2) - 1 {
        let k_ = k as f64;
        p.push(((2.0 * k_ + 1.0) * x * p[k] - k_ * p[k - 1]) / (k_ + 1.0));
    }
    p
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use mesh::{BoxMesh, CellMap, Curving, Mesh};

    fn curved<const D: usize>() -> (Mesh<D>, CellFinder<D>) {
        let curving = Curving::Wavy { amplitude: 0.05 };
        let mesh = BoxMesh { lower: [0.0; D], upper: [1.0; D], cells: [4; D], order: 5, curving, periodic: [false; D] };
        let mesh = mesh.build().unwrap();
        let nodes = |cell| {
            let x = mesh.cell_coordinates(cell);
            (0..D).flat_map(move |i| x.iter().skip(i).step_by(D).copied())
        };
        let positions = StoredField::new(D, (0..mesh.n_cells()).flat_map(nodes).collect(), mesh.n_cells()).unwrap();
        let finder = CellFinder::new(&positions);
        (mesh, finder)
    }

    /// A search among all cells finds the same, and the boxes leave few cells: of each, fewer than the 2^D that meet at a corner.
    fn finds_what_the_mesh_finds<const D: usize>() {
        let (mesh, finder) = curved::<D>();
        let mut candidates = 0;
        for number in 0..200 {
            let x: [f64; D] = std::array::from_fn(|i| (0.37 + 0.618 * (number * (i + 1)) as f64).fract() * 1.1 - 0.05);
            assert_eq!(finder.find(&x), mesh.locate(&x), "{x:?}");
            candidates += finder.near(&x).count();
        }
        assert!(candidates < 200 << D, "{candidates} cells for 200 points");
    }

    #[test]
    fn points_are_in_the_first_cell_that_holds_them() {
        finds_what_the_mesh_finds::<2>();
        finds_what_the_mesh_finds::<3>();
    }

    /// A corner of the lattice of cells belongs to 2^D of them: the first counts.
    #[test]
    fn corners_of_cells_are_found() {
        let (mesh, finder) = curved::<2>();
        let corners = CellMap::<2>::on_grid(5, &[-1.0, 1.0]);
        for cell in 0..mesh.n_cells() {
            for x in corners.positions(mesh.cell_coordinates(cell)) {
                assert_eq!(finder.find(&x), mesh.locate(&x));
                assert!(finder.near(&x).any(|near| near == cell));
            }
        }
    }

    #[test]
    fn coefficients_of_a_polynomial_are_found() {
        let nodes = basis::gauss_lobatto(4).points;
        let values: Vec<f64> = nodes.iter().map(|x| 2.0 - x + 0.5 * (5.0 * x * x * x - 3.0 * x)).collect();
        let found = along_axis(&to_legendre(4), &values, 0);
        let expected = [2.0, -1.0, 0.0, 1.0];
        assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-14), "{found:?}");
    }
}
