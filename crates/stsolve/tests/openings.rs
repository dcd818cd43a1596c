//! Gas that enters and leaves: vortices through an outflow, shear through an inflow, a blade started from a uniform stream, a channel with
//! a given mass flux. Also the reports of a run about flow for which a condition is not suited.
//!
//! The long versions: `cargo test --release -p stsolve --test openings -- --ignored`

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{Outcome, assert_same_bits, checkpoint, column, number, on_case, stsolve, summary};
use std::path::Path;
use tempfile::TempDir;

/// A vortex that leaves a box at M = 0.3 through its right side, at t = 5. The strength is the largest velocity in units of the
/// stream, times sqrt(e).
const VORTEX: &str = r#"
[mesh]
order = 2
[mesh.generate.box]
lower = [-5, -4]
upper = [5, 4]
cells = [10, 8]
[flow]
order = 4
exact = { uniform = { density = 1, velocity = [1, 0], mach = 0.3 } }
[flow.initial.vortex]
free_stream = { density = 1, velocity = [1, 0], mach = 0.3 }
centre = [0, 0]
strength = 2.5
[flow.boundary]
right = { outflow = { pressure = 7.936507936507937 } }
others = { far_field = { density = 1, velocity = [1, 0], mach = 0.3 } }
[time]
order = 2
end = 8
step = 0.1
"#;

/// A jet along an inflow, ten times faster than the Mach number 0.3 across it, or against it.
const SHEAR: &str = r#"
[constants]
push = 0.3
[mesh]
order = 2
[mesh.generate.box]
lower = [0, 0]
upper = [4, 2]
cells = [6, 3]
periodic = ["y"]
[flow]
order = 4
reference = { density = 1, speed = 1, pressure = 7.936507936507937 }
exact = { uniform = { density = 1, velocity = [0, 0], pressure = 7.936507936507937 } }
[flow.initial.expression]
density = 1
velocity = ["push", "4*exp(-x^2)*(1+0.1*sin(pi*y))"]
pressure = 7.936507936507937
[flow.boundary]
left = { inflow = { total_pressure = 7.98, total_temperature = 7.95, direction = [1, 0] } }
right = { outflow = { pressure = 7.936507936507937 } }
[time]
order = 2
end = 2
step = 0.05
"#;

/// A stream at M = 2 through a box.
const SUPERSONIC: &str = r#"
[mesh]
order = 2
[mesh.generate.box]
lower = [0, 0]
upper = [2, 1]
cells = [4, 2]
periodic = ["y"]
[flow]
order = 3
exact = { uniform = { density = 1, velocity = [1, 0], mach = 2 } }
[flow.boundary]
left = { supersonic_inflow = { uniform = { density = 1, velocity = [1, 0], mach = 2 } } }
right = { outflow = { pressure = 0.5 } }
[time]
order = 2
end = 1
step = 0.1
"#;

/// A passage of a row of blades, coarse, started from a uniform stream: the waves of the start push gas back through the
/// inflow.
const BLADE: &str = r#"
[mesh]
order = 4
[mesh.generate.turbine_blade]
[flow]
order = 3
initial = { uniform = { density = 1, velocity = [0.7912, 0.6115], mach = 0.3 } }
reference = { density = 1, speed = 1, pressure = 7.936507936507937 }
gas = { viscosity = { constant = 0.002 } }
[flow.boundary]
blade = { adiabatic_wall = {} }
inflow = { inflow = { total_pressure = 8.4476, total_temperature = 8.0794, direction = [0.7912, 0.6115] } }
outflow = { outflow = { pressure = 7.2 } }
[time]
order = 2
end = 0.7
step = 0.05
"#;

/// A duct between a reservoir and an outlet, steady, at M = 0.3.
const DUCT: &str = r#"
[mesh]
order = 2
[mesh.generate.box]
lower = [0, 0]
upper = [4, 1]
cells = [6, 2]
[flow]
order = 4
initial = { uniform = { density = 1, velocity = [0.7, 0], mach = 0.2 } }
reference = { density = 1, speed = 1, pressure = 7.936507936507937 }
[flow.boundary]
left = { inflow = { total_pressure = 8.4478, total_temperature = 8.0794, direction = [1, 0] } }
right = { outflow = { pressure = 7.936507936507937 } }
others = "slip_wall"
[time]
order = 1
end = 0.01
slabs = 1
[solver.steady]
"#;

