//! A square with a square hole in its middle.

use super::assembly::Assembly;
use super::growth::Check;
use crate::{Mesh, MeshError};

/// The square [-side/2, side/2]^2 without the centred square of side `hole`, in square cells of equal size. Boundaries
/// are "inner" and "outer".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotatingBoxMesh {
    /// Side of the domain.
    pub side: f64,
    /// Side of the hole.
    pub hole: f64,
    /// Cells along a side of the domain. The hole must take a whole number of them, with equally many on each side.
    pub cells_per_side: usize,
    /// N, nodes per direction of the geometry.
    pub order: usize,
}

impl RotatingBoxMesh {
    /// The unit square with a hole of side 0.2: `cells_per_side` is a multiple of 5.
    pub fn unit(cells_per_side: usize, order: usize) -> Self {
        RotatingBoxMesh { side: 1.0, hole: 0.2, cells_per_side, order }
    }

    /// The mesh: 3 x 3 blocks without the middle one.
    pub fn build(&self) -> Result<Mesh<2>, MeshError> {
        let margin = self.cells_beside_hole()?;
        let n = self.cells_per_side;
        let (starts, cells) = ([0, margin, n - margin], [margin, n - 2 * margin, margin]);
        let mut assembly = Assembly::new(self.order)?;
        for (i, j) in (0..9).map(|block| (block % 3, block / 3)).filter(|&block| block != (1, 1)) {
            let name = |k: usize, other: usize, side: usize| match k {
                1 => None,
                _ if side == k / 2 => Some("outer"),
                _ if other == 1 => Some("inner"),
                _ => None,
            };
            let names = [name(i, j, 0), name(i, j, 1), name(j, i, 0), name(j, i, 1)];
            let place = |t: f64| self.side * (t / n as f64 - 0.5);
            let position = |[s, t]: [f64; 2]| [place(starts[i] as f64 + s), place(starts[j] as f64 + t)];
            assembly.add([cells[i], cells[j]], names, position);
        }
        assembly.build(&[])
    }

    fn cells_beside_hole(&self) -> Result<usize, MeshError> {
        let check = Check { mesh: "rotating box" };
        let n = self.cells_per_side;
        check.positive("the side", self.side)?;
        check.positive("the side of the hole", self.hole)?;
        check.that(self.hole < self.side, "the side of the hole", self.hole, "less than the side of the domain")?;
        check.count("the number of cells per side", n)?;
        let margin = 0.5 * n as f64 * (1.0 - self.hole / self.side);
        let whole = (margin - margin.round()).abs() < 1e-9 && 2 * (margin.round() as usize) < n && margin > 0.5;
        let accepted = "a number that puts the sides of the hole on lines of cells (multiples of 5 for 0.2 of 1)";
        check.that(whole, "the number of cells per side", n as f64, accepted)?;
        Ok(margin.round() as usize)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_meshes_of_80_nodes_per_side() {
        for (order, cells_per_side, cells) in [(2, 40, 1536), (4, 20, 384), (8, 10, 96)] {
            let mesh = RotatingBoxMesh::unit(cells_per_side, order).build().unwrap();
            assert_eq!((mesh.n_cells(), mesh.order()), (cells, order));
            assert!((mesh.volume() - 0.96).abs() < 1e-13);
            let mut names = mesh.boundary_names().to_vec();
            names.sort();
            assert_eq!(names, ["inner", "outer"]);
            for facet in mesh.boundary_facets() {
                let side = if mesh.boundary_names()[facet.boundary] == "inner" { 0.1 } else { 0.5 };
                for x in mesh.face_positions(facet.side) {
                    assert!((x[0].abs().max(x[1].abs()) - side).abs() < 1e-15, "{x:?}");
                }
            }
            assert_eq!(mesh.boundary_facets().len(), 4 * cells_per_side + 4 * cells_per_side / 5);
        }
    }

    #[test]
    fn cells_that_miss_the_hole_are_refused() {
        for cells_per_side in [0, 1, 7, 12] {
            let error = RotatingBoxMesh::unit(cells_per_side, 3).build().unwrap_err();
            assert!(matches!(error, MeshError::Parameter { quantity: "the number of cells per side", .. }), "{error}");
        }
        let error = RotatingBoxMesh { hole: 1.5, ..RotatingBoxMesh::unit(10, 3) }.build().unwrap_err();
        assert!(error.to_string().contains("hole is 1.5"), "{error}");
        assert_eq!(RotatingBoxMesh::unit(10, 17).build().unwrap_err(), MeshError::Order { order: 17 });
    }
}
