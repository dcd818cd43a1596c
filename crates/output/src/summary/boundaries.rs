//! Openings and walls.

use serde::{Deserialize, Serialize};

/// The mass flow through an inflow or outflow, and observed flow that its condition is not made for.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Opening {
    /// The mass that leaves the domain per time, at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_flow: Option<f64>,
    /// Gas that entered a subsonic inflow faster than sound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub supersonic: Option<Misused>,
    /// Gas that left through an inflow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leaving: Option<Misused>,
    /// Gas that came back through an outflow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub backflow: Option<Misused>,
    /// Subsonic gas at a supersonic inflow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub subsonic: Option<Misused>,
    /// Gas that an inflow of a moving mesh has overtaken.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overtaking: Option<Misused>,
}

/// An observation of flow that a condition is not made for.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Misused {
    /// The time of the first observation.
    pub since: f64,
    /// The fraction of the area of the boundary, at the end.
    pub share: f64,
    /// The largest fraction over the run.
    pub largest_share: f64,
}

/// Impulse, work and heat that a wall received over the run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Time integral of the force, one entry per direction.
    pub impulse: Vec<f64>,
    /// Its part due to pressure.
    pub pressure_impulse: Vec<f64>,
    /// Its part due to friction.
    pub friction_impulse: Vec<f64>,
    /// Time integral of the moment, one entry per axis of rotation: one in two dimensions, three in three.
    pub moment_impulse: Vec<f64>,
    /// Work of the force on the wall.
    pub work: f64,
    /// Heat that the wall takes up by conduction.
    pub heat: f64,
    /// Drag coefficient at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drag_coefficient: Option<f64>,
    /// Lift coefficient at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lift_coefficient: Option<f64>,
    /// Moment coefficient at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moment_coefficient: Option<f64>,
}
