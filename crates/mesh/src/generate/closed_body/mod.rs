//! An O-mesh around a closed blunt body.
//!
//! Let c(s) be the outline of the body, clockwise, with s its arc length as a fraction of the whole, n(s) its outer normal and C its
//! centroid. Let e(s) be the unit vector that turns uniformly with s, at angles whose mean difference from the normals is 0. With d the
//! distance from the wall and r the largest distance of the wall from C, points of the mesh are
//!
//! ```text
//! x(s, d) = (1 - w(d)) (c(s) + d n(s)) + w(d) (C + (r + d) e(s)),     0 <= d <= D = R - r                              (body)
//! w(d) = v(d) / v(D),     v(d) = d^2 / (L^2 + d^2)
//! ```
//!
//! w and its derivative vanish at d = 0: lines leave the wall at right angles. At d = D the points lie on the circle of radius R around
//! C.
//! The length L is one of a few candidates: the one with the best cells, see [`BodyLines`]. Every cell of the result is proved valid; nothing is
//! assumed about the shape of the body.

mod lines;
mod outline;
#[cfg(test)]
mod tests;

use super::ClosedCurve;
use super::assembly::Assembly;
use super::growth::{Check, Growth};
use crate::{Mesh, MeshError};
use lines::BodyLines;
use outline::Outline;

/// Cells between a closed curve and a circle around its centroid, growing by a constant factor outwards. Edges along the wall have equal
/// lengths. Boundaries are "wall" and "far".
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedBodyMesh {
    /// The wall.
    pub body: ClosedCurve,
    /// Radius of the far field.
    pub outer_radius: f64,
    /// Height of the cells at the wall.
    pub first_cell: f64,
    /// Cells around, at least 3, and from the wall to the far field.
    pub cells: [usize; 2],
    /// N, nodes per direction of the geometry.
    pub order: usize,
}

impl ClosedBodyMesh {
    /// The mesh.
    pub fn build(&self) -> Result<Mesh<2>, MeshError> {
        let outline = Outline::new(&self.body);
        let growth = self.growth(&outline)?;
        let lines = BodyLines::new(&outline, self.outer_radius);
        let parameters = outline.divided(self.cells[0]);
        let mut assembly = Assembly::new(self.order)?;
        assembly.add(self.cells, [None, None, Some("wall"), Some("far")], |[s, t]| {
            // Between the ends of a cell the parameter of the curve is linear in s, so that the cell is as smooth as the curve.
            let cell = (s as usize).min(self.cells[0] - 1);
            let fraction = s - cell as f64;
            let u = (1.0 - fraction) * parameters[cell] + fraction * parameters[cell + 1];
            lines.position(u, s / self.cells[0] as f64, growth.size(t))
        });
        assembly.build(&[])
    }

    fn growth(&self, outline: &Outline<'_>) -> Result<Growth, MeshError> {
        let check = Check { mesh: "closed body" };
        let width = self.outer_radius - outline.reach;
        // Rounding of a curve that encloses as much area clockwise as counter-clockwise.
        let area = outline.area_and_centroid().0;
        let least = 1e-9 * outline.length().powi(2);
        check.that(area > least, "the area within the points", area, "a closed curve that does not cross itself")?;
        check.positive("the radius of the far field", self.outer_radius)?;
        check.positive("the radius of the far field less the largest distance of the wall from its centroid", width)?;
        check.positive("the height of the first cell", self.first_cell)?;
        check.count("the number of cells outwards", self.cells[1])?;
        check.count("the number of cells around", self.cells[0])?;
        check.that(self.cells[0] >= 3, "the number of cells around", self.cells[0] as f64, "at least 3")?;
        let accepted = "less than the radius of the far field less the largest distance of the wall from its centroid";
        check.first_cell((self.cells[1], self.first_cell), width, accepted)?;
        Ok(Growth::new(self.cells[1], self.first_cell, width))
    }
}
