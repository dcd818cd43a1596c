//! `[structure]`

use super::Axis;
use super::formula::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// An elastic body that fills the mesh. Its displacement has the order of the mesh. Positions and loads are those of the body at rest: with
/// the linear law the displacement is small.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Structure {
    /// Young's modulus E: a number, or a formula in the position x, y, z at rest.
    pub young_modulus: Formula,
    /// Poisson's ratio nu, -1 < nu < 0.5: a number, or a formula in the position x, y, z at rest.
    pub poisson_ratio: Formula,
    /// The stress of a strain. The laws that are not linear are for plane strain or three dimensions.
    #[serde(default)]
    pub law: StructureLaw,
    /// Rayleigh damping. Without it there is none.
    #[serde(default)]
    pub damping: Damping,
    /// The density at rest: mass per volume. A static analysis without natural modes needs none.
    pub density: Option<f64>,
    /// Whether the body has inertia.
    #[serde(default)]
    pub analysis: Analysis,
    /// What does not happen along the third axis of a two-dimensional body.
    pub plane: Option<Plane>,
    /// The force per volume, a formula per axis in the position x, y, z at rest and the time t. Without it there is none.
    pub body_force: Option<Vec<Formula>>,
    /// How each boundary is supported or loaded, by name; `others` stands for all that are not named.
    #[serde(default)]
    pub boundary: BTreeMap<String, StructureBoundary>,
    /// The motion at the start. Without it the body is at rest. A static analysis starts from the equilibrium at the start.
    #[serde(default)]
    pub initial: InitialMotion,
    /// How many natural modes to find, those of lowest frequency: their frequencies go to summary.json, and the coordinate of the motion
    /// in each of them to history.csv, as mode_1, mode_2, ...
    #[serde(default)]
    pub natural_modes: usize,
    /// Points at rest whose displacement goes to history.csv, by name.
    #[serde(default)]
    pub points: BTreeMap<String, Vec<f64>>,
}

/// The stress of a strain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StructureLaw {
    /// Linear elasticity, for small displacements.
    #[default]
    Linear,
    /// The law of St. Venant and Kirchhoff: linear in the strain of Green, for large displacements of small strain.
    StVenantKirchhoff,
    /// A compressible neo-Hookean material, for large strain.
    NeoHookean,
}

/// The damping C = alpha M + beta K of Rayleigh, a force against the velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Damping {
    /// alpha: per mass, in units of one over time.
    #[serde(default)]
    pub mass: f64,
    /// beta: per stiffness, in units of time.
    #[serde(default)]
    pub stiffness: f64,
}

/// Whether a structure has inertia.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Analysis {
    /// It vibrates: the equation of motion is solved.
    #[default]
    Dynamic,
    /// It is in equilibrium with its loads and supports at all times: time numbers the steps of the load. One slab is one step.
    Static,
}

/// What does not happen along the third axis of a two-dimensional body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Plane {
    /// No strain: a slice of a long body. This is what a case without the key has.
    #[default]
    Strain,
    /// No stress: a thin sheet, free to change its thickness.
    Stress,
}

/// How a boundary of a structure is supported or loaded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum StructureBoundary {
    /// Nothing acts on it.
    Free,
    /// It is clamped.
    Fixed,
    /// It is held along these axes and free along the others: a plane of symmetry, a wall without friction.
    Held(Vec<Axis>),
    /// Its displacement, a formula per axis in the position x, y, z at rest and the time t.
    Displacement(Vec<Formula>),
    /// The force per area, a formula per axis in the position x, y, z at rest and the time t.
    Traction(Vec<Formula>),
    /// The force per area against the outward normal at rest, a formula.
    Pressure(Formula),
    /// The same per area and against the normal of the body as it moves, a formula in the position x, y, z at rest and the time t.
    FollowerPressure(Formula),
}

/// The motion of a structure at the start, a formula per axis in the position x, y, z at rest. Supports have their own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InitialMotion {
    /// The displacement.
    pub displacement: Option<Vec<Formula>>,
    /// The velocity.
    pub velocity: Option<Vec<Formula>>,
}
