//! The unit of length, of a case that does not name a length, has no influence.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{column, number, on_text, stsolve, summary};
use std::path::Path;
use tempfile::TempDir;

/// Runs a case given as text; the result is in the folder `run`.
fn run(directory: &Path, case: &str) {
    on_text(directory, case, &[], "run", &["--force", "--quiet"]).expect(0, &[]);
}

/// A cylinder of the diameter `unit` in a channel at a Reynolds number of 150.
fn cylinder(unit: f64) -> String {
    let [length, height, centre, first] = [22.0, 4.1, 2.0, 0.1].map(|size| size * unit);
    let (viscosity, end) = (unit / 150.0, 0.1 * unit);
    format!(
        "time = {{ order = 2, end = {end}, slabs = 1 }}
         solver.steady = {{ stability_time = 2 }}
         [mesh]
         order = 3
         [mesh.generate.channel_cylinder]
         extent = [{length}, {height}]
         centre = [{centre}, {centre}]
         diameter = {unit}
         first_cell = {first}
         cells = [4, 3, 6]
         [flow]
         order = 2
         gas = {{ viscosity = {{ constant = {viscosity} }} }}
         initial = {{ uniform = {{ velocity = [1, 0], mach = 0.1 }} }}
         [flow.boundary]
         inflow = {{ velocity_inflow = {{ velocity = [\"6*y*({height}-y)/{height}^2\", 0], temperature = \"1/(1.4*0.1^2)\" }} }}
         outflow = {{ outflow = {{ pressure = \"1/(1.4*0.1^2)\" }} }}
         others = {{ adiabatic_wall = {{}} }}"
    )
}

/// The first step and the march in time followed from a length of 1. With a unit of 1000 no steady flow was found, and with one of 100 its
/// stability was tested for 0.08 time units in place of 8.
#[test]
fn a_steady_start_does_not_depend_on_the_unit_of_length() {
    let directory = TempDir::new().unwrap();
    let starts = [1.0, 1000.0].map(|unit| {
        run(directory.path(), &cylinder(unit));
        let steady = summary(&directory.path().join("run"))["steady"].clone();
        println!("{unit}: {steady}");
        (number(&steady, "newton"), number(&steady["stability"], "duration") / unit)
    });
    assert!((starts[0].0 - starts[1].0).abs() <= 2.0, "{starts:?}");
    assert!(starts.iter().all(|(_, duration)| (duration - 2.0).abs() < 1e-9), "{starts:?}");
}

/// A duct whose outflow opens, with a length of 3 and a height of 1.
fn duct(unit: f64) -> String {
    let [length, viscosity, end, step] = [3.0, 0.01, 4.0, 0.05].map(|number| number * unit);
    format!(
        "time = {{ order = 2, end = {end}, step = {step}, adaptive = {{ tolerance = 0.01 }} }}
         mesh = {{ order = 3, generate.box = {{ lower = [0, 0], upper = [{length}, {unit}], cells = [6, 3] }} }}
         [flow]
         order = 3
         gas = {{ viscosity = {{ constant = {viscosity} }} }}
         initial = {{ uniform = {{ density = 1, velocity = [0, 0], pressure = 1 }} }}
         reference = {{ density = 1, speed = 0.4, pressure = 1 }}
         [flow.boundary]
         left = {{ inflow = {{ total_pressure = 1, total_temperature = 1, direction = [1, 0] }} }}
         right = {{ outflow = {{ pressure = \"1 - 0.1*(1 - exp(-t/{unit}))\" }} }}
         others = {{ adiabatic_wall = {{}} }}"
    )
}

/// The jump was an L2 norm in the unit of the case: 12, 7 and 101 slabs.
#[test]
fn adapted_slabs_do_not_depend_on_the_unit_of_length() {
    let directory = TempDir::new().unwrap();
    let times = [1.0, 0.01, 100.0].map(|unit| -> Vec<f64> {
        run(directory.path(), &duct(unit));
        column(&directory.path().join("run"), "t").iter().map(|t| t / unit).collect()
    });
    assert!(times[0].len() > 8, "{times:?}");
    for others in &times[1..] {
        assert_eq!(others.len(), times[0].len(), "{times:?}");
        assert!(others.iter().zip(&times[0]).all(|(a, b)| (a / b - 1.0).abs() < 1e-4), "{times:?}");
    }
}

#[test]
fn a_reference_length_that_is_none_of_the_mesh_is_warned_of() {
    let directory = TempDir::new().unwrap();
    for (unit, is_told) in [(1.0, false), (0.1, false), (0.01, true), (100.0, true)] {
        std::fs::write(directory.path().join("case.toml"), cylinder(unit)).unwrap();
        let outcome = stsolve(directory.path(), &["check", "case.toml", "--probe", "never"]);
        outcome.expect(0, &[]);
        let told = outcome.stdout.contains(&format!("has a length of {unit}"));
        assert_eq!(told, is_told, "{unit}: {}", outcome.stdout);
    }
}
