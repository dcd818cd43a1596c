//! `stsolve motion`: the mesh alone, and the proof that it stays valid.

#![allow(clippy::unwrap_used)]

mod common;

use common::{column, number, on_case, shipped, stsolve, summary};
use tempfile::TempDir;

#[test]
fn a_valid_motion_is_proved() {
    let directory = TempDir::new().unwrap();
    let outcome = stsolve(directory.path(), &["motion", &shipped("vortex.toml"), "--output", "run"]);
    // det J = 1 - 0.01 sin^2: 0.99 at t = 2 and 6.
    outcome.expect(0, &["valid until t = 8", "det J / det J_0 >= 0.990000 proved"]);
    let (run, exact) =
        (directory.path().join("run"), |t: f64| 1.0 - (0.1 * (t * std::f64::consts::PI / 4.0).sin()).powi(2));
    let (times, bounds) = (column(&run, "t"), column(&run, "det_j_lower_bound"));
    assert_eq!(times.len(), 80);
    for (&t, &bound) in times.iter().zip(&bounds) {
        // The least value of a slab is at one of its ends, except around t = 2 and 6.
        let least = exact(t).min(exact(t - 0.1));
        assert!(bound <= least + 1e-9 && bound > least - 1e-6, "t = {t}: {bound} against {least}");
    }
    let summary = summary(&run);
    assert!(number(&summary, "error.displacement_max") < 1e-10, "{summary}");
    assert!(summary["mesh_quality"].get("first_invalid_time").is_none() && summary.get("newton").is_none());
}

/// The mesh of a flow that has a control, and of one that bodies move: the proof says that they rest.
#[test]
fn a_mesh_moves_without_controls_and_bodies() {
    let directory = TempDir::new().unwrap();
    let controls = "controls.force={measure=\"mass\",rate=\"0.1*(1 - measured)\"}";
    on_case(directory.path(), "motion", "vortex", &[controls, "time.end=0.3"], "controls", &[]).expect(0, &[]);
    let outcome = stsolve(directory.path(), &["motion", &shipped("piston_free.toml"), "--output", "bodies"]);
    outcome.expect(0, &["with bodies that rest"]);
    let outcome = stsolve(directory.path(), &["check", &shipped("piston_free.toml")]);
    outcome.expect(0, &[]);
    assert!(!outcome.stdout.contains("or more, proved\n"), "{}", outcome.stdout);
}

#[test]
fn an_invalid_motion_is_found() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.generate.box.cells=[3,3]", "constants.stretch=1.5"];
    let outcome = on_case(directory.path(), "motion", "vortex", &set, "run", &[]);
    outcome.expect(1, &["the mesh is not valid: cell ", "inverted or nearly so from t = 0.929", "falls to -1.25"]);
    // 1 = 1.5 sin(pi t / 4)
    let exact = (1.0_f64 / 1.5).asin() * 4.0 / std::f64::consts::PI;
    let run = directory.path().join("run");
    let first = number(&summary(&run), "mesh_quality.first_invalid_time");
    assert!((first - exact).abs() < 1e-3, "{first} against {exact}");
    // It continues, so that the whole motion can be examined.
    let (times, bounds) = (column(&run, "t"), column(&run, "det_j_lower_bound"));
    assert_eq!(times.len(), 80);
    assert!(times.iter().zip(&bounds).all(|(&t, &bound)| t > first || bound > 0.0));
    assert!(bounds.iter().any(|&bound| bound < -1.2));
}
