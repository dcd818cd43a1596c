//! Points of a curve: a list, or a file.

use super::one_of::{self, OneOf};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;
use std::path::PathBuf;

/// Points of a curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum BodyPoints {
    /// A text file.
    File(PathBuf),
    /// The points themselves.
    List(Vec<[f64; 2]>),
}

impl OneOf for BodyPoints {
    type Entry = [f64; 2];
    const EXPECTED: &'static str = "the name of a file in quotes, or a list of points [x, y]";
    const OF_TEXT: fn(String) -> Self = |name| BodyPoints::File(name.into());
    const OF_LIST: Option<fn(Vec<[f64; 2]>) -> Self> = Some(BodyPoints::List);
}

impl<'de> Deserialize<'de> for BodyPoints {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> Result<Self, S::Error> {
        one_of::deserialize(deserializer)
    }
}

impl JsonSchema for BodyPoints {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "BodyPoints".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let (file, list) = (generator.subschema_for::<PathBuf>(), generator.subschema_for::<Vec<[f64; 2]>>());
        json_schema!({ "anyOf": [file, list] })
    }
}
