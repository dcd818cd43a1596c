//! An entry of a tensor of inertia.

use super::formula::Formula;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;
use std::fmt;

/// A moment on the diagonal, or a row of the tensor.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum InertiaEntry {
    /// A moment about an axis.
    Moment(Formula),
    /// A row.
    Row(Vec<Formula>),
}

/// By hand, because the errors of untagged enums contain no place.
impl<'de> Deserialize<'de> for InertiaEntry {
    fn deserialize<T: Deserializer<'de>>(deserializer: T) -> Result<Self, T::Error> {
        deserializer.deserialize_any(EntryVisitor)
    }
}

struct EntryVisitor;

impl<'de> Visitor<'de> for EntryVisitor {
    type Value = InertiaEntry;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, a formula in quotes, or a list of these")
    }
    fn visit_f64<E: Error>(self, value: f64) -> Result<InertiaEntry, E> {
        Ok(InertiaEntry::Moment(Formula::Number(value)))
    }
    fn visit_i64<E: Error>(self, value: i64) -> Result<InertiaEntry, E> {
        self.visit_f64(value as f64)
    }
    fn visit_u64<E: Error>(self, value: u64) -> Result<InertiaEntry, E> {
        self.visit_f64(value as f64)
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<InertiaEntry, E> {
        Ok(InertiaEntry::Moment(Formula::Text(text.to_owned())))
    }
    fn visit_seq<A: SeqAccess<'de>>(self, row: A) -> Result<InertiaEntry, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(row)).map(InertiaEntry::Row)
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
