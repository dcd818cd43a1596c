//! Structures and bodies.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Frequencies and energy of a structure.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StructureSummary {
    /// Natural frequencies, periods per unit of time, in increasing order.
    pub natural_frequencies: Vec<f64>,
    /// The same of vibrations about the equilibrium at the end of a static analysis, under its loads.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub loaded_frequencies: Vec<f64>,
    /// The least stiffness under the loads at the end of a static analysis, relative to that without loads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_stiffness: Option<f64>,
    /// The multiple of the loads at which the structure buckles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub buckling_factor: Option<f64>,
    /// Kinetic and strain energy at the start.
    pub energy_at_start: f64,
    /// Kinetic and strain energy at the end.
    pub energy: f64,
    /// Work of body force and tractions.
    pub load_work: f64,
    /// Work done by boundaries with a prescribed displacement.
    pub support_work: f64,
    /// Energy lost in the jumps between slabs.
    pub dissipation: f64,
    /// Imbalance of the energy: the part of its change that work and dissipation do not explain.
    pub energy_error: f64,
    /// Iterations of the linear solvers over the run.
    pub iterations: u64,
}

/// A rigid body.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// The displacement along each axis.
    pub displacement: Vec<f64>,
    /// The angle of rotation in radians.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<f64>,
    /// Its rotation vector, where it turns about several axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation_vector: Option<Vec<f64>>,
    /// Its velocity; empty for a static analysis.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub velocity: Vec<f64>,
    /// Its angular velocity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angular_velocity: Option<f64>,
    /// The vector of its angular velocity, where it turns about several axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angular_velocity_vector: Option<Vec<f64>>,
    /// The amplitude of the coordinate that moves it most, over the last ten periods at most.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplitude: Option<f64>,
    /// Its frequency.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency: Option<f64>,
    /// Every coordinate: "x", "y", "z", "rotation", "rotation_x" ... of a rigid body, the displacements of the observed points of a
    /// structure.
    pub coordinates: BTreeMap<String, Oscillation>,
    /// The work of the flow on it.
    pub work: f64,
    /// Its kinetic energy.
    pub kinetic_energy: f64,
    /// The energy in the springs of a rigid body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spring_energy: Option<f64>,
    /// The energy of the strain of a structure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strain_energy: Option<f64>,
    /// The work of the drives of prescribed coordinates.
    pub drive_work: f64,
    /// The work of the outer force.
    pub force_work: f64,
    /// The energy dissipated by its dampers.
    pub damped: f64,
    /// The energy dissipated by the time integration.
    pub numerical_dissipation: f64,
}

/// The oscillation of a coordinate.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Oscillation {
    /// Half of the distance between turning points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplitude: Option<f64>,
    /// Periods per time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency: Option<f64>,
}
