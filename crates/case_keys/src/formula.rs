//! A number, or a text to be compiled.

use super::one_of::{self, OneOf};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;

/// A formula as written.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Formula {
    /// A plain number.
    Number(f64),
    /// A text.
    Text(String),
}

impl OneOf for Formula {
    type Entry = ();
    const EXPECTED: &'static str = "a number or a formula in quotes";
    const OF_TEXT: fn(String) -> Self = Formula::Text;
    const OF_NUMBER: Option<fn(f64) -> Self> = Some(Formula::Number);
}

impl<'de> Deserialize<'de> for Formula {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> Result<Self, S::Error> {
        one_of::deserialize(deserializer)
    }
}

impl JsonSchema for Formula {
    fn schema_name() -> Cow<'static, str> {
        "Formula".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": ["number", "string"], "description": "A number, or a formula in quotes." })
    }
}
