//! `[tables]`

use super::one_of::{self, OneOf};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;
use std::path::PathBuf;

/// A function given by a table: `t` and `values`, or a `file`. Between its points it is a cubic spline, with two continuous
/// derivatives. A boundary that starts at rest needs the value 0 at the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// The times, or values of another variable, increasing.
    pub t: Option<Vec<f64>>,
    /// The values at these times.
    pub values: Option<Vec<f64>>,
    /// Instead of both: a text file, relative to the case file. Each line holds the numbers of one time, the time first, separated
    /// by semicolons, tabs, commas or blanks. The first line may name the columns, with units behind the names; # begins a comment. If all
    /// lines above the numbers are comments, the last one may name the columns.
    pub file: Option<PathBuf>,
    /// The column of the file that holds the values: its name without the unit, or its number, where 1 is the time. Default: the second column.
    pub column: Option<Column>,
    /// The ends of the table, and the values beyond them.
    #[serde(default)]
    pub ends: Ends,
}

/// A column of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Column {
    /// Its number, from 1.
    Number(usize),
    /// Its name.
    Name(String),
}

impl OneOf for Column {
    type Entry = ();
    const EXPECTED: &'static str = "a name in quotes, or a whole number from 1";
    const OF_TEXT: fn(String) -> Self = Column::Name;
    const OF_WHOLE: Option<fn(usize) -> Self> = Some(Column::Number);
}

impl<'de> Deserialize<'de> for Column {
    fn deserialize<S: Deserializer<'de>>(deserializer: S) -> Result<Self, S::Error> {
        one_of::deserialize(deserializer)
    }
}

impl JsonSchema for Column {
    fn schema_name() -> Cow<'static, str> {
        "Column".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": ["string", "integer"], "description": "A name, or a whole number from 1." })
    }
}

/// The ends of a table, and the values beyond them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    /// No condition at the ends, and no value beyond them: the table must cover the run. At least four points.
    #[default]
    Free,
    /// The rate is zero at the ends, and beyond them the value is constant: a motion that starts and ends smoothly.
    AtRest,
    /// The table covers one period and is repeated; its last value equals its first. At least four points.
    Periodic,
}
