//! Runs that reach their end: their files and their accuracy.

#![allow(clippy::unwrap_used)]

mod common;

use common::{column, finished, number, on_case, shipped, stsolve, summary};
use tempfile::TempDir;

/// A vortex that costs little.
const SMALL: [&str; 2] = ["mesh.generate.box.cells=[4,4]", "time.end=0.5"];

#[test]
fn a_run_leaves_a_row_per_slab_a_summary_and_a_result() {
    let directory = TempDir::new().unwrap();
    let summary = finished(directory.path(), "vortex", &SMALL);
    let run = directory.path().join("vortex");
    let times = column(&run, "t");
    assert_eq!(times.len(), 5);
    assert!(times.iter().zip(1..).all(|(t, n)| (t - 0.1 * f64::from(n)).abs() < 1e-14), "{times:?}");
    let newton: f64 = column(&run, "newton").iter().sum();
    assert_eq!(newton, number(&summary, "newton.total"));
    assert!(run.join("log.jsonl").exists());

    let info = stsolve(directory.path(), &["info", "--json", "vortex/result.vtkhdf"]);
    info.expect(0, &[]);
    let info: serde_json::Value = serde_json::from_str(&info.stdout).unwrap();
    assert_eq!((&info["case_name"], info["times"].as_array().unwrap().len()), (&"vortex".into(), 6));
    assert_eq!(info["layout"]["grid"]["cells"], 16);
}

/// Whether a text is a number with a name before it. Records once held such texts, as in `mesh 7.198e-17, flow 6.555e-6`.
fn is_named_number(text: &str) -> bool {
    text.split_once(' ').is_some_and(|(_, number)| number.parse::<f64>().is_ok())
}

/// Values of records are numbers, words and flags, so that a program can read them. Here pseudo-time, Newton's method and rounding report.
#[test]
fn the_log_holds_numbers_and_words() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.order=3", "flow.order=3", "time.order=2", "time.end=2000", "time.slabs=2"];
    finished(directory.path(), "cylinder_steady", &set);
    let log = std::fs::read_to_string(directory.path().join("cylinder_steady/log.jsonl")).unwrap();
    let records: Vec<serde_json::Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for record in &records {
        let fields = record["fields"].as_object().unwrap();
        let is_plain = |value: &serde_json::Value| match value {
            serde_json::Value::String(text) => !text.contains(['{', '[']) && !text.split(", ").any(is_named_number),
            value => value.is_number() || value.is_boolean(),
        };
        assert!(fields.values().all(is_plain), "{record}");
    }
    let of_message = |message: &str| records.iter().find(|record| record["fields"]["message"] == message).unwrap();
    for name in ["step", "residual", "forcing", "linear_residual", "krylov", "step_length", "rejections"] {
        assert!(of_message("Newton step")["fields"][name].is_number(), "{name}: {log}");
    }
    for name in ["residual_flow", "inverse_pseudo_time_flow"] {
        assert!(of_message("Newton step")["fields"][name].is_number(), "{name}: {log}");
    }
    assert!(of_message("round-off of the residual, estimated")["fields"]["residual_flow"].is_number(), "{log}");
    assert!(!log.contains("::"), "modules of the program: {log}");
    let steady = &of_message("steady flow")["fields"];
    assert!(steady["order"] == 3 && steady["converged"] == true && steady["iterations"].is_number(), "{steady}");
}

#[test]
fn the_summary_has_the_figures_of_the_run() {
    let directory = TempDir::new().unwrap();
    let summary = finished(directory.path(), "vortex", &SMALL);
    // 16 cells of 4 x 4 nodes with 4 components, 11 x 11 free mesh nodes with 2, at 2 times.
    for (path, exact) in [("slabs", 5.0), ("rejected_slabs", 0.0), ("unknowns.flow", 2048.0), ("unknowns.mesh", 484.0)]
    {
        assert_eq!(number(&summary, path), exact, "{path}");
    }
    for (path, least, most) in [
        ("time", 0.5, 0.5),
        ("newton.max", 1.0, 6.0),
        ("newton.per_slab", 1.0, 6.0),
        ("krylov.max_per_newton", 1.0, 20.0),
        ("krylov.mean_per_newton", 1.0, 20.0),
        // The solver of the mesh is direct.
        ("krylov.elasticity_total", 0.0, 0.0),
        ("mesh_quality.det_j_lower_bound", 0.99, 1.0),
        ("mesh_quality.det_j_sampled_min", 0.99, 1.0),
        ("mesh_quality.scaled_jacobian_min", 0.99, 1.0),
        ("conservation.mass_error", 0.0, 1e-12),
        ("error.density_l2", 1e-6, 1e-2),
        ("error.momentum_l2", 1e-6, 0.2),
        ("error.energy_l2", 1e-6, 0.2),
        // The motion of the boundary is affine, and so is the motion of the interior.
        ("error.displacement_max", 0.0, 1e-10),
        ("cost.wall_seconds", 1e-3, 60.0),
        ("cost.threads", 1.0, 1e3),
        ("cost.residual_evaluations", 10.0, 1e3),
        ("cost.jacobian_products", 10.0, 1e3),
    ] {
        let value = number(&summary, path);
        assert!((least..=most).contains(&value), "{path} = {value}");
    }
    assert!(summary.get("reason").is_none() && summary.get("walls").is_none());
}

