//! `[controls.NAME]`

use super::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A number that the run changes after every slab: a force that keeps a mass flow, or the velocity behind an outflow. Formulas of `flow.source` and
/// `flow.boundary` may contain it by its name. history.csv has its values as `control_NAME`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Control {
    /// The number in the first slab: a formula of constants.
    #[serde(default = "zero")]
    pub initial: Formula,
    /// What is measured at the end of a slab: a column of history.csv, such as `outflow_mass_flow`, or `momentum_x` if
    /// `output.integrals` lists it.
    pub measure: String,
    /// The rate at which the number changes: a formula in `measured`, in `value`, the number in the slab, and in t, the time at its end. After a slab
    /// of length dt the number is `value` + dt times the rate.
    pub rate: Formula,
}

fn zero() -> Formula {
    Formula::Number(0.0)
}
