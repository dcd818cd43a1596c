//! Round-off: Newton's method stops at it, and balances hold to it at any tolerance.

#![allow(clippy::unwrap_used)]

mod common;

use common::{finished, number, stsolve, summary};
use serde_json::Value;
use tempfile::TempDir;

/// Runs the case `text` to its end in `directory`; returns its summary.
fn run(directory: &TempDir, name: &str, text: &str) -> Value {
    std::fs::write(directory.path().join(format!("{name}.toml")), text).unwrap();
    stsolve(directory.path(), &["run", &format!("{name}.toml"), "--output", name, "--quiet"]).expect(0, &[]);
    summary(&directory.path().join(name))
}

/// A uniform flow through a box of 4 x 4 cells and the given height, with a far field that matches it.
fn uniform(mach: f64, height: f64, slab: f64, gas: &str) -> String {
    format!(
        "[mesh]\norder = 3\n[mesh.generate.box]\nlower = [0, 0]\nupper = [1, {height:e}]\ncells = [4, 4]\n\
         [flow]\norder = 4\ngas = {{ gamma = 1.4, prandtl = 0.72, mach = {mach:e}{gas} }}\n\
         initial = {{ uniform = {{ density = 1, velocity = [1, 0], mach = {mach:e} }} }}\n\
         [flow.boundary]\nothers = {{ far_field = {{ density = 1, velocity = [1, 0], mach = {mach:e} }} }}\n\
         [time]\norder = 2\nend = {end:e}\nslabs = 3\n",
        end = 3.0 * slab
    )
}

const VISCOUS: &str = ", viscosity = { constant = 0.01 }";

/// These flows have a residual above 1e-13 in units of the reference state, which is pure round-off. With this number as the tolerance,
/// slabs would be halved until the run fails.
#[test]
fn a_uniform_flow_takes_at_most_one_newton_step_a_slab_at_low_mach_number_on_thin_cells_in_long_slabs() {
    let directory = TempDir::new().unwrap();
    for (name, mach, height, slab, gas) in [
        ("slow", 1e-3, 1.0, 0.1, VISCOUS),
        ("slow_inviscid", 1e-3, 1.0, 0.1, ""),
        ("thin", 0.2, 1e-5, 0.1, VISCOUS),
        ("long", 0.2, 1.0, 1e4, VISCOUS),
        ("all", 1e-3, 1e-5, 1e4, VISCOUS),
        ("all_inviscid", 1e-3, 1e-5, 1e4, ""),
    ] {
        let summary = run(&directory, name, &uniform(mach, height, slab, gas));
        assert_eq!(number(&summary, "rejected_slabs"), 0.0, "{name}: {summary}");
        assert!(number(&summary, "newton.max") <= 1.0, "{name}: {summary}");
    }
}

/// The rounding of the residual grows with the length of a slab. With the tolerance 1e-13 a slab of a steady flow at Mach 0.1 would be cut
/// into sixteen parts.
#[test]
fn a_cylinder_at_mach_0_1_goes_on_from_its_steady_flow_without_a_rejection() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.order=3", "flow.order=3", "time.order=2", "time.end=2000", "time.slabs=2"];
    let summary = finished(directory.path(), "cylinder_steady", &set);
    assert_eq!((number(&summary, "slabs"), number(&summary, "rejected_slabs")), (2.0, 0.0), "{summary}");
    let drag = |path: &str| number(&summary, path);
    let steady = drag("steady.walls.wall.drag_coefficient");
    assert!((drag("walls.wall.drag_coefficient") - steady).abs() < 1e-6 * steady, "{summary}");
}

/// A vortex of strength 1e-8 is, relative to its strength, as accurate as one of strength 1e-2. A solve that mistook its residual for
/// round-off would not move it.
#[test]
fn a_faint_vortex_is_not_taken_for_rounding() {
    let directory = TempDir::new().unwrap();
    let relative_error = |strength: f64| {
        let strength_of = format!("flow.exact.vortex.strength={strength:e}");
        let summary =
            finished(directory.path(), "vortex", &["mesh.generate.box.cells=[4,4]", "time.end=1", &strength_of]);
        number(&summary, "error.momentum_l2") / strength
    };
    let (strong, faint) = (relative_error(1e-2), relative_error(1e-8));
    assert!((faint / strong - 1.0).abs() < 0.01, "{faint:e} against {strong:e}");
}

/// Without the correction of the balances, mass and energy would have errors of 1e-9 to 1e-13 at the tolerances of the shipped cases, 1e-4
/// to 1e-8.
#[test]
fn balances_hold_to_round_off_at_any_tolerance() {
    let directory = TempDir::new().unwrap();
    for (name, set) in [
        ("cylinder_street", &["mesh.order=3", "flow.order=3", "time.end=2"][..]),
        ("vortex_period", &["flow.order=5", "time.end=1"]),
        ("couette", &[]),
        ("cylinder_m1", &["mesh.order=4", "flow.order=4", "time.slabs=5", "solver.newton_tolerance=1e-3"]),
        ("vortex", &["mesh.generate.box.cells=[4,4]", "time.end=0.5", "solver.newton_tolerance=1e-3"]),
    ] {
        let summary = finished(directory.path(), name, set);
        for sum in ["conservation.mass_error", "conservation.energy_error"] {
            assert!(number(&summary, sum) <= 2e-14, "{name} {sum}: {summary}");
        }
    }
}

/// Gas in a closed box and in a channel that is periodic along x, with isothermal walls, at 1, 2 and 4 nodes in time.
#[test]
fn a_closed_box_and_a_periodic_channel_keep_their_mass() {
    let directory = TempDir::new().unwrap();
    for (name, periodic) in [("box", ""), ("channel", "periodic = [\"x\"]\n")] {
        for time_order in [1, 2, 4] {
            let text = format!(
                "[mesh]\norder = 2\n[mesh.generate.box]\nlower = [0, 0]\nupper = [1, 1]\ncells = [3, 3]\n{periodic}\
                 [flow]\norder = 4\ngas = {{ gamma = 1.4, prandtl = 0.72, mach = 0.2, viscosity = {{ constant = 0.02 }} }}\n\
                 reference = {{ density = 1, speed = 1, pressure = 17.857142857142858 }}\n\
                 [flow.initial.expression]\ndensity = 1\nvelocity = [\"sin(pi*y)*sin(pi*y)\", 0]\npressure = \"(1 + 0.02*cos(pi*y))/(1.4*0.04)\"\n\
                 [flow.boundary]\nothers = {{ isothermal_wall = {{ temperature = 1 }} }}\n\
                 [time]\norder = {time_order}\nend = 1\nslabs = 5\n[solver]\nnewton_tolerance = 1e-2\n"
            );
            let summary = run(&directory, &format!("{name}_{time_order}"), &text);
            for sum in ["conservation.mass_error", "conservation.energy_error"] {
                assert!(number(&summary, sum) <= 1e-14, "{name} {time_order} {sum}: {summary}");
            }
        }
    }
}
