//! Formulas as values of boundary conditions and as sources; sponges.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../common/mod.rs"]
mod common;

mod boundaries;
mod controls;
mod sound;
mod sources;

use common::{number, on_text, summary};
use std::path::Path;

/// A run of `case` that must reach its end.
fn run(directory: &Path, case: &str, set: &[&str], output: &str) -> serde_json::Value {
    on_text(directory, case, set, output, &["--quiet"]).expect(0, &[]);
    summary(&directory.join(output))
}

fn largest_error(summary: &serde_json::Value) -> f64 {
    ["density_l2", "momentum_l2", "energy_l2"]
        .map(|name| number(summary, &format!("error.{name}")))
        .into_iter()
        .fold(0.0, f64::max)
}
