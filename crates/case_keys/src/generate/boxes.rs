//! Boxes.

use super::{fifth, one};
use crate::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A box along the axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxGenerator {
    /// The corner with the smallest coordinates: two or three, which makes the case two- or three-dimensional.
    pub lower: Vec<f64>,
    /// The corner with the largest coordinates.
    pub upper: Vec<f64>,
    /// The number of cells along each axis.
    pub cells: Vec<usize>,
    /// Along each axis, the size of the last cell over the size of the first; sizes in between form a geometric sequence.
    /// Default: all cells have the same size.
    pub size_ratio: Option<Vec<f64>>,
    /// The deformation of the box.
    #[serde(default)]
    pub curving: Curving,
    /// Axes along which the box is periodic; their boundaries are joined.
    #[serde(default)]
    pub periodic: Vec<Axis>,
    /// Pieces of an axis with their own sizes of cells, such that lines between cells lie at given places. They fill the axis from `lower` to
    /// `upper`, and have together as many cells as `cells` says.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub segments: BTreeMap<Axis, Vec<Segment>>,
    /// The mesh as the image of the box: the position of the point (x, y, z) of the box, a formula in x, y and z along each axis. Half of an annulus,
    /// a nozzle or a bump need no mesh file this way. Sizes, segments and regions are those of the box. Periodic sides must be translates of
    /// each other on the mesh too; sides that coincide are joined.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<Vec<Formula>>,
    /// Boxes in the box, by name, whose cells are a region: a solid, for instance. All other cells are the region "rest". Before curving,
    /// faces of a region lie on lines between cells.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub regions: BTreeMap<String, BoxRegion>,
}

/// A piece of an axis. It begins where the one before it ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// The coordinate at which it ends.
    pub end: f64,
    /// Its cells.
    pub cells: usize,
    /// The size of its last cell over that of its first.
    #[serde(default = "one")]
    pub size_ratio: f64,
}

/// A box in the box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxRegion {
    /// The corner with the smallest coordinates.
    pub lower: Vec<f64>,
    /// The corner with the largest coordinates.
    pub upper: Vec<f64>,
}

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// The first axis.
    X,
    /// The second axis.
    Y,
    /// The third axis.
    Z,
}

/// A smooth deformation of the box. Amplitudes are fractions of its extent; above 0.05 cells may be inverted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Curving {
    /// Straight cells.
    #[default]
    None,
    /// Each axis displaced by amplitude * product of sin(2 pi r) over the axes, r in [0, 1]: the boundary is not
    /// displaced.
    Smooth {
        /// The largest displacement.
        amplitude: f64,
    },
    /// Each axis i displaced by amplitude * sin(2 pi (sum of r) + i): the boundary is curved too, and stays periodic.
    Wavy {
        /// The largest displacement.
        amplitude: f64,
    },
    /// A few random waves; the boundary is displaced only if it is periodic.
    Random {
        /// A bound of the displacement.
        amplitude: f64,
        /// The seed of the waves.
        seed: u64,
    },
}

/// The square [-side/2, side/2]^2 without the centred square of side `hole`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotatingBoxGenerator {
    /// The side of the square.
    #[serde(default = "one")]
    pub side: f64,
    /// The side of the hole.
    #[serde(default = "fifth")]
    pub hole: f64,
    /// Cells along a side of the square. The sides of the hole must fall on lines between cells: for 0.2 of 1 a multiple of 5.
    pub cells_per_side: usize,
}
