//! Formulas as values of boundary conditions and as sources; sponges.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{Surface, column, number, stsolve, summary};
use std::path::Path;
use tempfile::TempDir;

/// Parallel inviscid flow of uniform pressure: u = 0.5 + 0.2 y, rho = 1 + 0.2 y. The total state varies across the inflow. All components are
/// polynomials of degree 3, so the flow is steady to round-off.
const SHEAR: &str = r#"
[mesh]
order = 2
[mesh.generate.box]
lower = [0, 0]
upper = [3, 1]
cells = [3, 2]
[flow]
order = 4
reference = { density = 1, speed = 0.5, pressure = 1 }
[flow.exact.expression]
density = "1 + 0.2*y"
velocity = ["0.5 + 0.2*y", 0]
pressure = 1
[flow.boundary.left.inflow]
total_pressure = "(1 + (0.5 + 0.2*y)^2*(1 + 0.2*y)/7)^3.5"
total_temperature = "1/(1 + 0.2*y) + (0.5 + 0.2*y)^2/7"
direction = [1, 0]
[flow.boundary]
right = { outflow = { pressure = "1 + 0*y" } }
others = "slip_wall"
[time]
order = 2
end = 1
step = 0.1
"#;

/// A duct between a reservoir and an outlet whose pressure oscillates, started from the steady flow at M = 0.3.
const PULSATING: &str = r#"
[constants]
p = 7.936507936507937
[mesh]
order = 2
[mesh.generate.box]
lower = [0, 0]
upper = [4, 1]
cells = [6, 1]
[flow]
order = 4
initial = { uniform = { density = 1, velocity = [1, 0], mach = 0.3 } }
[flow.boundary]
left = { inflow = { total_pressure = 8.4478, total_temperature = 8.0794, direction = [1, 0] } }
right = { outflow = { pressure = "p*(1 + 0.01*sin(2*pi*t/4))" } }
others = "slip_wall"
[time]
order = 2
end = 8
step = 0.1
"#;

/// Stokes' second problem at M = 0.02: a wall that slides by cos(w t) moves a layer of depth 1/k, k = sqrt(w / (2 nu)) = 10.
const STOKES: &str = r#"
[constants]
w = "2*pi"
nu = "w/200"
[mesh]
order = 2
[mesh.generate.box]
lower = [0, 0]
upper = [0.5, 1]
cells = [2, 6]
periodic = ["x"]
[flow]
order = 5
gas = { viscosity = { constant = "nu" } }
reference = { density = 1, speed = 1, pressure = 1785.7142857142858 }
[flow.exact.expression]
density = 1
velocity = ["exp(-10*y)*cos(w*t - 10*y)", 0]
pressure = 1785.7142857142858
[flow.boundary]
bottom = { isothermal_wall = { temperature = 1785.7142857142858, slide = ["cos(w*t)", 0] } }
top = "slip_wall"
[time]
order = 3
end = 1
step = 0.05
"#;

/// A uniform gas that a sponge draws to its target: u - u_t = exp(-2 t) (u_0 - u_t) in all conserved quantities.
const DECAY: &str = r#"
[mesh]
order = 2
[mesh.generate.box]
lower = [0, 0]
upper = [1, 1]
cells = [2, 2]
periodic = ["x", "y"]
[flow]
order = 2
reference = { density = 1, speed = 0.5, pressure = 1 }
sponge = { strength = 2, target = { density = 1, velocity = [0.5, 0], pressure = 1 } }
[flow.exact.expression]
density = "1 + 0.1*exp(-2*t)"
velocity = ["(0.5 + 0.2*exp(-2*t))/(1 + 0.1*exp(-2*t))", 0]
pressure = "0.4*(2.625 + 0.3*exp(-2*t) - 0.5*(0.5 + 0.2*exp(-2*t))^2/(1 + 0.1*exp(-2*t)))"
[time]
order = 2
end = 1
slabs = 8
"#;

