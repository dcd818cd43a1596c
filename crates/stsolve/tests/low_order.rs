//! The preconditioner of low order beside blocks: iterations, and where it is the default.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{assert_same_bits, on_case, on_text, summary};
use std::path::Path;
use tempfile::TempDir;

/// A stream in space that walls obstruct, on a mesh that moves.
const OBSTRUCTED: [&str; 5] = [
    "mesh.generate.box.cells=[4,4,4]",
    "flow.order=4",
    "flow.boundary.others=slip_wall",
    "time.slabs=2",
    "time.end=0.1",
];

/// Krylov iterations of a run with `preconditioner`, or with the default.
fn iterations(at: &Path, name: &str, set: &[&str], preconditioner: Option<&str>) -> u64 {
    let chosen = preconditioner.map(|name| format!("solver.preconditioner={name}"));
    let set: Vec<&str> = set.iter().copied().chain(chosen.as_deref()).collect();
    let output = preconditioner.unwrap_or("default");
    on_case(at, "run", name, &set, output, &["--force"]).expect(0, &[]);
    summary(&at.join(output))["krylov"]["total"].as_u64().unwrap()
}

#[test]
fn it_is_the_default_in_three_dimensions() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let [blocks, low_order] =
        ["blocks", "low_order"].map(|name| iterations(at, "free_stream_3d", &OBSTRUCTED, Some(name)));
    // 171 and 44. On a viscous wing the ratio is 1.5 (docs/src/speed.md).
    assert!(low_order <= 4 * blocks, "{low_order} iterations, {blocks} with blocks");
    iterations(at, "free_stream_3d", &OBSTRUCTED, None);
    assert_same_bits(&at.join("default"), &at.join("low_order"), "the default");
}

/// Blocks stay the default in the plane.
#[test]
fn in_two_dimensions_it_takes_three_times_as_many_iterations() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let set = ["mesh.generate.box.cells=[6,6]", "time.end=2", "time.step=0.4"];
    let [blocks, low_order] = ["blocks", "low_order"].map(|name| iterations(at, "vortex", &set, Some(name)));
    // 147 and 48.
    assert!(2 * low_order <= 7 * blocks, "{low_order} iterations, {blocks} with blocks");
    iterations(at, "vortex", &set, None);
    assert_same_bits(&at.join("default"), &at.join("blocks"), "the default");
}

/// Both preconditioners lost the soft modes of cells that are much thinner than wide and free at both ends of the short axis: thousands of
/// iterations, and slabs that were rejected.
#[test]
fn a_thin_span_takes_few_iterations() {
    let directory = TempDir::new().unwrap();
    let layer = |(layers, order): (usize, usize), depth: f64, periodic: &str, symmetric: &str, preconditioner: &str| {
        format!(
            "mesh = {{ order = 2, generate.box = {{ lower = [0, 0, 0], upper = [1, 1, {depth}], cells = [2, 3, {layers}], periodic = [{periodic}] }} }}
             time = {{ order = 2, end = 0.1, step = 0.1 }}
             {preconditioner}
             [flow]
             order = {order}
             gas = {{ viscosity = {{ constant = 0.05 }} }}
             exact.couette = {{ height = 1, speed = 0.5, lower_temperature = 1, upper_temperature = 1.1, pressure = 1 }}
             initial.uniform = {{ density = 0.95, velocity = [0.25, 0, 0], pressure = 1 }}
             boundary.bottom.isothermal_wall = {{ temperature = 1 }}
             boundary.top.isothermal_wall = {{ temperature = 1.1, slide = [0.5, 0, 0] }}
             {symmetric}"
        )
    };
    let symmetric = "boundary.others = \"symmetry\"";
    let [blocks, low_order] = ["blocks", "low_order"].map(|name| format!("solver.preconditioner = \"{name}\""));
    for (name, case, most) in [
        ("periodic", layer((1, 3), 0.01, "\"x\", \"z\"", "", &blocks), 10),
        ("symmetric", layer((2, 4), 0.01, "\"x\"", symmetric, &blocks), 20),
        ("thinner", layer((1, 3), 1e-4, "\"x\"", symmetric, &blocks), 20),
        ("by choice", layer((1, 4), 1e-3, "\"x\"", symmetric, ""), 20),
        ("low order", layer((2, 3), 0.01, "\"x\"", symmetric, &low_order), 100),
        ("low order, periodic", layer((1, 3), 0.01, "\"x\", \"z\"", "", &low_order), 100),
    ] {
        on_text(directory.path(), &case, &[], name, &[]).expect(0, &[]);
        let summary = summary(&directory.path().join(name));
        let [krylov, newton] = ["krylov", "newton"].map(|of| summary[of]["total"].as_u64().unwrap());
        println!("{name}: {krylov} iterations in {newton} steps");
        assert!(krylov <= most * newton, "{name}: {krylov} iterations in {newton} steps");
    }
    // Blocks in several terms are those of a run that was not interrupted.
    for (name, preconditioner) in [("blocks", &blocks), ("nodes", &low_order)] {
        let case = layer((1, 3), 0.01, "\"x\"", symmetric, preconditioner);
        let [through, split] = ["through", "split"].map(|part| format!("{name} {part}"));
        on_text(directory.path(), &case, &["time.end=0.2"], &through, &[]).expect(0, &[]);
        on_text(directory.path(), &case, &[], &split, &[]).expect(0, &[]);
        on_text(directory.path(), &case, &["time.end=0.2"], &split, &["--resume"]).expect(0, &[]);
        assert_same_bits(&directory.path().join(&through), &directory.path().join(&split), name);
    }
}
