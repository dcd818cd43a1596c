//! An O-mesh between two circles.

use super::assembly::Assembly;
use super::growth::{Check, Growth};
use crate::{Mesh, MeshError};
use std::f64::consts::TAU;

/// Cells between two circles around the origin, growing by a constant factor from the inner one outwards. All nodes lie
/// on circles. Boundaries are "wall" (inner) and "far" (outer).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnnulusMesh {
    /// Radius of the wall.
    pub inner_radius: f64,
    /// Radius of the far field.
    pub outer_radius: f64,
    /// Height of the cells at the wall.
    pub first_cell: f64,
    /// Cells around, at least 3, and from the wall to the far field.
    pub cells: [usize; 2],
    /// N, nodes per direction of the geometry.
    pub order: usize,
}

impl AnnulusMesh {
    /// The mesh.
    pub fn build(&self) -> Result<Mesh<2>, MeshError> {
        let growth = self.growth()?;
        let mut assembly = Assembly::new(self.order)?;
        assembly.add(self.cells, [None, None, Some("wall"), Some("far")], |[s, t]| {
            self.position(s, self.inner_radius + growth.size(t))
        });
        assembly.build(&[])
    }

    /// The point on the circle of radius r after s cells, clockwise, so that axis 1 is on the left of axis 0.
    fn position(&self, s: f64, r: f64) -> [f64; 2] {
        let angle = TAU * s / self.cells[0] as f64;
        [r * angle.cos(), -r * angle.sin()]
    }

    fn growth(&self) -> Result<Growth, MeshError> {
        let check = Check { mesh: "annulus" };
        let width = self.outer_radius - self.inner_radius;
        check.positive("the radius of the wall", self.inner_radius)?;
        check.positive("the radius of the far field less that of the wall", width)?;
        check.positive("the height of the first cell", self.first_cell)?;
        check.count("the number of cells outwards", self.cells[1])?;
        check.count("the number of cells around", self.cells[0])?;
        check.that(self.cells[0] >= 3, "the number of cells around", self.cells[0] as f64, "at least 3")?;
        check.first_cell((self.cells[1], self.first_cell), width, "less than the width")?;
        Ok(Growth::new(self.cells[1], self.first_cell, width))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::f64::consts::PI;

    const CYLINDER: AnnulusMesh =
        AnnulusMesh { inner_radius: 0.5, outer_radius: 50.0, first_cell: 0.02, cells: [24, 14], order: 4 };

    #[test]
    fn nodes_of_the_boundaries_lie_on_circles() {
        for order in 2..=8 {
            let mesh = AnnulusMesh { order, ..CYLINDER }.build().unwrap();
            assert_eq!((mesh.n_cells(), mesh.boundary_facets().len()), (24 * 14, 48));
            assert_eq!(mesh.interior_facets().len(), 24 * 14 + 24 * 13);
            for facet in mesh.boundary_facets() {
                let radius = if mesh.boundary_names()[facet.boundary] == "wall" { 0.5 } else { 50.0 };
                for x in mesh.face_positions(facet.side) {
                    assert!((x[0].hypot(x[1]) / radius - 1.0).abs() < 1e-14);
                }
            }
        }
    }

    /// The area within the polynomial arc of N nodes has the error of its nodes squared.
    #[test]
    fn the_area_converges_with_the_order() {
        let exact = PI * (50.0 * 50.0 - 0.25);
        let error = |order| (AnnulusMesh { order, ..CYLINDER }.build().unwrap().volume() / exact - 1.0).abs();
        assert!(
            error(2) > 1e-3 && error(3) < 1e-4 && error(4) < 1e-6 && error(6) < 1e-10,
            "{:e} {:e}",
            error(3),
            error(4)
        );
    }

    #[test]
    fn the_first_cell_has_its_height_and_cells_grow() {
        let mesh = CYLINDER.build().unwrap();
        let x = mesh.position(0, &[-1.0, 1.0]);
        assert!((x[0].hypot(x[1]) - 0.52).abs() < 1e-14);
        let factor = CYLINDER.growth().unwrap().factor();
        let x = mesh.position(24, &[-1.0, 1.0]);
        assert!((x[0].hypot(x[1]) - 0.52 - 0.02 * factor).abs() < 1e-13);
    }

    #[test]
    fn thin_cells_are_valid() {
        let thin = AnnulusMesh { first_cell: 1e-5, cells: [48, 30], order: 8, ..CYLINDER };
        assert!(thin.build().is_ok());
    }

    #[test]
    fn impossible_annuli_are_refused() {
        let refused = |mesh: AnnulusMesh| mesh.build().unwrap_err().to_string();
        assert!(refused(AnnulusMesh { outer_radius: 0.4, ..CYLINDER }).contains("far field"));
        assert!(refused(AnnulusMesh { first_cell: f64::NAN, ..CYLINDER }).contains("NaN"));
        assert!(refused(AnnulusMesh { first_cell: 60.0, ..CYLINDER }).contains("less than the width"));
        let gap = CYLINDER.outer_radius - CYLINDER.inner_radius;
        assert!(refused(AnnulusMesh { first_cell: gap, ..CYLINDER }).contains("less than the width"));
        assert!(AnnulusMesh { first_cell: gap, cells: [24, 1], ..CYLINDER }.build().is_ok());
        assert!(refused(AnnulusMesh { cells: [2, 3], ..CYLINDER }).contains("around is 2"));
        assert!(refused(AnnulusMesh { cells: [8, 0], ..CYLINDER }).contains("outwards is 0"));
    }
}
