//! Structures that the flow moves: exact solutions, energy, resuming, output, bad input.
#![allow(clippy::unwrap_used)]

mod common;

use common::{assert_same_bits, column, finished, number, on_case, on_text, stsolve};
use output::ResultReader;
use tempfile::TempDir;

/// V of z (2 f' - V) = p0 ((1 + 0.2 V)^7 - 1) with z = 10 and f' = 0.05.
const PISTON: f64 = 0.09044915185;

/// The flag of Turek and Hron in few cells and slabs.
const FLAG: [&str; 5] = [
    "mesh.order=3",
    "flow.order=3",
    "mesh.generate.channel_flag.cells={around=3,outwards=3,beside=3,along=3,across=1,after=3}",
    "time.step=0.02",
    "output.every=1",
];

#[test]
fn the_elastic_piston_has_its_exact_velocity() {
    let directory = TempDir::new().unwrap();
    let summary = finished(directory.path(), "elastic_piston", &[]);
    let velocity = summary["bodies"]["structure"]["velocity"][0].as_f64().unwrap();
    assert!((velocity - PISTON).abs() < 1e-6, "{velocity}");
    assert!(number(&summary, "conservation.coupled_energy_error") < 1e-11, "{summary}");
    assert!(number(&summary, "conservation.mass_error") < 1e-12);
    let run = directory.path().join("elastic_piston");
    assert_eq!(column(&run, "wall_x_rate").last(), Some(&velocity));
    let energies = ["structure_kinetic_energy", "structure_strain_energy", "structure_flow_work"];
    assert!(energies.iter().all(|name| column(&run, name).last().unwrap().abs() > 1e-7));
}

/// A wave runs in the bar while the gas still rests. Adapted slabs follow it.
#[test]
fn adapted_slabs_see_a_structure() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.order=4", "flow.order=4", "time={order=2,end=1,step=0.01,adaptive={tolerance=3e-4}}"];
    let summary = finished(directory.path(), "elastic_piston", &set);
    let velocity = summary["bodies"]["structure"]["velocity"][0].as_f64().unwrap();
    assert!((velocity / PISTON - 1.0).abs() < 0.05, "{velocity}");
}

/// Newton's method, the energy and the bits of a flag that bends far: one thread or two, stopped and resumed.
#[test]
fn a_flag_keeps_its_energy_and_its_bits() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let go = |end: &str, output: &str, extra: &[&str]| {
        let soft = ["structure.young_modulus=1e6", "solver.newton_tolerance=1e-10", end];
        on_case(at, "run", "turek_hron_fsi3", &[&FLAG[..], &soft].concat(), output, extra).expect(0, &[]);
    };
    go("time.end=0.4", "through", &["--threads", "1"]);
    go("time.end=0.2", "resumed", &["--threads", "2"]);
    go("time.end=0.4", "resumed", &["--threads", "2", "--resume"]);
    assert_same_bits(&at.join("through"), &at.join("resumed"), "structure");
    let summary = common::summary(&at.join("through"));
    assert!(number(&summary, "conservation.coupled_energy_error") < 1e-11, "{summary}");
    assert!(number(&summary, "newton.per_slab") < 6.0);
    assert!(column(&at.join("through"), "tip_x").last().unwrap().abs() > 1e-6);
}

/// The structure is drawn beside the flow, with its stress, and its exact motion is stored.
#[test]
fn the_result_holds_the_structure() {
    let directory = TempDir::new().unwrap();
    finished(directory.path(), "turek_hron_fsi3", &[&FLAG[..], &["time.end=0.04"]].concat());
    let run = directory.path().join("turek_hron_fsi3");
    let reader = ResultReader::open(&run.join("result.vtkhdf")).unwrap();
    let length = |name: &str| reader.layout.exact.iter().find(|array| array.name == name).unwrap().axes[0].length;
    let (flow, structure) = (length("position"), length("structure_position"));
    assert_eq!((structure, flow + structure), (6, reader.layout.grid.cells));
    let moved = reader.exact("structure_position", 2).unwrap().unwrap();
    let rest = reader.exact("structure_position", 0).unwrap().unwrap();
    assert!(moved.iter().zip(&rest).any(|(a, b)| a != b));
    let names: Vec<&str> = reader.layout.fields.iter().map(|field| &field.name[..]).collect();
    assert!(names.contains(&"displacement") && names.contains(&"von_mises"), "{names:?}");
    stsolve(directory.path(), &["report", run.to_str().unwrap()]).expect(0, &[]);
}

