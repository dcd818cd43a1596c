//! Rigid bodies: exact solutions, energy, resuming, bad input.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{assert_same_bits, column, finished, number, on_case, on_text, stsolve, summary};
use tempfile::TempDir;

/// V(1) and x(1) of the free piston.
const PISTON: [f64; 2] = [0.490146313218, 0.274380414368];

#[test]
fn the_free_piston_follows_its_simple_wave() {
    let directory = TempDir::new().unwrap();
    let summary = finished(directory.path(), "piston_free", &[]);
    let piston = &summary["bodies"]["piston"];
    let velocity = piston["velocity"][0].as_f64().unwrap();
    let position = piston["displacement"][0].as_f64().unwrap();
    assert!((velocity - PISTON[0]).abs() < 1e-8 && (position - PISTON[1]).abs() < 1e-8, "{velocity}, {position}");
    assert!(number(&summary, "conservation.coupled_energy_error") < 1e-12, "{summary}");
    assert!(number(&summary, "conservation.mass_error") < 1e-12);
    let work = column(&directory.path().join("piston_free"), "piston_flow_work");
    let kinetic = column(&directory.path().join("piston_free"), "piston_kinetic_energy");
    let lost = work.iter().zip(&kinetic).map(|(work, kinetic)| (work - kinetic).abs()).fold(0.0, f64::max);
    assert!(lost < 1e-9, "{lost:e}");
}

/// A force that makes x = t^6 / 20 the exact motion of the piston: V' = p(V) + F in front of a simple wave, p = p0 (1 - V/5)^7.
const SMOOTH: &str = "bodies.piston.force=[\"1.5*t^4 - p0*(1 - 0.06*t^5)^7\", 0]";

#[test]
fn a_piston_that_moves_smoothly_has_the_order_of_radau() {
    let directory = TempDir::new().unwrap();
    let errors = |order: usize, slabs: usize| {
        let (order, slabs) = (format!("time.order={order}"), format!("time.slabs={slabs}"));
        on_case(directory.path(), "run", "piston_free", &[&order, &slabs, SMOOTH], "run", &["--force"]).expect(0, &[]);
        let summary = summary(&directory.path().join("run"));
        let of = |key: &str| summary["bodies"]["piston"][key][0].as_f64().unwrap();
        [of("displacement") - 0.05, of("velocity") - 0.3]
    };
    for (order, slabs, wanted) in [(1, 16, [0.8, 0.8]), (2, 12, [2.8, 2.8]), (3, 8, [4.8, 3.7])] {
        let (coarse, fine) = (errors(order, slabs), errors(order, 2 * slabs));
        let found = [0, 1].map(|i| (coarse[i] / fine[i]).abs().log2());
        assert!(found[0] >= wanted[0] && found[1] >= wanted[1], "N_t = {order}: {found:.2?}");
    }
}

