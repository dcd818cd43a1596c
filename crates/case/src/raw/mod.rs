//! What the user writes: the keys of a case file with their types, defaults and descriptions.
//!
//! The doc comments here are the reference of the case file: `stsolve schema` prints them.

mod bodies;
mod flow;
mod formula;
mod generate;
mod mesh;
mod motion;
mod openings;
mod run;
mod solver;
mod structure;
mod table;

pub use bodies::*;
pub use flow::*;
pub use formula::Formula;
pub use generate::*;
pub use mesh::*;
pub use motion::*;
pub use openings::*;
pub use run::*;
pub use solver::*;
pub use structure::*;
pub use table::*;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A case of stsolve: a mesh, how it moves, the flow on it, and the time to cover; or a mesh, the structure that it is, and the time.
///
/// Units are any consistent system. Vectors have one entry per axis, two or three; the number of axes is that of the mesh.
/// A formula is a number or a text such as "0.1*sin(pi*t/4)" in x, y, z, t, pi, the constants and the tables of the case, with
/// + - * / ^, comparisons, if(condition, a, b), min, max, abs, sqrt, exp, log, sin, cos, tan, atan, tanh, sinh, cosh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// One line that says what the case is.
    #[serde(default)]
    pub title: String,
    /// Names for numbers, to be used in formulas. A constant may be a formula of the constants above it.
    #[serde(default)]
    pub constants: BTreeMap<String, Formula>,
    /// Functions given by tables, by name: with a table `heave`, formulas may contain "heave(t)". They are interpolated smoothly, by
    /// cubic splines, so that velocities are continuous.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub tables: BTreeMap<String, Table>,
    /// The mesh at rest.
    pub mesh: Mesh,
    /// How the mesh moves. Without it the mesh rests.
    pub motion: Option<Motion>,
    /// The flow. Without it only the mesh moves.
    pub flow: Option<Flow>,
    /// Rigid bodies that the flow moves, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub bodies: BTreeMap<String, Body>,
    /// An elastic structure that fills the mesh and moves by itself. It excludes `motion` and `flow`.
    pub structure: Option<Structure>,
    /// The time to cover.
    pub time: Time,
    /// Starts where another run stands, instead of from the initial state.
    pub restart: Option<Restart>,
    /// How the equations of a slab are solved.
    #[serde(default)]
    pub solver: Solver,
    /// What is written, and where.
    #[serde(default)]
    pub output: Output,
}

/// The JSON Schema of a case file.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(Case)
}
