//! Steady starts: their boundary data, their search, and their message if there is no steady flow.
//!
//! `scripts/steady_starts.py` runs the twelve starts of its table on finer meshes, each at two orders.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{Outcome, column, number, on_case, stsolve, summary};
use std::path::Path;
use tempfile::TempDir;

/// Runs a case given as text.
fn run(directory: &Path, name: &str, case: &str) -> Outcome {
    let file = directory.join(format!("{name}.toml"));
    std::fs::write(&file, case).unwrap();
    stsolve(directory, &["run", file.to_str().unwrap(), "--output", name, "--quiet"])
}

/// The state on the boundary varies in time: at t = 0 its density is 1, and its mean over the slab of the solver 1.0969.
#[test]
fn a_steady_start_takes_boundary_states_of_its_own_time() {
    let case = |start: f64| {
        format!(
            "mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [1, 1], cells = [3, 3] }} }}
             time = {{ order = 1, start = {start}, end = {start}, step = 1 }}
             solver = {{ steady = {{}} }}
             [flow]
             order = 3
             initial = {{ uniform = {{ velocity = [0.3, 0], pressure = 1 }} }}
             [flow.boundary.others.prescribed_state.expression]
             density = \"1 + 0.3*sin(t)\"
             velocity = [0.3, 0]
             pressure = 1"
        )
    };
    let directory = TempDir::new().unwrap();
    for (name, start) in [("zero", 0.0), ("later", 1.25)] {
        run(directory.path(), name, &case(start)).expect(0, &[]);
        let mass = common::column(&directory.path().join(name), "mass")[0];
        println!("start at {start}: mass {mass}");
        assert!((mass - (1.0 + 0.3 * f64::sin(start))).abs() < 1e-8, "{start}: {mass}");
    }
}

/// 280 cells.
const COARSE: &str = "mesh.generate.airfoil={ first_cell = 0.015, trailing_edge_cell = 0.02, surface_cells = 8, wake_cells = 6, \
                      normal_cells = 10, far_field = 20 }";

/// A gust that begins at t = 0 exerts no lift at that time.
#[test]
fn a_gust_is_not_felt_before_it_has_begun() {
    let gust = "flow.boundary.far={prescribed_state={expression={density=1,velocity=[1,\"0.1*sin(2*pi*t/5.3)\"],pressure=\"1/(1.4*0.2^2)\"}}}";
    let directory = TempDir::new().unwrap();
    let set = ["mesh.order=3", COARSE, "flow.order=3", gust, "time.end=0"];
    on_case(directory.path(), "run", "naca0012_heave", &set, "gust", &[]).expect(0, &[]);
    let wall = &summary(&directory.path().join("gust"))["steady"]["walls"]["airfoil"];
    println!("{wall}");
    assert!(number(wall, "lift_coefficient").abs() < 1e-7, "{wall}");
}

/// Euler flow around the airfoil at two degrees, on 216 cells; the drag of a flow without shocks is zero.
fn inviscid(mach: f64, order: usize) -> String {
    let [x, y] = [2.0_f64.to_radians().cos(), 2.0_f64.to_radians().sin()];
    format!(
        "time = {{ order = 1, end = 0, step = 1 }}
         solver.steady = {{}}
         [mesh]
         order = 4
         [mesh.generate.airfoil]
         first_cell = 0.03
         trailing_edge_cell = 0.03
         surface_cells = 8
         wake_cells = 5
         near_wake = {{ extent = 2, cells = 3 }}
         normal_cells = 8
         near_wall = {{ extent = 0.6, cells = 5 }}
         [flow]
         order = {order}
         initial = {{ uniform = {{ velocity = [{x}, {y}], mach = {mach} }} }}
         [flow.boundary]
         airfoil = \"slip_wall\"
         far = {{ far_field = {{ velocity = [{x}, {y}], mach = {mach} }} }}
         [flow.forces.airfoil]
         drag_direction = [{x}, {y}]"
    )
}