/// Runs a `case` with changes.
fn run(directory: &Path, case: &str, set: &[&str], output: &str, extra: &[&str]) -> Outcome {
    std::fs::write(directory.join("case.toml"), case).unwrap();
    let mut arguments = vec!["run", "case.toml", "--output", output];
    set.iter().for_each(|change| arguments.extend(["--set", change]));
    arguments.extend(extra);
    stsolve(directory, &arguments)
}

/// The summary of a run that must reach its end.
fn survives(case: &str, set: &[&str]) -> serde_json::Value {
    let directory = TempDir::new().unwrap();
    run(directory.path(), case, set, "run", &["--quiet"]).expect(0, &[]);
    summary(&directory.path().join("run"))
}

/// At a strength of 2.5 a run fails at t = 5.1 if gas that comes back has the entropy and the shear of the gas inside.
#[test]
fn vortices_leave_through_an_outflow() {
    for strength in ["1", "2.5", "4"] {
        let summary = survives(VORTEX, &[&format!("flow.initial.vortex.strength={strength}")]);
        // The weakest vortex is slower than the stream, so nothing comes back.
        if strength == "1" {
            assert!(summary["openings"]["right"].get("backflow").is_none(), "{summary}");
            continue;
        }
        let backflow = &summary["openings"]["right"]["backflow"];
        assert!((2.0..6.0).contains(&number(backflow, "since")), "{summary}");
        assert!((0.05..0.7).contains(&number(backflow, "largest_share")), "{summary}");
    }
}

/// The same through an outflow that lets sound pass.
#[test]
fn vortices_leave_through_an_outflow_of_velocity() {
    for strength in ["2.5", "4"] {
        let outflow = "flow.boundary.right={ outflow = { pressure = 7.936507936507937, velocity = [1, 0] } }";
        survives(VORTEX, &[&format!("flow.initial.vortex.strength={strength}"), outflow]);
    }
}

/// Density, speed and pressure at every node at the end of a run of order 4 in two dimensions.
fn gas_at_end(run: &Path) -> Vec<[f64; 3]> {
    const NODES: usize = 16;
    let flow: Vec<f64> = checkpoint(run).0["flow"].iter().map(|&bits| f64::from_bits(bits)).collect();
    let node = |cell: &[f64], i: usize| {
        let [density, x, y, energy] = [0, 1, 2, 3].map(|component| cell[component * NODES + i]);
        let squared = (x * x + y * y) / (density * density);
        [density, squared.sqrt(), 0.4 * (energy - 0.5 * density * squared)]
    };
    flow.chunks_exact(4 * NODES).flat_map(|cell| (0..NODES).map(move |i| node(cell, i))).collect()
}

/// The largest difference of the pressure from the pressure of the outlet, relative to it.
fn pressure_off(run: &Path) -> f64 {
    gas_at_end(run).iter().map(|[_, _, p]| (p / 7.936507936507937 - 1.0).abs()).fold(0.0, f64::max)
}

/// In a frictionless duct the total pressure and the total temperature of the inflow hold everywhere, and so does the pressure of the
/// outflow.
#[test]
fn a_duct_has_the_total_state_of_its_inflow() {
    let directory = TempDir::new().unwrap();
    run(directory.path(), DUCT, &[], "run", &["--quiet"]).expect(0, &[]);
    let run = directory.path().join("run");
    for [density, speed, pressure] in gas_at_end(&run) {
        let temperature = pressure / density;
        let total = temperature + speed * speed / 7.0;
        assert!((total / 8.0794 - 1.0).abs() < 1e-8, "{total}");
        let total_pressure = pressure * (total / temperature).powf(3.5);
        assert!((total_pressure / 8.4478 - 1.0).abs() < 1e-8, "{total_pressure}");
    }
    assert!(pressure_off(&run) < 1e-8);
}

