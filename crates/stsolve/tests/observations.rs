//! What a run observes of the flow: points, integrals, openings, walls; a body force.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Surface, column, finished, on_case, shipped, stsolve};
use std::fs;
use tempfile::TempDir;

fn largest_error(values: &[f64], exact: f64) -> f64 {
    values.iter().map(|value| (value - exact).abs()).fold(0.0, f64::max)
}

/// Points fixed in space or carried by a mesh that moves, and integrals, of a uniform stream.
#[test]
fn points_and_integrals_of_a_uniform_stream_are_exact() {
    let directory = TempDir::new().unwrap();
    let set = [
        "output.probes={fixed={at=[0.5,0.4]},carried={at=[0.05,0.95],carried=true},corner={at=[0,0]}}",
        "output.integrals=[\"kinetic_energy\",\"enstrophy\",\"entropy\"]",
    ];
    finished(directory.path(), "free_stream", &set);
    let run = directory.path().join("free_stream");
    let exact = [("density", 1.2), ("velocity_x", 0.4), ("velocity_y", -0.3), ("pressure", 0.8)];
    for (name, value) in exact {
        for probe in ["fixed", "carried"] {
            assert!(largest_error(&column(&run, &format!("{probe}_{name}")), value) < 1e-12, "{probe} {name}");
        }
    }
    // The corner of the mesh moves away from the point, and comes back never.
    assert!(column(&run, "corner_density").iter().any(|density| density.is_nan()));
    // That was told nowhere.
    let log = fs::read_to_string(run.join("log.jsonl")).unwrap();
    assert_eq!(log.matches("the point `corner` is outside of the mesh at t = ").count(), 1);
    assert_eq!(log.matches("is outside of the mesh").count(), 1);
    let mass = column(&run, "mass");
    let kinetic: Vec<f64> = column(&run, "kinetic_energy").iter().zip(&mass).map(|(k, mass)| k / mass).collect();
    assert!(largest_error(&kinetic, 0.125) < 1e-12, "{kinetic:?}");
    let entropy: Vec<f64> = column(&run, "entropy").iter().zip(&mass).map(|(s, mass)| s / mass).collect();
    assert!(largest_error(&entropy, 0.8_f64.ln() - 1.4 * 1.2_f64.ln()) < 1e-11, "{entropy:?}");
    assert!(largest_error(&column(&run, "enstrophy"), 0.0) < 1e-18);
}

/// A uniform gas that a body force accelerates in a periodic box: v = a t, and the pressure stays.
#[test]
fn a_body_force_accelerates_a_uniform_gas() {
    let directory = TempDir::new().unwrap();
    let case = directory.path().join("falling.toml");
    let text = r#"
        mesh = { order = 3, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 3], periodic = ["x", "y"] } }
        flow = { order = 3, initial.uniform = { density = 2, velocity = [0.1, 0], pressure = 3 }, source = { acceleration = ["0.3", "-0.2*t"] } }
        time = { order = 3, end = 1, slabs = 5 }
        solver.newton_tolerance = 1e-12
        output.probes.middle = { at = [0.3, 0.6] }
    "#;
    fs::write(&case, text).unwrap();
    stsolve(directory.path(), &["run", case.to_str().unwrap(), "--output", "run", "--quiet"]).expect(0, &[]);
    let run = directory.path().join("run");
    for (name, value) in [("velocity_x", 0.4), ("velocity_y", -0.1), ("density", 2.0), ("pressure", 3.0)] {
        let last = *column(&run, &format!("middle_{name}")).last().unwrap();
        assert!((last - value).abs() < 1e-10, "{name}: {last}");
    }
}

/// The states of openings of a channel, and the force on a wall from its file, against summary.json and the exact stress of Couette flow.
#[test]
fn walls_and_openings_are_told() {
    let directory = TempDir::new().unwrap();
    let set = ["output.surfaces={walls=[\"bottom\"]}", "time.slabs=4", "time.end=0.2"];
    let summary = finished(directory.path(), "couette", &set);
    let run = directory.path().join("couette");
    let surface = Surface::read(&run, "bottom");
    let integral = |name: &str| surface.integral(name);
    // mu du/dy = 0.02 * 0.5 on a length of 2.
    assert!((integral("friction_x") - 0.02).abs() < 1e-5, "{}", integral("friction_x"));
    assert!((integral("pressure") - 1.6).abs() < 1e-6);
    let force = column(&run, "bottom_friction_force_x");
    assert!((force.last().unwrap() - integral("friction_x")).abs() < 1e-14);
    let heat = *column(&run, "bottom_heat_flow").last().unwrap();
    assert!((heat - integral("heat_flux")).abs() < 1e-13, "{heat}, {}", integral("heat_flux"));
    assert!(surface.column("y_plus").iter().all(|y| *y > 0.0));
    assert!(surface.column("normal_y").iter().all(|n| *n < -0.9));
    assert!(summary["walls"]["bottom"].is_object());
}

