//! Channels.

use super::one;
use mesh::generate::ChannelFlagMesh;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The channel [0, L_x] x [0, L_y], in three dimensions x [0, L_z] and periodic along z. Walls are at both ends of y; the flow
/// is along x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChannelGenerator {
    /// Length, height and, in three dimensions, width. The number of entries makes the case two- or three-dimensional.
    pub extent: Vec<f64>,
    /// The number of cells along each axis.
    pub cells: Vec<usize>,
    /// Height of the cells in the middle over the height of the cells at either wall; cells grow by a constant factor in
    /// between. Two cells or fewer have one height.
    #[serde(default = "one")]
    pub wall_ratio: f64,
    /// Whether the channel is periodic along x.
    #[serde(default)]
    pub periodic: bool,
}

/// The channel [0, L] x [0, H] without a circle. The rectangle around the circle ends at twice the x of its centre. Cells between the
/// circle and the rectangle grow outwards; cells after the rectangle lie in rows along the channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChannelCylinderGenerator {
    /// Length and height of the channel.
    pub extent: [f64; 2],
    /// The centre of the circle.
    pub centre: [f64; 2],
    /// The diameter of the circle.
    pub diameter: f64,
    /// The height of the cells at the cylinder, where it is nearest to a wall or the inflow.
    pub first_cell: f64,
    /// Cells along the part of the cylinder that faces a side of the rectangle around it, which is also the number across the channel. Then
    /// those outwards from the cylinder, and those from the rectangle to the end.
    pub cells: [usize; 3],
}

/// The channel [0, L] x [0, H] without a circle, to which a flag is attached at the height of its centre. A rectangle around the cylinder ends at
/// twice the x of its centre. The defaults are the geometry of Turek & Hron (2006), in about 500 cells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ChannelFlagGenerator {
    /// Length and height of the channel.
    pub extent: [f64; 2],
    /// The centre of the circle.
    pub centre: [f64; 2],
    /// The diameter of the circle.
    pub diameter: f64,
    /// x of the end of the flag.
    pub flag_end: f64,
    /// The thickness of the flag.
    pub thickness: f64,
    /// The height of the cells at the cylinder, where it is nearest to a wall or the inflow.
    pub first_cell: f64,
    /// The height of the cells beside the flag.
    pub flag_cell: f64,
    /// Numbers of cells.
    pub cells: FlagCells,
}

/// Numbers of cells around a flag.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FlagCells {
    /// Along the cylinder on its front, its top and its bottom, each.
    pub around: usize,
    /// Outwards from the cylinder to the rectangle around it.
    pub outwards: usize,
    /// From either side of the flag to the wall.
    pub beside: usize,
    /// Along the flag behind the rectangle.
    pub along: usize,
    /// Across the flag.
    pub across: usize,
    /// From the end of the flag to the outflow.
    pub after: usize,
}

impl Default for FlagCells {
    fn default() -> Self {
        let mesh::generate::FlagCells { around, outwards, beside, along, across, after } =
            ChannelFlagMesh::turek_hron(2).cells;
        FlagCells { around, outwards, beside, along, across, after }
    }
}

impl Default for ChannelFlagGenerator {
    fn default() -> Self {
        let ChannelFlagMesh { extent, centre, diameter, flag_end, thickness, first_cell, flag_cell, .. } =
            ChannelFlagMesh::turek_hron(2);
        let cells = FlagCells::default();
        ChannelFlagGenerator { extent, centre, diameter, flag_end, thickness, first_cell, flag_cell, cells }
    }
}
