//! Sources and the frame of reference.

use super::FreeStream;
use crate::formula::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Source {
    /// The source that makes the exact state a solution, by exact differentiation.
    Manufactured,
    /// A body force per mass, a formula per axis in x, y, z and t: gravity, or what drives a periodic channel. It acts on the gas alone: bodies
    /// have `force`, structures `body_force`.
    Acceleration(Vec<Formula>),
    /// Mass, momentum and energy per volume and time.
    Given(GivenSource),
}

/// A source per volume and time, by formulas in x, y, z and t.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GivenSource {
    /// The mass. Default: 0.
    pub density: Option<Formula>,
    /// The momentum, a formula per axis. Default: 0.
    pub momentum: Option<Vec<Formula>>,
    /// The total energy. Default: 0.
    pub energy: Option<Formula>,
}

/// A sponge: the source - strength (u - target) of all conserved quantities u. It may be combined with `source = { acceleration = ... }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sponge {
    /// The strength, an inverse time: a formula in x, y, z and t that is 0 outside of the sponge.
    pub strength: Formula,
    /// The state to which the gas is drawn.
    pub target: FreeStream,
}

/// A frame that turns at a constant rate: the Coriolis force -2 rho Omega x w, and the centrifugal force, which does work. It may be combined with
/// `source = { acceleration = ... }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotatingFrame {
    /// The angular velocity in radians per time, counter-clockwise.
    pub rate: f64,
    /// A point of the axis. Default: the origin.
    pub centre: Option<Vec<f64>>,
    /// In three dimensions, the direction of the axis, of any length. Default: along z.
    pub axis: Option<[f64; 3]>,
}
