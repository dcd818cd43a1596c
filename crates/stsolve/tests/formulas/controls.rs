//! A control finds the force of a mass flow, after a resume and a restart too.

use crate::common::{column, on_text, stsolve, summary};
use crate::run;
use tempfile::TempDir;

/// A channel at rest in which a control makes the mean velocity 1. The force then is 3 mu u / h^2 with mu = 0.01 and h = 1.
const DRIVEN: &str = r#"
[mesh]
order = 2
generate.channel = { extent = [1, 2], cells = [1, 3], periodic = true }
[flow]
order = 4
source = { acceleration = ["force", 0] }
initial = { expression = { density = 1, velocity = [0, 0], pressure = "100/1.4" } }
reference = { density = 1, speed = 1, pressure = "100/1.4", length = 1 }
gas = { gamma = 1.4, prandtl = 0.72, gas_constant = "100/1.4", viscosity = { constant = 0.01 } }
[flow.boundary]
bottom = { isothermal_wall = { temperature = 1 } }
top = { isothermal_wall = { temperature = 1 } }
[controls.force]
measure = "momentum_x"
rate = "0.1*(2 - measured)"
[output]
integrals = ["momentum_x"]
[time]
order = 2
end = 400
step = 0.5
"#;

#[test]
fn a_control_finds_the_force_of_a_mass_flow() {
    let directory = TempDir::new().unwrap();
    run(directory.path(), DRIVEN, &[], "run");
    let last = |name: &str| *column(&directory.path().join("run"), name).last().unwrap();
    let (momentum, force) = (last("momentum_x"), last("control_force"));
    assert!((momentum - 2.0).abs() < 1e-3 && (force - 0.03).abs() < 3e-4, "{momentum} {force}");
}

/// A control that nothing contains had no effect, and nothing said so.
#[test]
fn a_control_that_no_formula_contains_is_warned_of() {
    let directory = TempDir::new().unwrap();
    std::fs::write(directory.path().join("case.toml"), DRIVEN).unwrap();
    let check = |change: &str| stsolve(directory.path(), &["check", "case.toml", "--set", change]).stdout;
    let told = "no formula contains `force`";
    let [unused, used] = ["flow.source.acceleration=[0.03,0]", "time.end=2"].map(check);
    assert!(unused.contains(told) && !used.contains(told), "{unused}{used}");
}

#[test]
fn a_control_has_the_same_bits_after_a_resume() {
    let directory = TempDir::new().unwrap();
    run(directory.path(), DRIVEN, &["time.end=40"], "whole");
    run(directory.path(), DRIVEN, &["time.end=17"], "parts");
    let resumed = ["run", "case.toml", "--quiet", "--output", "parts", "--resume", "--set", "time.end=40"];
    stsolve(directory.path(), &resumed).expect(0, &[]);
    let history = |run: &str| std::fs::read_to_string(directory.path().join(run).join("history.csv")).unwrap();
    assert_eq!(history("whole"), history("parts"));
}

/// The run ended without a summary, and the slabs since the last checkpoint were lost. The work of the force was told to be an error of the energy.
#[test]
fn a_control_without_a_value_ends_a_run_like_any_failure() {
    let directory = TempDir::new().unwrap();
    std::fs::write(directory.path().join("case.toml"), DRIVEN).unwrap();
    let rate = "controls.force.rate=\"log(1.25 - t)\"";
    let arguments = ["run", "case.toml", "--quiet", "--output", "run", "--set", rate, "--set", "time.end=10"];
    stsolve(directory.path(), &arguments).expect(1, &["the run stopped at t = 1.5", "the control `force` is NaN"]);
    let run = directory.path().join("run");
    assert_eq!((column(&run, "t"), &summary(&run)["completed"]), (vec![0.5, 1.0, 1.5], &false.into()));
    assert!(column(&run, "energy_error").iter().all(|error| error.is_nan()));
    assert!(column(&run, "mass_error").iter().all(|error| error.abs() < 1e-12));
}

/// A control took the value that another one had in the same place.
#[test]
fn a_restart_finds_its_controls_by_their_names() {
    let directory = TempDir::new().unwrap();
    run(directory.path(), DRIVEN, &["time.end=2"], "first");
    let last = |run: &str, name: &str| *column(&directory.path().join(run), name).last().unwrap();
    let other =
        DRIVEN.replace("\"force\"", "\"push\"").replace("controls.force", "controls.push").replace("0.1*(", "0*(");
    let from = "restart.from=\"first\"";
    run(directory.path(), &other, &["time.end=3", from, "controls.push.initial=0.25"], "second");
    assert_eq!(last("second", "control_push"), 0.25);
    run(directory.path(), DRIVEN, &["time.end=2.5", from], "third");
    assert!(last("third", "control_force") > last("first", "control_force"));
}

#[test]
fn a_control_of_an_unknown_column_is_refused() {
    let directory = TempDir::new().unwrap();
    std::fs::write(directory.path().join("case.toml"), DRIVEN).unwrap();
    for command in ["check", "run"] {
        let arguments = [command, "case.toml", "--set", "controls.force.measure=\"flow_rate\""];
        stsolve(directory.path(), &arguments).expect(2, &["controls.force.measure", "flow_rate", "momentum_x"]);
    }
}

/// A duct with gas at rest, in which a control sets the pressure outside.
const DUCT: &str = r#"
[mesh]
order = 2
generate.box = { lower = [0, 0], upper = [1, 0.5], cells = [2, 1] }
[flow]
order = 2
initial.uniform = { density = 1, velocity = [0, 0], pressure = 1 }
reference = { density = 1, speed = 0.3, pressure = 1, length = 1 }
gas.gamma = 1.4
[flow.boundary]
left = { inflow = { total_pressure = 1, total_temperature = 1, direction = [1, 0] } }
right = { outflow = { pressure = "back" } }
others = "slip_wall"
[controls.back]
measure = "right_mass_flow"
initial = 1
rate = -12
[time]
order = 2
end = 0.3
step = 0.1
"#;

/// The failure blamed the mesh, and the condition on another boundary.
#[test]
fn a_control_that_makes_a_pressure_negative_is_named() {
    let directory = TempDir::new().unwrap();
    let told = ["the control `back` has become -0.2", "`pressure` of the boundary `right` is -0.2"];
    let outcome = on_text(directory.path(), DUCT, &[], "run", &["--quiet"]);
    assert!(!outcome.stderr.contains("likely cause"), "{}", outcome.stderr);
    outcome.expect(1, &told);
    let initial = ["check", "case.toml", "--set", "controls.back.initial=0"];
    stsolve(directory.path(), &initial).expect(2, &["the pressure of 0 at [1.0, 0.0] and t = 0", "its `initial`"]);
}