#[test]
#[ignore = "a minute"]
fn the_pressure_is_that_of_the_outlet_30_after_a_vortex() {
    let directory = TempDir::new().unwrap();
    for strength in ["1", "2.5", "4"] {
        let set = [&format!("flow.initial.vortex.strength={strength}")[..], "time.end=30"];
        run(directory.path(), VORTEX, &set, strength, &["--quiet"]).expect(0, &[]);
        let off = pressure_off(&directory.path().join(strength));
        assert!(off < 1e-3, "{strength}: {off:e}");
    }
}

/// SHEAR with a jet of another speed.
fn jet(speed: &str) -> String {
    format!("flow.initial.expression.velocity=[\"push\", \"{speed}*exp(-x^2)*(1 + 0.1*sin(pi*y))\"]")
}

/// SHEAR without a jet is a column of gas of length L = 4 that the reservoir pushes towards the outlet. It gathers speed by
///
/// L du/dt = (U^2 - u^2) / 2,   u = U tanh(U t / (2 L) + artanh(u_0 / U)),   U = sqrt(2 c_p (T_0 - T)), T from p_0 to p
///
/// for a gas of hardly varying density. U = 0.295, so that 2 L / U = 27: at t = 30 the pressure is 1.1e-3 (u_0 = 0.1) and 2.0e-3 (0) above
/// the outlet's at the inflow. No treatment of the openings makes that less.
#[test]
fn a_column_of_gas_gathers_speed_between_a_reservoir_and_an_outlet() {
    let directory = TempDir::new().unwrap();
    let (reservoir, outlet): (f64, f64) = (7.98, 7.936507936507937);
    let largest = (7.0 * 7.95 * (1.0 - (outlet / reservoir).powf(2.0 / 7.0))).sqrt();
    for (push, start) in [("0.1", 0.1), ("0", 0.0)] {
        let set = [&format!("constants.push={push}")[..], &jet("0"), "time.end=30", "time.step=0.1"];
        run(directory.path(), SHEAR, &set, push, &["--quiet"]).expect(0, &[]);
        let run = directory.path().join(push);
        let speed = largest * (largest * 30.0 / 8.0 + (start / largest).atanh()).tanh();
        // Of unit density in a box of height 2.
        let found = number(&summary(&run)["openings"]["right"], "mass_flow") / 2.0;
        assert!((found / speed - 1.0).abs() < 2e-3, "push {push}: {found}, not {speed}");
        let (off, law) = (pressure_off(&run), (largest * largest - speed * speed) / 2.0 / outlet);
        assert!((off / law - 1.0).abs() < 0.15, "push {push}: {off:e}, not {law:e}");
    }
}

/// The jet leaves with the gas, and then the column of gas without it goes on. A jet of M = 0.3 has left by t = 60, one of M = 1.2 by t = 120.
/// By t = 30 only the first at a push of 0.3 has. At the end the deviation falls as in the column, by exp(-U t / L).
#[test]
#[ignore = "long: a minute; scripts/test --long"]
fn long_the_pressure_is_that_of_the_outlet_after_shear() {
    let directory = TempDir::new().unwrap();
    let off = |speed: &str, push: &str, end: &str| {
        let set = [&format!("constants.push={push}")[..], &jet(speed), &format!("time.end={end}"), "time.step=0.1"];
        let output = format!("{speed}_{push}_{end}");
        run(directory.path(), SHEAR, &set, &output, &["--quiet"]).expect(0, &[]);
        let off = pressure_off(&directory.path().join(output));
        println!(
            "| shear through `inflow`, jet {speed}, push {push}, t = {end} | pressure off the outlet's | {off:.2e} | 0 | 1.0e-3 |"
        );
        off
    };
    assert!(off("1", "0.3", "30") < 1e-3);
    for push in ["0.3", "0.1", "0", "-0.1"] {
        let (earlier, later) = (off("1", push, "60"), off("1", push, "80"));
        assert!(earlier < 1e-3, "{push}: {earlier:e}");
        let rate = (earlier / later).ln() / 20.0;
        assert!((rate / (0.2947 / 4.0) - 1.0).abs() < 0.4, "{push}: {rate}");
        let fast = off("4", push, "120");
        assert!(fast < 1e-3, "{push}: {fast:e}");
    }
}

/// All of these would fail before t = 0.4 if shear were imposed on gas that leaves.
#[test]
fn shear_passes_an_inflow() {
    for push in ["0.3", "0.1", "0", "-0.1"] {
        survives(SHEAR, &[&format!("constants.push={push}")]);
    }
}

