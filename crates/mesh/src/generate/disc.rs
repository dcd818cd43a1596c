//! The inside of a circle, in five blocks.

use super::assembly::Assembly;
use super::growth::Check;
use crate::{Mesh, MeshError};
use std::array::from_fn;
use std::f64::consts::FRAC_PI_4;

/// Side of the middle block, measured to its corners, as a fraction of the radius.
const CORE: f64 = 0.5;

/// The roundness of the middle block: 0 a square, 1 a circle.
const ROUNDNESS: f64 = 0.4;

/// The disc of radius `radius` around the origin: a rounded square in the middle and four blocks around it
/// ("butterfly"). The nodes of the boundary, "wall", lie on the circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscMesh {
    /// Radius of the circle.
    pub radius: f64,
    /// Cells along a side of the middle block, which is a quarter of the number around.
    pub core_cells: usize,
    /// Cells from the middle block to the circle.
    pub radial_cells: usize,
    /// N, nodes per direction of the geometry.
    pub order: usize,
}

impl DiscMesh {
    /// The mesh.
    pub fn build(&self) -> Result<Mesh<2>, MeshError> {
        let check = Check { mesh: "disc" };
        check.positive("the radius", self.radius)?;
        check.count("the number of cells along the middle block", self.core_cells)?;
        check.count("the number of cells outwards", self.radial_cells)?;
        let mut assembly = Assembly::new(self.order)?;
        // Index coordinates of a side of the middle block to [-1, 1].
        let along = |s: f64| 2.0 * s / self.core_cells as f64 - 1.0;
        assembly.add([self.core_cells; 2], [None; 4], |[s, t]| self.core(along(s), along(t)));
        for quarter in 0..4 {
            let cells = [self.radial_cells, self.core_cells];
            assembly.add(cells, [None, Some("wall"), None, None], |[s, t]| {
                turned(self.petal(s / self.radial_cells as f64, along(t)), quarter)
            });
        }
        assembly.build(&[])
    }

    /// The middle block: (a, b) in [-1, 1]^2 to a square with rounded sides.
    fn core(&self, a: f64, b: f64) -> [f64; 2] {
        let corner = (1.0 - 0.5 * ROUNDNESS).sqrt();
        let bulge = |c: f64| (1.0 - 0.5 * ROUNDNESS * c * c).sqrt();
        // Corners at distance CORE * radius from the centre.
        let scale = CORE * self.radius * std::f64::consts::FRAC_1_SQRT_2 / corner;
        [scale * a * bulge(b), scale * b * bulge(a)]
    }

    /// The block on the right: r from 0, the middle block, to 1, the circle; b in [-1, 1] counter-clockwise.
    fn petal(&self, r: f64, b: f64) -> [f64; 2] {
        let inner = self.core(1.0, b);
        let angle = FRAC_PI_4 * b;
        let outer = [self.radius * angle.cos(), self.radius * angle.sin()];
        from_fn(|i| (1.0 - r) * inner[i] + r * outer[i])
    }
}

/// x turned by `quarters` right angles counter-clockwise, exactly.
fn turned(x: [f64; 2], quarters: usize) -> [f64; 2] {
    (0..quarters).fold(x, |[x, y], _| [-y, x])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::f64::consts::PI;

    fn disc(order: usize) -> DiscMesh {
        DiscMesh { radius: 0.5, core_cells: 4, radial_cells: 3, order }
    }

    #[test]
    fn the_wall_is_the_circle_and_the_area_that_of_the_disc() {
        let mut last = f64::INFINITY;
        for order in 2..=8 {
            let mesh = disc(order).build().unwrap();
            assert_eq!((mesh.n_cells(), mesh.boundary_facets().len()), (16 + 48, 16));
            for facet in mesh.boundary_facets() {
                for x in mesh.face_positions(facet.side) {
                    assert!((x[0].hypot(x[1]) - 0.5).abs() < 1e-15);
                }
            }
            let error = (mesh.volume() / (0.25 * PI) - 1.0).abs();
            assert!(error < 0.1 * last || error < 1e-14, "{order} {error:e}");
            last = error;
        }
        assert!(last < 1e-13);
    }

    #[test]
    fn no_cell_is_strongly_deformed() {
        let mesh = DiscMesh { core_cells: 8, radial_cells: 6, ..disc(5) }.build().unwrap();
        let check = crate::ValidityCheck::<2>::new(5, &[0.0]);
        let answers = check.decide_cells(mesh.n_cells(), |cell, x| x.copy_from_slice(mesh.cell_coordinates(cell)));
        let worst = answers.iter().map(|answer| answer.bound().scaled_jacobian()).fold(1.0, f64::min);
        assert!(worst > 0.5, "{worst}");
    }

    #[test]
    fn impossible_discs_are_refused() {
        let error = DiscMesh { radius: -1.0, ..disc(3) }.build().unwrap_err();
        assert_eq!(error.to_string(), "disc mesh: the radius is -1, expected a positive number");
        assert!(DiscMesh { radial_cells: 0, ..disc(3) }.build().is_err());
    }
}
