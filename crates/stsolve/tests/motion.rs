//! `stsolve motion`: the mesh alone, and the proof that it stays valid. Bodies whose nodes would leave planes beside them.

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

/// The mesh of a flow that has a control, and those that nothing but the flow moves: nothing is said to be proved of these.
#[test]
fn a_mesh_moves_without_controls_and_not_without_its_flow() {
    let directory = TempDir::new().unwrap();
    let controls = "controls.force={measure=\"mass\",rate=\"0.1*(1 - measured)\"}";
    on_case(directory.path(), "motion", "vortex", &[controls, "time.end=0.3"], "controls", &[]).expect(0, &[]);
    for name in ["piston_free.toml", "elastic_piston.toml"] {
        stsolve(directory.path(), &["motion", &shipped(name)]).expect(2, &["only the flow moves this mesh"]);
        let outcome = stsolve(directory.path(), &["check", "--probe", "always", &shipped(name)]);
        outcome.expect(0, &[]);
        assert!(
            outcome.stdout.contains("only the flow moves it") && !outcome.stdout.contains("proved"),
            "{}",
            outcome.stdout
        );
    }
}

/// The mesh follows a cylinder by weights between the distances 1 and 15: it folds where the slope 1.875 / 14 of the weight times the
/// displacement 5 t^2 is one, at t = 1.22. In other coordinates the cylinder is free.
#[test]
fn driven_bodies_move_the_mesh() {
    let directory = TempDir::new().unwrap();
    let driven = "bodies.cylinder.y={motion=\"5*t^2\"}";
    let motion = |output: &str, set: &[&str]| {
        let case = shipped("cylinder_viv.toml");
        let mut arguments = vec!["motion", &case, "--output", output, "--set", driven];
        set.iter().for_each(|set| arguments.extend(["--set", set]));
        stsolve(directory.path(), &arguments)
    };
    motion("valid", &["time.end=1.1"]).expect(0, &["valid until t = 1.1:"]);
    motion("folded", &["time.end=2"]).expect(1, &["inverted"]);
    let first = number(&summary(&directory.path().join("folded")), "mesh_quality.first_invalid_time");
    assert!((1.1..1.24).contains(&first), "{first}");
    let free = motion("free", &["time.end=1.1", "bodies.cylinder.x={spring=1}"]);
    free.expect(0, &["valid until t = 1.1, while all that the flow moves rests"]);
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

/// A piston that moves along the walls beside it took the nodes that it shares with them out of their planes.
#[test]
fn a_body_does_not_take_nodes_of_other_walls_along() {
    let directory = TempDir::new().unwrap();
    let case = |freedom: &str| {
        format!(
            r#"
            mesh = {{ order = 2, generate.box = {{ lower = [0, 0, 0], upper = [1, 1, 1], cells = [2, 2, 2] }} }}
            motion.boundary.others = "slide"
            time = {{ order = 2, end = 0.1, slabs = 1 }}
            flow.order = 2
            flow.initial.uniform = {{ density = 1, velocity = [0, 0, 0], pressure = 1 }}
            flow.reference = {{ density = 1, speed = 1, pressure = 1 }}
            flow.boundary.others = "slip_wall"
            bodies.left = {{ mass = 3, {freedom} }}
            "#
        )
    };
    for (freedom, refused) in [
        ("x = {}", None),
        ("y = {}", Some("would leave its plane, for `left` can move along y")),
        ("moment_of_inertia = 1, rotation = {}", Some("would leave its plane")),
        ("moment_of_inertia = 1, rotation = {}, axis = [1, 0, 0]", Some("would leave its plane")),
    ] {
        std::fs::write(directory.path().join("case.toml"), case(freedom)).unwrap();
        let outcome = stsolve(directory.path(), &["check", "case.toml", "--probe", "never"]);
        outcome.expect(if refused.is_some() { 2 } else { 0 }, &Vec::from_iter(refused));
    }
}

/// The mesh that followed a half cylinder by weights bent the plane of symmetry under it.
#[test]
fn a_mesh_that_follows_by_weights_stays_in_planes_of_symmetry() {
    let directory = TempDir::new().unwrap();
    let case = |freedom: &str, plane: &str| {
        format!(
            r#"
            mesh.order = 4
            mesh.generate.box = {{ lower = [0, 0], upper = [1, 1], cells = [4, 6], map = ["(1+5*x)*cos(pi*y)", "(1+5*x)*sin(pi*y)"] }}
            time = {{ order = 2, end = 0.5, slabs = 10 }}
            flow.order = 3
            flow.initial.uniform = {{ density = 1, velocity = [0, 0], pressure = 7 }}
            flow.reference = {{ density = 1, speed = 1, pressure = 7 }}
            flow.boundary = {{ bottom = {plane}, top = {plane}, others = "slip_wall" }}
            bodies.left = {{ mass = 1, mesh.between = {{ inner = 1.1, outer = 5.5 }}, {freedom} = {{ rate = 0.3 }} }}
            "#
        )
    };
    for (freedom, plane, refused) in [
        ("x", "\"symmetry\"", None),
        ("y", "\"symmetry\"", Some("would leave its plane, for `left` can move along y")),
        ("y", "\"slip_wall\"", None),
    ] {
        std::fs::write(directory.path().join("case.toml"), case(freedom, plane)).unwrap();
        let outcome = stsolve(directory.path(), &["check", "case.toml", "--probe", "never"]);
        outcome.expect(if refused.is_some() { 2 } else { 0 }, &Vec::from_iter(refused));
    }
}
