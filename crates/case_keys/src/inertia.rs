//! An entry of a tensor of inertia.

use super::formula::Formula;
use super::one_of::{self, OneOf};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;

/// A moment on the diagonal, or a row of the tensor.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum InertiaEntry {
    /// A moment about an axis.
    Moment(Formula),
    /// A row.
    Row(Vec<Formula>),
}

impl OneOf for InertiaEntry {
    type Entry = Formula;
    const EXPECTED: &'static str = "a number, a formula in quotes, or a list of these";
    const OF_TEXT: fn(String) -> Self = |text| InertiaEntry::Moment(Formula::Text(text));
    const OF_NUMBER: Option<fn(f64) -> Self> = Some(|value| InertiaEntry::Moment(Formula::Number(value)));
    const OF_LIST: Option<fn(Vec<Formula>) -> Self> = Some(InertiaEntry::Row);
}

impl<'de> Deserialize<'de> for InertiaEntry {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> Result<Self, S::Error> {
        one_of::deserialize(deserializer)
    }
}

impl JsonSchema for InertiaEntry {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "InertiaEntry".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let formula = generator.subschema_for::<Formula>();
        json_schema!({ "anyOf": [formula, { "type": "array", "items": formula }] })
    }
}