#[test]
fn the_mesh_comes_back_after_a_period() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.generate.box.cells=[3,3]", "time.end=8", "time.step=0.8"];
    let summary = finished(directory.path(), "vortex", &set);
    assert!(number(&summary, "error.displacement_max") < 1e-10, "{summary}");
}

#[test]
fn a_uniform_flow_does_not_notice_the_motion() {
    let directory = TempDir::new().unwrap();
    for name in ["free_stream", "free_stream_3d"] {
        let summary = finished(directory.path(), name, &[]);
        for path in ["conservation.free_stream_error", "conservation.mass_error"] {
            assert!(number(&summary, path) <= 1e-12, "{name}: {path} = {}", number(&summary, path));
        }
    }
}

/// Errors in density, momentum and energy as stated in the comment of the case, with a tolerance of a tenth.
fn assert_stated_errors(name: &str, stated: [f64; 3]) {
    assert_errors(name, &[], stated);
}

/// The same of a case with other settings.
fn assert_errors(name: &str, settings: &[&str], stated: [f64; 3]) {
    let directory = TempDir::new().unwrap();
    let summary = finished(directory.path(), name, settings);
    for (path, stated) in ["error.density_l2", "error.momentum_l2", "error.energy_l2"].iter().zip(stated) {
        let error = number(&summary, path);
        assert!((0.5 * stated..1.1 * stated).contains(&error), "{name}: {path} = {error:e}, stated {stated:e}");
    }
}

#[test]
fn viscous_cases_are_as_accurate_as_they_say() {
    assert_stated_errors("couette", [4.7e-6, 5.4e-6, 1.35e-5]);
    assert_stated_errors("manufactured", [1.97e-4, 1.01e-4, 3.10e-4]);
}

#[test]
fn vortices_are_as_accurate_as_they_say() {
    assert_stated_errors("vortex", [7.4e-5, 1.49e-3, 1.36e-3]);
    assert_stated_errors("vortex_sinusoidal", [3.6e-5, 5.8e-4, 6.1e-4]);
    // A twentieth of the period, at a lower order.
    let start = ["flow.order=12", "flow.quadrature.points=12", "time.end=1"];
    assert_errors("vortex_period", &start, [2.73e-5, 9.44e-5, 3.03e-4]);
}

/// Couette flow: the sliding plate does work, each plate takes up the conducted heat, and together they balance the energy.
#[test]
fn walls_report_force_and_power() {
    let directory = TempDir::new().unwrap();
    let summary = finished(directory.path(), "couette", &["time.end=0.2", "time.slabs=4"]);
    let of = |wall: &str, key: &str| number(&summary["walls"][wall], key);
    // The drag of the moving plate: mu U / H times its length 2, over 0.2; its work is that times U = 0.5.
    let (impulse, drag) = (summary["walls"]["top"]["impulse"][0].as_f64().unwrap(), 0.02 * 0.5 * 2.0 * 0.2);
    assert!((impulse + drag).abs() < 5e-3 * drag, "{impulse}");
    assert!((of("top", "work") + 0.5 * drag).abs() < 5e-3 * 0.5 * drag, "{summary}");
    assert!(of("bottom", "work").abs() < 1e-15, "{summary}");
    // kappa T' = kappa (T_u - T_l) + mu U^2 / 2 (1 - 2 y), into the wall.
    let (conducted, friction) = (0.02 * 3.5 / 0.72 * 0.05, 0.02 * 0.25 / 2.0);
    for (wall, expected) in [("bottom", conducted + friction), ("top", friction - conducted)] {
        let heat = of(wall, "heat");
        assert!((heat / (0.4 * expected) - 1.0).abs() < 0.01, "{wall}: {heat} instead of {}", 0.4 * expected);
    }
    let run = directory.path().join("couette");
    let force = column(&run, "top_force_x");
    assert!(force.iter().all(|force| (force + 0.02).abs() < 4e-4), "{force:?}");
    let (power, heat_flow) = (column(&run, "top_power"), column(&run, "bottom_heat_flow"));
    assert!(power.iter().zip(&force).all(|(power, force)| (power - 0.5 * force).abs() < 1e-14), "{power:?}");
    assert!(heat_flow.iter().all(|flow| (flow / (2.0 * (conducted + friction)) - 1.0).abs() < 0.02), "{heat_flow:?}");
}

