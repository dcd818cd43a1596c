//! A steady start keeps what no boundary can change: mass, energy, momentum.

use crate::common::{column, number, stsolve, summary};
use crate::run;
use tempfile::TempDir;

/// Gas between a wall at T = 1 and one at T = 2. Conduction makes T = 1 + x, and p is uniform. With the mass 1 in a box of size 1, p = 1 / ln 2.
#[test]
fn a_steady_start_in_a_closed_domain_keeps_the_mass() {
    const CASE: &str = r#"
[mesh]
order = 2
generate.box = { lower = [0, 0], upper = [1, 1], cells = [4, 1], periodic = ["y"] }
[flow]
order = 5
gas = { gamma = 1.4, prandtl = 0.72, gas_constant = 1, viscosity = { constant = 0.1 } }
initial.uniform = { density = 1, velocity = [0, 0], pressure = 1 }
reference = { density = 1, speed = 1, pressure = 1, length = 1 }
[flow.boundary]
left.isothermal_wall.temperature = 1
right.isothermal_wall.temperature = 2
[output.probes]
middle = { at = [0.5, 0.5] }
[time]
order = 1
end = 0.1
slabs = 1
[solver.steady]
"#;
    let directory = TempDir::new().unwrap();
    for first_step in ["0.1", "100"] {
        run(directory.path(), first_step, &format!("{CASE}first_step = {first_step}\n")).expect(0, &[]);
        let last = |name: &str| *column(&directory.path().join(first_step), name).last().unwrap();
        let (mass, pressure) = (last("mass"), last("middle_pressure"));
        assert!((mass - 1.0).abs() < 1e-10, "{mass}");
        assert!((pressure - 1.0 / std::f64::consts::LN_2).abs() < 1e-6, "{pressure}");
    }
}

/// Between walls the mass is corrected, and the flow is solved once more. Where that took no step, the residual was told to be that of the start.
#[test]
fn a_steady_flow_between_walls_tells_its_residual() {
    let directory = TempDir::new().unwrap();
    let case = r#"
        mesh = { order = 3, generate.box = { lower = [0, 0], upper = [2, 1], cells = [2, 2], periodic = ["x"] } }
        time = { order = 2, end = 0.1, slabs = 1 }
        solver.steady = {}
        [flow]
        order = 4
        gas = { gamma = 1.4, prandtl = 0.72, viscosity = { constant = 0.02 } }
        initial.uniform = { density = 1, velocity = [0.2, 0], pressure = 0.8 }
        boundary.bottom.isothermal_wall = { temperature = 0.8 }
        boundary.top.isothermal_wall = { temperature = 0.85, slide = [0.5, 0] }
    "#;
    run(directory.path(), "couette", case).expect(0, &[]);
    let residual = number(&summary(&directory.path().join("couette")), "steady.residual");
    assert!(residual < 1e-8, "{residual:e}");
}

/// Friction heats the gas for ever, which was told as an unsteady flow.
#[test]
fn a_steady_start_warns_where_no_wall_takes_the_heat() {
    let directory = TempDir::new().unwrap();
    let case = |walls: &str| {
        format!(
            "mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [1, 1], cells = [1, 2], periodic = [\"x\"] }} }}
             time = {{ order = 1, end = 1, step = 1 }}
             solver.steady = {{}}
             [flow]
             order = 3
             gas = {{ gamma = 1.4, gas_constant = 1, viscosity = {{ constant = 0.1 }} }}
             reference = {{ density = 1, speed = 1, pressure = 1, length = 1 }}
             initial.uniform = {{ density = 1, velocity = [0, 0], pressure = 1 }}
             source.acceleration = [0.01, 0]
             boundary.others = {walls}"
        )
    };
    let check = |walls: &str| {
        std::fs::write(directory.path().join("case.toml"), case(walls)).unwrap();
        stsolve(directory.path(), &["check", "case.toml", "--probe", "never"])
    };
    let warns = |walls: &str| check(walls).stdout.contains("friction heats moving gas for ever");
    assert!(warns("{ adiabatic_wall = {} }") && !warns("{ isothermal_wall = { temperature = 1 } }"));
}

/// What no boundary can change stays: the energy between adiabatic walls, the momentum without boundaries, and the mass also where a source
/// adds momentum alone.
#[test]
fn a_steady_start_keeps_what_nothing_can_change() {
    let case = |periodic: &str, boundary: &str, velocity: &str, source: &str| {
        format!(
            "mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [1, 1], cells = [3, 3], periodic = {periodic} }} }}
             time = {{ order = 1, end = 0, step = 1 }}
             solver.steady = {{ tolerance = 1e-11 }}
             output = {{ fields = [], integrals = [\"momentum_x\"] }}
             [flow]
             order = 4
             gas = {{ gamma = 1.4, gas_constant = 1, viscosity = {{ constant = 0.1 }} }}
             reference = {{ density = 1, speed = 1, pressure = 1, length = 1 }}
             {source}
             [flow.initial.expression]
             density = \"1 + 0.1*sin(2*pi*x)\"
             velocity = [{velocity}, 0]
             pressure = \"1 + 0.2*sin(2*pi*y)\"
             {boundary}"
        )
    };
    let directory = TempDir::new().unwrap();
    let totals = |name: &str, case: &str| {
        run(directory.path(), name, case).expect(0, &[]);
        ["mass", "energy", "momentum_x"].map(|column| self::column(&directory.path().join(name), column)[0])
    };
    let walls = "[flow.boundary]\nothers.adiabatic_wall = {}";
    let [mass, energy, _] = totals("adiabatic", &case("[]", walls, "0", ""));
    assert!((mass - 1.0).abs() < 1e-9 && (energy - 2.5).abs() < 1e-9, "{mass} {energy}");
    let stream = "\"0.3 + 0.1*sin(2*pi*y)\"";
    let [mass, energy, momentum] = totals("periodic", &case("[\"x\", \"y\"]", "", stream, ""));
    // int rho u^2 / 2, with int sin^2 = 1/2
    let kinetic = 0.5 * (0.09 + 0.005);
    assert!((mass - 1.0).abs() < 1e-9 && (momentum - 0.3).abs() < 1e-9, "{mass} {momentum}");
    assert!((energy - 2.5 - kinetic).abs() < 1e-5, "{energy}");
    // Frictionless walls along x exert no force along x. The momentum that was found depended on the first step.
    let [_, _, momentum] = totals("between", &case("[\"x\"]", "[flow.boundary]\nothers = \"symmetry\"", stream, ""));
    assert!((momentum - 0.3).abs() < 1e-9, "{momentum}");
    let walls = "[flow.boundary]\nothers.isothermal_wall.temperature = 1";
    let source = "source.given = { density = 0, momentum = [\"0.1*sin(2*pi*y)\", 0], energy = 0 }";
    let [mass, ..] = totals("stirred", &case("[]", walls, "0", source));
    assert!((mass - 1.0).abs() < 1e-9, "{mass}");
}
