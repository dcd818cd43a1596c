//! Points of a curve: a list, or a file.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;
use std::fmt;
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

/// By hand, because the errors of untagged enums contain no place.
impl<'de> Deserialize<'de> for BodyPoints {
    fn deserialize<T: Deserializer<'de>>(deserializer: T) -> Result<Self, T::Error> {
        deserializer.deserialize_any(PointsVisitor)
    }
}

struct PointsVisitor;

impl<'de> Visitor<'de> for PointsVisitor {
    type Value = BodyPoints;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a file in quotes, or a list of points [x, y]")
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<BodyPoints, E> {
        Ok(BodyPoints::File(text.into()))
    }
    fn visit_seq<A: SeqAccess<'de>>(self, points: A) -> Result<BodyPoints, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(points)).map(BodyPoints::List)
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
