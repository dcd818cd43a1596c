//! Viscous gas enters and leaves a passage of blades and a channel.

use crate::common::{column, number, on_case, on_text, summary};
use crate::survives;
use tempfile::TempDir;

/// A passage of a row of blades, coarse, started from a uniform stream: the waves of the start push gas back through the
/// inflow.
const BLADE: &str = r#"
[mesh]
order = 4
[mesh.generate.turbine_blade]
[flow]
order = 3
initial = { uniform = { density = 1, velocity = [0.7912, 0.6115], mach = 0.3 } }
reference = { density = 1, speed = 1, pressure = 7.936507936507937 }
gas = { viscosity = { constant = 0.002 } }
[flow.boundary]
blade = { adiabatic_wall = {} }
inflow = { inflow = { total_pressure = 8.4476, total_temperature = 8.0794, direction = [0.7912, 0.6115] } }
outflow = { outflow = { pressure = 7.2 } }
[time]
order = 2
end = 0.7
step = 0.05
"#;

/// The waves of the start push gas back through the inflow.
#[test]
fn a_blade_starts_from_a_uniform_stream() {
    let summary = survives(BLADE, &[]);
    let through = |name: &str| number(&summary["openings"][name], "mass_flow");
    assert!(number(&summary, "openings.inflow.leaving.largest_share") > 0.5, "{summary}");
    assert!(through("inflow") < 0.0 && through("outflow") > 0.0, "{summary}");
}

/// DFG 2D-1 (Schäfer & Turek 1996) at M = 0.025: the drag, and the given mass flux of 0.2 times the height. A prescribed state would lose
/// 2.5 % of the mass flux.
#[test]
fn the_cylinder_in_a_channel_has_the_drag_of_the_benchmark() {
    let directory = TempDir::new().unwrap();
    on_case(directory.path(), "run", "channel_cylinder", &[], "run", &[]).expect(0, &[]);
    let summary = summary(&directory.path().join("run"));
    let flow = |name: &str| number(&summary["openings"][name], "mass_flow");
    assert!((flow("inflow") / -0.082 - 1.0).abs() < 1e-10, "{summary}");
    assert!((flow("outflow") / 0.082 - 1.0).abs() < 1e-6, "{summary}");
    let history = column(&directory.path().join("run"), "inflow_mass_flow");
    assert_eq!(history.last().copied(), Some(flow("inflow")));
    let drag = number(&summary, "steady.walls.cylinder.drag_coefficient");
    assert!((drag - 5.577).abs() < 0.003, "{drag}");
}

/// Plane channel flow at Re = 2, on a mesh that resolves mu / (rho w). Walls at rest do no work, so it leaves as it has entered. With derivatives
/// along the normal from inside, the total temperature at an outflow was 1.034, and that of gas that is sucked out 0.79.
#[test]
fn viscous_gas_leaves_with_the_total_temperature_with_which_it_enters() {
    let profile = "[\"0.6*y*(1-y)\", 0]";
    let case = |left: &str, right: &str| {
        format!(
            "mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [1, 1], cells = [4, 4] }} }}
             time = {{ order = 2, end = 0.1, step = 0.1 }}
             solver.steady = {{}}
             [flow]
             order = 5
             gas.viscosity.constant = 0.05
             initial.expression = {{ density = 1, velocity = {profile}, pressure = \"1 + 0.06*(1 - x)\" }}
             reference = {{ density = 1, speed = 0.1, pressure = 1 }}
             boundary = {{ left = {left}, right = {right}, others.adiabatic_wall = {{}} }}"
        )
    };
    let pushed = format!("{{ velocity_inflow = {{ velocity = {profile}, temperature = 1 }} }}");
    let reservoir = "{ inflow = { total_pressure = 1.06, total_temperature = 1, direction = [1, 0] } }";
    let outflow = "{ outflow = { pressure = 1 } }";
    let directory = TempDir::new().unwrap();
    let total_temperature = |left: &str, right: &str| {
        on_text(directory.path(), &case(left, right), &[], "run", &["--quiet", "--force"]).expect(0, &[]);
        *column(&directory.path().join("run"), "right_total_temperature").last().unwrap()
    };
    // The mean over the mass flux of T + w^2 / 7 is 1.0022 where the profile enters.
    let (leaves, is_sucked) = (total_temperature(&pushed, outflow), total_temperature(reservoir, &pushed));
    println!("total temperature {leaves} at an outflow, {is_sucked} sucked out");
    assert!((leaves - 1.0022).abs() < 1e-3 && (is_sucked - 1.0).abs() < 1e-3, "{leaves} {is_sucked}");
}
