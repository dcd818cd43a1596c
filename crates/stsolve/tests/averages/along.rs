//! Averages along axes of the mesh: profiles, planes, the budget of kinetic energy.

use crate::common::stsolve;
use crate::{assert_all, run};
use output::read_viewer_file;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A gas whose velocity fluctuates along x about a shear flow. One slab is so short that nothing changes.
const WAVY: &str = r#"
    mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [6, 2], periodic = ["x"] } }
    time = { order = 1, end = 1e-10, slabs = 1 }
    [flow]
    order = 8
    gas = { viscosity = { constant = 0.01 } }
    reference = { density = 1, speed = 1, pressure = 3, length = 1 }
    initial.expression = { density = 1, velocity = ["y + 0.2*cos(2*pi*x)", "0.1*cos(2*pi*x)*(1 + y)"], pressure = "3 + 0.5*cos(2*pi*x)" }
    boundary.others = "slip_wall"
"#;

/// The rows of averages_along.csv and its header.
fn along(run: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = fs::read_to_string(run.join("averages_along.csv")).unwrap();
    let mut lines = text.lines();
    let names = lines.next().unwrap().split(',').map(str::to_owned).collect();
    (names, lines.map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect())
}

/// With c = cos 2 pi x and s = sin 2 pi x: v' = (0.2 c, 0.1 c (1 + y)), p' = 0.5 c, <c c> = 1/2, <c s> = <c c c> = 0.
#[test]
fn the_budget_of_kinetic_energy_along_x_is_that_of_the_flow() {
    let directory = TempDir::new().unwrap();
    let wanted =
        "output.averages={from=0,along=[\"x\"],fields=[\"velocity\",\"reynolds_stress\",\"kinetic_energy_budget\"]}";
    run(directory.path(), WAVY, &["--set", wanted]);
    let (names, rows) = along(&directory.path().join("run"));
    // Two cells of 8 nodes share one.
    assert_eq!(rows.len(), 15);
    for row in &rows {
        let (y, mu, pi2) = (row[0], 0.01, std::f64::consts::PI.powi(2));
        let at = |name: &str| row[names.iter().position(|other| other == name).unwrap()];
        let exact = [
            ("mean_velocity_x", y),
            ("mean_velocity_y", 0.0),
            ("reynolds_stress_xx", 0.02),
            ("reynolds_stress_xy", 0.01 * (1.0 + y)),
            ("reynolds_stress_yy", 0.005 * (1.0 + y).powi(2)),
            ("production", -0.01 * (1.0 + y)),
            ("pressure_dilatation", 0.025),
            ("dissipation", mu * (4.0 / 3.0 * (0.08 * pi2 + 0.005) + 0.02 * pi2 * (1.0 + y).powi(2))),
            ("turbulent_flux_x", 0.0),
            ("turbulent_flux_y", 0.0),
            ("pressure_flux_x", 0.05),
            ("pressure_flux_y", 0.025 * (1.0 + y)),
            ("viscous_flux_y", -mu * 0.4 / 3.0 * 0.05 * (1.0 + y)),
        ];
        for (name, exact) in exact {
            let error = (at(name) - exact).abs();
            assert!(error < 1e-6, "{name} at y = {y}: {} for {exact}", at(name));
        }
    }
}

/// The weights ignored the stretch of the mesh inside a cell: the mean density was 1.10479, the stress 0.024824.
#[test]
fn averages_along_a_stretched_axis_are_exact() {
    let directory = TempDir::new().unwrap();
    let text = r#"
        mesh.order = 4
        mesh.generate.box = { lower = [0, 0], upper = [1, 1], cells = [1, 2], map = ["x + 0.9*x*(1-x)*(x-0.5)", "y"] }
        time = { order = 1, end = 1e-9, slabs = 1 }
        output.averages = { from = 0, along = ["x"], fields = ["density", "reynolds_stress"] }
        [flow]
        order = 8
        initial.expression = { density = "1+0.3*x^2", velocity = ["0.5*x+0.2*y", 0], pressure = 10 }
        reference = { density = 1, speed = 1, pressure = 10, length = 1 }
        boundary.others = "slip_wall"
    "#;
    run(directory.path(), text, &[]);
    let (names, rows) = along(&directory.path().join("run"));
    let of = |name: &str| names.iter().position(|other| other == name).unwrap();
    for row in &rows {
        assert!((row[of("mean_density")] - 1.1).abs() < 1e-6, "{row:?}");
        assert!((row[of("reynolds_stress_xx")] - 0.25 / 12.0).abs() < 1e-6, "{row:?}");
    }
}

