//! A run with bodies or a structure that starts from the result of another one, with changes.

#![allow(clippy::unwrap_used)]

mod common;

use common::{Outcome, column, number, on_case, on_text, summary};
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
    // What Newton's method leaves.
    assert!(error("free") < 1e-12 && error("sprung") < 1e-12, "{:e}, {:e}", error("free"), error("sprung"));
}

/// Only keys of `bodies` and `structure` were compared. A spring that is a formula of a constant changed with that constant alone, and its energy
/// was counted as an error of the balance.
#[test]
fn the_balance_of_energy_begins_anew_with_other_constants() {
    let directory = TempDir::new().unwrap();
    let error = |output: &str| number(&summary(&directory.path().join(output)), "conservation.coupled_energy_error");
    let by_constants = ["constants.m=1", "constants.k=1", "bodies.piston.mass=\"m\"", "bodies.piston.x.spring=\"k\""];
    let small = ["flow.order=3", "mesh.generate.box.cells=[4,1]", "time={order=2,end=0.4,step=0.05}"];
    let set = [&by_constants[..], &small].concat();
    run(directory.path(), "piston_free", &set, None, "first").expect(0, &[]);
    for (constant, output) in [("constants.k=3", "stiffer"), ("constants.m=2", "heavier")] {
        let changes = [&set[..], &[constant, "time.end=0.8"]].concat();
        run(directory.path(), "piston_free", &changes, Some("first"), output).expect(0, &[]);
        assert!(error(output) < 1e-12, "{constant}: {:e}", error(output));
    }
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

/// The message spoke of "coordinates of the bodies" where flow or structure had another mesh.
#[test]
fn another_mesh_beside_a_structure_is_refused() {
    let directory = TempDir::new().unwrap();
    run(directory.path(), "elastic_piston", &PISTON, None, "first").expect(0, &[]);
    for (solid, gas, told) in
        [(4, 3, "the mesh of the structure there: "), (3, 4, "beside a structure, which cannot be")]
    {
        let cells = format!("mesh.generate.box.cells=[{},1]", solid + gas);
        let segments = format!("mesh.generate.box.segments={{x=[{{end=0,cells={solid}}},{{end=1.2,cells={gas}}}]}}");
        let changes = [&PISTON[..], &[&cells, &segments, "time.end=0.6", "restart.allow=[\"mesh\"]"]].concat();
        run(directory.path(), "elastic_piston", &changes, Some("first"), "then").expect(2, &[told]);
    }
}

/// A piston that is driven, with slabs that adapt.
const DRIVEN: [&str; 5] = [
    "flow.order=3",
    "mesh.generate.box.cells=[4,1]",
    "time={order=2,end=0.4,step=0.05}",
    "time.adaptive={tolerance=1e-3}",
    "bodies.piston.x.motion=\"0.1*t^2\"",
];

/// Whether a run from the result "first" warns of a rate that jumps.
fn warns(directory: &Path, name: &str, changes: &[&str], told: &str) -> bool {
    let output = format!("then_{}", std::fs::read_dir(directory).unwrap().count());
    run(directory, name, changes, Some("first"), &output).expect(0, &[]);
    std::fs::read_to_string(directory.join(output).join("log.jsonl")).unwrap().contains(told)
}

/// Only a jump of the velocity of the mesh was warned of.
#[test]
fn rates_that_jump_are_warned_of() {
    let directory = TempDir::new().unwrap();
    run(directory.path(), "piston_free", &DRIVEN, None, "first").expect(0, &[]);
    for (motion, expected) in [
        // A motion is zero at t = 0.
        ("0.016*min(10*t,1)", true),
        ("(0.016+0.08*(t-0.4))*min(10*t,1)", false),
        ("0.1*t^2+t*(t-0.4)^2", false),
    ] {
        let motion = format!("bodies.piston.x.motion=\"{motion}\"");
        let changes = [&DRIVEN[..], &[&motion, "time.end=0.5"]].concat();
        let found =
            warns(directory.path(), "piston_free", &changes, "the body `piston` changes its rate at once at t = 0.4");
        assert_eq!(found, expected, "{motion}");
    }
    let directory = TempDir::new().unwrap();
    run(directory.path(), "elastic_piston", &PISTON, None, "first").expect(0, &[]);
    for (left, expected) in [("0.02*sin(0.4)*min(10*t,1)", true), ("0.02*sin(t)+0.01*t*(t-0.4)^2", false)] {
        let left = format!("structure.boundary.left={{displacement=[\"{left}\",0]}}");
        let changes = [&PISTON[..], &[&left, "time.end=0.5"]].concat();
        let told = "a support of the structure changes its velocity at once at t = 0.4";
        assert_eq!(warns(directory.path(), "elastic_piston", &changes, told), expected, "{left}");
    }
}

/// A new `rate` was passed over without a word.
#[test]
fn a_rate_that_a_restart_does_not_take_is_warned_of() {
    let directory = TempDir::new().unwrap();
    let free = ["flow.order=3", "mesh.generate.box.cells=[4,1]", "time={order=2,end=0.4,step=0.1}"];
    run(directory.path(), "piston_free", &free, None, "first").expect(0, &[]);
    for (rate, expected) in [("bodies.piston.x.rate=-3", true), ("bodies.piston.x.spring=2", false)] {
        let changes = [&free[..], &[rate, "time.end=0.5"]].concat();
        let found = warns(directory.path(), "piston_free", &changes, "`bodies.piston.x.rate` has no effect");
        assert_eq!(found, expected, "{rate}");
    }
}

/// The piston made its way in the shortest slab, a thousandth of the step: the work of its drive was a million times larger.
#[test]
fn a_jump_that_is_allowed_is_made_in_a_whole_slab() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    run(at, "piston_free", &DRIVEN, None, "first").expect(0, &[]);
    let jump = ["bodies.piston.x.motion=\"0.03*min(10*t,1)\"", "restart.allow=[\"motion\"]", "time.end=0.5"];
    run(at, "piston_free", &[&DRIVEN[..], &jump].concat(), Some("first"), "jumped").expect(0, &[]);
    let rows = column(&at.join("first"), "t").len();
    let times = column(&at.join("jumped"), "t");
    assert!(times[rows] - times[rows - 1] > 0.01, "{:?}", &times[rows - 1..]);
    assert!(times[rows + 1] - times[rows] < times[rows] - times[rows - 1], "the next slab is shortened");
    let work = column(&at.join("jumped"), "piston_drive_work");
    assert!((work[rows] - work[rows - 1]).abs() < 1.0, "{work:?}");
}

