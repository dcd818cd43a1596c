//! `[bodies.<name>]`

use super::formula::Formula;
use super::inertia::InertiaEntry;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rigid body that the flow moves. Lengths, masses and forces are per depth in two dimensions. Its coordinates are zero at the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// The walls that are its surface. Default: the wall that has the name of the body.
    pub walls: Option<Vec<String>>,
    /// Its mass.
    pub mass: Formula,
    /// Its moment of inertia about the axis of `rotation` through the centre of mass; needed with `rotation`.
    pub moment_of_inertia: Option<Formula>,
    /// Its tensor of inertia about the centre of mass at rest, in three dimensions: three rows of three numbers, or the three numbers of its
    /// diagonal. Needed with `rotation_x`, `rotation_y`, `rotation_z`.
    pub inertia: Option<Vec<InertiaEntry>>,
    /// A point on the axis of rotation, at rest; with rotations about several axes the point about which the body turns. Default: the
    /// origin.
    pub pivot: Option<Vec<f64>>,
    /// The axis of `rotation` in three dimensions. Default: z.
    pub axis: Option<[f64; 3]>,
    /// The centre of mass at rest. Default: the pivot.
    pub centre_of_mass: Option<Vec<f64>>,
    /// An outer force on the centre of mass, such as its weight: a formula per axis in the time t.
    pub force: Option<Vec<Formula>>,
    /// The translation along x, if the body has it.
    pub x: Option<Freedom>,
    /// The translation along y, if the body has it.
    pub y: Option<Freedom>,
    /// The translation along z, if the body has it.
    pub z: Option<Freedom>,
    /// The rotation about the axis through the pivot, in radians, if the body has it; in two dimensions counter-clockwise.
    pub rotation: Option<Freedom>,
    /// The component along x of the rotation vector, if the body has it, in three dimensions. The body turns about this vector, by its length
    /// in radians.
    pub rotation_x: Option<Freedom>,
    /// The component along y of the rotation vector, if the body has it.
    pub rotation_y: Option<Freedom>,
    /// The component along z of the rotation vector, if the body has it.
    pub rotation_z: Option<Freedom>,
    /// How the mesh follows the body. Default: the mesh is an elastic body, see `motion`.
    pub mesh: Option<FollowingMesh>,
}

impl Body {
    /// The coordinates that a body may have, with their keys: translations, then rotations about `axis` and about x, y and z.
    pub fn coordinates(&self) -> [(&'static str, Option<&Freedom>); 7] {
        let Body { x, y, z, rotation, rotation_x, rotation_y, rotation_z, .. } = self;
        [
            ("x", x),
            ("y", y),
            ("z", z),
            ("rotation", rotation),
            ("rotation_x", rotation_x),
            ("rotation_y", rotation_y),
            ("rotation_z", rotation_z),
        ]
        .map(|(name, freedom)| (name, freedom.as_ref()))
    }
}

/// A translation or rotation of a body. An empty section makes it free, without spring and damper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Freedom {
    /// Force per displacement, or moment per angle.
    #[serde(default = "zero")]
    pub spring: Formula,
    /// The same per cube of the displacement.
    #[serde(default = "zero")]
    pub cubic_spring: Formula,
    /// Where the springs are at rest.
    #[serde(default = "zero")]
    pub rest: Formula,
    /// Force or moment per rate.
    #[serde(default = "zero")]
    pub damping: Formula,
    /// The rate at the start.
    #[serde(default = "zero")]
    pub rate: Formula,
    /// Springs that act outside of a range only.
    pub stops: Option<Stops>,
    /// The displacement or angle as a formula in the time t, zero at the start: it is prescribed, not free.
    pub motion: Option<Formula>,
    /// The time from which a prescribed coordinate is free. A slab must begin there; `time.adaptive` cuts one.
    pub release: Option<f64>,
}

fn zero() -> Formula {
    Formula::Number(0.0)
}

/// Springs that act outside of a range only.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stops {
    /// The lower end of the range.
    pub lower: f64,
    /// The upper end of the range.
    pub upper: f64,
    /// Force per distance beyond the range.
    pub stiffness: f64,
}

/// How the mesh follows a body: each point moves with the body by a weight w, turned by w times the angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum FollowingMesh {
    /// w is one up to a distance from the pivot, zero from another one on, and smooth in between.
    Between {
        /// The distance up to which the mesh moves as the body does.
        inner: f64,
        /// The distance from which on it rests.
        outer: f64,
    },
    /// w as a formula in the position x, y, z at rest: one on the walls of the body, zero on boundaries that rest.
    Weight(Formula),
}
