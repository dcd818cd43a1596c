//! The steady flow at the start.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The steady flow from which a run starts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Steady {
    /// Newton steps.
    pub newton: u64,
    /// Krylov iterations.
    pub krylov: u64,
    /// The residual, relative to the residual of the initial state.
    pub residual: f64,
    /// The residual at the next higher order, relative to its inertial terms.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub next_order_residual: Option<f64>,
    /// The result of a march in time from the steady flow, if there was one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub stability: Option<SteadyStability>,
    /// The coefficients of the walls, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub walls: BTreeMap<String, SteadyWall>,
}

/// A march in time from a steady flow that was disturbed slightly.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SteadyStability {
    /// The factor by which the rate of change has grown.
    pub growth: f64,
    /// The time marched.
    pub duration: f64,
    /// Whether every slab could be solved.
    pub completed: bool,
    /// Whether the steady flow is unstable.
    pub unstable: bool,
}

/// The coefficients of a wall in steady flow.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SteadyWall {
    /// Drag coefficient.
    pub drag_coefficient: f64,
    /// Lift coefficient.
    pub lift_coefficient: f64,
    /// Moment coefficient.
    pub moment_coefficient: f64,
}
