//! Steady starts: their boundary data, their search, and their message if there is no steady flow.
//!
//! `scripts/steady_starts.py` runs the twelve starts of its table on finer meshes, each at two orders.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../common/mod.rs"]
mod common;

mod boundaries;
mod closed_domains;
mod convection;
mod equilibrium;
mod search;
mod stability;

use common::{Outcome, stsolve};
use std::path::Path;

/// Runs a case given as text.
fn run(directory: &Path, name: &str, case: &str) -> Outcome {
    let file = directory.join(format!("{name}.toml"));
    std::fs::write(&file, case).unwrap();
    stsolve(directory, &["run", file.to_str().unwrap(), "--output", name, "--quiet"])
}

/// 280 cells.
const COARSE: &str = "mesh.generate.airfoil={ first_cell = 0.015, trailing_edge_cell = 0.02, surface_cells = 8, wake_cells = 6, \
                      normal_cells = 10, far_field = 20 }";
