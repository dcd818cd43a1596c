//! States of a gas, and typical values.

use crate::formula::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A uniform state: density, velocity and one of pressure, temperature and Mach number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FreeStream {
    /// The density.
    #[serde(default = "density")]
    pub density: f64,
    /// The velocity, one entry per axis.
    pub velocity: Vec<f64>,
    /// The pressure.
    pub pressure: Option<f64>,
    /// Instead of the pressure: the temperature.
    pub temperature: Option<f64>,
    /// Instead of the pressure: the Mach number of the velocity.
    pub mach: Option<f64>,
}

fn density() -> f64 {
    1.0
}

/// A state as a function of position and time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum State {
    /// A uniform state.
    Uniform(FreeStream),
    /// An isentropic vortex carried by a free stream (Diosady & Murman, AIAA 2018-0919): strength is their beta.
    Vortex(Vortex),
    /// The same vortex with the strength as in Persson, Bonet & Peraire (2009): strength is their epsilon.
    VortexPersson(Vortex),
    /// Couette flow with heat conduction between the plates y = 0 and y = height. Needs a constant viscosity.
    Couette(Couette),
    /// Smooth waves of all components: a solution only with `source = "manufactured"`.
    Waves(Waves),
    /// Formulas in x, y, z and t.
    Expression(Primitive),
}

/// An isentropic vortex; in three dimensions, a column along z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Vortex {
    /// The free stream, which carries the vortex.
    pub free_stream: FreeStream,
    /// The centre at t = 0, one entry per axis.
    pub centre: Vec<f64>,
    /// The radius R of exp(-r^2 / (2 R^2)).
    #[serde(default = "radius")]
    pub radius: f64,
    /// The strength; positive turns counter-clockwise.
    pub strength: f64,
    /// The period of the domain in x and y, if it is periodic: the nearest image of the vortex is taken.
    pub period: Option<[f64; 2]>,
}

fn radius() -> f64 {
    1.0
}

/// Couette flow: a plate y = 0 at rest, a plate y = height that moves along x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Couette {
    /// The distance of the plates.
    pub height: f64,
    /// The velocity of the upper plate.
    pub speed: f64,
    /// The temperature of the lower plate.
    pub lower_temperature: f64,
    /// The temperature of the upper plate.
    pub upper_temperature: f64,
    /// The pressure.
    pub pressure: f64,
    /// The velocity of the lower plate, if the whole flow moves with it. Default: zero.
    pub frame: Option<Vec<f64>>,
}

/// Waves about a mean state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Waves {
    /// The mean state.
    pub mean: FreeStream,
    /// The relative amplitude, in [0, 1).
    pub amplitude: f64,
    /// The period, in space and time.
    pub length: f64,
}

/// A state by formulas in x, y, z and t.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Primitive {
    /// The density.
    pub density: Formula,
    /// The velocity, one formula per axis.
    pub velocity: Vec<Formula>,
    /// The pressure.
    pub pressure: Formula,
}

/// Typical values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// A density.
    #[serde(default = "density")]
    pub density: f64,
    /// A speed of the flow.
    pub speed: f64,
    /// A pressure.
    pub pressure: f64,
    /// A length: of coefficients, of the Reynolds number, and of scales of time, which are the length over the speed. Steady starts and
    /// `time.adaptive` use these. Default: 1 for coefficients and the Reynolds number. Scales of time then use the largest extent of the largest body
    /// in the mesh, or the second largest one if the body has ends in all three dimensions. Without a body they use the second largest extent of the
    /// mesh.
    pub length: Option<f64>,
}