/// A pulse of sound that runs to the right, c = 1, to an outflow that reflects it. It passes the probe on its way back at t = 11.
const PULSE: &str = r#"
[constants]
p = "1/1.4"
e = 1e-3
[mesh]
order = 2
[mesh.generate.box]
lower = [0, 0]
upper = [8, 0.5]
cells = [24, 1]
periodic = ["y"]
[flow]
order = 4
reference = { density = 1, speed = 1, pressure = "p" }
[flow.initial.expression]
density = "1 + e*exp(-4*(x - 3)^2)"
velocity = ["e*exp(-4*(x - 3)^2)", 0]
pressure = "p*(1 + 1.4*e*exp(-4*(x - 3)^2))"
[flow.boundary]
left = { far_field = { velocity = [0, 0], pressure = "p" } }
right = { outflow = { pressure = "p" } }
[output.probes]
behind = { at = [2, 0.25] }
[time]
order = 2
end = 12.5
step = 0.1
"#;

/// A run of `case` that must reach its end.
fn run(directory: &Path, case: &str, set: &[&str], output: &str) -> serde_json::Value {
    std::fs::write(directory.join("case.toml"), case).unwrap();
    let mut arguments = vec!["run", "case.toml", "--quiet", "--output", output];
    set.iter().for_each(|change| arguments.extend(["--set", change]));
    stsolve(directory, &arguments).expect(0, &[]);
    summary(&directory.join(output))
}

fn largest_error(summary: &serde_json::Value) -> f64 {
    ["density_l2", "momentum_l2", "energy_l2"]
        .map(|name| number(summary, &format!("error.{name}")))
        .into_iter()
        .fold(0.0, f64::max)
}

#[test]
fn a_shear_flow_enters_by_its_total_state() {
    let directory = TempDir::new().unwrap();
    let error = largest_error(&run(directory.path(), SHEAR, &[], "run"));
    assert!(error < 1e-10, "{error:e}");
    let uniform =
        "flow.boundary.left={ inflow = { total_pressure = 1.15, total_temperature = 1, direction = [1, 0] } }";
    assert!(largest_error(&run(directory.path(), SHEAR, &[uniform], "uniform")) > 1e-2);
}

#[test]
fn the_pressure_at_an_outflow_follows_its_formula() {
    let directory = TempDir::new().unwrap();
    run(directory.path(), PULSATING, &[], "run");
    let [t, pressure] = ["t", "right_pressure"].map(|name| column(&directory.path().join("run"), name));
    let swing = |t: f64| 0.01 * (2.0 * std::f64::consts::PI * t / 4.0).sin();
    let off = |(t, p): (&f64, &f64)| (p / 7.936507936507937 - 1.0 - swing(*t)).abs();
    let largest = t.iter().zip(&pressure).map(off).fold(0.0, f64::max);
    assert!(largest < 1e-4, "{largest:e} of a swing of 1e-2");
}

#[test]
fn a_wall_that_slides_to_and_fro_drags_a_layer() {
    let directory = TempDir::new().unwrap();
    let with = |set: &[&str], output: &str| number(&run(directory.path(), STOKES, set, output), "error.momentum_l2");
    let (moving, resting) =
        (with(&[], "moving"), with(&["flow.boundary.bottom.isothermal_wall.slide=[0,0]"], "resting"));
    println!("error of the momentum: {moving:.2e}, with a wall at rest {resting:.2e}");
    assert!(moving < 2e-4 && resting > 1e-1, "{moving:e}, {resting:e}");
}

/// The distribution along a wall whose values vary is that of the scheme: it sums to the force in history.csv.
#[test]
fn a_distribution_knows_the_values_of_its_wall() {
    let directory = TempDir::new().unwrap();
    let set = ["output.surfaces={ walls = [\"bottom\"] }", "time.end=0.2"];
    run(directory.path(), STOKES, &set, "run");
    let run = directory.path().join("run");
    let (along, force) = (Surface::read(&run, "bottom").at(0.2).force("x"), column(&run, "bottom_force_x"));
    let force = force.last().copied().unwrap();
    assert!(force.abs() > 1e-3 && (along / force - 1.0).abs() < 1e-10, "{along:e}, {force:e}");
}

