//! The quality of the cells of a mesh.

use mesh::{Mesh, ValidityCheck};

/// The cell with the smallest scaled Jacobian, and that value: 1 is undistorted, 0 degenerate.
pub(super) fn smallest_scaled_jacobian<const D: usize>(mesh: &Mesh<D>) -> (usize, f64) {
    let check = ValidityCheck::<D>::new(mesh.order(), &[0.0]);
    let scaled = |cell| check.bound(mesh.cell_coordinates(cell)).scaled_jacobian();
    let cells = (0..mesh.n_cells()).map(|cell| (cell, scaled(cell)));
    cells.fold((0, f64::INFINITY), |smallest, found| if found.1 < smallest.1 { found } else { smallest })
}

/// The mean position of the nodes of a cell.
pub(super) fn centre<const D: usize>(mesh: &Mesh<D>, cell: usize) -> [f64; D] {
    let nodes = mesh.cell_coordinates(cell);
    let count = nodes.len() / D;
    std::array::from_fn(|axis| nodes.iter().skip(axis).step_by(D).sum::<f64>() / count as f64)
}
