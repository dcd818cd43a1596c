//! `[mesh.generate]`

use super::{BodyPoints, Formula};
use mesh::generate::{AirfoilMesh, BladeMesh, ChannelFlagMesh};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A generated mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Generate {
    /// A box of quadrilaterals or hexahedra. Its boundaries are left, right (x), bottom, top (y), front, back (z).
    Box(BoxGenerator),
    /// A square around the origin with a centred square hole, in square cells. Its boundaries are inner and outer.
    RotatingBox(RotatingBoxGenerator),
    /// A box between two walls. Its boundaries are bottom and top, and inflow and outflow if it is not periodic.
    Channel(ChannelGenerator),
    /// A channel along x with a cylinder across it. Its boundaries are inflow, outflow, bottom, top and cylinder.
    ChannelCylinder(ChannelCylinderGenerator),
    /// A channel along x with a flag behind a cylinder, as of Turek & Hron. Its boundaries are inflow, outflow, bottom, top and cylinder, its
    /// regions fluid and flag.
    ChannelFlag(ChannelFlagGenerator),
    /// Cells between two circles around the origin. Its boundaries are wall, the inner one, and far.
    Annulus(AnnulusGenerator),
    /// Cells between a closed blunt body and a circle around it. Its boundaries are wall and far.
    ClosedBody(ClosedBodyGenerator),
    /// Cells between an ellipsoid around the origin and the far field, in three dimensions. Its boundaries are wall and far.
    Ellipsoid(EllipsoidGenerator),
    /// The inside of a circle around the origin. Its boundary is wall.
    Disc(DiscGenerator),
    /// A C-mesh around an airfoil of chord 1 with its nose at the origin. Its boundaries are airfoil and far.
    Airfoil(AirfoilGenerator),
    /// A passage of a row of turbine blades, periodic in the pitch. Its boundaries are blade, inflow and outflow.
    TurbineBlade(TurbineBladeGenerator),
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
    /// between.
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
    /// Cells along a quarter of the cylinder, which is also the number across the channel; outwards from the cylinder; from the
    /// rectangle to the end.
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

/// Cells between two circles, growing by a constant factor outwards.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AnnulusGenerator {
    /// The radius of the wall.
    pub inner_radius: f64,
    /// The radius of the far field.
    pub outer_radius: f64,
    /// The height of the cells at the wall.
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
    /// The height of the cells at the wall.
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

/// An airfoil with a closed trailing edge: NACA 00xx by its thickness, another one by `naca` or `profile`. Lengths are in chords.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AirfoilGenerator {
    /// The largest thickness: 0.12 for the NACA 0012.
    pub thickness: f64,
    /// Instead of the thickness: four digits of NACA, such as `"2412"`. The nose of the camber line is at the origin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub naca: Option<String>,
    /// Instead of the thickness: a text file, relative to the case file, with a point in each line, x and y. The points run from the trailing
    /// edge over the upper side and the nose back to the trailing edge. In the format of Lednicer they run from the nose along the upper
    /// side, and again along the lower one. Lines before the first point may be names. Where semicolons separate x and y, a comma may stand for the
    /// decimal point. A cubic spline goes through the points. The chord from nose to trailing edge is scaled to 1 and moved, not turned: the
    /// trailing edge lies at (1, 0). A blunt one is closed.
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
        let AirfoilMesh { thickness, far_field, first_cell, trailing_edge_cell, .. } = AirfoilMesh::naca0012(2);
        let AirfoilMesh { surface_cells, wake_cells, normal_cells, .. } = AirfoilMesh::naca0012(2);
        AirfoilGenerator {
            thickness,
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
    /// The distance of the inflow from the layer, along x.
    pub inflow_distance: f64,
    /// The distance of the outflow from the layer, along x.
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

fn one() -> f64 {
    1.0
}

fn fifth() -> f64 {
    0.2
}
