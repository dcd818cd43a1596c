//! The mesh as the files of a run need it.

use mesh::{Mesh, NodeNumbering};
use std::ops::Range;

/// The mesh as the recorder needs it: C0 nodes per cell and reference positions `[cell][component][node]`.
pub struct MeshView<const D: usize> {
    pub(super) cells: Vec<Vec<usize>>,
    pub(super) positions: Vec<Vec<f64>>,
}

impl<const D: usize> MeshView<D> {
    /// The view of `mesh` and its nodes.
    pub fn new(mesh: &Mesh<D>, numbering: &NodeNumbering) -> Self {
        let cells = 0..mesh.n_cells();
        let transposed = |cell| {
            let nodes = mesh.cell_coordinates(cell);
            (0..D).flat_map(|d| nodes.iter().skip(d).step_by(D).copied()).collect()
        };
        MeshView {
            cells: cells.clone().map(|cell| numbering.cell(cell).to_vec()).collect(),
            positions: cells.map(transposed).collect(),
        }
    }

    /// A C0 field `[C0 node][component]` on `cell`, `[component][node]`.
    pub(super) fn on_cell(&self, cell: usize, field: &[f64]) -> Vec<f64> {
        (0..D).flat_map(|d| self.cells[cell].iter().map(move |node| field[node * D + d])).collect()
    }

    /// Positions of the nodes of `cell`, displaced by `d`.
    pub(super) fn displaced(&self, cell: usize, d: &[f64]) -> Vec<f64> {
        let displacement = self.on_cell(cell, d);
        self.positions[cell].iter().zip(displacement).map(|(x, d)| x + d).collect()
    }

    /// Positions of the nodes of all cells, displaced by `d`.
    pub(super) fn all_displaced(&self, d: &[f64]) -> Vec<f64> {
        (0..self.cells.len()).flat_map(|cell| self.displaced(cell, d)).collect()
    }
}

/// Positions `[cell][component][node]` and velocities `[cell][time node][component][node]` of `cells`.
pub(super) fn exact_mesh<const D: usize>(
    mesh: &MeshView<D>,
    cells: Range<usize>,
    displacement: &[f64],
    velocities: &[f64],
) -> [Vec<f64>; 2] {
    let fields = || velocities.chunks_exact(displacement.len());
    let positions = cells.clone().flat_map(|cell| mesh.displaced(cell, displacement)).collect();
    let velocities = cells.flat_map(|cell| fields().flat_map(move |field| mesh.on_cell(cell, field))).collect();
    [positions, velocities]
}