/// A light gas around a cylinder that flies against a stop. The contact lasts a fiftieth of a slab. The time integration multiplied the speed by up to
/// 14, without a word.
#[test]
fn a_stiff_stop_gives_a_body_no_energy() {
    let directory = TempDir::new().unwrap();
    let text = "mesh = { order = 4, generate.annulus = { inner_radius = 0.5, outer_radius = 6, first_cell = 0.7, cells = [8, 3] } }
        time = { order = 3, end = 0.8, step = 0.05 }
        [flow]
        order = 2
        gas = { gamma = 1.4 }
        initial.expression = { density = 1e-6, velocity = [0, 0], pressure = \"1e-4/1.4\" }
        reference = { density = 1e-6, speed = 1, pressure = 7.142857142857143e-5 }
        boundary = { wall = \"slip_wall\", far = \"slip_wall\" }
        [bodies.b]
        walls = [\"wall\"]
        mass = 1
        y = { rate = 0.5, stops = { lower = -0.3, upper = 0.31, stiffness = 1e7 } }
        mesh = { between = { inner = 0.6, outer = 5.9 } }";
    let run = on_text(directory.path(), text, &[], "run", &[]);
    run.expect(0, &["the slab is too long for the contact of body"]);
    let speed = column(&directory.path().join("run"), "b_y_rate").last().unwrap().abs();
    assert!(speed < 0.51, "{speed}");
}

/// In slabs as short as these the piston goes less than the tolerance in units of the node spacing. It moves all the same.
#[test]
fn a_body_that_hardly_moves_in_a_slab_moves() {
    let directory = TempDir::new().unwrap();
    let coarse = ["flow.order=3", "time.order=2", "mesh.generate.box.cells=[4,1]"];
    for (set, wanted) in [
        (&["solver.newton_tolerance=1e-3"][..], PISTON[1]),
        (&["time.end=0.1", "time.slabs=1500", "solver.newton_tolerance=1e-8"], 3.508e-3),
        (&["bodies.piston.mass=1e5", "solver.newton_tolerance=1e-3"], 3.57e-6),
    ] {
        on_case(directory.path(), "run", "piston_free", &[&coarse[..], set].concat(), "run", &["--force"])
            .expect(0, &[]);
        let x = *column(&directory.path().join("run"), "piston_x").last().unwrap();
        println!("{set:?}: {x}");
        assert!((x / wanted - 1.0).abs() < 0.02, "{set:?}: {x} for {wanted}");
    }
}

/// Jumps of bodies count in units of rho U^2: with a dense gas in front of a heavy piston the slabs are the same.
#[test]
fn adapted_slabs_of_a_body_are_the_same_in_all_units() {
    let directory = TempDir::new().unwrap();
    let times = |density: f64| {
        let set = [
            "flow.order=3".to_owned(),
            "mesh.generate.box.cells=[4,1]".to_owned(),
            "time={order=2,end=1,step=0.05,adaptive={tolerance=1e-3}}".to_owned(),
            format!("flow.initial.expression={{density={density:e},velocity=[0,0],pressure=\"{density:e}*p0\"}}"),
            format!("flow.reference={{density={density:e},speed=1,pressure=\"{density:e}/1.4\"}}"),
            format!("bodies.piston.mass={density:e}"),
        ];
        on_case(directory.path(), "run", "piston_free", &set.each_ref().map(String::as_str), "run", &["--force"])
            .expect(0, &[]);
        column(&directory.path().join("run"), "t")
    };
    let (light, dense) = (times(1.0), times(1e4));
    assert!(light.len() == dense.len() && light.len() > 5, "{light:?} {dense:?}");
    assert!(light.iter().zip(&dense).all(|(a, b)| (a / b - 1.0).abs() < 1e-4), "{light:?} {dense:?}");
}

/// Gas, a free piston and a wall that move with one velocity keep it, while the mesh between them stretches.
#[test]
fn bodies_that_move_with_the_stream_leave_it_alone() {
    let directory = TempDir::new().unwrap();
    let set = [
        "time={order=2,end=1,slabs=10}",
        "flow.initial.expression.velocity=[0.3,0]",
        "bodies.piston={walls=[\"right\"],mass=1,force=[\"-p0\",0],x={rate=0.3},mesh={weight=\"(x/1.5)^2\"}}",
        "bodies.left={walls=[\"left\"],mass=1,x={motion=\"0.3*t\"},mesh={weight=\"1-x/1.5\"}}",
        "output.probes.inside.at=[0.7,0.5]",
    ];
    let summary = finished(directory.path(), "piston_free", &set);
    assert!(number(&summary, "mesh_quality.det_j_sampled_min") < 0.9, "the mesh has not moved");
    let last = |name: &str| *column(&directory.path().join("piston_free"), name).last().unwrap();
    let velocity = [last("piston_x_rate"), last("inside_velocity_x")].map(|v| (v - 0.3).abs());
    assert!(velocity.iter().all(|error| *error < 1e-13), "{velocity:?}");
    assert!((last("inside_density") - 1.0).abs() < 1e-13 && last("inside_velocity_y").abs() < 1e-13);
    for key in ["mass_error", "energy_error", "coupled_energy_error"] {
        assert!(number(&summary, &format!("conservation.{key}")) < 1e-13, "{key}");
    }
}

/// A cylinder on springs over some slabs, on one thread and on two, stopped and resumed.
#[test]
fn bodies_have_the_same_bits_for_threads_and_after_a_resume() {
    let directory = TempDir::new().unwrap();
    let coarse = ["mesh.order=3", "flow.order=3", "mesh.generate.annulus.cells=[12,6]", "time.order=2"];
    let go = |end: &str, output: &str, extra: &[&str]| {
        let set = [&coarse[..], &[end]].concat();
        on_case(directory.path(), "run", "cylinder_viv", &set, output, extra).expect(0, &[]);
    };
    go("time.end=2", "through", &["--threads", "1"]);
    go("time.end=1", "resumed", &["--threads", "2"]);
    go("time.end=2", "resumed", &["--threads", "2", "--resume"]);
    assert_same_bits(&directory.path().join("through"), &directory.path().join("resumed"), "bodies");
    let y = column(&directory.path().join("through"), "cylinder_y");
    assert!(y.iter().any(|y| y.abs() > 1e-4), "{y:?}");
}

/// A prescribed coordinate follows its formula, and is free from its release on. It began with the rate of a polynomial through the prescribed
/// positions, here 0.3902.
#[test]
fn a_driven_coordinate_is_released() {
    let directory = TempDir::new().unwrap();
    let set = [
        "mesh.order=3",
        "flow.order=3",
        "mesh.generate.annulus.cells=[12,6]",
        "time.end=2",
        "bodies.cylinder.y.motion=\"0.1*t^4\"",
        "bodies.cylinder.y.release=1",
    ];
    finished(directory.path(), "cylinder_viv", &set);
    let run = directory.path().join("cylinder_viv");
    let (t, y) = (column(&run, "t"), column(&run, "cylinder_y"));
    let driven = |t: f64| 0.1 * t.powi(4);
    let apart = |(t, y): (&f64, &f64)| (*t, (y - driven(*t)).abs());
    for (t, apart) in t.iter().zip(&y).map(apart) {
        assert!(if t <= 1.0 + 1e-9 { apart < 1e-10 } else { apart > 1e-6 }, "t = {t}: {apart:e}");
    }
    let rate = column(&run, "cylinder_y_rate");
    assert!((rate[4] - 0.4).abs() < 1e-12, "{rate:?}");
    let drive = column(&run, "cylinder_drive_work");
    assert!(drive[3].abs() > 1e-3 && drive.last() == drive.get(4), "{drive:?}");
}

/// A run continues with the bodies that it had, and with other nodes in time.
#[test]
fn a_restart_from_other_bodies_is_refused() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let go = |changes: &[&str], output: &str| {
        let coarse = ["mesh.order=3", "flow.order=3", "mesh.generate.annulus.cells=[12,6]"];
        on_case(at, "run", "cylinder_viv", &[&coarse[..], changes].concat(), output, &[])
    };
    go(&["time.order=2", "time.end=0.4"], "first").expect(0, &[]);
    let from = format!("restart.from={}", at.join("first").display());
    go(&["time.order=3", "time.end=0.8", &from], "second").expect(0, &[]);
    assert_eq!(column(&at.join("second"), "cylinder_y").len(), 4);
    go(&["time.order=2", "time.end=0.8", &from, "bodies.cylinder.x={}"], "refused")
        .expect(2, &["the rigid bodies there", "`cylinder` with y, walls wall", "`cylinder` with x, y, walls wall"]);
    go(&["time.order=2", "time.end=0.8", &from, "bodies.cylinder.pivot=[0.1,0]"], "refused")
        .expect(2, &["about [0.1, 0.0]"]);
    assert!(!at.join("refused").exists());
}

#[test]
fn bodies_that_cannot_be_are_refused() {
    let directory = TempDir::new().unwrap();
    let case = common::shipped("cylinder_viv.toml");
    let refused = [
        ("bodies.cylinder.walls=[\"far\"]", "boundary `far` is no wall"),
        ("bodies.cylinder.walls=[\"hull\"]", "unknown boundary"),
        ("bodies.cylinder.mass=0", "the mass"),
        ("bodies.cylinder.z={}", "the mesh is two-dimensional"),
        ("bodies.cylinder.rotation={}", "no moment of inertia"),
        ("bodies.cylinder.y.release=1", "a coordinate that nothing drives is free already"),
        ("bodies.cylinder.y.motion=\"1+t\"", "zero at the start"),
        ("bodies.cylinder.mesh.between.inner=0.2", "a weight of one on the walls of the body"),
        ("bodies.cylinder.pivot=[100,0]", "`bodies.cylinder.pivot` where the body is"),
        ("bodies.cylinder.mesh.between.outer=0.5", "above `inner`"),
        ("motion.boundary.others=\"fixed\"", "move the whole mesh by weights"),
        ("bodies.cylinder.y.stops={lower=1,upper=0,stiffness=1}", "above `lower`"),
        ("flow.rotation={rate=2}", "do not feel the centrifugal and Coriolis forces"),
    ];
    for (change, message) in refused {
        stsolve(directory.path(), &["check", &case, "--set", change]).expect(2, &[message]);
    }
    let driven = "bodies.cylinder.y.motion=\"0.2*(1-cos(pi*t))\"";
    for (change, message) in [
        ("bodies.cylinder.y.release=1.1", "a time at which a slab begins"),
        ("bodies.cylinder.y.rate=5", "`rate` has no effect"),
    ] {
        stsolve(directory.path(), &["check", &case, "--set", driven, "--set", change]).expect(2, &[message]);
    }
}

/// A cylinder that turns about its axis, and its mesh with it.
const TURNING: &str = r#"
    mesh = { order = 4, generate.annulus = { inner_radius = 0.5, outer_radius = 8, first_cell = 0.2, cells = [8, 6] } }
    time = { order = 2, end = 1, step = 0.2 }
    [flow]
    order = 4
    gas = { gamma = 1.4, viscosity = { constant = 0.05 } }
    initial.uniform = { density = 1, velocity = [1, 0], pressure = "1/(1.4*0.05^2)" }
    boundary.wall.adiabatic_wall = {}
    boundary.far.far_field = { density = 1, velocity = [1, 0], pressure = "1/(1.4*0.05^2)" }
    forces.wall = {}
    [bodies.wall]
    mass = 3
    moment_of_inertia = 0.5
    rotation = { motion = "1-cos(t)" }
    mesh.between = { inner = 1, outer = 6 }
"#;

/// The power at the top of a slab is that of the velocity of the body. The velocity of the mesh meets positions only, and has a component
/// normal to the wall, on which the pressure does work.
#[test]
fn the_power_on_a_body_that_turns_is_moment_times_rate() {
    let directory = TempDir::new().unwrap();
    std::fs::write(directory.path().join("case.toml"), TURNING).unwrap();
    stsolve(directory.path(), &["run", "case.toml", "--output", "run", "--quiet"]).expect(0, &[]);
    let run = directory.path().join("run");
    let [t, power, moment] = ["t", "wall_power", "wall_moment"].map(|name| column(&run, name));
    for ((t, power), moment) in t.iter().zip(&power).zip(&moment) {
        let exact = moment * t.sin();
        assert!((power - exact).abs() < 1e-10 * exact.abs().max(1.0), "t = {t}: {power} {exact}");
    }
}

/// A body jumped where its motion did not go on.
#[test]
fn a_restart_in_which_a_driven_body_would_jump_is_refused() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let case = |motion: &str, more: &str| TURNING.replace("1-cos(t)", motion).replace("end = 1,", "end = 0.4,") + more;
    std::fs::write(at.join("first.toml"), case("1-cos(t)", "")).unwrap();
    stsolve(at, &["run", "first.toml", "--output", "first", "--quiet"]).expect(0, &[]);
    let restart = "\n[restart]\nfrom = \"first\"\n";
    for (motion, code, message) in
        [("0.5*(1-cos(t))", 2, "the coordinate `rotation` of the body `wall`"), ("1-cos(t)", 0, "")]
    {
        let text = case(motion, restart).replace("end = 0.4,", "end = 0.6,");
        std::fs::write(at.join("second.toml"), text).unwrap();
        stsolve(at, &["run", "second.toml", "--output", &format!("second{code}"), "--quiet"]).expect(code, &[message]);
    }
}

/// A jump by a tenth of its way is a jump in a mesh of any size. It was compared with one metre.
#[test]
fn a_restart_in_which_a_small_body_would_jump_is_refused() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let case = |length: f64, end: f64, more: &str| {
        format!(
            r#"
            mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [1e-6, 1e-6], cells = [2, 1] }} }}
            time = {{ order = 2, end = {end:e}, step = 1e-7 }}
            {more}
            [bodies.left]
            mass = 1
            x = {{ motion = "{length:e}*(1-cos(1e6*t))" }}
            mesh = {{ weight = "1-x/1e-6" }}
            {GAS_AT_REST}
            "#
        )
    };
    std::fs::write(at.join("first.toml"), case(1e-7, 2e-7, "")).unwrap();
    stsolve(at, &["run", "first.toml", "--output", "first", "--quiet"]).expect(0, &[]);
    for (length, code, message) in [(1.1e-7, 2, "the coordinate `x` of the body `left`"), (1e-7, 0, "")] {
        std::fs::write(at.join("second.toml"), case(length, 4e-7, "restart.from = \"first\"")).unwrap();
        stsolve(at, &["run", "second.toml", "--output", &format!("second{code}"), "--quiet"]).expect(code, &[message]);
    }
}

