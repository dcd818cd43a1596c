//! The wall time of the parts of a run.

#![allow(clippy::unwrap_used)]

mod common;

use common::{number, on_case, shipped, stsolve, summary};
use simulation::clock::{CostClock, table};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tracing_subscriber::Layer;
use tracing_subscriber::filter::filter_fn;
use tracing_subscriber::layer::SubscriberExt;

const SMALL: [&str; 2] = ["mesh.generate.box.cells=[4,4]", "time.end=0.4"];

/// Seconds and calls of every part.
fn parts(summary: &serde_json::Value) -> BTreeMap<String, (f64, f64)> {
    let parts = summary["cost"]["parts"].as_object().unwrap();
    parts.iter().map(|(name, part)| (name.clone(), (number(part, "seconds"), number(part, "calls")))).collect()
}

#[test]
fn the_summary_has_the_parts_of_a_run() {
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
    // Only slabs evaluate residuals.
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

/// A motion of the mesh in a slab is proved once. A linear law has one motion a slab; with another law every iterate is proved.
#[test]
fn no_motion_of_the_mesh_is_proved_twice() {
    let directory = TempDir::new().unwrap();
    let bent = [
        "mesh.generate.box.cells=[3,3]",
        "time.step=0.2",
        "time.end=1",
        "motion.boundary={others={displacement=[\"0.2*t*sin(0.3*y)\",\"0.3*t*sin(0.4*x)\"]}}",
    ];
    let linear: &[&str] = &[];
    let (neo_hookean, joint) = ("motion.elasticity.law=\"neo_hookean\"", "solver.predictor=\"extrapolate\"");
    for (command, name, set, proofs) in [
        ("run", "linear", linear, 5.0),
        ("motion", "linear alone", linear, 5.0),
        ("run", "neo-Hookean", &[neo_hookean], 17.0),
        ("motion", "neo-Hookean alone", &[neo_hookean], 10.0),
        ("run", "solved with the flow", &[neo_hookean, joint], 16.0),
    ] {
        on_case(directory.path(), command, "vortex", &[&bent[..], set].concat(), name, &[]).expect(0, &[]);
        let summary = summary(&directory.path().join(name));
        assert_eq!((number(&summary, "slabs"), parts(&summary)["mesh_proof"].1), (5.0, proofs), "{name}");
    }
}

/// Time within a span belongs to that span alone, and all parts together are the wall time.
#[test]
fn parts_add_up_to_the_wall_time() {
    let begun = Instant::now();
    let pause = || std::thread::sleep(Duration::from_millis(10));
    pause();
    let clock = CostClock::new(begun);
    let layer = clock.clone().with_filter(filter_fn(CostClock::counts));
    tracing::subscriber::with_default(tracing_subscriber::registry().with(layer), || {
        let outer = tracing::trace_span!(target: "cost", "orthogonalisation").entered();
        for _ in 0..2 {
            let _inner = tracing::trace_span!(target: "cost", "product").entered();
            let _other = tracing::trace_span!(target: "something else", "product").entered();
            pause();
        }
        drop(outer);
        pause();
    });
    let parts = clock.parts();
    let wall = begun.elapsed().as_secs_f64();
    let sum: f64 = parts.values().map(|part| part.seconds).sum();
    // Time counted twice would exceed the wall time.
    assert!((0.04..=wall).contains(&sum), "{sum} of {wall}");
    let calls: Vec<_> = parts.iter().map(|(name, part)| (name.as_str(), part.calls)).collect();
    assert_eq!(calls, [("orthogonalisation", 1), ("product", 2), ("rest", 0), ("setup", 1)]);
    assert!(parts["product"].seconds >= 0.02 && parts["rest"].seconds >= 0.01 && parts["setup"].seconds >= 0.01);
    let table = table(&parts);
    assert!(table.contains("Jacobian products") && table.lines().count() == 5, "{table}");
}