#[test]
fn a_sponge_draws_the_gas_to_its_target_with_the_order_of_time() {
    let directory = TempDir::new().unwrap();
    let error = |slabs: &str| largest_error(&run(directory.path(), DECAY, &[&format!("time.slabs={slabs}")], slabs));
    let (coarse, fine) = (error("8"), error("16"));
    println!("errors with 8 and 16 slabs: {coarse:.2e}, {fine:.2e}");
    let order = (coarse / fine).log2();
    assert!(fine < 1e-5 && (order - 3.0).abs() < 0.2, "{coarse:e}, {fine:e}: order {order}");
}

/// A given source acts as its formulas say: rho = 1 + 0.3 t, rho u = 0.2 t^2, rho E = 2.5 + t.
#[test]
fn a_given_source_adds_mass_momentum_and_energy() {
    let directory = TempDir::new().unwrap();
    let set = [
        "flow.source={ given = { density = 0.3, momentum = [\"0.4*t\", 0], energy = 1 } }",
        "flow.exact.expression={ density = \"1 + 0.3*t\", velocity = [\"0.2*t^2/(1 + 0.3*t)\", 0], \
         pressure = \"0.4*(2.5 + t - 0.02*t^4/(1 + 0.3*t))\" }",
    ];
    let case: String = DECAY.lines().filter(|line| !line.starts_with("sponge")).collect::<Vec<_>>().join("\n");
    let summary = run(directory.path(), &case, &set, "run");
    let error = largest_error(&summary);
    assert!(error < 1e-9, "{error:e}");
    assert!(summary["conservation"]["mass_error"].is_null(), "{summary}");
}

/// The part of the pulse that comes back.
fn returned_of_pulse(directory: &Path, case: &str, set: &[&str], output: &str) -> f64 {
    run(directory, case, set, output);
    let [t, pressure] = ["t", "behind_pressure"].map(|name| column(&directory.join(output), name));
    let late = t.iter().zip(pressure).filter(|(t, _)| **t > 8.0);
    late.map(|(_, p)| (1.4 * p - 1.0).abs() / 1.4e-3).fold(0.0, f64::max)
}

/// An outflow that knows the velocity outside lets the pulse leave. If that velocity follows the mean one with a memory of 20, it has grown by
/// int w dt / 20 = 0.044 of the pulse, and half of it is a pressure.
#[test]
fn an_outflow_of_velocity_lets_a_pulse_of_sound_leave() {
    let directory = TempDir::new().unwrap();
    let returned = |keys: &str, output: &str| {
        let outflow = format!("flow.boundary.right={{ outflow = {{ pressure = \"p\", velocity = [0, 0]{keys} }} }}");
        returned_of_pulse(directory.path(), PULSE, &[&outflow], output)
    };
    let (fixed, relaxed) = (returned("", "fixed"), returned(", relaxation = 20", "relaxed"));
    println!("reflected part of the pulse: {fixed:.2e} with the velocity outside, {relaxed:.2e} with a relaxation");
    assert!(fixed < 0.01 && relaxed < 0.05, "{fixed:e} {relaxed:e}");
}

#[test]
fn a_relaxed_outflow_has_the_same_bits_after_a_resume() {
    let directory = TempDir::new().unwrap();
    let outflow = "flow.boundary.right={ outflow = { pressure = \"p\", velocity = [0, 0], relaxation = 2 } }";
    run(directory.path(), PULSE, &[outflow, "time.end=7"], "whole");
    run(directory.path(), PULSE, &[outflow, "time.end=6"], "parts");
    let resumed =
        ["run", "case.toml", "--quiet", "--output", "parts", "--resume", "--set", "time.end=7", "--set", outflow];
    stsolve(directory.path(), &resumed).expect(0, &[]);
    let history = |run: &str| std::fs::read_to_string(directory.path().join(run).join("history.csv")).unwrap();
    assert_eq!(history("whole"), history("parts"));
    let stream = column(&directory.path().join("whole"), "control_right_stream");
    assert!(stream.last().is_some_and(|w| *w > 1e-5), "{stream:?}");
}