/// Gas at rest between walls.
const GAS_AT_REST: &str = r#"
    [flow]
    order = 2
    initial.uniform = { velocity = [0, 0], pressure = 1 }
    reference = { density = 1, speed = 1, pressure = 1 }
    boundary.others = "slip_wall"
"#;

/// One body must not move the wall of another one.
#[test]
fn weights_vanish_on_other_bodies_and_are_periodic() {
    let directory = TempDir::new().unwrap();
    let pistons = r#"
        mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [4, 2] } }
        time = { order = 2, end = 0.1, slabs = 1 }
        [bodies.left]
        mass = 1
        x = {}
        mesh.weight = "1-0.5*x"
        [bodies.right]
        mass = 1
        x = {}
        mesh.weight = "x"
    "#;
    let check = |text: &str, message: &str| {
        std::fs::write(directory.path().join("case.toml"), format!("{text}{GAS_AT_REST}")).unwrap();
        stsolve(directory.path(), &["check", "case.toml", "--probe", "never"])
            .expect(if message.is_empty() { 0 } else { 2 }, &[message]);
    };
    check(pistons, "on a wall of the body `right`");
    check(&pistons.replace("1-0.5*x", "1-x"), "");
    let periodic = r#"
        mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [4, 2], periodic = ["x"] } }
        motion.displacement = ["0.1*x*t", 0]
        time = { order = 2, end = 0.1, slabs = 1 }
    "#;
    check(periodic, "the displacement is not periodic");
    check(&periodic.replace("0.1*x*t", "0.1*sin(2*pi*x)*t"), "");
}

