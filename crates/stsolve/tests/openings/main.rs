//! Gas that enters and leaves: vortices through an outflow, shear through an inflow, a blade started from a uniform stream, a channel with
//! a given mass flux. Also the reports of a run about flow for which a condition is not suited.
//!
//! The long versions: `cargo test --release -p stsolve --test openings -- --ignored`

#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../common/mod.rs"]
mod common;

mod passages;
mod reservoirs;
mod supersonic;
mod vortices;

use common::{checkpoint, on_text, summary};
use std::path::Path;
use tempfile::TempDir;

/// The summary of a run that must reach its end.
fn survives(case: &str, set: &[&str]) -> serde_json::Value {
    let directory = TempDir::new().unwrap();
    on_text(directory.path(), case, set, "run", &["--quiet"]).expect(0, &[]);
    summary(&directory.path().join("run"))
}

/// Density, speed and pressure at every node at the end of a run of order 4 in two dimensions.
fn gas_at_end(run: &Path) -> Vec<[f64; 3]> {
    const NODES: usize = 16;
    let flow: Vec<f64> = checkpoint(run).0["flow"].iter().map(|&bits| f64::from_bits(bits)).collect();
    let node = |cell: &[f64], i: usize| {
        let [density, x, y, energy] = [0, 1, 2, 3].map(|component| cell[component * NODES + i]);
        let squared = (x * x + y * y) / (density * density);
        [density, squared.sqrt(), 0.4 * (energy - 0.5 * density * squared)]
    };
    flow.chunks_exact(4 * NODES).flat_map(|cell| (0..NODES).map(move |i| node(cell, i))).collect()
}

/// The largest difference of the pressure from the pressure of the outlet, relative to it.
fn pressure_off(run: &Path) -> f64 {
    gas_at_end(run).iter().map(|[_, _, p]| (p / 7.936507936507937 - 1.0).abs()).fold(0.0, f64::max)
}
