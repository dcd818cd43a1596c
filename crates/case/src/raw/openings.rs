//! The conditions of `[flow.boundary]` at which gas enters or leaves.

use super::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Subsonic inflow of given total state, for an observer at rest. Gas that is pushed back leaves at the total pressure. The values are
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

/// Subsonic inflow of given temperature and either velocity or mass flux. The pressure comes from inside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VelocityInflow {
    /// The velocity: a formula in x, y, z and t per axis.
    pub velocity: Option<Vec<Formula>>,
    /// Instead of the velocity: the mass flux, density times velocity. It is met exactly at any pressure.
    pub mass_flux: Option<Vec<Formula>>,
    /// The temperature: a formula in x, y, z and t.
    pub temperature: Formula,
}

/// Outflow to a static pressure; nothing is imposed where it is supersonic. Gas that comes back has the given pressure and temperature
/// at rest, and enters along the normal. The values are numbers or formulas in x, y, z and t.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Outflow {
    /// The static pressure; the total pressure of gas that comes back.
    pub pressure: Formula,
    /// The total temperature of gas that comes back. Default: the one of the reference state, p / (rho R) + U^2 / (2
    /// c_p).
    pub total_temperature: Option<Formula>,
}
