//! Shocks, with the artificial viscosity of `flow.shock_capturing`.

#![allow(clippy::unwrap_used)]

mod common;

use common::{assert_conserves, column, finished, number, on_case};
use std::path::Path;
use tempfile::TempDir;

/// Values of a column of line_axis.csv at the last time, with x in a range.
fn on_axis(run: &Path, name: &str, [from, to]: [f64; 2]) -> Vec<f64> {
    let text = std::fs::read_to_string(run.join("line_axis.csv")).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let place = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(|v| v.parse().unwrap()).collect()).collect();
    let (t, x, value) = (place("t"), place("x"), place(name));
    let last = rows.last().unwrap()[t];
    let inside = |row: &&Vec<f64>| row[t] == last && (from..=to).contains(&row[x]);
    rows.iter().filter(inside).map(|row| row[value]).collect()
}

/// The exact solution of the Riemann problem has p* = 0.3031301781, u* = 0.9274526200, and the densities 0.4263194281 and 0.2655737117 on the sides
/// of the contact. The coarse mesh has half of the cells of the case.
#[test]
fn sods_shock_tube_has_its_star_values_on_a_mesh_that_is_stirred() {
    let directory = TempDir::new().unwrap();
    let summary = finished(directory.path(), "sod", &["mesh.generate.box.cells=[50,2]", "time.slabs=50"]);
    let run = directory.path().join("sod");
    for (density, range) in [(0.426_319_428_1, [0.54, 0.64]), (0.265_573_711_7, [0.74, 0.8])] {
        for (name, exact) in [("density", density), ("velocity_x", 0.927_452_62), ("pressure", 0.303_130_178_1)] {
            let values = on_axis(&run, name, range);
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            assert!((mean / exact - 1.0).abs() < TOLERANCE, "{name} in {range:?}: {mean} for {exact}");
        }
    }
    assert_conserves(&summary);
    assert_eq!((number(&summary, "rejected_slabs"), &summary["split_form_since"]), (0.0, &serde_json::Value::Null));
    // The tube holds 0.5 (1 + 0.125), and is 0.04 high: the jump of the initial state lies between two cells.
    let mass = column(&run, "mass");
    assert!(mass.iter().all(|mass| (mass / 0.0225 - 1.0).abs() < 1e-11), "{mass:?}");
    let entropy = column(&run, "entropy");
    assert!(entropy.windows(2).all(|pair| pair[1] > pair[0] - 1e-12), "{entropy:?}");
}

const TOLERANCE: f64 = 3e-3;

/// Toro's third test, with pressures of 1000 and 0.01: p* = 460.894 and u* = 19.5975.
#[test]
fn order_2_stands_pressures_that_are_1e5_apart() {
    let directory = TempDir::new().unwrap();
    let changes = [
        "flow.order=2",
        "flow.initial.expression.pressure=\"if(x < 0.5, 1000, 0.01)\"",
        "flow.initial.expression.density=1",
        "flow.reference={density=1, speed=20, pressure=1000}",
        "motion.displacement=[0, 0]",
        "mesh.generate.box={lower=[0, 0], upper=[1, 0.01], cells=[60, 1]}",
        "time={order=2, end=0.012, slabs=200}",
        "output.lines={}",
        "output.probes.star={at=[0.603, 0.005], fields=[\"velocity\", \"pressure\"]}",
    ];
    finished(directory.path(), "sod", &changes);
    let last = |name: &str| *column(&directory.path().join("sod"), name).last().unwrap();
    for (name, exact) in [("star_velocity_x", 19.5975), ("star_pressure", 460.894)] {
        assert!((last(name) / exact - 1.0).abs() < 0.015, "{name}: {} for {exact}", last(name));
    }
}

/// The flow begins uniform, so many fills are equal up to rounding. An order of elimination from a Jacobian in single precision takes 25 Krylov
/// iterations per Newton step instead of 15.
#[test]
fn the_order_of_elimination_does_not_follow_the_rounding_of_single_precision() {
    let directory = TempDir::new().unwrap();
    let summary = finished(directory.path(), "sod", &["time.end=0.02", "time.slabs=10"]);
    let iterations = number(&summary, "krylov.mean_per_newton");
    assert!(iterations < 18.0, "{iterations} Krylov iterations per Newton step");
}

/// Smooth flow is not compressed enough: not a bit changes.
#[test]
fn smooth_flow_does_not_feel_shock_capturing() {
    let directory = TempDir::new().unwrap();
    let small = ["mesh.generate.box.cells=[8,6]", "time.end=0.4", "time.slabs=4"];
    let error = |capturing: &[&str]| {
        number(&finished(directory.path(), "vortex_sinusoidal", &[&small[..], capturing].concat()), "error.density_l2")
    };
    let (without, with) = (error(&[]), error(&["flow.shock_capturing.strength=2"]));
    assert!((with / without - 1.0).abs() < 1e-10, "{with:e} for {without:e}");
}

#[test]
fn numbers_of_shock_capturing_are_positive() {
    let directory = TempDir::new().unwrap();
    let refused = on_case(directory.path(), "run", "vortex", &["flow.shock_capturing.threshold=0"], "run", &[]);
    refused.expect(2, &["flow.shock_capturing.threshold"]);
}