/// Mean states of openings, and integrals, on a periodic mesh: a uniform stream at an angle.
#[test]
fn openings_of_a_periodic_passage_have_their_total_state() {
    let directory = TempDir::new().unwrap();
    let case = directory.path().join("passage.toml");
    let text = r#"
        mesh = { order = 3, generate.box = { lower = [0, 0], upper = [2, 1], cells = [3, 3], periodic = ["y"] } }
        output = { integrals = ["kinetic_energy"], probes.edge = { at = [1.1, 0.99] } }
        time = { order = 1, end = 0.1, slabs = 2 }
        [flow]
        order = 3
        initial.uniform = { density = 1.4, velocity = [0.4, 0.3], pressure = 1 }
        boundary.left.inflow = { total_pressure = 1.1862126380443982, total_temperature = 0.75, direction = [4, 3] }
        boundary.right.outflow = { pressure = 1 }
    "#;
    fs::write(&case, text).unwrap();
    stsolve(directory.path(), &["run", case.to_str().unwrap(), "--output", "run", "--quiet"]).expect(0, &[]);
    let run = directory.path().join("run");
    // M = 1/2: p0 / p = 1.05^3.5, T = 1/1.4.
    let total = [1.05_f64.powf(3.5), 0.75, 1.0];
    for opening in ["left", "right"] {
        for (name, value) in ["total_pressure", "total_temperature", "pressure"].iter().zip(total) {
            let found = column(&run, &format!("{opening}_{name}"));
            assert!(largest_error(&found, value) < 1e-9, "{opening} {name}: {found:?}, {value}");
        }
    }
    for (opening, velocity) in [("left", -0.4), ("right", 0.4)] {
        let found = column(&run, &format!("{opening}_velocity"));
        assert!(found.iter().all(|w| (w - velocity).abs() < 1e-9), "{opening}: {found:?}");
    }
    let loss = column(&run, "loss_coefficient");
    assert!(loss.iter().all(|loss| loss.abs() < 1e-7), "{loss:?}");
    assert!(largest_error(&column(&run, "kinetic_energy"), 0.35) < 1e-9);
    assert!(largest_error(&column(&run, "edge_pressure"), 1.0) < 1e-9);
}

#[test]
fn what_cannot_be_observed_is_refused() {
    let directory = TempDir::new().unwrap();
    let refused = [
        ("free_stream", "output.probes={far={at=[7,7]}}", "inside the flow"),
        ("free_stream", "output.probes={far={at=[0.5]}}", "output.probes.far.at"),
        ("free_stream", "output.surfaces={walls=[\"left\"]}", "the case has no wall in a flow"),
        ("couette", "output.surfaces={walls=[\"left\"]}", "accepted: `bottom`, `top`"),
        ("couette", "output.surfaces={walls=[\"top\",\"top\"]}", "is listed twice"),
        ("couette", "output.surfaces={walls=[\"top\"],every=0}", "1 or more"),
        ("couette", "output.surfaces=[\"top\"]", "with keys among `every`, `walls`"),
        ("free_stream", "output.integrals=[\"mass\"]", "kinetic_energy"),
        ("cantilever", "output.probes={tip={at=[0.5,0.5]}}", "without a flow there is nothing to observe"),
        ("free_stream", "flow.source={acceleration=[\"1/x\",0]}", "the acceleration at"),
    ];
    for (case, change, message) in refused {
        let case = shipped(&format!("{case}.toml"));
        stsolve(directory.path(), &["check", &case, "--set", change]).expect(2, &[message]);
    }
}

/// Columns of a resumed run are those of its checkpoint.
#[test]
fn other_points_are_no_resumed_run() {
    let directory = TempDir::new().unwrap();
    let go = |set: &[&str], extra: &[&str]| on_case(directory.path(), "run", "free_stream", set, "run", extra);
    go(&["time.end=0.2", "time.slabs=2"], &[]).expect(0, &[]);
    let probe = "output.probes={middle={at=[0.5,0.4]}}";
    go(&["time.end=0.4", "time.slabs=4", probe], &["--resume"]).expect(2, &["output.probes"]);
}

