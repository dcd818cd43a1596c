//! Steady convection in a closed box.

use crate::common::{column, on_case};
use tempfile::TempDir;

/// The benchmark T1 of Le Quere et al. (2005): Nusselt number 8.85978, mean pressure 0.856338 of the initial one.
#[test]
fn a_heated_cavity_has_the_published_heat_flow_and_pressure() {
    let directory = TempDir::new().unwrap();
    on_case(directory.path(), "run", "heated_cavity", &["flow.order=4"], "run", &[]).expect(0, &[]);
    let run = directory.path().join("run");
    let last = |name: &str| *column(&run, name).last().unwrap();
    let (hot, cold, pressure) = (last("left_heat_flow"), last("right_heat_flow"), 0.4 * last("energy") / 500.0);
    println!("{hot} {cold} {pressure}");
    assert!((hot + 8.85978).abs() < 2e-3 && (cold - 8.85978).abs() < 2e-3, "{hot}, {cold}");
    assert!((pressure - 0.856338).abs() < 1e-4, "{pressure}");
    assert!((last("mass") - 1.0).abs() < 1e-10);
}