/// From the free stream orders 3 to 5 stall at once at Mach numbers of 0.1 and 0.5. Lift: a thin airfoil of 12 % has
/// 2 pi (1 + 0.77 * 0.12) alpha / sqrt(1 - M^2) = 0.241 at M = 0.1, 0.277 at M = 0.5. Order 3 is coarse here, order 4 is not.
#[test]
fn an_inviscid_airfoil_is_found_by_lower_orders() {
    let directory = TempDir::new().unwrap();
    for (mach, lift) in [(0.1, 0.241), (0.5, 0.277)] {
        for (order, bound) in [(3, 0.2), (4, 0.05)] {
            let name = format!("order_{order}_mach_{mach}");
            run(directory.path(), &name, &inviscid(mach, order)).expect(0, &[]);
            let steady = &summary(&directory.path().join(&name))["steady"];
            println!("M = {mach}, order {order}: {steady}");
            let wall = &steady["walls"]["airfoil"];
            let found = number(wall, "lift_coefficient");
            assert!((found / lift - 1.0).abs() < bound, "M = {mach}, order {order}: C_L = {found}, not {lift}");
            assert!(number(wall, "drag_coefficient").abs() < 5e-3, "{wall}");
        }
    }
}

/// At Re = 4000 the wake of a cylinder is unsteady on this mesh. The search must report this with its measurements, and must not
/// advise anything that it has tried.
#[test]
fn a_flow_without_a_steady_state_is_called_unsteady_and_its_rate_of_change_is_shown() {
    let directory = TempDir::new().unwrap();
    let set = [
        "mesh.order=3",
        "mesh.generate.annulus.cells=[16,10]",
        "time={order=1,end=0,step=1}",
        "flow.order=5",
        "flow.gas.viscosity.constant=0.00025",
    ];
    let outcome = on_case(directory.path(), "run", "cylinder_steady", &set, "unsteady", &[]);
    println!("{}", outcome.stderr);
    outcome.expect(1, &["the flow is unsteady", "its rate of change went from", "remove `[solver.steady]`"]);
    for tried in ["solver.steady.steps", "krylov_iterations", "lax_friedrichs"] {
        assert!(!outcome.stderr.contains(tried), "{tried} was tried: {}", outcome.stderr);
    }
}

/// An airfoil at 6 degrees and Re = 20000 on 328 cells of order 2 with two quadrature points per direction: hopelessly coarse, so that the
/// discrete equations have several steady solutions.
const UNRESOLVED: &str = r#"
[constants]
alpha = "6*pi/180"
[mesh]
order = 4
[mesh.generate.airfoil]
first_cell = 0.01
trailing_edge_cell = 0.03
surface_cells = 10
wake_cells = 6
near_wake = { extent = 2, cells = 3 }
normal_cells = 9
near_wall = { extent = 0.6, cells = 6 }
[flow]
order = 2
quadrature = { points = 2 }
gas = { gamma = 1.4, prandtl = 0.72, mach = 0.2, viscosity = { constant = 5e-5 } }
reference = { density = 1, speed = 1, pressure = 17.857142857142858 }
initial = { uniform = { velocity = [1, 0], mach = 0.2 } }
[flow.boundary]
airfoil = { adiabatic_wall = {} }
far = { far_field = { velocity = [0.9945218953682733, 0.10452846326765347], mach = 0.2 } }
[flow.forces]
airfoil = { drag_direction = [0.9945218953682733, 0.10452846326765347] }
[time]
order = 1
end = 0
step = 1
[solver.steady]
first_step = 100
sequence = false
[output]
fields = []
"#;

/// The steady section of the summary of UNRESOLVED with changes, and whether the run has warned; None where no steady flow was found.
fn unresolved(directory: &Path, changes: &[&str]) -> Option<(serde_json::Value, bool)> {
    let file = directory.join("case.toml");
    std::fs::write(&file, UNRESOLVED).unwrap();
    let mut arguments = vec!["run", file.to_str().unwrap(), "--output", "run", "--force"];
    changes.iter().for_each(|change| arguments.extend(["--set", change]));
    let outcome = stsolve(directory, &arguments);
    let told = outcome.stdout + &outcome.stderr;
    let warned = told.contains("warning: the steady flow is unstable") && told.contains("a higher `flow.order`");
    println!("{changes:?}: {}", outcome.code);
    (outcome.code == 0).then(|| (summary(&directory.join("run"))["steady"].clone(), warned))
}

