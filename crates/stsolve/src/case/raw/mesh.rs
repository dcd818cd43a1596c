//! `[mesh]`

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The mesh at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mesh {
    /// N, the nodes per direction of the geometry and of the displacement of the mesh, 2 to 16: degree N - 1.
    pub order: usize,
    /// How the mesh is made.
    pub generate: Generate,
}

/// A generated mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Generate {
    /// A box of quadrilaterals or hexahedra. Its boundaries are left, right (x), bottom, top (y), front, back (z).
    Box(BoxGenerator),
}

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
    /// Along each axis, the size of the last cell over that of the first; sizes in between form a geometric sequence. Without
    /// it all cells have the same size.
    pub size_ratio: Option<Vec<f64>>,
    /// How the cells are curved.
    #[serde(default)]
    pub curving: Curving,
    /// Axes along which the box is periodic; their boundaries vanish.
    #[serde(default)]
    pub periodic: Vec<Axis>,
    /// Turns the axes of every cell at random, by this seed. A test of the program: results must not change.
    pub scramble: Option<u64>,
}

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
    /// Each axis displaced by amplitude * product of sin(2 pi r) over the axes, r in [0, 1]: the boundary stays.
    Smooth {
        /// The largest displacement.
        amplitude: f64,
    },
    /// Each axis i displaced by amplitude * sin(2 pi (sum of r) + i): the boundary is curved too, and stays periodic.
    Wavy {
        /// The largest displacement.
        amplitude: f64,
    },
    /// A few random waves; the boundary stays, unless it is periodic.
    Random {
        /// A bound of the displacement.
        amplitude: f64,
        /// Chooses the waves.
        seed: u64,
    },
}
