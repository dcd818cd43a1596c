//! The conditions of `[flow.boundary]` at which gas enters or leaves.

use super::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Subsonic inflow of given total state, by velocities in the frame of the case. Gas that is pushed back leaves at the total pressure. The values are
/// numbers or formulas in x, y, z and t.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Inflow {
    /// The total pressure.
    pub total_pressure: Formula,
    /// The total temperature.
    pub total_temperature: Formula,
    /// The direction into the domain, of any length.
    pub direction: Vec<Formula>,
}

/// Subsonic inflow of given temperature and either velocity or mass flux. The pressure is that of the gas inside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VelocityInflow {
    /// The velocity: a formula in x, y, z and t per axis.
    pub velocity: Option<Vec<Formula>>,
    /// Instead of the velocity: the mass flux, density times velocity. It is met exactly at any pressure.
    pub mass_flux: Option<Vec<Formula>>,
    /// The temperature of gas that enters: a formula in x, y, z and t.
    pub temperature: Formula,
}

/// Outflow to a static pressure; nothing is imposed where it is supersonic. Gas that comes back has the given pressure and temperature at
/// rest, and enters along the normal. The values are numbers or formulas in x, y, z and t. With `velocity` sound leaves; without it, all
/// sound is reflected.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Outflow {
    /// The static pressure; the total pressure of gas that comes back.
    pub pressure: Formula,
    /// The total temperature of gas that comes back. Default: the one of the reference state, p / (rho R) + U^2 / (2
    /// c_p).
    pub total_temperature: Option<Formula>,
    /// The velocity of the stream outside, a formula per axis: sound leaves, as through a `far_field`. Where the normal velocity of the gas
    /// differs from it by dw, the pressure differs by about rho c dw. Default: the pressure is `pressure`, and sound is reflected.
    pub velocity: Option<Vec<Formula>>,
    /// The time constant with which the normal velocity outside follows the mean normal velocity of the gas on the boundary, which must be
    /// plane, and must not turn. Its value at the start is `velocity`, without `t` and controls; a profile keeps its shape. The mean pressure returns to
    /// `pressure` in one to two times this time, behind a reservoir in 1 + 1/M times, with the Mach number M. Sound whose period is much shorter leaves. A
    /// steady start takes the pressure alone, and the velocity of the flow that it finds.
    pub relaxation: Option<f64>,
}