/// A coarse shear flow in which nothing fluctuates: the jump of its gradient between cells counted as a fluctuation.
#[test]
fn jumps_between_cells_are_no_fluctuations() {
    let directory = TempDir::new().unwrap();
    let text = r#"
        mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 4], periodic = ["x"] } }
        time = { order = 1, end = 1e-9, step = 1e-9 }
        output.averages = { from = 0, along = ["x"], fields = ["velocity", "reynolds_stress", "kinetic_energy_budget"] }
        [flow]
        order = 2
        gas = { gamma = 1.4, prandtl = 0.72, viscosity = { constant = 0.1 } }
        reference = { density = 1, speed = 1, pressure = 20 }
        initial.expression = { density = 1, velocity = ["4*y*(1-y)", 0], pressure = 20 }
        boundary.others.adiabatic_wall = {}
    "#;
    run(directory.path(), text, &[]);
    let (names, rows) = along(&directory.path().join("run"));
    let dissipation = names.iter().position(|name| name == "dissipation").unwrap();
    assert_eq!(rows.len(), 5);
    assert!(rows.iter().all(|row| row[dissipation].abs() < 1e-15), "{rows:?}");
}

/// The span of a box: one cell of the file for each stack of four.
#[test]
fn averages_along_a_span_are_a_plane_for_a_viewer() {
    let directory = TempDir::new().unwrap();
    let text = r#"
        mesh = { order = 2, generate.box = { lower = [0, 0, 0], upper = [2, 1, 1], cells = [2, 1, 4], periodic = ["y", "z"] } }
        time = { order = 1, end = 1e-10, slabs = 1 }
        output.averages = { from = 0, along = ["z"], fields = ["velocity", "reynolds_stress"] }
        [flow]
        order = 6
        boundary.others = "slip_wall"
        initial.expression = { density = 1, velocity = ["0.1*x", 0, "0.4*cos(2*pi*z)"], pressure = 2 }
        reference = { density = 1, speed = 1, pressure = 2, length = 1 }
    "#;
    run(directory.path(), text, &[]);
    let run = directory.path().join("run");
    let file = run.join("averages_along.vtkhdf");
    // It was called damaged.
    let info = stsolve(directory.path(), &["info", "run/averages_along.vtkhdf"]);
    info.expect(2, &["has no seal of a run", "`result.vtkhdf`"]);
    let (_, points) = read_viewer_file(&file, "Points").unwrap();
    let (_, velocity) = read_viewer_file(&file, "mean_velocity").unwrap();
    let (_, stress) = read_viewer_file(&file, "reynolds_stress_zz").unwrap();
    assert_eq!((points.len(), velocity.len(), stress.len()), (3 * 72, 3 * 72, 72));
    for (x, v) in points.chunks_exact(3).zip(velocity.chunks_exact(3)) {
        assert!(
            (v[0] - 0.1 * x[0]).abs() < 1e-8 && v[1].abs() < 1e-8 && v[2].abs() < 1e-5 && x[2] == 0.0,
            "{x:?}: {v:?}"
        );
    }
    assert_all(&stress, 0.08, 1e-4, "stress");
    let (names, rows) = along(&run);
    assert_eq!((&names[..3], rows.len()), (&["x", "y", "mean_velocity_x"].map(str::to_owned)[..], 66));
    let profile = "output.averages={from=0,along=[\"x\",\"z\"],fields=[\"velocity\",\"reynolds_stress\"]}";
    crate::run(directory.path(), text, &["--set", profile, "--force"]);
    let (names, rows) = along(&run);
    assert_eq!((&names[0][..], rows.len()), ("y", 6));
    let of = |name: &str| names.iter().position(|other| other == name).unwrap();
    for row in &rows {
        // v_x = 0.1 x on 0 < x < 2 has the variance 0.01 / 3.
        assert!(
            (row[of("mean_velocity_x")] - 0.1).abs() < 1e-8
                && (row[of("reynolds_stress_xx")] - 0.01 / 3.0).abs() < 1e-8
        );
    }
}
