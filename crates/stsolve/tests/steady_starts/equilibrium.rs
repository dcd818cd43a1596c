//! Bodies and structures start in equilibrium with the steady flow.

use crate::common::{column, number, on_case, summary};
use crate::run;
use tempfile::TempDir;

/// A piston on a spring closes a tube of gas, whose other end has a pressure that varies in time: k x = p(t) at the start.
#[test]
fn a_body_starts_in_equilibrium_with_the_flow() {
    let case = |start: f64, bodies: &str, mass: f64| {
        format!(
            "mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [1.5, 1], cells = [6, 1], periodic = [\"y\"] }} }}
             time = {{ order = 2, start = {start}, end = {start}, step = 0.1 }}
             solver.steady = {{ bodies = \"{bodies}\" }}
             bodies.piston = {{ walls = [\"right\"], mass = {mass}, x = {{ spring = 50 }}, mesh = {{ weight = \"x/1.5\" }} }}
             [flow]
             order = 3
             gas = {{ viscosity = {{ constant = 0.1 }} }}
             initial = {{ uniform = {{ velocity = [0, 0], pressure = 0.7 }} }}
             reference = {{ density = 1, speed = 1, pressure = 0.7, length = 1.5 }}
             boundary.left.inflow = {{ total_pressure = \"0.7*(1 + 0.3*sin(t))\", total_temperature = 0.7, direction = [1, 0] }}
             boundary.right = \"slip_wall\""
        )
    };
    let directory = TempDir::new().unwrap();
    // A heavy piston hardly moves in the first slabs of the search.
    for (name, start, bodies, mass) in [
        ("zero", 0.0, "equilibrium", 1.0),
        ("later", 1.25, "equilibrium", 1.0),
        ("heavy", 0.0, "equilibrium", 1e6),
        ("held", 1.25, "held", 1.0),
    ] {
        run(directory.path(), name, &case(start, bodies, mass)).expect(0, &[]);
        let [x, rate] = ["piston_x", "piston_x_rate"].map(|name_of| column(&directory.path().join(name), name_of)[0]);
        let expected = if bodies == "held" { 0.0 } else { 0.7 * (1.0 + 0.3 * start.sin()) / 50.0 };
        println!("{bodies} at {start}: x {x} for {expected}, rate {rate}");
        assert!((x - expected).abs() < 1e-8 && rate == 0.0, "{name}: {x} for {expected}, {rate}");
    }
}

/// A bar of length 2 and modulus 10, held at its far end, is pressed by 0.01 more than its outer load: u = -0.01 L / E.
#[test]
fn a_structure_starts_in_equilibrium_with_the_flow() {
    let case = "mesh = { order = 3, generate.box = { lower = [-2, 0], upper = [1, 0.5], cells = [6, 1], regions = { bar = { lower = [-2, 0], upper = [0, 0.5] } } } }
         time = { order = 2, end = 1, step = 0.1 }
         solver = { newton_tolerance = 1e-10, steady = { bodies = \"equilibrium\" } }
         motion.boundary = { bottom = \"slide\", top = \"slide\", others = \"fixed\" }
         [flow]
         order = 3
         gas = { viscosity = { constant = 0.1 } }
         initial = { uniform = { velocity = [0, 0], pressure = 0.7 } }
         reference = { density = 1, speed = 1, pressure = 0.7, length = 1 }
         boundary = { right = { outflow = { pressure = 0.71 } }, others = \"slip_wall\" }
         [structure]
         regions = [\"bar\"]
         density = 10
         young_modulus = 10
         poisson_ratio = 0
         points = { wall = [0, 0.25] }
         boundary = { left = \"fixed\", bottom = { held = [\"y\"] }, top = { held = [\"y\"] }, rest = { pressure = -0.7 } }";
    let directory = TempDir::new().unwrap();
    run(directory.path(), "bar", case).expect(0, &[]);
    let positions = column(&directory.path().join("bar"), "wall_x");
    println!("{positions:?}");
    // It starts there, and stays there.
    assert!(positions.len() == 11 && positions.iter().all(|x| (x + 0.01 * 2.0 / 10.0).abs() < 1e-8), "{positions:?}");

    // From there, a softer bar has another equilibrium; the old one was taken, and the mass was that of the mesh at rest.
    let softer =
        case.replace("young_modulus = 10", "young_modulus = 5").replace("time =", "restart.from = \"start\"\ntime =");
    run(directory.path(), "start", &case.replace("end = 1,", "end = 0,")).expect(0, &[]);
    run(directory.path(), "softer", &softer).expect(0, &[]);
    let positions = column(&directory.path().join("softer"), "wall_x");
    assert!(positions.len() == 11 && positions.iter().all(|x| (x + 0.01 * 2.0 / 5.0).abs() < 1e-8), "{positions:?}");
    let error = number(&summary(&directory.path().join("softer")), "conservation.mass_error");
    assert!(error < 1e-9, "{error:e}");
}

/// The lift of a symmetric airfoil is rounding: the search must not wait until that falls, too.
#[test]
fn a_symmetric_airfoil_is_in_equilibrium_at_once() {
    let directory = TempDir::new().unwrap();
    let set = ["solver.steady={bodies=\"equilibrium\"}", "time.end=0", "flow.order=3"];
    on_case(directory.path(), "run", "flutter_airfoil", &set, "airfoil", &[]).expect(0, &[]);
    for name in ["airfoil_y", "airfoil_rotation"] {
        let place = column(&directory.path().join("airfoil"), name)[0];
        println!("{name} {place:.1e}");
        assert!(place.abs() < 1e-9, "{name} {place:.1e}");
    }
}

/// A plate between two gases, much stiffer under their pressure than without. Slabs longer than its period made it swing, and the search gave up.
#[test]
fn a_plate_under_a_large_pressure_finds_its_equilibrium() {
    let plate = "law = \"neo_hookean\"
         young_modulus = 200
         poisson_ratio = 0.3
         points = { middle = [1.05, 0.5] }";
    let alone = format!(
        "mesh = {{ order = 3, generate.box = {{ lower = [1, 0], upper = [1.1, 1], cells = [1, 4] }} }}
         time = {{ order = 1, end = 1, slabs = 2 }}
         [structure]
         {plate}
         analysis = \"static\"
         boundary = {{ bottom = \"fixed\", top = \"fixed\", left = {{ follower_pressure = 7.14 }}, right = {{ follower_pressure = 7.854 }} }}"
    );
    let between = format!(
        "time = {{ order = 2, end = 0.01, slabs = 1 }}
         solver = {{ newton_tolerance = 1e-9, steady.bodies = \"equilibrium\" }}
         motion.boundary.others = \"fixed\"
         [mesh]
         order = 3
         [mesh.generate.box]
         lower = [0, 0]
         upper = [2.1, 1]
         cells = [5, 4]
         segments = {{ x = [{{ end = 1, cells = 2 }}, {{ end = 1.1, cells = 1 }}, {{ end = 2.1, cells = 2 }}] }}
         regions = {{ plate = {{ lower = [1, 0], upper = [1.1, 1] }}, dense = {{ lower = [1.1, 0], upper = [2.1, 1] }} }}
         [flow]
         order = 3
         gas = {{ viscosity = {{ constant = 0.05 }}, gas_constant = 7.14 }}
         initial.expression = {{ density = \"if(x > 1.05, 1.1, 1)\", velocity = [0, 0], pressure = \"if(x > 1.05, 7.854, 7.14)\" }}
         reference = {{ density = 1, speed = 1, pressure = 7.14, length = 1 }}
         boundary.left.outflow = {{ pressure = 7.14 }}
         boundary.right.outflow = {{ pressure = 7.854 }}
         boundary.others.adiabatic_wall = {{}}
         [structure]
         {plate}
         regions = [\"plate\"]
         density = 10
         boundary = {{ bottom = \"fixed\", top = \"fixed\" }}"
    );
    let directory = TempDir::new().unwrap();
    let [alone, between] = [("alone", alone), ("between", between)].map(|(name, case)| {
        run(directory.path(), name, &case).expect(0, &[]);
        *column(&directory.path().join(name), "middle_x").last().unwrap()
    });
    assert!((between - alone).abs() < 1e-8 && (alone + 0.0603).abs() < 1e-4, "{between} between gases, {alone} alone");
}
