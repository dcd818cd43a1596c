//! What a run cost, and on which machine: parts of `summary.json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// The machine of the run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// What the processor calls itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub processor: Option<String>,
    /// Processors that the run may use.
    pub processors: usize,
    /// Operating system and instruction set.
    pub system: String,
}

/// What the run cost.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// Seconds from start to end.
    pub wall_seconds: f64,
    /// Seconds of these before the first slab.
    pub setup_seconds: f64,
    /// Largest memory of the process.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_memory_bytes: Option<u64>,
    /// Threads used.
    pub threads: usize,
    /// Residual evaluations.
    pub residual_evaluations: u64,
    /// Jacobian-vector products.
    pub jacobian_products: u64,
    /// Where the seconds went, by name: they add up to `wall_seconds`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub parts: BTreeMap<String, Part>,
}

/// A part of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Seconds spent in it.
    pub seconds: f64,
    /// How often it was called.
    pub calls: u64,
}
