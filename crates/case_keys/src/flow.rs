//! `[flow]`

mod conditions;
mod sources;
mod states;

pub use conditions::*;
pub use sources::*;
pub use states::*;

use super::formula::Formula;
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
    /// `exact`; or else the far field, if all boundaries with that condition have the same; or else `initial`.
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
    /// The same for flows that are slow beside sound, at Mach numbers below 0.3: waves of sound damp jumps of the velocity with `flow.reference.speed`
    /// instead of the speed of sound. Vortices on a coarse mesh lose less. Shear along the mesh needs a split form of `volume_flux` beside it. A flow that
    /// the mesh does not resolve may need the stronger damping of "roe". Conditions of boundaries take "roe".
    LowMachRoe,
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

/// An artificial viscosity, which gives shocks a width of a few nodes. It is zero in expansions, contacts and shear, and
/// where the compression is below `threshold`. It widens shocks that viscosity and mesh resolve without it.
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
