//! `[flow]`

use super::formula::Formula;
use super::openings::{Inflow, Outflow, VelocityInflow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The compressible flow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Flow {
    /// N_s, the nodes per direction and cell of the flow, 2 to 16: degree N_s - 1, order of accuracy N_s.
    pub order: usize,
    /// The gas.
    #[serde(default)]
    pub gas: Gas,
    /// The numerical flux between cells.
    #[serde(default)]
    pub riemann: Riemann,
    /// The quadrature points.
    #[serde(default)]
    pub quadrature: Quadrature,
    /// A solution that is known. Errors are measured against it, boundaries with the condition "exact" take it, and it is the
    /// initial state if no other is given.
    pub exact: Option<State>,
    /// The state at the start. Default: the exact one.
    pub initial: Option<State>,
    /// A source on the right-hand side of the equations.
    pub source: Option<Source>,
    /// The condition on each boundary, by name; `others` stands for all that are not named.
    #[serde(default)]
    pub boundary: BTreeMap<String, Condition>,
    /// What the forces on walls refer to, by the name of the wall; `others` stands for all that are not named.
    #[serde(default)]
    pub forces: BTreeMap<String, Forces>,
    /// Typical sizes, by which residuals are weighted and dimensionless numbers are formed. Default: the free stream (or mean
    /// state) of the exact or the initial state.
    pub reference: Option<Reference>,
}

/// A perfect gas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gas {
    /// The ratio of specific heats, above 1.
    #[serde(default = "gamma")]
    pub gamma: f64,
    /// The specific gas constant R of p = rho R T. Default: 1, so that T = p / rho.
    pub gas_constant: Option<f64>,
    /// Instead of gas_constant: R = 1 / (gamma mach^2), so that T = 1 where density and speed are 1 at this Mach number.
    pub mach: Option<f64>,
    /// The Prandtl number.
    #[serde(default = "prandtl")]
    pub prandtl: f64,
    /// The dynamic viscosity.
    #[serde(default)]
    pub viscosity: Viscosity,
}

fn gamma() -> f64 {
    1.4
}

fn prandtl() -> f64 {
    0.72
}

impl Default for Gas {
    fn default() -> Self {
        Gas { gamma: gamma(), gas_constant: None, mach: None, prandtl: prandtl(), viscosity: Viscosity::Inviscid }
    }
}

/// The dynamic viscosity.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Viscosity {
    /// None: the Euler equations.
    #[default]
    Inviscid,
    /// The same everywhere.
    Constant(f64),
    /// Sutherland's law, viscosity (T / temperature)^1.5 (temperature + constant) / (T + constant).
    Sutherland {
        /// The viscosity at `temperature`.
        viscosity: f64,
        /// The temperature at which `viscosity` is given.
        temperature: f64,
        /// Sutherland's constant (air: 110.4 K).
        constant: f64,
    },
}

/// The numerical flux between cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Riemann {
    /// Roe's average, wave speeds smoothed near zero.
    #[default]
    Roe,
    /// Three waves; keeps contacts and shear layers.
    Hllc,
    /// The fastest wave damps all: simple, robust, dissipative.
    LaxFriedrichs,
}

/// The quadrature points per direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Quadrature {
    /// The fewest with which a free stream is kept exactly on any moving mesh.
    #[default]
    Conserving,
    /// Twice the order, in space and time.
    Double,
    /// This number in space; in time as "conserving".
    Points(usize),
}

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
    /// The same everywhere.
    Uniform(FreeStream),
    /// An isentropic vortex that a free stream carries (Diosady & Murman, AIAA 2018-0919): strength is their beta.
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
    /// The state far away, which carries the vortex along.
    pub free_stream: FreeStream,
    /// The centre at t = 0, one entry per axis.
    pub centre: Vec<f64>,
    /// The radius R of exp(-r^2 / (2 R^2)).
    #[serde(default = "radius")]
    pub radius: f64,
    /// The strength; positive turns counter-clockwise.
    pub strength: f64,
    /// The period of the domain in x and y, where it is periodic: the nearest image of the vortex is taken.
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
    /// The velocity of the lower plate, if everything moves along with it. Default: zero.
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

/// A source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// The source with which the exact state is a solution, by exact differentiation.
    Manufactured,
}

/// A condition on a boundary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Condition {
    /// A free stream far away.
    FarField(FreeStream),
    /// The exact state.
    Exact,
    /// A state as a function of position and time.
    PrescribedState(State),
    /// A no-slip wall that moves with the mesh and passes no heat.
    AdiabaticWall(AdiabaticWall),
    /// A no-slip wall that moves with the mesh and has a temperature.
    IsothermalWall(IsothermalWall),
    /// A wall without friction.
    SlipWall,
    /// A plane of symmetry.
    Symmetry,
    /// Subsonic inflow from a reservoir.
    Inflow(Inflow),
    /// Subsonic inflow of given velocity or mass flux.
    VelocityInflow(VelocityInflow),
    /// Supersonic inflow of a state as a function of position and time: all of it enters, whatever the gas inside does.
    SupersonicInflow(State),
    /// Outflow.
    Outflow(Outflow),
}

/// A no-slip wall that passes no heat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdiabaticWall {
    /// The velocity with which the wall slides in its plane, relative to the mesh. Default: zero.
    pub slide: Option<Vec<f64>>,
}

/// A no-slip wall with a temperature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IsothermalWall {
    /// The temperature.
    pub temperature: f64,
    /// The velocity with which the wall slides in its plane, relative to the mesh. Default: zero.
    pub slide: Option<Vec<f64>>,
}

/// Typical sizes.
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
    /// A length, for the Reynolds number.
    #[serde(default = "length")]
    pub length: f64,
}

fn length() -> f64 {
    1.0
}

/// What the force on a wall refers to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Forces {
    /// The point about which moments are taken: a formula per axis in the time t, which gives it the motion of the body.
    /// Default: the origin.
    pub point: Option<Vec<Formula>>,
    /// The area of the coefficients; in two dimensions per unit span, such as a chord. Default: the reference length, in three
    /// dimensions its square.
    pub area: Option<f64>,
    /// The length of the moment coefficient. Default: the reference length.
    pub length: Option<f64>,
    /// The direction of drag, of any length; lift is to its left in the x-y plane. Default: along x.
    pub drag_direction: Option<Vec<f64>>,
    /// Which moments are positive.
    #[serde(default)]
    pub moment_positive: MomentPositive,
}

/// Which moments are positive. In two dimensions this is the sign of `<wall>_moment`, `<wall>_moment_impulse` and of the moment coefficient.
/// In three the moments about x, y and z follow the right-hand rule always, and this says about which axis the coefficient is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum MomentPositive {
    /// Counter-clockwise in the x-y plane: about the axis z.
    #[default]
    CounterClockwise,
    /// Those that raise a nose which is upstream, towards the lift: clockwise, about the axis -z.
    NoseUp,
    /// In three dimensions: about this axis, of any length, by the right-hand rule.
    Axis([f64; 3]),
}
