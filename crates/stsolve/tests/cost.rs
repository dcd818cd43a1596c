//! Where the time of a run goes.

#![allow(clippy::unwrap_used)]

mod common;

use common::{number, on_case, shipped, stsolve, summary};
use std::collections::BTreeMap;
use tempfile::TempDir;

const SMALL: [&str; 2] = ["mesh.generate.box.cells=[4,4]", "time.end=0.4"];

/// Seconds and calls of every part.
fn parts(summary: &serde_json::Value) -> BTreeMap<String, (f64, f64)> {
    let parts = summary["cost"]["parts"].as_object().unwrap();
    parts.iter().map(|(name, part)| (name.clone(), (number(part, "seconds"), number(part, "calls")))).collect()
}

#[test]
fn the_parts_of_a_run_add_up_to_its_wall_time() {
    let directory = TempDir::new().unwrap();
    let case = shipped("vortex.toml");
    let outcome = stsolve(directory.path(), &["run", &case, "--output", "run", "--set", SMALL[0], "--set", SMALL[1]]);
    outcome.expect(0, &["where the time went", "Jacobian products", "preconditioner, made", "proof of the mesh"]);
    let summary = summary(&directory.path().join("run"));
    let parts = parts(&summary);
    let names: Vec<&str> = parts.keys().map(String::as_str).collect();
    let known = [
        "elasticity",
        "mesh_proof",
        "orthogonalisation",
        "output",
        "preconditioner",
        "preconditioner_setup",
        "product",
        "residual",
        "rest",
        "setup",
    ];
    assert_eq!(names, known);
    let (sum, wall) = (parts.values().map(|part| part.0).sum::<f64>(), number(&summary, "cost.wall_seconds"));
    assert!((sum - wall).abs() < 1e-9, "{sum} of {wall}");
    assert!(parts.values().all(|part| part.0 > 0.0), "{parts:?}");
    // Beside those of slabs, residuals are evaluated nowhere.
    assert_eq!(parts["residual"].1, number(&summary, "cost.residual_evaluations"));
    assert_eq!(parts["product"].1, number(&summary, "cost.jacobian_products"));
    assert_eq!(parts["preconditioner"].1, number(&summary, "krylov.total"));
}

#[test]
fn calls_are_the_same_in_every_run_and_a_quiet_run_tells_nothing() {
    let directory = TempDir::new().unwrap();
    let calls = ["1", "2"].map(|threads| {
        let outcome = on_case(directory.path(), "run", "vortex", &SMALL, threads, &["--threads", threads]);
        outcome.expect(0, &[]);
        assert_eq!(outcome.stderr, "");
        let parts = parts(&summary(&directory.path().join(threads)));
        parts.into_iter().map(|(name, part)| (name, part.1)).collect::<Vec<_>>()
    });
    assert_eq!(calls[0], calls[1]);
}