/// The waves of the start push gas back through the inflow.
#[test]
fn a_blade_starts_from_a_uniform_stream() {
    let summary = survives(BLADE, &[]);
    let through = |name: &str| number(&summary["openings"][name], "mass_flow");
    assert!(number(&summary, "openings.inflow.leaving.largest_share") > 0.5, "{summary}");
    assert!(through("inflow") < 0.0 && through("outflow") > 0.0, "{summary}");
}

/// Checkpoints hold the observations of a run at its openings.
#[test]
fn a_resumed_run_knows_what_came_back() {
    let directory = TempDir::new().unwrap();
    let coarse = ["mesh.generate.box.cells=[5,4]", "flow.order=3"];
    let to = |end: &str, output: &str, extra: &[&str]| {
        run(directory.path(), VORTEX, &[&coarse[..], &[end]].concat(), output, extra).expect(0, &[]);
    };
    to("time.end=5", "through", &[]);
    to("time.end=4.5", "resumed", &[]);
    to("time.end=5", "resumed", &["--resume"]);
    let at = |name: &str| directory.path().join(name);
    assert_same_bits(&at("through"), &at("resumed"), "resumed");
    let [through, resumed] = ["through", "resumed"].map(|name| summary(&at(name))["openings"].clone());
    assert_eq!(through, resumed);
    assert!(number(&through, "right.backflow.since") < 4.5, "{through}");
}

#[test]
fn a_supersonic_stream_enters_by_its_state() {
    let summary = survives(SUPERSONIC, &[]);
    assert!(number(&summary, "conservation.free_stream_error") < 1e-12, "{summary}");
    assert!(summary["openings"]["left"].get("subsonic").is_none(), "{summary}");
    assert!((number(&summary, "openings.left.mass_flow") + 1.0).abs() < 1e-12, "{summary}");
}

/// Check, run and summary report a supersonic stream through `inflow`.
#[test]
fn a_supersonic_stream_through_a_subsonic_inflow_is_told() {
    // p_0 = p 1.8^3.5 and T_0 = 1.8 T of M = 2.
    let inflow =
        "flow.boundary.left={ inflow = { total_pressure = 1.3973, total_temperature = 0.32143, direction = [1, 0] } }";
    let directory = TempDir::new().unwrap();
    let outcome = run(directory.path(), SUPERSONIC, &[inflow], "run", &[]);
    let told = "gas enters through the subsonic inflow `left` faster than sound (normal Mach number 2.000), on 100 % of it, since t = 0";
    assert!(outcome.stderr.contains(told), "{}", outcome.stderr);
    let summary = summary(&directory.path().join("run"));
    let seen = &summary["openings"]["left"]["supersonic"];
    assert_eq!((number(seen, "since"), number(seen, "largest_share")), (0.0, 1.0), "{summary}");
    let check = stsolve(directory.path(), &["check", "case.toml", "--probe", "never", "--set", inflow]);
    assert!(check.stdout.contains(told), "{}", check.stdout);
}

/// With one Newton step allowed every slab fails; the opening must be named first among the causes.
#[test]
fn a_misused_opening_is_the_first_cause() {
    let inflow =
        "flow.boundary.left={ inflow = { total_pressure = 1.3973, total_temperature = 0.32143, direction = [1, 0] } }";
    let directory = TempDir::new().unwrap();
    let set = [inflow, "solver.newton_steps=1", "solver.slab_halvings=0"];
    let outcome = run(directory.path(), SUPERSONIC, &set, "run", &["--quiet"]);
    outcome.expect(
        1,
        &["likely cause: gas enters through the subsonic inflow `left` faster than sound", "supersonic_inflow"],
    );
}