/// A plate in three dimensions: the energy of gas and plate.
#[test]
fn a_plate_in_three_dimensions_keeps_its_energy() {
    let directory = TempDir::new().unwrap();
    let coarse = ["time.end=0.1", "time.slabs=5", "solver.newton_tolerance=1e-10", "mesh.order=2", "flow.order=2"];
    let summary = finished(directory.path(), "flexible_plate_3d", &coarse);
    assert!(number(&summary, "conservation.coupled_energy_error") < 1e-11, "{summary}");
    assert!(summary["bodies"]["structure"]["displacement"][0].as_f64().unwrap() != 0.0);
}

/// The default preconditioner takes 8 iterations per slab there, the low-order one 35.
#[test]
fn a_plate_in_three_dimensions_takes_few_iterations() {
    let directory = TempDir::new().unwrap();
    finished(directory.path(), "flexible_plate_3d", &["time.end=0.04", "time.slabs=2"]);
    let iterations = column(&directory.path().join("flexible_plate_3d"), "krylov");
    assert!(iterations.len() == 2 && iterations.iter().all(|krylov| *krylov <= 12.0), "{iterations:?}");
}

#[test]
fn a_restart_with_another_structure_is_refused() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let go = |changes: &[&str], output: &str| {
        on_case(at, "run", "turek_hron_fsi3", &[&FLAG[..], changes].concat(), output, &[])
    };
    go(&["time.end=0.04"], "first").expect(0, &[]);
    let from = format!("restart.from={}", at.join("first").display());
    go(&["time.end=0.08", &from], "second").expect(0, &[]);
    assert_eq!(column(&at.join("second"), "tip_y").len(), 4);
    let finer = "mesh.generate.channel_flag.cells={around=3,outwards=3,beside=3,along=3,across=2,after=3}";
    go(&["time.end=0.08", &from, finer], "refused").expect(2, &["cannot start from"]);
}

/// The support was compared with the initial displacement at a time before the restart, and the case refused.
#[test]
fn a_support_may_begin_to_move_where_a_run_is_restarted() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let small = ["mesh.order=3", "flow.order=3", "time={order=2,end=0.1,step=0.025}", "structure.initial={}"];
    let go = |changes: &[&str], output: &str| {
        on_case(at, "run", "elastic_piston", &[&small[..], changes].concat(), output, &[])
    };
    go(&["structure.boundary.left=\"fixed\""], "first").expect(0, &[]);
    let from = format!("restart.from={}", at.join("first").display());
    let moved = |start: &str| format!("structure.boundary.left={{displacement=[\"0.1*(t-{start})\",0]}}");
    go(&[&from, "time.end=0.15", &moved("0.1")], "second").expect(0, &[]);
    assert_eq!(column(&at.join("second"), "t").len(), 6);
    go(&[&from, "time.end=0.15", &moved("0")], "refused").expect(2, &["at t = 0.1 the support of the structure"]);
}

