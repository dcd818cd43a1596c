//! The quality of the cells of a mesh.

use mesh::{CellMap, Mesh};
use tensor::{det, norm};

/// The least orthogonal cell, and its orthogonality: the smallest det J over the product of the lengths of the columns of J, at corners and centre.
/// It is 1 for a rectangular cell and 0 for a flat one. For quadrilaterals it is the sine of an angle.
pub(super) fn least_orthogonal<const D: usize>(mesh: &Mesh<D>) -> (usize, f64) {
    let map = CellMap::<D>::on_grid(mesh.order(), &[-1.0, 0.0, 1.0]);
    let of_cell = |cell: usize| {
        let jacobians = map.jacobians(mesh.cell_coordinates(cell));
        jacobians.iter().map(orthogonality).fold(f64::INFINITY, f64::min)
    };
    let cells = (0..mesh.n_cells()).map(|cell| (cell, of_cell(cell)));
    cells.fold((0, f64::INFINITY), |smallest, found| if found.1 < smallest.1 { found } else { smallest })
}

fn orthogonality<const D: usize>(jacobian: &[[f64; D]; D]) -> f64 {
    let length = |axis: usize| norm::<f64, D>(&std::array::from_fn(|i| jacobian[i][axis]));
    det(jacobian) / (0..D).map(length).product::<f64>()
}

/// The mean position of the nodes of a cell.
pub(super) fn centre<const D: usize>(mesh: &Mesh<D>, cell: usize) -> [f64; D] {
    let nodes = mesh.cell_coordinates(cell);
    let count = nodes.len() / D;
    std::array::from_fn(|axis| nodes.iter().skip(axis).step_by(D).sum::<f64>() / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns of lengths 2 and 3 at an angle of 30 degrees, and those of a box.
    #[test]
    fn a_skewed_cell_has_the_sine_of_its_angle() {
        let (cos, sin) = (0.75_f64.sqrt(), 0.5);
        assert!((orthogonality(&[[2.0, 3.0 * cos], [0.0, 3.0 * sin]]) - sin).abs() < 1e-15);
        assert_eq!(orthogonality(&[[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 0.1]]), 1.0);
    }
}
