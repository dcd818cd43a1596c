//! Collocated quadrature and split forms in whole runs: accuracy, conservation, robustness, the same bits after a resume.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{assert_same_bits, column, finished, number, on_case, on_text, stsolve};
use tempfile::TempDir;

/// A vortex on a mesh whose nodes move by sines, coarse.
const STIRRED: [&str; 3] = ["mesh.generate.box.cells=[8,8]", "time.end=1", "time.slabs=10"];

/// The error of the density of the vortex on the swirling mesh.
fn stirred(quadrature: &str) -> f64 {
    let directory = TempDir::new().unwrap();
    let quadrature = format!("flow.quadrature={quadrature}");
    let set = [&STIRRED[..], &[&quadrature]].concat();
    let summary = finished(directory.path(), "vortex_sinusoidal", &set);
    assert!(number(&summary, "conservation.mass_error") < 1e-12, "{quadrature}");
    number(&summary, "error.density_l2")
}

#[test]
fn gauss_points_collocated_are_as_accurate_as_the_rule_that_integrates_the_map() {
    let [conserving, collocated, lobatto] = ["conserving", "collocated", "collocated_lobatto"].map(stirred);
    assert!(collocated < 1.1 * conserving, "{collocated:e} for {conserving:e}");
    assert!(lobatto < 8.0 * conserving, "{lobatto:e} for {conserving:e}");
}

#[test]
fn a_free_stream_stays_with_every_collocated_rule() {
    for case in ["free_stream", "free_stream_3d"] {
        for rule in [
            &["flow.quadrature=collocated"][..],
            &["flow.quadrature=collocated_lobatto"],
            &["flow.quadrature=collocated_lobatto", "flow.volume_flux=entropy"],
            &["flow.quadrature=collocated_lobatto", "flow.volume_flux=entropy_viscosity"],
        ] {
            let directory = TempDir::new().unwrap();
            let summary = finished(directory.path(), case, rule);
            for figure in ["free_stream_error", "mass_error", "energy_error"] {
                let value = number(&summary, &format!("conservation.{figure}"));
                assert!(value < 1e-12, "{case}, {rule:?}, {figure}: {value:e}");
            }
        }
    }
}

/// J is carried from slab to slab: a resumed run needs it.
#[test]
fn a_collocated_run_resumes_with_the_same_bits() {
    let directory = TempDir::new().unwrap();
    let run = |end: &str, output: &str, extra: &[&str]| {
        let set = ["mesh.generate.box.cells=[3,3]", "flow.quadrature=collocated", "constants.stretch=0.8", end];
        on_case(directory.path(), "run", "vortex", &set, output, extra).expect(0, &[]);
    };
    run("time.end=0.8", "through", &["--threads", "1"]);
    run("time.end=0.5", "stopped", &["--threads", "2"]);
    run("time.end=0.8", "stopped", &["--threads", "2", "--resume"]);
    assert_same_bits(&directory.path().join("through"), &directory.path().join("stopped"), "interrupted at 0.5");
}

/// Other orders start with the determinant of their own map.
#[test]
fn a_collocated_run_goes_on_with_another_order() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.generate.box.cells=[6,6]", "flow.quadrature=collocated", "time.end=0.2"];
    on_case(directory.path(), "run", "vortex", &set, "first", &[]).expect(0, &[]);
    let from = format!("restart.from={}", directory.path().join("first").display());
    let set = ["mesh.generate.box.cells=[6,6]", "flow.quadrature=collocated", "time.end=0.4", "flow.order=5", &from];
    on_case(directory.path(), "run", "vortex", &set, "second", &[]).expect(0, &[]);
    let error = number(&common::summary(&directory.path().join("second")), "error.density_l2");
    assert!(error < 5e-3, "{error:e}");
}

/// The default rule fails at t = 2.349 on this mesh.
#[test]
fn an_unresolved_instability_lives_and_loses_no_entropy() {
    for volume_flux in ["entropy", "entropy_viscosity"] {
        let directory = TempDir::new().unwrap();
        let set = ["time.end=2.6", &format!("flow.volume_flux={volume_flux}")];
        finished(directory.path(), "kelvin_helmholtz", &set);
        let entropy = column(&directory.path().join("kelvin_helmholtz"), "entropy");
        assert!(entropy.len() >= 130);
        for (before, after) in entropy.iter().zip(&entropy[1..]) {
            assert!(after > &(before - 1e-12), "{volume_flux}: {before} to {after}");
        }
    }
}

/// The flow is resolved to 1e-3: cells hardly ever need a viscosity.
#[test]
fn a_viscosity_of_entropy_leaves_smooth_flow_as_accurate() {
    let error = |volume_flux: &str| {
        let directory = TempDir::new().unwrap();
        let volume_flux = format!("flow.volume_flux={volume_flux}");
        let set = [&STIRRED[..], &["flow.quadrature=collocated_lobatto", &volume_flux]].concat();
        number(&finished(directory.path(), "vortex_sinusoidal", &set), "error.density_l2")
    };
    let [with, without] = ["entropy_viscosity", "central"].map(error);
    assert!(with < 1.1 * without, "{with:e} for {without:e}");
}

