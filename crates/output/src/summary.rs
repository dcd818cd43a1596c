//! `summary.json`: the figures of a run for scripts and tests. An absent key means that it does not apply.

mod bodies;
mod boundaries;
mod numerics;
mod steady;

pub use bodies::*;
pub use boundaries::*;
pub use numerics::*;
pub use steady::*;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::cost::{Cost, Machine};
use crate::directory::RunDirectory;
use crate::error::OutputError;
use crate::files::{file_error, write_atomically};

/// Name of the summary in the run directory.
pub const SUMMARY_FILE: &str = "summary.json";

/// The figures of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Summary {
    /// Name of the case.
    pub case: String,
    /// Version of the program.
    pub version: String,
    /// Whether the end time was reached.
    pub completed: bool,
    /// Why the run ended before its end time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Size of the mesh.
    pub mesh: MeshSize,
    /// Number of unknowns of a slab.
    pub unknowns: Unknowns,
    /// Slabs done.
    pub slabs: u64,
    /// Attempts at slabs that failed and were repeated: with a shorter slab, an easier start or in a split form.
    pub rejected_slabs: u64,
    /// The thickness of the boundary layer that the initial state was given at walls, if it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_layer: Option<f64>,
    /// The time from which the flow is solved in a split form, if a slab could not be solved without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub split_form_since: Option<f64>,
    /// Time reached.
    pub time: f64,
    /// Newton steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub newton: Option<Newton>,
    /// Krylov iterations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub krylov: Option<Krylov>,
    /// Quality of the moving mesh over the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh_quality: Option<MeshQuality>,
    /// Errors of conserved quantities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub conservation: Option<Conservation>,
    /// Distance to the exact solution at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorNorms>,
    /// The steady flow from which the run starts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steady: Option<Steady>,
    /// Frequencies and energy of a structure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub structure: Option<StructureSummary>,
    /// Forces on the walls, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub walls: BTreeMap<String, Wall>,
    /// Rigid bodies that the flow moves, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub bodies: BTreeMap<String, Body>,
    /// Mass flow and warnings of inflows and outflows, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub openings: BTreeMap<String, Opening>,
    /// The machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine: Option<Machine>,
    /// The cost of the run.
    pub cost: Cost,
}

impl Summary {
    /// Writes `summary.json`; an older file is replaced as a whole.
    ///
    /// # Errors
    /// [`OutputError::File`] if the system refuses.
    pub fn write(&self, directory: &RunDirectory) -> Result<(), OutputError> {
        let path = directory.path().join(SUMMARY_FILE);
        let text = serde_json::to_string_pretty(self).map_err(|error| file_error(&path, error.into()))?;
        write_atomically(&path, (text + "\n").as_bytes())
    }
}

#[cfg(test)]
mod tests;