/// Newton's method finds lifts of 0.448 and 0.632 from a uniform stream and of 0.113 from gas at rest, all with residuals below 1e-9. No flow in
/// time stays at the first two: a march fails after some time units.
#[test]
fn a_spurious_steady_flow_is_told_by_a_march_in_time() {
    let directory = TempDir::new().unwrap();
    let lift = |steady: &serde_json::Value| number(&steady["walls"]["airfoil"], "lift_coefficient");
    let judged = |(steady, warned): &(serde_json::Value, bool), unstable: bool| {
        println!("{steady}");
        assert!(number(steady, "next_order_residual") > 0.1, "{steady}");
        assert_eq!(steady["stability"]["unstable"], unstable, "{steady}");
        assert_eq!(*warned, unstable, "{steady}");
    };
    // The way of Newton's method from there is long: with another order of elimination some of these get lost.
    let (long, low_order) = ("solver.steady.first_step=1e4", "solver.preconditioner=low_order");
    let ways: [&[&str]; 3] = [&["solver.steady.first_step=30"], &[long], &[long, low_order]];
    let from_stream = ways.iter().filter_map(|way| unresolved(directory.path(), way));
    let spurious: Vec<_> = from_stream.filter(|(steady, _)| (lift(steady) - 0.113).abs() > 0.1).collect();
    assert!(!spurious.is_empty(), "the spurious flow was not found");
    spurious.iter().for_each(|flow| judged(flow, true));
    let at_rest = "flow.initial={ uniform = { velocity = [0, 0.01], mach = 0.002 } }";
    let ways: [&[&str]; 3] = [&[at_rest, "solver.steady.first_step=10"], &[at_rest, long], &[at_rest]];
    let rest = ways.iter().find_map(|way| unresolved(directory.path(), way)).unwrap();
    assert!((lift(&rest.0) - 0.113).abs() < 1e-3, "{}", rest.0);
    judged(&rest, false);
}

/// A flow that is resolved costs no march, and is stable where the case asks for one.
#[test]
fn a_resolved_steady_flow_is_not_doubted() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.order=4", COARSE, "flow.order=4", "time.end=0"];
    for (name, more) in [("usual", "flow.order=4"), ("asked", "solver.steady.stability_time=8")] {
        on_case(directory.path(), "run", "naca0012_heave", &[&set[..], &[more]].concat(), name, &[]).expect(0, &[]);
        let steady = &summary(&directory.path().join(name))["steady"];
        println!("{name}: {steady}");
        assert!(number(steady, "next_order_residual") < 0.1, "{steady}");
        assert_eq!(steady.get("stability").is_some(), name == "asked", "{steady}");
    }
}

/// The steady flow around a cylinder at Re = 100 exists, but vortices are shed: the disturbance grows by exp(0.13 t).
#[test]
fn the_steady_flow_around_a_cylinder_at_re_100_is_unstable() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.order=3", "flow.order=4", "flow.gas.viscosity.constant=0.01", "solver.steady.stability_time=60"];
    on_case(directory.path(), "run", "cylinder_steady", &set, "run", &[]).expect(0, &[]);
    let steady = &summary(&directory.path().join("run"))["steady"];
    println!("{steady}");
    assert_eq!(steady["stability"]["unstable"], true, "{steady}");
}