/// DFG 2D-1 (Schäfer & Turek 1996) at M = 0.025: the drag, and the given mass flux of 0.2 times the height. A prescribed state would lose
/// 2.5 % of the mass flux.
#[test]
fn the_cylinder_in_a_channel_has_the_drag_of_the_benchmark() {
    let directory = TempDir::new().unwrap();
    on_case(directory.path(), "run", "channel_cylinder", &[], "run", &[]).expect(0, &[]);
    let summary = summary(&directory.path().join("run"));
    let flow = |name: &str| number(&summary["openings"][name], "mass_flow");
    assert!((flow("inflow") / -0.082 - 1.0).abs() < 1e-10, "{summary}");
    assert!((flow("outflow") / 0.082 - 1.0).abs() < 1e-6, "{summary}");
    let history = column(&directory.path().join("run"), "inflow_mass_flow");
    assert_eq!(history.last().copied(), Some(flow("inflow")));
    let drag = number(&summary, "steady.walls.cylinder.drag_coefficient");
    assert!((drag - 5.577).abs() < 0.003, "{drag}");
}

/// Plane channel flow at Re = 2, on a mesh that resolves mu / (rho w). Walls at rest do no work, so it leaves as it has entered. With derivatives
/// along the normal from inside, the total temperature at an outflow was 1.034, and that of gas that is sucked out 0.79.
#[test]
fn viscous_gas_leaves_with_the_total_temperature_with_which_it_enters() {
    let profile = "[\"0.6*y*(1-y)\", 0]";
    let case = |left: &str, right: &str| {
        format!(
            "mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [1, 1], cells = [4, 4] }} }}
             time = {{ order = 2, end = 0.1, step = 0.1 }}
             solver.steady = {{}}
             [flow]
             order = 5
             gas.viscosity.constant = 0.05
             initial.expression = {{ density = 1, velocity = {profile}, pressure = \"1 + 0.06*(1 - x)\" }}
             reference = {{ density = 1, speed = 0.1, pressure = 1 }}
             boundary = {{ left = {left}, right = {right}, others.adiabatic_wall = {{}} }}"
        )
    };
    let pushed = format!("{{ velocity_inflow = {{ velocity = {profile}, temperature = 1 }} }}");
    let reservoir = "{ inflow = { total_pressure = 1.06, total_temperature = 1, direction = [1, 0] } }";
    let outflow = "{ outflow = { pressure = 1 } }";
    let directory = TempDir::new().unwrap();
    let total_temperature = |left: &str, right: &str| {
        run(directory.path(), &case(left, right), &[], "run", &["--quiet", "--force"]).expect(0, &[]);
        *column(&directory.path().join("run"), "right_total_temperature").last().unwrap()
    };
    // The mean over the mass flux of T + w^2 / 7 is 1.0022 where the profile enters.
    let (leaves, is_sucked) = (total_temperature(&pushed, outflow), total_temperature(reservoir, &pushed));
    println!("total temperature {leaves} at an outflow, {is_sucked} sucked out");
    assert!((leaves - 1.0022).abs() < 1e-3 && (is_sucked - 1.0).abs() < 1e-3, "{leaves} {is_sucked}");
}

#[test]
fn openings_that_cannot_be_are_refused() {
    let directory = TempDir::new().unwrap();
    let refused =
        |change: &str, parts: &[&str]| run(directory.path(), SUPERSONIC, &[change], "run", &[]).expect(2, parts);
    let uniform = |mach: &str| {
        format!("flow.boundary.left={{ supersonic_inflow = {{ uniform = {{ velocity = [1, 0], mach = {mach} }} }} }}")
    };
    refused(&uniform("0.8"), &["at most 0.800", "more than 1; for slower gas `inflow`"]);
    let outwards = "flow.boundary.left={ inflow = { total_pressure = 1, total_temperature = 1, direction = [-1, 0] } }";
    refused(outwards, &["direction", "into the domain: the outward normal", "-1.000"]);
    let velocity = |keys: &str| format!("flow.boundary.left={{ velocity_inflow = {{ {keys} }} }}");
    refused(&velocity("temperature = 1"), &["the velocity is missing", "one of `velocity` and `mass_flux`"]);
    refused(&velocity("velocity = [1, 0], mass_flux = [1, 0], temperature = 1"), &["given twice"]);
    refused(
        &velocity("velocity = [1, 0], temperature = \"y - 0.5\""),
        &["the temperature at [0.0, 0.0] and t = 0, -0.5,", "positive"],
    );
    refused(&velocity("velocity = [\"1/0\", 0], temperature = 1"), &["the vector at"]);
    refused(
        "flow.boundary.right={ outflow = { pressure = 1, total_temperature = 0 } }",
        &["total_temperature", "positive"],
    );
}
