//! `[tables]`

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
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
    /// by commas or blanks. The first line may name the columns; # begins a comment.
    pub file: Option<PathBuf>,
    /// The name of the column of the file that holds the values. Default: the second column.
    pub column: Option<String>,
    /// The ends of the table, and the values beyond them.
    #[serde(default)]
    pub ends: Ends,
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
