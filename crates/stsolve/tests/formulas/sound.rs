//! A pulse of sound leaves through outflows, sponges and controls.

use crate::common::{column, stsolve};
use crate::run;
use std::path::Path;
use tempfile::TempDir;

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

/// 49 % of the pulse came back through a far field with `low_mach_roe`, whose smaller damping of sound acted on the boundary too.
#[test]
fn sound_leaves_through_a_far_field_with_every_flux() {
    let directory = TempDir::new().unwrap();
    for flux in ["roe", "hllc", "lax_friedrichs", "low_mach_roe"] {
        let set = [
            "flow.boundary.right={ far_field = { velocity = [0, 0], pressure = \"p\" } }",
            "flow.reference.speed=0.1",
            &format!("flow.riemann=\"{flux}\""),
        ];
        let returned = returned_of_pulse(directory.path(), PULSE, &set, flux);
        println!("{flux}: reflected part of the pulse {returned:.1e}");
        assert!(returned < 1e-2, "{flux}: {returned:e}");
    }
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