/// The wall of a body that turns was bent in the last layer of cells, where it goes on through a periodic side. A node that a boundary and a body
/// move went with the sum of both motions.
#[test]
fn a_body_alone_moves_its_nodes_to_one_place() {
    let directory = TempDir::new().unwrap();
    let check = |periodic: &str, body: &str, message: &str| {
        let text = format!(
            r#"
            mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [2, 1], cells = [4, 2]{periodic} }} }}
            time = {{ order = 2, end = 0.1, slabs = 1 }}
            {body}
            {GAS_AT_REST}
            "#
        );
        std::fs::write(directory.path().join("case.toml"), text).unwrap();
        stsolve(directory.path(), &["check", "case.toml", "--probe", "never"])
            .expect(if message.is_empty() { 0 } else { 2 }, &[message]);
    };
    let turning = "[bodies.bottom]\nmass = 1\nmoment_of_inertia = 1\nrotation = {}\n";
    check(", periodic = [\"x\"]", turning, "one node of the mesh by periodicity");
    check("", turning, "would leave its plane");
    check(", periodic = [\"x\"]", "[bodies.bottom]\nmass = 1\ny = {}\n", "");
    let beside = |motion: &str| {
        format!(
            "motion.boundary = {{ top = {{ displacement = [\"0\", \"{motion}\"] }}, others = \"fixed\" }}\n[bodies.left]\nmass = 1\nx = {{}}\n"
        )
    };
    check("", &beside("0.1*t*(2-x)"), "the body `left` moves it, too");
    check("", &beside("0.1*t*x*(2-x)"), "");
}