/// The most dissipative flux at M = 0.05: iterations, but no failure. Table: cargo test ... -- --nocapture
#[test]
fn the_lax_friedrichs_flux_works_at_a_low_mach_number_and_costs_iterations() {
    let directory = TempDir::new().unwrap();
    let airfoil = ["mesh.order=3", COARSE, "flow.order=3", "time.end=0.2"];
    let cylinder = ["mesh.order=4", "flow.order=4"];
    for (case, coarse, wall) in [("naca0012_heave", &airfoil[..], "airfoil"), ("cylinder_steady", &cylinder, "wall")] {
        let [roe, dissipative] = ["roe", "lax_friedrichs"].map(|flux| {
            let mach = ["gas", "initial.uniform", "boundary.far.far_field"].map(|key| format!("flow.{key}.mach=0.05"));
            let flux = format!("flow.riemann={flux}");
            let set: Vec<&str> =
                coarse.iter().copied().chain(mach.iter().map(String::as_str)).chain([&flux[..]]).collect();
            on_case(directory.path(), "run", case, &set, "run", &["--force"]).expect(0, &[]);
            let summary = summary(&directory.path().join("run"));
            assert_eq!(number(&summary, "rejected_slabs"), 0.0, "{summary}");
            let (steady, slabs) = (&summary["steady"], number(&summary, "krylov.total"));
            let drag = number(&steady["walls"][wall], "drag_coefficient");
            println!("{case}, {flux}: steady {} Krylov iterations, slabs {slabs}, C_D {drag:.5}", steady["krylov"]);
            [number(steady, "krylov"), drag]
        });
        assert!((dissipative[1] / roe[1] - 1.0).abs() < 0.02, "{case}: {roe:?} {dissipative:?}");
        assert!(dissipative[0] > 1.5 * roe[0], "{case}: {roe:?} {dissipative:?}");
    }
}

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

/// The same flow in other units of length, speed and density: steps in pseudo-time follow the units.
#[test]
fn a_steady_start_takes_the_same_steps_in_all_units() {
    let directory = TempDir::new().unwrap();
    let steps = |length: f64, speed: f64, density: f64| {
        let stream = format!("{{density={density:e},velocity=[{speed:e},0],mach=0.1}}");
        let set = [
            "mesh.order=4".into(),
            "flow.order=4".into(),
            format!(
                "mesh.generate.annulus={{inner_radius={:e},outer_radius={:e},first_cell={:e},cells=[20,14]}}",
                0.5 * length,
                100.0 * length,
                0.1 * length
            ),
            format!("flow.gas.viscosity.constant={:e}", 0.025 * density * speed * length),
            format!("flow.initial.uniform={stream}"),
            format!("flow.boundary.far.far_field={stream}"),
            format!(
                "flow.reference={{density={density:e},speed={speed:e},pressure={:e},length={length:e}}}",
                density * speed * speed / (1.4 * 0.01)
            ),
            "time={order=1,end=0,step=1}".into(),
        ];
        on_case(directory.path(), "run", "cylinder_steady", &set.each_ref().map(String::as_str), "run", &["--force"])
            .expect(0, &[]);
        let steady = &summary(&directory.path().join("run"))["steady"];
        println!("length {length}, speed {speed}, density {density}: {steady}");
        [number(steady, "newton"), number(steady, "krylov"), number(&steady["walls"]["wall"], "drag_coefficient")]
    };
    let [newton, krylov, drag] = steps(1.0, 1.0, 1.0);
    for [length, speed, density] in [[1.0, 1e-3, 1.0], [1e-3, 340.0, 1.2], [1e3, 1.0, 1e-3], [1e6, 10.0, 1.0]] {
        let other = steps(length, speed, density);
        assert_eq!(other[0], newton, "{other:?}");
        assert!((other[1] - krylov).abs() <= 0.1 * krylov, "{other:?} {krylov}");
        assert!((other[2] / drag - 1.0).abs() < 1e-6, "{other:?} {drag}");
    }
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
    let walls = "[flow.boundary]\nothers.isothermal_wall.temperature = 1";
    let source = "source.given = { density = 0, momentum = [\"0.1*sin(2*pi*y)\", 0], energy = 0 }";
    let [mass, ..] = totals("stirred", &case("[]", walls, "0", source));
    assert!((mass - 1.0).abs() < 1e-9, "{mass}");
}