/// A uniform stream of speed u, seen from a frame that turns at the rate 2: w = R(-2 t) u - 2 x r. The state is a polynomial in space.
const TURNING: &str = r#"
[constants]
u = 0.5
[mesh]
order = 2
[mesh.generate.box]
lower = [-0.5, -1]
upper = [1, 0.5]
cells = [2, 2]
[flow]
order = 3
reference = { density = 1, speed = 1, pressure = 1 }
rotation = { rate = 2 }
[flow.exact.expression]
density = 1
velocity = ["u*cos(2*t) + 2*y", "-u*sin(2*t) - 2*x"]
pressure = 1
[flow.boundary]
others = "exact"
[time]
order = 2
end = 1
slabs = 8
"#;

#[test]
fn a_uniform_stream_is_one_in_a_rotating_frame() {
    let directory = TempDir::new().unwrap();
    let error = |set: &[&str], output: &str| largest_error(&run(directory.path(), TURNING, set, output));
    let (coarse, fine) = (error(&["time.slabs=16"], "16"), error(&["time.slabs=32"], "32"));
    let order = (coarse / fine).log2();
    println!("a uniform stream in a rotating frame: errors {coarse:.2e} and {fine:.2e}, order {order:.2}");
    assert!(fine < 1e-3 && order > 2.7, "{coarse:e}, {fine:e}: order {order}");
    let still = error(&["constants.u=0"], "still");
    assert!(still < 1e-9, "gas at rest: {still:e}");
    let elsewhere = error(&["constants.u=0", "flow.rotation.centre=[0.1, 0]"], "elsewhere");
    assert!(elsewhere > 1e-3, "about another axis: {elsewhere:e}");
}

#[test]
fn a_sponge_absorbs_a_pulse_of_sound() {
    let directory = TempDir::new().unwrap();
    let returned = |set: &[&str], output: &str| returned_of_pulse(directory.path(), PULSE, set, output);
    let hard = returned(&[], "hard");
    let target = "target = { velocity = [0, 0], pressure = \"p\" }";
    let sponge = format!("flow.sponge={{ strength = \"4*max(0, (x - 5)/3)^2\", {target} }}");
    let soft = returned(&[&sponge], "soft");
    println!("reflected part of the pulse: {hard:.3} without a sponge, {soft:.2e} with it");
    assert!((hard - 1.0).abs() < 0.05 && soft < 1e-2 * hard, "{hard}, {soft:e}");
}

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

/// Two controls set the outflow to the pressure of a wave that leaves.
#[test]
fn controls_let_a_pulse_of_sound_leave() {
    let directory = TempDir::new().unwrap();
    let controls = "[controls.now]\nmeasure = \"right_mass_flow\"\nrate = \"(measured - value)/0.2\"\n[controls.slow]\nmeasure = \
                    \"right_mass_flow\"\nrate = \"(measured - value)/20\"\n";
    let set = ["flow.boundary.right={ outflow = { pressure = \"p + (now - slow)/0.5\" } }"];
    run(directory.path(), &format!("{PULSE}{controls}"), &set, "run");
    let [t, pressure] = ["t", "behind_pressure"].map(|name| column(&directory.path().join("run"), name));
    let late = t.iter().zip(pressure).filter(|(t, _)| **t > 8.0);
    let returned = late.map(|(_, p)| (1.4 * p - 1.0).abs() / 1.4e-3).fold(0.0, f64::max);
    println!("reflected part of the pulse with controls: {returned:.3}");
    assert!(returned < 0.1, "{returned}");
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
