//! The raw case: the keys of a case file with their types, defaults and descriptions.
//!
//! These doc comments are the reference of the case file: `stsolve schema` prints them. The crate `case` checks what the keys say.
//!
//! A case is read once per run. So this crate is compiled without optimisation, which shortens a first build.

mod bodies;
mod control;
mod fields;
mod flow;
mod formula;
mod generate;
mod inertia;
mod mesh_keys;
mod motion;
mod newton_settings;
mod one_of;
mod openings;
mod parallel;
mod points;
mod run;
mod solver;
mod structure;
mod table;

pub use bodies::*;
pub use control::Control;
pub use flow::*;
pub use formula::Formula;
pub use generate::*;
pub use inertia::InertiaEntry;
pub use mesh_keys::*;
pub use motion::*;
pub use openings::*;
pub use parallel::{Parallel, Stages};
pub use points::BodyPoints;
pub use run::*;
pub use solver::*;
pub use structure::*;
pub use table::*;

use schemars::JsonSchema;
use serde::de::IntoDeserializer;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A case of stsolve: a mesh, its motion, the flow on it, and the time to cover; or a mesh, the structure that fills it, and the
/// time. A structure beside a flow fills some regions of the mesh.
///
/// Units are any consistent system. Vectors have one entry per axis, two or three, as many as the mesh has axes.
/// A formula is a number or a text such as "0.1*sin(pi*t/4)". It may contain x, y, z, t, pi, the constants and the tables of
/// the case. Its operators are + - * / ^ (or **), comparisons and if(condition, a, b). Functions of two numbers are min, max and atan2(y, x). Functions of one
/// number are abs, sqrt, exp, log (the natural one), sin, cos, tan, asin, acos, atan, tanh, sinh, cosh and floor. deg(a) is the angle of a degrees, in radians. Wherever a number is needed, a formula of
/// constants may stand in quotes: `velocity = ["cos(deg(5))", "sin(deg(5))"]`, `end = "10*period"`, `slabs = "40*periods"`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// A title in one line.
    #[serde(default)]
    pub title: String,
    /// Names of numbers for formulas. A constant may be a formula of others, in any order.
    #[serde(default)]
    pub constants: BTreeMap<String, Formula>,
    /// Functions given by tables, by name: with a table `heave`, formulas may contain "heave(t)". They are interpolated by cubic
    /// splines, so that velocities are continuous.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub tables: BTreeMap<String, Table>,
    /// Numbers in formulas that the run changes after every slab, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub controls: BTreeMap<String, Control>,
    /// The mesh at rest.
    pub mesh: Mesh,
    /// The motion of the mesh. Without it the mesh rests.
    pub motion: Option<Motion>,
    /// The flow. Without it only the mesh moves.
    pub flow: Option<Flow>,
    /// Rigid bodies that the flow moves, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub bodies: BTreeMap<String, Body>,
    /// An elastic structure. It moves by itself, or with the flow beside it.
    pub structure: Option<Structure>,
    /// The time to cover.
    pub time: Time,
    /// Starts from the result of another run instead of the initial state; only together with `[flow]`.
    pub restart: Option<Restart>,
    /// The solver of a slab.
    #[serde(default)]
    pub solver: Solver,
    /// The output.
    #[serde(default)]
    pub output: Output,
    /// Work on several machines.
    #[serde(default)]
    pub parallel: Parallel,
}

/// The name of the schema, for editors.
const SCHEMA_ID: &str = "https://github.com/stsolve/stsolve/schema/case.json";

/// The JSON Schema of a case file.
pub fn schema() -> schemars::Schema {
    let mut schema = schemars::schema_for!(Case);
    schema.insert("$id".to_owned(), SCHEMA_ID.into());
    schema
}

/// The schema for editors: every number may be a formula in quotes.
pub fn editor_schema() -> schemars::Schema {
    let mut schema = schema().to_value();
    accept_formulas(&mut schema);
    omit_null(&mut schema);
    schemars::Schema::try_from(schema).expect("an object stays one")
}

/// Drops the choice of null, which TOML does not have. With it an editor marks every key of a section in which one is wrong.
fn omit_null(schema: &mut serde_json::Value) {
    match schema {
        serde_json::Value::Object(entries) => {
            let is_null =
                |kind: &serde_json::Value| kind == "null" || kind.get("type").is_some_and(|kind| kind == "null");
            for list in ["anyOf", "type", "enum"] {
                let Some(serde_json::Value::Array(choices)) = entries.get_mut(list) else { continue };
                choices.retain(|choice| !is_null(choice) && !choice.is_null());
                match (list, &choices[..]) {
                    ("anyOf", [serde_json::Value::Object(one)]) => {
                        let one = one.clone();
                        entries.remove(list);
                        one.into_iter().for_each(|(key, value)| _ = entries.entry(key).or_insert(value));
                    }
                    ("type", [one]) => *entries.get_mut(list).expect("the list was found") = one.clone(),
                    _ => {}
                }
            }
            entries.retain(|key, value| key != "default" || !value.is_null());
            entries.values_mut().for_each(omit_null);
        }
        serde_json::Value::Array(entries) => entries.iter_mut().for_each(omit_null),
        _ => {}
    }
}

fn accept_formulas(schema: &mut serde_json::Value) {
    match schema {
        serde_json::Value::Object(entries) => {
            let is_number = |kind: &serde_json::Value| kind == "number" || kind == "integer";
            match entries.get_mut("type") {
                Some(kind) if is_number(kind) => *kind = serde_json::json!([*kind, "string"]),
                Some(serde_json::Value::Array(kinds))
                    if kinds.iter().any(is_number) && !kinds.iter().any(|k| k == "string") =>
                {
                    kinds.push("string".into());
                }
                _ => {}
            }
            entries.values_mut().for_each(accept_formulas);
        }
        serde_json::Value::Array(entries) => entries.iter_mut().for_each(accept_formulas),
        _ => {}
    }
}

/// Reads a case from the `tree` of a document.
///
/// # Errors
/// The first key that is missing, unknown or of the wrong type.
pub fn read_case(tree: toml::Spanned<toml::de::DeTable<'_>>) -> Result<Case, toml::de::Error> {
    Case::deserialize(toml::de::Deserializer::from(tree))
}

/// Reads a case from the text that [`to_toml`] gave.
///
/// # Errors
/// What is wrong in the text.
pub fn from_toml(text: &str) -> Result<Case, String> {
    toml::from_str(text).map_err(|error| error.message().to_owned())
}

/// `case` as text.
pub fn to_toml(case: &Case) -> String {
    toml::to_string(case).expect(WRITABLE)
}

/// `case` as a table.
pub fn to_table(case: &Case) -> toml::Table {
    toml::Table::try_from(case).expect(WRITABLE)
}

/// Why a case that was read can be written.
const WRITABLE: &str = "a case consists of tables, arrays, texts and numbers, which TOML can write";

/// Reads a formula from a `value` of a document.
///
/// # Errors
/// A value that is neither a number nor a text.
pub fn read_formula(value: toml::Spanned<toml::de::DeValue<'_>>) -> Result<Formula, toml::de::Error> {
    Formula::deserialize(value.into_deserializer())
}
