//! A cylinder across a channel.

use super::assembly::Assembly;
use super::growth::{Check, Growth};
use crate::{Mesh, MeshError};
use std::f64::consts::TAU;

/// The channel [0, L] x [0, H] without a circle: four blocks between the circle and the rectangle [0, 2 x_c] x [0, H], and one block from
/// there to the end. Boundaries are "inflow" (x = 0), "outflow" (x = L), "bottom", "top" and "cylinder". All nodes of the cylinder lie on
/// the circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelCylinderMesh {
    /// L and H.
    pub extent: [f64; 2],
    /// (x_c, y_c)
    pub centre: [f64; 2],
    /// Diameter of the circle.
    pub diameter: f64,
    /// Height of the cells at the cylinder, where it is nearest to the rectangle.
    pub first_cell: f64,
    /// Cells along the part of the cylinder that faces a side of the rectangle around it, which is also the number across the channel. Then cells
    /// from the cylinder outwards, and cells from the rectangle to the end.
    pub cells: [usize; 3],
    /// N, nodes per direction of the geometry.
    pub order: usize,
}

impl ChannelCylinderMesh {
    /// The mesh.
    pub fn build(&self) -> Result<Mesh<2>, MeshError> {
        let gap = self.gap()?;
        let [around, outwards, after] = self.cells;
        let growth = Growth::new(outwards, self.first_cell, gap);
        let part = |t: f64| growth.size(t) / gap;
        let ([length, height], end) = (self.extent, 2.0 * self.centre[0]);

        // Clockwise, so that axis 1 is on the left of axis 0.
        let corners = [[0.0, 0.0], [0.0, height], [end, height], [end, 0.0]];
        let names = [Some("inflow"), Some("top"), None, Some("bottom")];
        let mut assembly = Assembly::new(self.order)?;
        for (side, name) in names.into_iter().enumerate() {
            let ends = [corners[side], corners[(side + 1) % 4]];
            assembly.add([around, outwards], [None, None, Some("cylinder"), name], |[s, t]| {
                let (circle, rectangle) = self.ray(ends, s / around as f64);
                std::array::from_fn(|i| circle[i] + part(t) * (rectangle[i] - circle[i]))
            });
        }
        // The first cells after the rectangle are as long as the last ones before it.
        let last = (end - self.centre[0] - 0.5 * self.diameter) * (1.0 - part(outwards as f64 - 1.0));
        let downstream = Growth::new(after, last.min((length - end) / after as f64), length - end);
        let names = [None, Some("outflow"), Some("bottom"), Some("top")];
        assembly.add([after, around], names, |[s, t]| [end + downstream.size(s), height * (t / around as f64)]);
        assembly.build(&[])
    }

    /// The points on the circle and on the rectangle at the fraction `s` of the side between two of its corners.
    fn ray(&self, ends: [[f64; 2]; 2], s: f64) -> ([f64; 2], [f64; 2]) {
        let angle = |x: [f64; 2]| (x[1] - self.centre[1]).atan2(x[0] - self.centre[0]);
        let (from, to) = (angle(ends[0]), angle(ends[1]));
        let to = if to > from { to - TAU } else { to };
        let (sine, cosine) = (from + s * (to - from)).sin_cos();
        let radius = 0.5 * self.diameter;
        let circle = [self.centre[0] + radius * cosine, self.centre[1] + radius * sine];
        (circle, std::array::from_fn(|i| ends[0][i] * (1.0 - s) + ends[1][i] * s))
    }

    /// The distance from the cylinder to the rectangle.
    fn gap(&self) -> Result<f64, MeshError> {
        let check = Check { mesh: "channel with a cylinder" };
        let ([length, height], [x, y]) = (self.extent, self.centre);
        check.positive("the length", length)?;
        check.positive("the height", height)?;
        check.positive("the diameter", self.diameter)?;
        check.positive("the height of the first cell", self.first_cell)?;
        for (quantity, cells) in COUNTS.into_iter().zip(self.cells) {
            check.count(quantity, cells)?;
        }
        let radius = 0.5 * self.diameter;
        let (beside, above) = (x - radius, (y - radius).min(height - y - radius));
        let inside = "a place at which the cylinder touches neither walls nor inflow, and 2 x less than the length";
        check.that(beside > 0.0 && 2.0 * x < length, "x of the centre", x, inside)?;
        check.that(above > 0.0, "y of the centre", y, inside)?;
        let gap = beside.min(above);
        let accepted = "less than the distance from the cylinder to walls and inflow";
        check.first_cell((self.cells[1], self.first_cell), gap, accepted)?;
        Ok(gap)
    }
}

const COUNTS: [&str; 3] =
    ["the number of cells along a quarter", "the number of cells outwards", "the number of cells after"];

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::f64::consts::PI;

    /// The benchmark of Schäfer & Turek (1996).
    const BENCHMARK: ChannelCylinderMesh = ChannelCylinderMesh {
        extent: [2.2, 0.41],
        centre: [0.2, 0.2],
        diameter: 0.1,
        first_cell: 0.01,
        cells: [6, 5, 9],
        order: 5,
    };

    #[test]
    fn a_channel_with_a_hole() {
        let mesh = BENCHMARK.build().unwrap();
        assert_eq!((mesh.n_cells(), mesh.boundary_facets().len()), (4 * 30 + 54, 24 + 6 + 6 + 2 * 15));
        assert!((mesh.volume() / (2.2 * 0.41 - 0.0025 * PI) - 1.0).abs() < 1e-9);
        for facet in mesh.boundary_facets() {
            for [x, y] in mesh.face_positions(facet.side) {
                let distance = match &mesh.boundary_names()[facet.boundary][..] {
                    "inflow" => x,
                    "outflow" => x - 2.2,
                    "bottom" => y,
                    "top" => y - 0.41,
                    _ => (x - 0.2).hypot(y - 0.2) - 0.05,
                };
                assert!(distance.abs() < 1e-14, "{x} {y}");
            }
        }
    }

    #[test]
    fn impossible_channels_are_refused() {
        let refused = |mesh: ChannelCylinderMesh| mesh.build().unwrap_err().to_string();
        assert!(refused(ChannelCylinderMesh { diameter: 0.4, ..BENCHMARK }).contains("x of the centre"));
        assert!(refused(ChannelCylinderMesh { centre: [0.2, 0.4], ..BENCHMARK }).contains("y of the centre"));
        assert!(refused(ChannelCylinderMesh { centre: [1.2, 0.2], ..BENCHMARK }).contains("x of the centre"));
        assert!(refused(ChannelCylinderMesh { first_cell: 0.2, ..BENCHMARK }).contains("first cell"));
        assert!(refused(ChannelCylinderMesh { cells: [0, 5, 9], ..BENCHMARK }).contains("quarter"));
        assert!(refused(ChannelCylinderMesh { diameter: f64::NAN, ..BENCHMARK }).contains("diameter"));
    }
}