/// A probe `bottom` of a formula `force_x` would have the column of the wall `bottom`.
#[test]
fn two_columns_of_the_same_name_are_refused() {
    let directory = TempDir::new().unwrap();
    let text = r#"
        mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2] } }
        time = { order = 1, end = 0.1, slabs = 1 }
        output = { probes.bottom = { at = [0.5, 0.5], fields = ["density"] }, formulas.force_x = "2" }
        [flow]
        order = 2
        initial.uniform = { velocity = [0, 0], pressure = 1 }
        reference = { density = 1, speed = 1, pressure = 1 }
        boundary.others = "slip_wall"
        forces.bottom = {}
    "#;
    std::fs::write(directory.path().join("case.toml"), text).unwrap();
    for arguments in [&["run", "case.toml", "--output", "run", "--quiet"][..], &["check", "case.toml"]] {
        stsolve(directory.path(), arguments).expect(2, &["two columns of history.csv would be named `bottom_force_x`"]);
    }
}

#[test]
fn what_cannot_be_cut_is_refused() {
    let directory = TempDir::new().unwrap();
    let line = |rest: &str| format!("output.lines.a={{from=[0.1,0.1],to=[0.9,0.8]{rest}}}");
    let refused = [
        ("free_stream", line(",points=1"), "2 to 100000 points"),
        ("free_stream", line(",fields=[\"von_mises\"]"), "a field of the flow"),
        ("free_stream", line(",fields=[]"), "at least one field"),
        ("free_stream", "output.probes.a={at=[0.5,0.5],fields=[]}".to_owned(), "at least one field"),
        ("free_stream", line(",fields=[\"cp\"]"), "pressure_coefficient"),
        ("free_stream", line(",every=0"), "1 or more"),
        ("free_stream", "output.lines.a={from=[0,0],to=[0,0]}".to_owned(), "other than the start"),
        ("free_stream", "output.lines.\"a/b\"={from=[0,0],to=[0,1]}".to_owned(), "letters, digits"),
        ("free_stream", "output.slices.a={point=[0,0],normal=[0,1]}".to_owned(), "output.lines"),
        ("free_stream_3d", "output.slices.a={point=[0,0,0],normal=[0,0,0]}".to_owned(), "not zero"),
        ("free_stream", "output.formulas.a=\"presure\"".to_owned(), "did you mean `pressure`"),
        ("free_stream", "output.formulas.mach=\"pressure\"".to_owned(), "this name has another meaning"),
        ("free_stream", "output.formulas.a-b=\"pressure\"".to_owned(), "this is no name of a formula"),
        ("free_stream", "output.formulas.a=\"1/0*density\"".to_owned(), "finite somewhere"),
        ("cantilever", "output.formulas.a=\"x\"".to_owned(), "without a flow there is nothing to observe"),
    ];
    for (case, change, message) in refused {
        let case = shipped(&format!("{case}.toml"));
        stsolve(directory.path(), &["check", &case, "--set", &change]).expect(2, &[message]);
    }
}

/// Fields of the result file have the values at the nodes of the vortex's initial state.
#[test]
fn the_result_holds_fields_by_formulas() {
    let directory = TempDir::new().unwrap();
    let set = ["time.end=0.05", "time.slabs=1", "output.formulas={residue=\"entropy - log(pressure/density^1.4)\"}"];
    on_case(directory.path(), "run", "free_stream", &set, "run", &[]).expect(0, &[]);
    let info = stsolve(directory.path(), &["info", "run/result.vtkhdf", "--json"]);
    let fields: serde_json::Value = serde_json::from_str(&info.stdout).unwrap();
    assert!(fields.to_string().contains("\"residue\""), "{fields}");
    // Internals are shown to those who ask for them.
    for (verbose, shown) in [(&["info", "run"][..], false), (&["info", "-v", "run"], true)] {
        let text = stsolve(directory.path(), verbose).stdout;
        assert!(text.contains("residue") && text.contains("written by"), "{text}");
        for part in ["fingerprint", "checkpoint", "reuse.base"] {
            assert_eq!(text.contains(part), shown, "{part}: {text}");
        }
    }
}
