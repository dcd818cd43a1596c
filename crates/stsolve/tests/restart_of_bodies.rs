//! A run with bodies or a structure that starts from the result of another one, with changes.

#![allow(clippy::unwrap_used)]

mod common;

use common::{Outcome, number, on_case, summary};
use std::path::Path;
use tempfile::TempDir;

/// The case `name` with `changes`, from the result of `origin` if there is one.
fn run(directory: &Path, name: &str, changes: &[&str], origin: Option<&str>, output: &str) -> Outcome {
    let from = origin.map(|origin| format!("restart.from={}", directory.join(origin).display()));
    let changes = changes.iter().copied().chain(from.as_deref()).collect::<Vec<_>>();
    on_case(directory, "run", name, &changes, output, &[])
}

/// The energy of a new spring, of another mass or of another modulus was counted as an error of the balance.
#[test]
fn the_balance_of_energy_begins_anew_with_other_bodies() {
    let directory = TempDir::new().unwrap();
    let error = |output: &str| number(&summary(&directory.path().join(output)), "conservation.coupled_energy_error");
    let small = ["flow.order=3", "mesh.generate.box.cells=[4,1]", "time={order=2,end=0.4,step=0.05}"];
    run(directory.path(), "piston_free", &small, None, "free").expect(0, &[]);
    let on = ["time.end=0.8", "bodies.piston.mass=2", "bodies.piston.x.spring=3"];
    run(directory.path(), "piston_free", &[&small[..], &on].concat(), Some("free"), "sprung").expect(0, &[]);
    assert!(error("free") < 1e-13 && error("sprung") < 1e-13, "{:e}, {:e}", error("free"), error("sprung"));
}

/// A short elastic piston whose support moves.
const PISTON: [&str; 7] = [
    "mesh.order=2",
    "mesh.generate.box.cells=[6,1]",
    "mesh.generate.box.segments={x=[{end=0,cells=3},{end=1.2,cells=3}]}",
    "flow.order=3",
    "structure.initial={}",
    "time={order=2,end=0.4,step=0.1}",
    "structure.boundary.left={displacement=[\"0.02*sin(t)\",0]}",
];

/// The velocity of a support is prescribed, so a formula that jumps was followed with an offset for the rest of the run.
#[test]
fn a_support_that_jumps_is_refused() {
    let directory = TempDir::new().unwrap();
    run(directory.path(), "elastic_piston", &PISTON, None, "first").expect(0, &[]);
    for (left, code, told) in [
        ("{displacement=[\"0.04*sin(t)\",0]}", 2, &["structure.boundary", "displaced by"][..]),
        ("\"fixed\"", 2, &["structure.boundary", "displaced by"]),
        ("{displacement=[\"0.02*sin(t)+0.01*t*(t-0.4)^2\",0]}", 0, &[]),
    ] {
        let left = format!("structure.boundary.left={left}");
        let changes = [&PISTON[..], &[&left, "time.end=0.6"]].concat();
        let output = format!("then_{code}");
        run(directory.path(), "elastic_piston", &changes, Some("first"), &output).expect(code, told);
    }
}
