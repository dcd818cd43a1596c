//! Cost and machine of a run: parts of `summary.json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// The machine of the run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// The name that the processor reports.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub processor: Option<String>,
    /// Processors that the run may use.
    pub processors: usize,
    /// Operating system and instruction set.
    pub system: String,
}

/// The cost of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// Seconds from start to end.
    pub wall_seconds: f64,
    /// Seconds before the first slab, included above.
    pub setup_seconds: f64,
    /// Largest memory of the process.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_memory_bytes: Option<u64>,
    /// The same of all processes, if there are several: 0 where it is not known.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub peak_memory_of_processes: Vec<u64>,
    /// Threads used.
    pub threads: usize,
    /// Residual evaluations.
    pub residual_evaluations: u64,
    /// Jacobian-vector products.
    pub jacobian_products: u64,
    /// Seconds and calls of the parts, by name; the seconds add up to `wall_seconds`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub parts: BTreeMap<String, Part>,
}

/// A part of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Seconds spent in it.
    pub seconds: f64,
    /// The number of its calls.
    pub calls: u64,
}
