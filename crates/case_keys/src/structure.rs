//! `[structure]`

use super::Axis;
use super::formula::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// An elastic body that fills the mesh, or beside a flow some regions of it. Its displacement has the order of the mesh. Positions and
/// loads refer to the body at rest, so with the linear law displacements must be small.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Structure {
    /// The regions of the mesh that the body fills. A flow fills all others; structure and flow move each other. Default: the body fills
    /// the mesh, and there is no flow.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<String>,
    /// Young's modulus E: a number, or a formula in the position x, y, z at rest.
    pub young_modulus: Formula,
    /// Poisson's ratio nu, -1 < nu < 0.5: a number, or a formula in the position x, y, z at rest.
    pub poisson_ratio: Formula,
    /// The law of the material, stress by strain. A nonlinear law needs plane strain or three dimensions.
    #[serde(default)]
    pub law: StructureLaw,
    /// Rayleigh damping. By default the body is undamped.
    #[serde(default)]
    pub damping: Damping,
    /// The density at rest: mass per volume. A static analysis without natural modes does not need it.
    pub density: Option<f64>,
    /// Whether the body has inertia.
    #[serde(default)]
    pub analysis: Analysis,
    /// Plane strain or plane stress, for a two-dimensional body.
    pub plane: Option<Plane>,
    /// The force per volume, a formula per axis in the position x, y, z at rest and the time t. Default: no force.
    pub body_force: Option<Vec<Formula>>,
    /// The support or load of each boundary, by name; `others` stands for all that are not named. The walls between the body and the flow
    /// are named after the region of the flow, or after a named line of the mesh there. They have no support, and need no entry; `others` does not stand for them.
    #[serde(default)]
    pub boundary: BTreeMap<String, StructureBoundary>,
    /// The motion at the start. Default: the body is at rest. A static analysis starts from the equilibrium at the start.
    #[serde(default)]
    pub initial: InitialMotion,
    /// The number of natural modes to find, those of lowest frequency, of the body without loads. Their frequencies go to summary.json, and the coordinate of the
    /// motion in each of them to history.csv, as mode_1, mode_2, ... A static analysis with large displacements also finds the frequencies of
    /// vibrations about its equilibrium, which loads change.
    #[serde(default)]
    pub natural_modes: usize,
    /// Points at rest whose displacement goes to history.csv, by name.
    #[serde(default)]
    pub points: BTreeMap<String, Vec<f64>>,
}

/// The law of the material, stress by strain.
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
    /// The body has inertia: the equation of motion is solved.
    #[default]
    Dynamic,
    /// The body is in equilibrium with its loads and supports at all times: time numbers the load steps. One slab is one step.
    Static,
}

/// Plane strain or plane stress, for a two-dimensional body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Plane {
    /// No strain along the third axis: a slice of a long body. This is the default.
    #[default]
    Strain,
    /// No stress along the third axis: a thin sheet, free to change its thickness.
    Stress,
}

/// The support or load of a boundary of a structure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum StructureBoundary {
    /// No support or load.
    Free,
    /// Clamped.
    Fixed,
    /// Held along these axes and free along the others: a plane of symmetry, a frictionless wall.
    Held(Vec<Axis>),
    /// A prescribed displacement, a formula per axis in the position x, y, z at rest and the time t.
    Displacement(Vec<Formula>),
    /// The force per area, a formula per axis in the position x, y, z at rest and the time t.
    Traction(Vec<Formula>),
    /// The force per area against the outward normal at rest, a formula.
    Pressure(Formula),
    /// The force per current area against the current outward normal, a formula in the position x, y, z at rest and the time t.
    FollowerPressure(Formula),
}

/// The motion of a structure at the start, a formula per axis in the position x, y, z at rest. Supports have their own
/// motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InitialMotion {
    /// The displacement.
    pub displacement: Option<Vec<Formula>>,
    /// The velocity.
    pub velocity: Option<Vec<Formula>>,
}
