//! Gas that enters and leaves: vortices through an outflow, shear through an inflow, a blade started from a uniform stream, a channel with
//! a given mass flux. Also the reports of a run about flow for which a condition is not suited.
//!
//! The long versions: `cargo test --release -p stsolve --test openings -- --ignored`

#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../common/mod.rs"]
mod common;

mod passages;
mod reservoirs;
mod supersonic;
mod vortices;

use common::{checkpoint, on_text, stsolve, summary};
use std::path::Path;
use tempfile::TempDir;

/// The summary of a run that must reach its end.
fn survives(case: &str, set: &[&str]) -> serde_json::Value {
    let directory = TempDir::new().unwrap();
    on_text(directory.path(), case, set, "run", &["--quiet"]).expect(0, &[]);
    summary(&directory.path().join("run"))
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

/// Conditions in other units than the initial state, of which only the failure of the run told.
#[test]
fn check_tells_of_openings_that_start_with_a_jump() {
    let directory = TempDir::new().unwrap();
    let text = r#"
        mesh = { order = 2, generate.box = { lower = [0, 0], upper = [2, 1], cells = [2, 1] } }
        time = { order = 1, end = 1, slabs = 10 }
        [flow]
        order = 2
        initial.uniform = { density = 1, velocity = [0.3, 0], pressure = 1 }
        [flow.boundary]
        left = { inflow = { total_pressure = 1.07, total_temperature = 1.02, direction = [1, 0] } }
        right = { outflow = { pressure = 1 } }
        others = "slip_wall"
    "#;
    std::fs::write(directory.path().join("case.toml"), text).unwrap();
    let checked = |set: &str| stsolve(directory.path(), &["check", "case.toml", "--set", set]).stdout;
    for (set, told) in [
        ("flow.boundary.right.outflow.pressure=0.9", None),
        (
            "flow.boundary.right.outflow.pressure=0.1",
            Some("at `right`: the state that the condition sets there has a pressure of"),
        ),
        ("flow.boundary.right.outflow.pressure=100", Some("at `right`")),
        ("flow.boundary.left.inflow.total_pressure=10", Some("at `left`")),
        ("flow.boundary.left.inflow.total_temperature=300", Some("at `left`")),
        ("flow.boundary.right=\"slip_wall\"", None),
        (
            "flow={order=2,shock_capturing={},initial={uniform={density=1,velocity=[3,0],pressure=1}},reference={density=1,speed=3,pressure=1},boundary={left={supersonic_inflow={uniform={density=1,velocity=[3,0],pressure=1}}},others=\"slip_wall\"}}",
            Some(
                "at `right`: the state that the condition sets there has a normal velocity of 0.0000e0, the gas 3.0000e0: let the velocity",
            ),
        ),
        (
            "flow.boundary.left={velocity_inflow={velocity=[30,0],temperature=1}}",
            Some("at `left`: the state that the condition sets there has a velocity along x of 3.0000e1"),
        ),
    ] {
        let said = checked(set);
        match told {
            Some(part) => assert!(said.contains("the flow starts with a jump") && said.contains(part), "{set}: {said}"),
            None => assert!(!said.contains("jump"), "{set}: {said}"),
        }
    }
}