/// Gas at rest between resting walls at T = 0.8 and 1.2: the conducted heat, +-0.0389, is not work.
#[test]
fn heat_that_is_conducted_is_no_work() {
    let directory = TempDir::new().unwrap();
    std::fs::write(directory.path().join("plates.toml"), PLATES).unwrap();
    stsolve(directory.path(), &["run", "plates.toml", "--output", "plates", "--quiet"]).expect(0, &[]);
    let summary = summary(&directory.path().join("plates"));
    let conducted = 0.02 * 3.5 / 0.72 * 0.4;
    for (wall, sign) in [("bottom", 1.0), ("top", -1.0)] {
        let of = |key: &str| number(&summary["walls"][wall], key);
        assert_eq!(of("work"), 0.0, "{summary}");
        assert!((of("heat") - sign * conducted).abs() < 1e-6, "{wall}: {} instead of {conducted}", of("heat"));
        assert!(column(&directory.path().join("plates"), &format!("{wall}_power")).iter().all(|power| *power == 0.0));
    }
}

const PLATES: &str = r#"
[mesh]
order = 4
generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 4], periodic = ["x"] }
[flow]
order = 5
gas.viscosity = { constant = 0.02 }
reference = { density = 1, speed = 0.1, pressure = 1 }
initial.expression = { density = "1/(0.8 + 0.4*y)", velocity = [0, 0], pressure = 1 }
boundary.bottom = { isothermal_wall = { temperature = 0.8 } }
boundary.top = { isothermal_wall = { temperature = 1.2 } }
[time]
order = 2
end = 1
slabs = 5
[solver]
newton_tolerance = 1e-10
"#;

/// Stokes' second problem: a plate at the speed U cos(omega t) spends mu U^2 sqrt(omega / (2 nu)) / 2 per area on average. The gas in
/// the closed box gains the work and heat of both walls.
#[test]
fn an_oscillating_plate_pays_for_its_friction_and_the_box_keeps_its_energy() {
    let directory = TempDir::new().unwrap();
    std::fs::write(directory.path().join("stokes.toml"), STOKES).unwrap();
    stsolve(directory.path(), &["run", "stokes.toml", "--output", "stokes", "--quiet"]).expect(0, &[]);
    let run = directory.path().join("stokes");
    let (speed, mu, omega) = (0.03, 0.02, 2.0 * std::f64::consts::PI);
    // One period, a plate of length 0.2; density 1.
    let expected = -mu * speed * speed * (omega / (2.0 * mu)).sqrt() / 2.0 * 0.2;
    let summary = summary(&run);
    let work = number(&summary["walls"]["bottom"], "work");
    assert!((work / expected - 1.0).abs() < 2e-3, "{work} instead of {expected}");
    assert_eq!(number(&summary["walls"]["top"], "work"), 0.0);
    let energy = column(&run, "energy");
    let walls = ["bottom_work_in_slab", "bottom_heat_in_slab", "top_work_in_slab", "top_heat_in_slab"];
    let given: f64 = walls.iter().flat_map(|name| column(&run, name).into_iter().skip(1)).sum();
    let open = energy[energy.len() - 1] - energy[0] + given;
    assert!(open.abs() < 1e-12 * energy[0], "{open:e} of {}", energy[0]);
    // The balance is not one of zeros.
    assert!(number(&summary["walls"]["bottom"], "heat") > 1e-7, "{summary}");
}

