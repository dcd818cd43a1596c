//! `check` estimates the memory of a run.

#![allow(clippy::unwrap_used)]

mod common;

use common::{finished, number, shipped, stsolve};
use tempfile::TempDir;

/// The estimate must be within a fifth of the memory that the process needed: `name`, changed by `set`, which keeps it
/// short.
#[allow(clippy::print_stdout)]
fn assert_estimate(name: &str, set: &[&str]) {
    let directory = TempDir::new().unwrap();
    let case = shipped(&format!("{name}.toml"));
    let mut arguments = vec!["check", "--json", "--probe", "never", &case];
    set.iter().for_each(|change| arguments.extend(["--set", change]));
    let check: serde_json::Value = serde_json::from_str(&stsolve(directory.path(), &arguments).stdout).unwrap();
    let estimate = check["unknowns and memory"]["memory of a run"].as_f64().unwrap();
    let needed = 1e-6 * number(&finished(directory.path(), name, set), "cost.peak_memory_bytes");
    println!("{name} {set:?}: estimated {estimate:.0} MB, needed {needed:.0} MB");
    assert!((estimate / needed - 1.0).abs() < 0.2, "{name}: estimated {estimate} MB, needed {needed} MB");
}

#[test]
fn of_the_vortex() {
    assert_estimate("vortex", &["time.end=2"]);
}

/// Order 8: large blocks.
#[test]
fn of_the_deforming_cylinder() {
    assert_estimate("cylinder_m1", &["time.slabs=8", "time.end=0.1"]);
}

/// Many cells, and a steady start.
#[test]
fn of_the_heaving_airfoil() {
    assert_estimate("naca0012_heave", &["time.end=0.2"]);
}

/// Walls that obstruct the stream, so that the slab is not trivial; with blocks, and with the preconditioner of low order, which takes more
/// iterations than the estimate supposes. The second thread may add 50 MB that the estimate does not count, so the flow is not small.
#[test]
fn in_three_dimensions() {
    let set = ["mesh.generate.box.cells=[6,6,6]", "flow.order=4", "flow.boundary.others=slip_wall", "time.slabs=1"];
    for changes in [["time.end=0.05", "solver.preconditioner=blocks"], ["time.end=0.05", "solver.krylov_restart=16"]] {
        assert_estimate("free_stream_3d", &[&set[..], &changes].concat());
    }
}

/// The mesh has many more nodes than the flow, so the mesh dominates the estimate.
#[test]
fn of_a_mesh_of_high_order() {
    assert_estimate("couette", &["mesh.order=12", "flow.order=3", "mesh.generate.box.cells=[16,16]", "time.end=0.1"]);
}

/// In three dimensions the proof that cells are valid takes more memory than the flow.
#[test]
fn of_a_mesh_of_high_order_in_three_dimensions() {
    let set = ["mesh.generate.box.cells=[4,4,4]", "mesh.order=8", "flow.order=2", "flow.boundary.others=slip_wall"];
    assert_estimate("free_stream_3d", &[&set[..], &["time.slabs=1", "time.end=0.05"]].concat());
}