#[test]
fn structures_that_cannot_be_are_refused() {
    let directory = TempDir::new().unwrap();
    let case = common::shipped("turek_hron_fsi3.toml");
    let refused = [
        ("structure.regions=[]", "of \"fluid\", \"flag\""),
        ("structure.regions=[\"sail\"]", "sail"),
        ("structure.regions=[\"flag\",\"fluid\"]", "fluid"),
        ("structure.analysis=\"static\"", "a flow moves the structure in time"),
        ("structure.natural_modes=2", "natural modes are those of a structure by itself"),
        ("structure.boundary.fluid=\"fixed\"", "the flow moves this wall"),
        ("structure.boundary.sail=\"fixed\"", "sail"),
        ("structure.points.tip=[1,0.2]", "a point inside the structure"),
        ("output.probes.tip.at=[0.5,0.2]", "a point inside the flow"),
        ("structure.boundary.others={pressure=1}", "a load on a wall to the flow by name, `fluid`"),
        ("motion.boundary.flag={displacement=[\"0\",\"0.1*t^2\"]}", "moved by the structure"),
        ("motion.boundary.flag=\"slide\"", "moved by the structure"),
        ("structure.initial={displacement=[\"0\",\"0.01\"]}", "structure.initial.displacement"),
        ("bodies.flag={mass=1,y={}}", "belongs to the structure"),
    ];
    for (change, message) in refused {
        stsolve(directory.path(), &["check", &case, "--set", change]).expect(2, &[message]);
    }
    let piston = common::shipped("elastic_piston.toml");
    let open = "flow.boundary.bar={outflow={pressure=1}}";
    stsolve(directory.path(), &["check", &piston, "--set", open]).expect(2, &["no wall of the flow"]);
    let loose = "structure.boundary.bottom=\"free\"";
    stsolve(directory.path(), &["check", &piston, "--set", loose]).expect(2, &["holds the mesh along y"]);
}

/// Gas at rest in the length 1 beside an elastic bar of the length 1.
const BAR: &str = r#"
    mesh = { order = 4, generate.box = { lower = [-1, 0], upper = [1, 0.1], cells = [10, 1], regions = { bar = { lower = [-1, 0], upper = [0, 0.1] } } } }
    motion.boundary = { bottom = "slide", top = "slide", others = "fixed" }
    time = { order = 1, end = 0, step = 1 }
    solver.steady.bodies = "equilibrium"
    [flow]
    order = 4
    initial.expression = { density = 1, velocity = [0, 0], pressure = "1/1.4" }
    reference = { density = 1, speed = 1, pressure = "1/1.4" }
    boundary.others = "slip_wall"
    [structure]
    regions = ["bar"]
    density = 10
    young_modulus = 100
    poisson_ratio = 0
    points = { wall = [0, 0.05] }
    boundary = { left = "fixed", bottom = { held = ["y"] }, top = { held = ["y"] } }
"#;

/// Nothing damps the modes of inviscid gas at rest. The search was at the equilibrium to 1e-6, went on, and lost it.
#[test]
fn a_bar_beside_inviscid_gas_finds_its_equilibrium() {
    let directory = TempDir::new().unwrap();
    std::fs::write(directory.path().join("case.toml"), BAR).unwrap();
    stsolve(directory.path(), &["run", "case.toml", "--output", "run", "--quiet"]).expect(0, &[]);
    // p0 (1 - d)^-1.4 = -E d
    let pressure = |d: f64| (1.0 - d).powf(-1.4) / 1.4;
    let exact = (0..50).fold(0.0, |d, _| -pressure(d) / 100.0);
    let found = *column(&directory.path().join("run"), "wall_x").last().unwrap();
    assert!((found / exact - 1.0).abs() < 1e-3, "{found} for {exact}");
}

/// No file had the force of a clamp. In equilibrium that of the bar carries the pressure of the gas on its other end.
#[test]
fn the_clamp_of_a_bar_carries_the_pressure_of_the_gas() {
    let directory = TempDir::new().unwrap();
    on_text(directory.path(), &BAR.replace("end = 0,", "end = 1,"), &[], "run", &["--quiet"]).expect(0, &[]);
    let last = |name: &str| *column(&directory.path().join("run"), name).last().unwrap();
    // The stress -E d acts on the height 0.1.
    let (found, exact) = (last("left_reaction_x"), -10.0 * last("wall_x"));
    assert!((found / exact - 1.0).abs() < 1e-3, "{found} for {exact}");
    assert!((last("bottom_reaction_y") + last("top_reaction_y") + last("left_reaction_y")).abs() < 1e-6 * exact);
}