#[test]
fn two_point_fluxes_ask_for_points_that_are_nodes() {
    let directory = TempDir::new().unwrap();
    let refused = on_case(directory.path(), "run", "vortex", &["flow.volume_flux=entropy"], "run", &[]);
    refused.expect(2, &["flow.volume_flux", "collocated_lobatto"]);
}

/// A mesh of order 5 with thin cells, which order 3 of the flow cannot represent. Unchecked, the residual would be NaN.
#[test]
fn a_mesh_that_the_order_of_the_flow_turns_inside_out_is_refused() {
    let directory = TempDir::new().unwrap();
    let set = ["flow.quadrature=collocated", "flow.order=3"];
    let refused = on_case(directory.path(), "run", "flapping_free", &set, "run", &[]);
    refused.expect(2, &["flow.quadrature", "inside out", "flow.order"]);
}

/// Six blocks around a sphere with corners on its surface: J is positive at the nodes and negative at Gauss points between them. The run was
/// said to fail because the flow is steep.
#[test]
fn a_mesh_that_gauss_points_turn_inside_out_is_refused() {
    let directory = TempDir::new().unwrap();
    let text = r#"
        mesh = { order = 3, generate.ellipsoid = { semi_axes = [0.5, 0.5, 0.5], outer_radius = 3, first_cell = 0.4, cells = [2, 2, 2, 2] } }
        time = { order = 2, end = 0.01, slabs = 2 }
        [flow]
        order = 3
        quadrature = "collocated"
        initial.uniform = { velocity = [0, 0, 0], pressure = 1 }
        reference = { speed = 1, pressure = 1 }
        boundary.others = "slip_wall"
    "#;
    let check = |text: &str, code: i32, message: &str| {
        std::fs::write(directory.path().join("case.toml"), text).unwrap();
        stsolve(directory.path(), &["check", "case.toml", "--probe", "never"]).expect(code, &[message]);
    };
    check(text, 2, "interpolated from the nodes of the flow to the Gauss points, is not positive");
    check(&text.replace("\"collocated\"", "\"collocated_lobatto\""), 0, "");
}

/// A cylinder on a torsion spring in viscous gas, released from an angle.
const TORSION: &str = r#"
    time = { order = 3, end = 3, step = 0.2 }
    solver = { newton_tolerance = 1e-6 }
    [mesh]
    order = 5
    [mesh.generate.annulus]
    inner_radius = 1
    outer_radius = 2
    first_cell = 0.15
    cells = [8, 3]
    [flow]
    order = 5
    gas = { gamma = 1.4, viscosity = { constant = 0.05 } }
    initial = { expression = { density = 1, velocity = [0, 0], pressure = "10^2/1.4" } }
    reference = { density = 1, speed = 1, pressure = "10^2/1.4", length = 1 }
    [flow.boundary]
    others = { adiabatic_wall = {} }
    [bodies.ball]
    walls = ["wall"]
    mass = 1
    moment_of_inertia = 2
    rotation = { spring = 2, rest = 0.1 }
    mesh = { between = { inner = 1.05, outer = 1.95 } }
"#;

/// With two nodes in time the pressure of the gas at rest works on the wall that turns, 1e4 times the pressure of its motion. `check` tells.
#[test]
fn slow_bodies_that_turn_need_three_nodes_in_time_in_a_collocated_rule() {
    let directory = TempDir::new().unwrap();
    let angles = |name: &str, set: &[&str]| {
        on_text(directory.path(), TORSION, set, name, &["--quiet"]).expect(0, &[]);
        column(&directory.path().join(name), "ball_rotation")
    };
    let exact = angles("default", &[]);
    let error = |name: &str, set: &[&str]| {
        let off = angles(name, set).iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!("{name}: {:.1e} of the amplitude", off / 0.1);
        off / 0.1
    };
    let collocated = "flow.quadrature=\"collocated\"";
    assert!(error("conserving, 2 nodes", &["time.order=2"]) < 2e-4);
    assert!(error("collocated, 3 nodes", &[collocated]) < 5e-5);
    assert!(error("collocated, 2 nodes", &[collocated, "time.order=2"]) < 0.02);
    let told = |set: &[&str]| {
        let set: Vec<&str> = set.iter().flat_map(|change| ["--set", *change]).collect();
        let checked = stsolve(directory.path(), &[&["check", "case.toml", "--probe", "never"], &set[..]].concat());
        checked.stdout.contains("pressure at rest works on walls that turn")
    };
    assert!(told(&[collocated, "time.order=2"]) && !told(&[collocated]) && !told(&["time.order=2"]));
}