const STOKES: &str = r#"
[constants]
U = 0.03
w = "2*pi"
k = "sqrt(w/0.04)"
[mesh]
order = 2
generate.box = { lower = [0, 0], upper = [0.2, 1], cells = [2, 10], periodic = ["x"] }
[motion]
elasticity = {}
boundary.bottom = { displacement = ["U/w*sin(w*t)", 0] }
boundary.top = "fixed"
[flow]
order = 5
gas.viscosity = { constant = 0.02 }
reference = { density = 1, speed = 0.03, pressure = 1 }
initial.expression = { density = 1, velocity = ["U*exp(-k*y)*cos(k*y)", 0], pressure = 1 }
boundary.others = { isothermal_wall = { temperature = 1 } }
[time]
order = 3
end = 1
slabs = 20
[solver]
newton_tolerance = 1e-11
"#;

/// The sign of a moment is the requested one, in every figure.
#[test]
fn moments_are_positive_nose_up_where_that_is_asked_for() {
    let directory = TempDir::new().unwrap();
    let run = |output: &str, extra: &[&str]| {
        let set = [&["time.end=0.1", "time.slabs=2"], extra].concat();
        on_case(directory.path(), "run", "couette", &set, output, &[]).expect(0, &[]);
        directory.path().join(output)
    };
    let (left, up) = (run("left", &[]), run("up", &["flow.forces.others.moment_positive=nose_up"]));
    for name in ["top_moment", "top_moment_coefficient", "top_moment_impulse_in_slab", "bottom_moment"] {
        let (left, up) = (column(&left, name), column(&up, name));
        assert!(left.iter().zip(&up).all(|(left, up)| *left == -up && *left != 0.0), "{name}: {left:?} {up:?}");
    }
    assert_eq!(column(&left, "top_power"), column(&up, "top_power"));
    let of = |run: &std::path::Path| summary(run)["walls"]["top"].clone();
    let impulse = |wall: &serde_json::Value| wall["moment_impulse"][0].as_f64().unwrap();
    assert_eq!(impulse(&of(&left)), -impulse(&of(&up)));
    assert_eq!(number(&of(&left), "moment_coefficient"), -number(&of(&up), "moment_coefficient"));
}

#[test]
fn differences_in_place_of_duals_lead_to_the_same_answer() {
    let directory = TempDir::new().unwrap();
    let difference = {
        let exact = finished(directory.path(), "vortex", &SMALL);
        let set = [&SMALL[..], &["solver.jacobian=finite_difference"]].concat();
        on_case(directory.path(), "run", "vortex", &set, "differences", &[]).expect(0, &[]);
        let by_differences = summary(&directory.path().join("differences"));
        assert!(number(&by_differences, "newton.total") <= number(&exact, "newton.total") + 5.0);
        number(&exact, "error.density_l2") - number(&by_differences, "error.density_l2")
    };
    assert!(difference.abs() < 1e-8, "{difference:e}");
    let flow = |run: &str| {
        let path = directory.path().join(run).join("result.vtkhdf");
        output::read_checkpoint(&path).unwrap().1.arrays["flow"].clone()
    };
    let (one, other) = (flow("vortex"), flow("differences"));
    let largest = one.iter().zip(other.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(largest > 0.0 && largest < 1e-7, "{largest:e}");
}

#[test]
fn the_default_directory_is_named_after_the_case() {
    let directory = TempDir::new().unwrap();
    let set = "time.end=0.1";
    stsolve(directory.path(), &["run", "-q", &shipped("free_stream.toml"), "--set", set, "--set", "time.slabs=1"])
        .expect(0, &[]);
    assert!(directory.path().join("runs/free_stream/summary.json").exists());
}

/// Roe's flux damps a vortex at a Mach number of 0.01 with the speed of sound.
#[test]
fn a_slow_vortex_is_more_accurate_with_the_flux_for_low_mach_numbers() {
    let error = |riemann: &str| {
        let (directory, flux) = (TempDir::new().unwrap(), format!("flow.riemann={riemann}"));
        let slow = ["flow.exact.vortex.free_stream.mach=0.01", "flow.exact.vortex.strength=0.004"];
        let summary = finished(directory.path(), "vortex", &[&flux, slow[0], slow[1], "time.end=1"]);
        number(&summary, "error.momentum_l2")
    };
    let [roe, low_mach] = ["roe", "low_mach_roe"].map(error);
    assert!(low_mach < 0.5 * roe, "{low_mach:e} for {roe:e}");
}
