//! The value of a field at one point of a mesh.

use fem::functions_at;
use mesh::{Mesh, NodeNumbering};

/// A point of the mesh at rest, at which C0 fields are observed: d(x) = sum_k phi_k(x) d_k over the nodes of its cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    nodes: Vec<usize>,
    functions: Vec<f64>,
}

impl Observation {
    /// The point at `x`; `None` if it lies outside the mesh.
    pub fn new<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering, x: &[f64; D]) -> Option<Self> {
        let (cell, xi) = mesh.locate(x)?;
        let functions = functions_at(numbering.order(), &xi);
        Some(Observation { nodes: numbering.cell(cell).to_vec(), functions })
    }

    /// The value of a field `[C0 node][component]` at the point.
    pub fn value<const D: usize>(&self, field: &[f64]) -> [f64; D] {
        let terms = |i: usize| self.nodes.iter().zip(&self.functions).map(move |(node, phi)| phi * field[node * D + i]);
        std::array::from_fn(|i| terms(i).sum())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use mesh::{BoxMesh, Curving};

    #[test]
    fn a_field_of_the_space_is_observed_exactly() {
        let curving = Curving::Wavy { amplitude: 0.02 };
        let mesh =
            BoxMesh { lower: [0.0; 2], upper: [2.0, 1.0], cells: [3, 2], order: 4, curving, periodic: [false; 2] };
        let mesh = mesh.build().unwrap();
        let numbering = NodeNumbering::new(&mesh, 4);
        let mut field = vec![0.0; numbering.count * 2];
        for cell in 0..mesh.n_cells() {
            for (node, x) in numbering.cell(cell).iter().zip(mesh.cell_coordinates(cell).chunks_exact(2)) {
                (field[2 * node], field[2 * node + 1]) = (1.0 + x[0] - 3.0 * x[1], x[1]);
            }
        }
        let [a, b] = Observation::new(&mesh, &numbering, &[1.3, 0.4]).unwrap().value(&field);
        assert!((a - 1.1).abs() < 1e-9 && (b - 0.4).abs() < 1e-9, "{a}, {b}");
        assert_eq!(Observation::new(&mesh, &numbering, &[5.0, 0.4]), None);
    }
}
