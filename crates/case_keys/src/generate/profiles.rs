//! Airfoils and blades.

use crate::one_of::{self, OneOf};
use mesh::generate::{AirfoilMesh, BladeMesh};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};
use std::path::PathBuf;

/// An airfoil with a closed trailing edge: NACA 00xx by its thickness, another one by `naca` or `profile`. Lengths are in chords.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AirfoilGenerator {
    /// The largest thickness of a NACA 00xx. Default: 0.12, that of the NACA 0012.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
    /// Instead of the thickness: four digits of NACA, such as `"2412"`. The nose of the camber line is at the origin.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "digits")]
    pub naca: Option<String>,
    /// Instead of the thickness: a text file, relative to the case file, with a point in each line, x and y. The points run from the trailing
    /// edge over the upper side and the nose back to the trailing edge. In the format of Lednicer they run from the nose along the upper
    /// side, and again along the lower one. Lines before the first point may be names. Where semicolons separate x and y, a comma may stand for the
    /// decimal point. A cubic spline goes through the points. The profile is scaled and moved, not turned: its foremost
    /// point lies at x = 0, also if it has an incidence, and the trailing edge at (1, 0). A blunt one is closed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<PathBuf>,
    /// The smallest distance of the far field.
    pub far_field: f64,
    /// The height of the cells at the wall.
    pub first_cell: f64,
    /// The length of the last cell before the trailing edge; the others follow smoothly.
    pub trailing_edge_cell: f64,
    /// Cells along one side of the airfoil.
    pub surface_cells: usize,
    /// Cells along the wake, up to the far field.
    pub wake_cells: usize,
    /// The near wake behind the trailing edge, with finer cells. Default: cells grow by one factor up to the far field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near_wake: Option<NearPart>,
    /// Cells from the wall to the far field.
    pub normal_cells: usize,
    /// The near part at the wall, with finer cells. Default: cells grow by one factor up to the far field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near_wall: Option<NearPart>,
}

/// Digits as a text, or as a number, which an option `--set ...naca=2412` is.
struct Digits(String);

impl OneOf for Digits {
    type Entry = f64;
    const EXPECTED: &'static str = "four digits in quotes";
    const OF_TEXT: fn(String) -> Self = Digits;
    const OF_WHOLE: Option<fn(usize) -> Self> = Some(|number| Digits(format!("{number:04}")));
}

fn digits<'de, S: Deserializer<'de>>(deserializer: S) -> Result<Option<String>, S::Error> {
    one_of::deserialize(deserializer).map(|Digits(digits)| Some(digits))
}

/// A part of a mesh with finer cells: in it cells grow by one factor, beyond it by another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NearPart {
    /// Its extent, in chords.
    pub extent: f64,
    /// Its number of cells, less than the number up to the far field.
    pub cells: usize,
}

impl Default for AirfoilGenerator {
    fn default() -> Self {
        let AirfoilMesh { far_field, first_cell, trailing_edge_cell, .. } = AirfoilMesh::naca0012(2);
        let AirfoilMesh { surface_cells, wake_cells, normal_cells, .. } = AirfoilMesh::naca0012(2);
        AirfoilGenerator {
            thickness: None,
            naca: None,
            profile: None,
            far_field,
            first_cell,
            trailing_edge_cell,
            surface_cells,
            wake_cells,
            near_wake: None,
            normal_cells,
            near_wall: None,
        }
    }
}

/// One blade of a row along y, in a layer of cells normal to it and a frame around the layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TurbineBladeGenerator {
    /// The shape of the blade.
    pub profile: Profile,
    /// The distance of the blades, along y.
    pub pitch: f64,
    /// The direction of the incoming flow, in degrees from the x-axis. It determines the layout of the mesh.
    pub inflow_angle: f64,
    /// The direction of the outgoing flow, in degrees from the x-axis.
    pub outflow_angle: f64,
    /// The distance of the inflow along x from the middle between the two front corners of the layer.
    pub inflow_distance: f64,
    /// The distance of the outflow along x from the middle between the two rear corners of the layer.
    pub outflow_distance: f64,
    /// The thickness of the layer of cells around the blade, less than the radius of curvature of every concave part of
    /// the blade.
    pub layer: f64,
    /// The height of the cells at the blade.
    pub first_cell: f64,
    /// The numbers of cells.
    pub cells: BladeCells,
}

/// The shape of a blade.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Profile {
    /// A low-pressure turbine blade of chord 1, close to the T106.
    LowPressureTurbine,
    /// A smooth closed curve through the points of a text file, relative to the case file. The file has a line for each point
    /// with its x and y, clockwise or counter-clockwise. Lines before the first point may be names; # begins a comment.
    File(PathBuf),
}

/// Numbers of cells around a blade.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BladeCells {
    /// Along each side of the blade, without its ends.
    pub side: usize,
    /// Around each end of the blade.
    pub end: usize,
    /// From the blade to the edge of the layer.
    pub normal: usize,
    /// From the layer to either periodic line.
    pub gap: usize,
    /// From the inflow to the layer.
    pub before: usize,
    /// From the layer to the outflow.
    pub after: usize,
}

fn default_blade() -> BladeMesh {
    BladeMesh::low_pressure_turbine(2).expect("the built-in profile is a smooth curve")
}

impl Default for BladeCells {
    fn default() -> Self {
        let mesh::generate::BladeCells { side, end, normal, gap, before, after } = default_blade().cells;
        BladeCells { side, end, normal, gap, before, after }
    }
}

impl Default for TurbineBladeGenerator {
    fn default() -> Self {
        let BladeMesh { pitch, slopes, distances, layer, first_cell, .. } = default_blade();
        // In degrees with two decimals, without the round-off of the tangent.
        let [inflow_angle, outflow_angle] = slopes.map(|slope| (100.0 * slope.atan().to_degrees()).round() / 100.0);
        let [inflow_distance, outflow_distance] = distances;
        TurbineBladeGenerator {
            profile: Profile::LowPressureTurbine,
            pitch,
            inflow_angle,
            outflow_angle,
            inflow_distance,
            outflow_distance,
            layer,
            first_cell,
            cells: BladeCells::default(),
        }
    }
}
