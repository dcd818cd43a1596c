//! A number, or a text to be compiled.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;
use std::fmt;

/// A formula as written.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Formula {
    /// A plain number.
    Number(f64),
    /// A text.
    Text(String),
}

/// By hand, because the errors of untagged enums contain no place.
impl<'de> Deserialize<'de> for Formula {
    fn deserialize<T: Deserializer<'de>>(deserializer: T) -> Result<Self, T::Error> {
        deserializer.deserialize_any(FormulaVisitor)
    }
}

struct FormulaVisitor;

impl Visitor<'_> for FormulaVisitor {
    type Value = Formula;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a formula in quotes")
    }
    fn visit_f64<E: Error>(self, value: f64) -> Result<Formula, E> {
        Ok(Formula::Number(value))
    }
    fn visit_i64<E: Error>(self, value: i64) -> Result<Formula, E> {
        Ok(Formula::Number(value as f64))
    }
    fn visit_u64<E: Error>(self, value: u64) -> Result<Formula, E> {
        Ok(Formula::Number(value as f64))
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<Formula, E> {
        Ok(Formula::Text(text.to_owned()))
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
