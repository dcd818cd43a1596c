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
    /// The inviscid flux inside of cells.
    #[serde(default)]
    pub volume_flux: VolumeFlux,
    /// An artificial viscosity where the gas is compressed as in a shock. Default: none.
    pub shock_capturing: Option<ShockCapturing>,
    /// The inviscid flux of walls and planes of symmetry.
    #[serde(default)]
    pub wall_flux: WallFlux,
    /// An exact solution, if known. Errors are measured against it, boundaries with the condition "exact" take it, and it is
    /// the default initial state.
    pub exact: Option<State>,
    /// The state at the start. Default: the exact one.
    pub initial: Option<State>,
    /// A source on the right-hand side of the equations.
    pub source: Option<Source>,
    /// A sponge, which draws the gas to a uniform state: it absorbs waves and wakes before they reach a boundary.
    pub sponge: Option<Sponge>,
    /// The rotation of the frame, about an axis at rest. All velocities are then relative to the frame, and total pressures and temperatures are those
    /// of the relative velocity.
    pub rotation: Option<RotatingFrame>,
    /// The condition on each boundary, by name; `others` stands for all that are not named.
    #[serde(default)]
    pub boundary: BTreeMap<String, Condition>,
    /// The reference values of the forces on walls, by the name of the wall; `others` stands for all that are not
    /// named.
    #[serde(default)]
    pub forces: BTreeMap<String, Forces>,
    /// Typical values, which scale residuals and define dimensionless numbers. Default: the free stream (or mean state) of
    /// the exact or the initial state.
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
    /// Instead of gas_constant: R = 1 / (gamma mach^2), so that T = 1 at density 1, speed 1 and this Mach number.
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
    /// A constant viscosity.
    Constant(f64),
    /// The constant viscosity of this Reynolds number rho U L / mu, with density, speed and length of `flow.reference`.
    Reynolds(f64),
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
    /// Three waves; preserves contacts and shear layers.
    Hllc,
    /// The fastest wave damps all components: simple, robust, dissipative.
    LaxFriedrichs,
}

/// The inviscid flux inside of cells. All except "central" are for flow that the mesh does not resolve, with `quadrature =
/// "collocated_lobatto"`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum VolumeFlux {
    /// The flux at every point.
    #[default]
    Central,
    /// Two-point fluxes that keep the balance of kinetic energy (Kennedy and Gruber).
    KineticEnergy,
    /// Two-point fluxes that keep the balances of kinetic energy and of entropy (Ranocha).
    Entropy,
    /// The flux at every point, and in every cell a viscosity that is just large enough where entropy would be lost (Chan).
    EntropyViscosity,
}

/// An artificial viscosity, which gives shocks a width of a few nodes. It is zero in expansions, contacts, shear and in flow that the mesh
/// resolves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShockCapturing {
    /// The factor of the viscosity: larger numbers make wider shocks with fewer oscillations.
    #[serde(default = "shock_strength")]
    pub strength: f64,
    /// The least compression at which it acts: the change of the velocity from node to node over the speed of sound.
    #[serde(default = "shock_threshold")]
    pub threshold: f64,
}

fn shock_strength() -> f64 {
    2.0
}

fn shock_threshold() -> f64 {
    0.02
}

/// The inviscid flux of walls and planes of symmetry. No mass crosses them either way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WallFlux {
    /// The pressure of the gas at the wall. Forces converge fastest with it.
    #[default]
    Inside,
    /// The pressure between the gas and its mirror image, which resists gas that runs into the wall or away from it: more robust where the mesh
    /// does not resolve the flow.
    Mirrored,
}

/// The quadrature points per direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Quadrature {
    /// The least number that preserves a free stream exactly on any moving mesh.
    #[default]
    Conserving,
    /// Three points for two nodes, but at least as many as "conserving": for flow that the mesh does not resolve. In time as "conserving".
    ThreeHalves,
    /// Twice the order, in space and time.
    Double,
    /// This number in space; in time as "conserving".
    Points(usize),
    /// As many Gauss points as nodes, in space and time. It preserves a free stream exactly on any moving mesh by its metric.
    Collocated,
    /// The same with Gauss-Lobatto points, the nodes of the flow: faster, and less accurate.
    CollocatedLobatto,
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

/// A source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Source {
    /// The source that makes the exact state a solution, by exact differentiation.
    Manufactured,
    /// A body force per mass, a formula per axis in x, y, z and t: gravity, or what drives a periodic channel.
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
    /// An adiabatic no-slip wall that moves with the mesh.
    AdiabaticWall(AdiabaticWall),
    /// An isothermal no-slip wall that moves with the mesh.
    IsothermalWall(IsothermalWall),
    /// A frictionless wall.
    SlipWall,
    /// A plane of symmetry.
    Symmetry,
    /// Subsonic inflow from a reservoir.
    Inflow(Inflow),
    /// Subsonic inflow of given velocity or mass flux.
    VelocityInflow(VelocityInflow),
    /// Supersonic inflow of a state as a function of position and time: the whole state enters for any gas inside.
    SupersonicInflow(State),
    /// Outflow.
    Outflow(Outflow),
}

impl Condition {
    /// Whether it is that of a wall, with or without slip; a plane of symmetry is no wall.
    pub fn is_wall(&self) -> bool {
        match self {
            Condition::AdiabaticWall(_) | Condition::IsothermalWall(_) | Condition::SlipWall => true,
            Condition::FarField(_)
            | Condition::Exact
            | Condition::PrescribedState(_)
            | Condition::Symmetry
            | Condition::Inflow(_)
            | Condition::VelocityInflow(_)
            | Condition::SupersonicInflow(_)
            | Condition::Outflow(_) => false,
        }
    }
}

/// An adiabatic no-slip wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdiabaticWall {
    /// The velocity with which the wall slides in its plane, relative to the mesh: a formula per axis in x, y, z and t. Default: zero.
    pub slide: Option<Vec<Formula>>,
}

/// An isothermal no-slip wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IsothermalWall {
    /// The temperature: a formula in x, y, z and t.
    pub temperature: Formula,
    /// The velocity with which the wall slides in its plane, relative to the mesh: a formula per axis in x, y, z and t. Default: zero.
    pub slide: Option<Vec<Formula>>,
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
    /// A length, for the Reynolds number.
    #[serde(default = "length")]
    pub length: f64,
}

fn length() -> f64 {
    1.0
}

/// The reference values of the force on a wall.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Forces {
    /// The point about which moments are taken: a formula per axis in the time t, so that it may move with the body.
    /// Default: the origin.
    pub point: Option<Vec<Formula>>,
    /// The reference area of the coefficients; in two dimensions per unit span, such as a chord. Default: the reference
    /// length, in three dimensions its square.
    pub area: Option<f64>,
    /// The reference length of the moment coefficient. Default: the reference length.
    pub length: Option<f64>,
    /// The direction of drag, of any length; lift is to its left in the x-y plane. Default: along x.
    pub drag_direction: Option<Vec<f64>>,
    /// The sign of moments.
    #[serde(default)]
    pub moment_positive: MomentPositive,
}

/// The sign of moments. In two dimensions it applies to `<wall>_moment`, its impulses and the moment coefficient. In three the
/// moments about x, y and z always follow the right-hand rule, and this chooses the axis of the coefficient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum MomentPositive {
    /// Counter-clockwise in the x-y plane: about the axis z.
    #[default]
    CounterClockwise,
    /// Positive if the moment raises a nose that points upstream, towards the lift: clockwise, about the axis -z.
    NoseUp,
    /// In three dimensions: about this axis, of any length, by the right-hand rule.
    Axis([f64; 3]),
}
