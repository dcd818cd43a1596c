//! A passage of a blade row: one blade, periodic in the pitch.
//!
//! An O-block with lines normal to the blade, and around it a frame of 3 x 3 blocks without the middle one:
//!
//! ```text
//!            upper periodic line
//!       +---------+---------------+---------+
//!       |         |    above      |         |
//!       |         FU ----------- RU         |        F front, R rear; U upper, L lower corner of the O-block
//! inflow| before  |   (O-block)   |  after  | outflow
//!       |         FL ----------- RL         |
//!       |         |    below      |         |
//!       +---------+---------------+---------+
//!            lower periodic line
//! ```
//!
//! The frame is straight in the coordinates (x, Y) of [`shear`], in which the flow is along x. The periodic lines are Y
//! = -pitch/2 and +pitch/2. In these coordinates blocks are filled by transfinite interpolation of their sides and
//! smoothed ([`Harmonic`](super::smoothing::Harmonic)). The shear has determinant 1, so validity there implies validity
//! in (x, y).

mod around;
mod frame;
mod shear;
#[cfg(test)]
mod tests;

use super::assembly::Assembly;
use super::growth::{Check, Growth};
use super::{ClosedCurve, low_pressure_turbine_profile};
use crate::{Mesh, MeshError};
use around::Around;
use frame::Frame;
use shear::Shear;

/// A point of the plane.
type Point = [f64; 2];

/// A mesh around one blade of a row along y. Boundaries are "blade", "inflow" and "outflow".
#[derive(Clone, Debug, PartialEq)]
pub struct BladeMesh {
    /// The blade.
    pub profile: ClosedCurve,
    /// The distance of the blades, along y.
    pub pitch: f64,
    /// dy/dx of the flow that enters, and of the flow that leaves.
    pub slopes: [f64; 2],
    /// Distance of the inflow from the front of the O-block, and of the outflow from its rear, along x.
    pub distances: [f64; 2],
    /// Thickness of the O-block, less than the radius of curvature of every concave part of the blade.
    pub layer: f64,
    /// Height of the cells at the blade.
    pub first_cell: f64,
    /// The numbers of cells.
    pub cells: BladeCells,
    /// N, nodes per direction of the geometry.
    pub order: usize,
}

/// Numbers of cells of a [`BladeMesh`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BladeCells {
    /// Along each side of the blade, without its ends.
    pub side: usize,
    /// Around each end of the blade.
    pub end: usize,
    /// From the blade to the edge of the O-block.
    pub normal: usize,
    /// From the O-block to either periodic line.
    pub gap: usize,
    /// From the inflow to the O-block.
    pub before: usize,
    /// From the O-block to the outflow.
    pub after: usize,
}

impl BladeMesh {
    /// 744 cells around a low-pressure turbine blade of chord 1, see [`low_pressure_turbine_profile`].
    pub fn low_pressure_turbine(order: usize) -> Result<Self, MeshError> {
        Ok(BladeMesh {
            profile: low_pressure_turbine_profile()?,
            pitch: 0.798,
            slopes: [37.7_f64.to_radians().tan(), -63.2_f64.to_radians().tan()],
            distances: [0.6, 0.8],
            layer: 0.05,
            first_cell: 0.006,
            cells: BladeCells { side: 26, end: 6, normal: 4, gap: 4, before: 8, after: 12 },
            order,
        })
    }

    /// The mesh.
    pub fn build(&self) -> Result<Mesh<2>, MeshError> {
        let growth = self.check()?;
        let shear = Shear::new(self);
        let around = Around::new(self, &shear);
        let frame = Frame::new(self, &around, &shear);
        let mut assembly = Assembly::new(self.order)?;
        let rings = [around.corners[4], self.cells.normal];
        assembly.add(rings, [None, None, Some("blade"), None], |[s, t]| {
            shear.straightened(around.position(s, growth.size(t)))
        });
        for column in 0..3 {
            for row in (0..3).filter(|&row| (column, row) != (1, 1)) {
                frame.add_block(&mut assembly, column, row);
            }
        }
        assembly.smooth_from(rings[0] * rings[1]);
        assembly.map(|x| shear.bent(x));
        assembly.build(&[("upper", "lower", [0.0, -self.pitch])])
    }

    /// Checks the numbers and returns the growth of the cells of the O-block.
    fn check(&self) -> Result<Growth, MeshError> {
        let check = Check { mesh: "blade" };
        let BladeCells { side, end, normal, gap, before, after } = self.cells;
        for (quantity, value) in [
            ("the number of cells along a side", side),
            ("the number of cells around an end", end),
            ("the number of cells normal to the blade", normal),
            ("the number of cells beside the O-block", gap),
            ("the number of cells before the blade", before),
            ("the number of cells behind the blade", after),
        ] {
            check.count(quantity, value)?;
        }
        for (quantity, value) in [
            ("the pitch", self.pitch),
            ("the distance of the inflow", self.distances[0]),
            ("the distance of the outflow", self.distances[1]),
            ("the thickness of the O-block", self.layer),
            ("the height of the first cell", self.first_cell),
        ] {
            check.positive(quantity, value)?;
        }
        let steepest = self.slopes[0].abs().max(self.slopes[1].abs());
        check.that(steepest < 20.0, "the slope of the flow", steepest, "less than 20 (87 degrees)")?;
        check.first_cell((normal, self.first_cell), self.layer, "less than the layer")?;
        Ok(Growth::new(normal, self.first_cell, self.layer))
    }
}
