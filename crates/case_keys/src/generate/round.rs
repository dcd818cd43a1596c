//! Meshes of layers around a closed body, and discs.

use super::one;
use crate::BodyPoints;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Cells between two circles, growing by a constant factor outwards.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AnnulusGenerator {
    /// The radius of the wall.
    pub inner_radius: f64,
    /// The radius of the far field.
    pub outer_radius: f64,
    /// The height of the cells at the wall. A single cell outwards fills the shell.
    pub first_cell: f64,
    /// Cells around, at least 3, and from the wall to the far field.
    pub cells: [usize; 2],
}

/// Cells between a smooth closed curve and a circle around its centroid, growing by a constant factor outwards. Edges along the wall have
/// equal lengths. Lines leave the wall at right angles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClosedBodyGenerator {
    /// The points of the wall, clockwise or counter-clockwise, 5 to 2000: a list of `[x, y]`, or a text file, relative to the case file. A
    /// periodic cubic spline goes through them; it rounds sharp corners. A file holds x and y of one point in each line, separated by
    /// commas, semicolons, tabs or blanks. Lines before the first point may be names; # begins a comment.
    pub points: BodyPoints,
    /// The radius of the far field, more than the largest distance of the wall from its centroid.
    pub outer_radius: f64,
    /// The height of the cells at the wall. A single cell outwards fills the shell.
    pub first_cell: f64,
    /// Cells around, at least 3, and from the wall to the far field.
    pub cells: [usize; 2],
}

/// Six patches of cells, like the faces of a cube, in layers that end on ellipsoids with the foci of the wall. Far away these tend to
/// spheres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EllipsoidGenerator {
    /// The semi-axes of the wall along x, y and z, in any ratio. Equal ones make a sphere; a short one along y makes a wing with rounded
    /// edges and tips.
    pub semi_axes: [f64; 3],
    /// The largest semi-axis of the far field.
    pub outer_radius: f64,
    /// The height of the cells at the wall, along the shortest semi-axis. Cells grow by a constant factor along it; along longer semi-axes
    /// the first ones are thinner. A single cell outwards fills the shell. Around a flat wall, a mesh of order 3 needs a factor below 3.
    pub first_cell: f64,
    /// Cells of the patches along x, y and z, and from the wall to the far field: 2 (x y + y z + z x) cells in each layer.
    pub cells: [usize; 4],
}

/// A rounded square in the middle of the disc and four blocks around it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscGenerator {
    /// The radius of the circle.
    #[serde(default = "one")]
    pub radius: f64,
    /// Cells along a side of the middle block, a quarter of the number around.
    pub core_cells: usize,
    /// Cells from the middle block to the circle.
    pub radial_cells: usize,
}