/// A cylinder on springs, with the motion of the far boundary alone.
const CYLINDER: &str = "
    mesh = { order = 3, generate.annulus = { inner_radius = 0.5, outer_radius = 10, first_cell = 0.3, cells = [8, 4] } }
    motion.boundary = { far = \"fixed\" }
    time = { order = 2, end = 0.2, step = 0.2 }
    [flow]
    order = 3
    gas = { gamma = 1.4, prandtl = 0.72, mach = 0.2, viscosity.constant = 0.05 }
    initial.uniform = { density = 1, velocity = [1, 0], mach = 0.2 }
    boundary = { wall.adiabatic_wall = {}, far.far_field = { density = 1, velocity = [1, 0], mach = 0.2 } }
    [bodies.b]
    walls = [\"wall\"]
    mass = 2
    x = { spring = 1 }";

/// The wall of a body was taken for one without a motion: \"the velocities of the motion cannot be compared\".
#[test]
fn the_motion_of_bodies_is_compared_without_a_warning() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    on_text(at, CYLINDER, &[], "first", &[]).expect(0, &[]);
    let from = format!("restart.from={}", at.join("first").display());
    let run = on_text(at, CYLINDER, &[&from, "time.end=0.4"], "second", &[]);
    run.expect(0, &[]);
    assert!(!run.stderr.contains("warning"), "{}", run.stderr);
}
