//! `stsolve check` warns of doubtful choices.

use crate::common::shipped;
use crate::outcome;
use std::path::Path;

/// Other far fields of the airfoil, and a wall of another temperature.
const FAST: &str = "flow.boundary.far={far_field={velocity=[1,0],mach=0.9}}";
const SLOW: &str = "flow.boundary.far={far_field={velocity=[1,0],mach=0.05}}";
const TURNED: &str = "flow.boundary.far={far_field={velocity=[1,0.1],mach=0.2}}";
const HOT: &str = "flow.boundary.airfoil={isothermal_wall={temperature=300}}";
/// A motion that follows a rest, in slabs that adapt.
const ADAPTIVE: &str = "time.adaptive.tolerance=1e-3";
const PULSE: &str = "motion.boundary.airfoil.displacement=[0, \"if(t < 2, 0, 0.1*sin(pi*(t - 2))^2)\"]";
const THIN: &str = "flow.gas.viscosity.constant=1e-7";

/// Settings of the airfoil, the subject of the only warning, and a part of its remedy.
const DOUBTFUL: &[(&[&str], &str, &str)] = &[
    (&["time.step=0.5", "time.order=1"], "slab length", "`time.step` of"),
    (&[ADAPTIVE, PULSE, "time.end=4"], "longest slab", "`time.adaptive.largest` of 2.5"),
    (&[ADAPTIVE, PULSE, "time.end=4", "time.adaptive.largest=0.2"], "none", ""),
    (&["mesh.generate.airfoil.far_field=5"], "far field", "`far_field`"),
    (&["mesh.generate.airfoil={first_cell=0.2}"], "first cell", "`first_cell`"),
    (&["flow.quadrature={points=5}"], "quadrature", "\"conserving\""),
    (&["flow.quadrature=\"collocated\"", "time.order=1"], "quadrature in time", "`time.order = 2` or more"),
    (&["motion.boundary.airfoil.displacement=[0, \"t\"]"], "start of the motion", "at_rest"),
    (&["motion={displacement=[0, \"0.5*t\"]}"], "start of the motion", "with a speed of 5.00e-1"),
    (
        &["flow.gas={viscosity={sutherland={viscosity=2e-2,temperature=288.15,constant=110.4}}}"],
        "Sutherland's law",
        "`flow.gas.gas_constant`",
    ),
    // This one starts from rest, although it is fast within the first slab.
    (&["motion.boundary.airfoil.displacement=[0, \"0.1*sin(pi*t)^2\"]"], "none", ""),
    (&["motion.boundary.airfoil.displacement=[0, \"3*t^2\"]"], "speed of walls", "`shock_capturing = {}`"),
    (&["flow.gas.gamma=14"], "ratio of specific heats", "1.4 for air"),
    // The Mach number of the gas was swept, and all runs were the same.
    (&["flow.gas.mach=0.4"], "Mach number of the gas", "of `flow.initial`, of far fields"),
    (&["flow.initial.uniform.mach=0.9", FAST, "flow.gas.mach=0.9"], "Mach number", "`shock_capturing = {}`"),
    (
        &["flow.initial.uniform.mach=0.05", SLOW, "flow.gas.mach=0.05", "flow.riemann=\"lax_friedrichs\""],
        "Mach number",
        "\"roe\"",
    ),
    (
        &["flow.initial.uniform={velocity=[3.6,0],mach=0.72}"],
        "free stream",
        "the far field `far` has density 1, velocity [1.0, 0.0]",
    ),
    (&[TURNED, "flow.initial.uniform.velocity=[1,0.1]"], "drag", "`flow.forces.airfoil.drag_direction = [1.0, 0.1]`"),
    (&[HOT], "wall temperature", "`flow.gas.gas_constant`"),
    (&[THIN], "turbulence", "lower Reynolds number"),
    (&["solver={newton_tolerance=1e-5}"], "start of the flow", "`[solver.steady]`"),
    (&["flow.gas.viscosity=\"inviscid\""], "viscosity", "slip_wall"),
    (&["flow.boundary.airfoil=\"symmetry\"", "flow.forces={}"], "none", ""),
    (
        &["flow.boundary.airfoil={far_field={velocity=[1,0],mach=0.2}}", "flow.forces={}"],
        "moving boundary",
        "flow.boundary.airfoil",
    ),
    (&["flow.exact={uniform={velocity=[1,0],mach=0.2}}"], "exact solution", "`flow.initial`"),
    (&["flow.rotation={rate=0.5}"], "rotating frame", "`prescribed_state = { expression"),
    (&["solver.preconditioner=\"lines\""], "preconditioner", "\"blocks\""),
    (
        &["flow.reference={speed=2,pressure=17.857142857142858}", "flow.gas.mach=0.4"],
        "reference state",
        "the far field `far` density 1, speed 1",
    ),
    (&["output.every=1", "flow.order=16", "time.step=0.001"], "result file", "`output.every`"),
];

#[test]
fn check_warns_of_doubtful_choices_and_names_the_remedy() {
    let airfoil = shipped("naca0012_heave.toml");
    for &(settings, subject, remedy) in DOUBTFUL {
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let arguments: Vec<&str> = ["check", "--json", "--probe", "never", &airfoil].into_iter().chain(set).collect();
        let (code, stdout, stderr) = outcome(Path::new("."), &arguments);
        assert_eq!((code, stderr.as_str()), (0, ""), "{settings:?}");
        let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        let warnings = json["warnings"].as_object().unwrap();
        assert_eq!(warnings.keys().collect::<Vec<_>>(), [subject], "{settings:?}");
        assert!(warnings[subject].as_str().unwrap().contains(remedy), "{settings:?}: {warnings:?}");
    }
    // Cells alone suffice for it.
    let (_, stdout, _) =
        outcome(Path::new("."), &["check", "--json", "--probe", "never", &shipped("vortex_period.toml")]);
    assert!(stdout.contains("\"none\":\"\"") && !stdout.contains("sound crosses"), "{stdout}");
    let (_, stdout, _) = outcome(Path::new("."), &["check", "--json", "--probe", "never", &airfoil]);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(json["warnings"]["none"], "", "the case as it is shipped");
    // The airfoil moves by a chord, A = 1/2, at 8/9 at most: h' = (24 t^2 - 12 t^3) / 16 at t = 4/3.
    let number = |section: &str, key: &str| json[section][key].as_f64().unwrap();
    assert!((number("motion", "amplitude A") - 0.5).abs() < 1e-9);
    assert!((number("flow", "reduced frequency") - 8.0 / 9.0).abs() < 1e-3);
    assert!((number("flow", "Strouhal number") - 8.0 / 9.0 / std::f64::consts::PI).abs() < 1e-3);
    // Blasius at Re = 1000: u_tau / U = sqrt(0.332 / sqrt(1000)).
    let wall_units = number("walls", "first cell") * 1000.0 * (0.332 / 1000.0_f64.sqrt()).sqrt();
    assert!((number("walls", "first cell in wall units") / wall_units - 1.0).abs() < 1e-12);
}

/// Whether `check` of a shipped case with other settings warns about a subject.
fn warns(case: &str, settings: &[&str], subject: &str) -> bool {
    let case = shipped(case);
    let mut arguments = vec!["check", "--json", "--probe", "never", &case];
    settings.iter().for_each(|setting| arguments.extend(["--set", setting]));
    let (code, stdout, stderr) = outcome(Path::new("."), &arguments);
    assert_eq!((code, stderr.as_str()), (0, ""), "{settings:?}");
    serde_json::from_str::<serde_json::Value>(&stdout).unwrap()["warnings"].get(subject).is_some()
}

/// Bodies were left out: a prescribed motion that starts suddenly, and walls beside them that bulge with their mesh.
#[test]
fn check_warns_of_doubtful_bodies() {
    let cylinder = "cylinder_viv.toml";
    assert!(warns(cylinder, &["bodies.cylinder.y={motion=\"0.1*t\"}"], "start of the motion"));
    assert!(!warns(cylinder, &["bodies.cylinder.y={motion=\"0.1*t^2\"}"], "start of the motion"));
    // Prescribed bodies were no motion: neither fast walls were told, nor a rest that adapted slabs may step over.
    assert!(warns(cylinder, &["bodies.cylinder.y={motion=\"2*t^2\"}"], "speed of walls"));
    let pulse = "bodies.cylinder.y={motion=\"if(t<3,0,if(t<3.3,1-cos(2*pi*(t-3)/0.3),0))\"}";
    assert!(warns(cylinder, &[pulse, "time.adaptive={tolerance=0.01}", "time.end=5"], "longest slab"));
    let (walls, subject) = ("flow.boundary.far=\"slip_wall\"", "wall beside a body");
    assert!(warns(cylinder, &[walls, "bodies.cylinder.mesh.between.outer=60"], subject));
    assert!(!warns(cylinder, &[walls], subject));
    // The gas alone feels this force.
    let gravity = "flow.source={acceleration=[0,\"-1\"]}";
    assert!(warns(cylinder, &[gravity], "body force"));
    assert!(!warns(cylinder, &[gravity, "bodies.cylinder.force=[0,-2]"], "body force"));
    assert!(!warns(cylinder, &[], "body force"));
    // A period of 2 pi (2 / spring)^1/2 in slabs of 0.2 with two nodes.
    assert!(warns(cylinder, &["bodies.cylinder.y={spring=1e3}"], "spring"));
    assert!(!warns(cylinder, &["bodies.cylinder.y={spring=4e2}"], "spring"));
    let released = "solver.steady={bodies=\"equilibrium\"}";
    assert!(warns(cylinder, &[released, "bodies.cylinder.x={}"], "equilibrium"));
    assert!(!warns(cylinder, &[released], "equilibrium"));
    for (left, is_unheld) in [("free", true), ("fixed", false)] {
        let left = format!("structure.boundary.left=\"{left}\"");
        assert_eq!(warns("elastic_piston.toml", &[released, "structure.initial={}", &left], "equilibrium"), is_unheld);
    }
    assert!(warns("cantilever.toml", &["structure.poisson_ratio=0.4999"], "Poisson's ratio"));
    // A slab of 4 D / U with two nodes, springs with a wrong sign, and stops beside the start.
    assert!(warns(cylinder, &["time.step=4"], "slab length") && !warns(cylinder, &[], "slab length"));
    assert!(warns(cylinder, &["bodies.cylinder.y={spring=-1}"], "spring"));
    let stops = |lower: f64| format!("bodies.cylinder.y={{spring=1,stops={{lower={lower},upper=2,stiffness=10}}}}");
    assert!(warns(cylinder, &[&stops(1.0)], "stops") && !warns(cylinder, &[&stops(-1.0)], "stops"));
    // The same stream stands at three places of this case.
    assert!(warns(cylinder, &["flow.boundary.far.far_field.mach=0.05"], "opening") && !warns(cylinder, &[], "opening"));
    assert!(warns(cylinder, &["flow.boundary.far.far_field.velocity=[2,0]"], "reference state"));
    // A constant that no formula contains any more.
    assert!(warns(cylinder, &["bodies.cylinder.y={spring=1}"], "constants") && !warns(cylinder, &[], "constants"));
    let free = "structure.boundary={cylinder=\"fixed\"}";
    let subject_of_pressure = "pressure on the structure";
    assert!(warns("turek_hron_fsi3.toml", &[free], subject_of_pressure));
    assert!(!warns("turek_hron_fsi3.toml", &[], subject_of_pressure));
    // These walls move along themselves.
    let beside = ["mesh.generate.box.periodic=[]", "flow.boundary.others=\"slip_wall\""];
    assert!(!warns("piston_free.toml", &beside, subject));
    // Gas sticks to these.
    let viscous = ["flow.gas.viscosity={constant=1e-3}", "flow.boundary.others={adiabatic_wall={}}", beside[0]];
    assert!(warns("piston_free.toml", &viscous, subject));
}

/// Stiff stops, pivots that were forgotten and rates at the start had no warning; a pendulum was told to have no equilibrium.
#[test]
fn check_warns_of_bodies_that_bounce_turn_and_start() {
    let (cylinder, released) = ("cylinder_viv.toml", "solver.steady={bodies=\"equilibrium\"}");
    // Contacts of pi (2 / stiffness)^1/2 in slabs of 0.2; slabs that adapt resolve them.
    let stiff = "bodies.cylinder.y={spring=1,stops={lower=-1,upper=2,stiffness=1e4}}";
    assert!(
        warns(cylinder, &[stiff], "stops") && !warns(cylinder, &[stiff, "time.adaptive={tolerance=0.01}"], "stops")
    );
    // It is the origin; here it is far from the cylinder.
    let turns = |pivot: &str| {
        format!("bodies.cylinder={{walls=[\"wall\"],mass=1,moment_of_inertia=1,pivot={pivot},rotation={{spring=1}}}}")
    };
    assert!(warns(cylinder, &[&turns("[3,0]")], "pivot") && !warns(cylinder, &[&turns("[0.4,0]")], "pivot"));
    assert!(warns(cylinder, &["bodies.cylinder.y={spring=1,rate=0.1}"], "start of the motion"));
    // A weight off the pivot holds it.
    let pendulum = |force: &str| {
        format!(
            "bodies.cylinder={{walls=[\"wall\"],mass=1,moment_of_inertia=1,centre_of_mass=[0.1,0]{force},rotation={{}}}}"
        )
    };
    assert!(warns(cylinder, &[released, &pendulum("")], "equilibrium"));
    assert!(!warns(cylinder, &[released, &pendulum(",force=[0,-1]")], "equilibrium"));
}

/// The warnings of a case, and its table of outputs.
fn checked(case: &str, settings: &[&str]) -> (serde_json::Value, serde_json::Value) {
    let case = shipped(&format!("{case}.toml"));
    let set = settings.iter().flat_map(|setting| ["--set", setting]);
    let arguments: Vec<&str> = ["check", "--json", "--probe", "never", &case].into_iter().chain(set).collect();
    let (code, stdout, stderr) = outcome(Path::new("."), &arguments);
    assert_eq!(code, 0, "{settings:?}: {stderr}");
    let mut json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    (json["warnings"].take(), json["output"].take())
}

#[test]
fn check_lists_what_is_observed_and_warns_where_there_is_nothing_to_see() {
    let inside = [
        "output.lines.a={from=[0.1,0.1],to=[0.9,0.8]}",
        "output.probes.b={at=[0.5,0.4]}",
        "output.formulas.c=\"2*pressure\"",
    ];
    let (warnings, output) = checked("free_stream", &inside);
    assert_eq!(warnings["none"], "", "{warnings}");
    for (key, name) in [("lines", "a"), ("points", "b"), ("fields by formulas", "c")] {
        assert_eq!(output[key][0], name, "{output}");
    }
    let (warnings, _) = checked("free_stream", &["output.lines.away={from=[7,7],to=[8,9]}"]);
    assert!(warnings["lines"].as_str().unwrap().contains("no point of `away`"), "{warnings}");
    let slice = |z: f64| format!("output.slices.a={{point=[0.5,0.5,{z}],normal=[0,0,1]}}");
    let (warnings, output) = checked("free_stream_3d", &[&slice(0.5)]);
    assert!(warnings["slices"].is_null() && output["slices"][0] == "a", "{warnings}");
    let (warnings, _) = checked("free_stream_3d", &[&slice(3.0)]);
    assert!(warnings["slices"].as_str().unwrap().contains("does not cut the mesh"), "{warnings}");
}

#[test]
fn check_warns_of_phases_that_the_run_does_not_meet() {
    let averages = |period: f64| format!("output.averages={{from=0,period={period},phases=4,fields=[\"velocity\"]}}");
    let end = ["time.end=1", "time.slabs=4"];
    let (warnings, _) = checked("free_stream", &[end[0], end[1], &averages(1.0)]);
    assert!(warnings["averages"].is_null(), "{warnings}");
    let (warnings, _) = checked("free_stream", &[end[0], end[1], &averages(1.5)]);
    assert!(warnings["averages"].as_str().unwrap().contains("less than their period"), "{warnings}");
}

/// Flows that the mesh does not resolve are told what keeps them stable, unless it is in use.
#[test]
fn check_advises_robust_quadrature_where_a_flow_is_not_resolved() {
    let advice = "`flow.quadrature = \"three_halves\"`";
    let tells = |case: &str, settings: &[&str], subject: &str| {
        let (warnings, _) = checked(case, settings);
        warnings[subject].as_str().is_some_and(|text| text.contains(advice))
    };
    assert!(tells("naca0012_heave", &["mesh.generate.airfoil={first_cell=0.2}"], "first cell"));
    assert!(tells("naca0012_heave", &["flow.gas.viscosity.constant=1e-7"], "turbulence"));
    assert!(!tells(
        "naca0012_heave",
        &["flow.gas.viscosity.constant=1e-7", "flow.quadrature=\"double\""],
        "turbulence"
    ));
    assert!(tells("taylor_green_3d", &["flow.quadrature=\"conserving\""], "resolution"));
    assert!(!tells("taylor_green_3d", &[], "resolution"));
}

/// The warnings about the case `text` in `directory`.
fn warnings_of(directory: &Path, text: &str, set: &[&str]) -> serde_json::Value {
    std::fs::write(directory.join("case.toml"), text).unwrap();
    let set = set.iter().flat_map(|setting| ["--set", setting]);
    let arguments: Vec<&str> = ["check", "--json", "--probe", "never", "case.toml"].into_iter().chain(set).collect();
    let (code, stdout, stderr) = outcome(directory, &arguments);
    assert_eq!(code, 0, "{stderr}");
    serde_json::from_str::<serde_json::Value>(&stdout).unwrap()["warnings"].take()
}

/// A channel at a high Reynolds number.
const CHANNEL: &str = r#"
    mesh = { order = 2, generate.box = { lower = [0, 0], upper = [2, 1], cells = [2, 2], periodic = ["x"] } }
    time = { order = 1, end = 0.01, slabs = 1 }
    [flow]
    order = 2
    gas = { mach = 0.2, viscosity = { constant = 1e-3 } }
    initial = { uniform = { velocity = [1, 0], mach = 0.2 } }
    reference = { density = 1, speed = 1, pressure = 17.857142857142858, length = 1 }
    [flow.boundary]
    others = { adiabatic_wall = {} }
"#;

/// Layers of plates that have met were measured by the layer of a plate in a stream.
#[test]
fn check_knows_no_boundary_layer_in_a_channel() {
    let directory = tempfile::TempDir::new().unwrap();
    let warnings = warnings_of(directory.path(), CHANNEL, &[]);
    assert!(warnings["first cell"].is_null() && !warnings["start of the flow"].is_null(), "{warnings}");
    let open = ["mesh.generate.box.periodic=[]", "flow.boundary.left={far_field={velocity=[1,0],mach=0.2}}"];
    let warnings = warnings_of(directory.path(), CHANNEL, &open);
    assert!(!warnings["first cell"].is_null(), "{warnings}");
}

/// A restart was told that its flow starts uniform.
#[test]
fn check_knows_that_a_restart_has_a_flow() {
    let directory = tempfile::TempDir::new().unwrap();
    let _ = warnings_of(directory.path(), CHANNEL, &[]);
    assert_eq!(outcome(directory.path(), &["run", "case.toml", "--output", "first", "--quiet"]).0, 0);
    let warnings =
        warnings_of(directory.path(), CHANNEL, &["restart={from=\"first\"}", "time={order=1,end=0.02,slabs=2}"]);
    assert!(warnings["start of the flow"].is_null(), "{warnings}");
}

/// A uniform flow along walls with slip is exact.
#[test]
fn check_accepts_an_exact_flow_along_slip_walls() {
    let exact = "flow.exact={uniform={velocity=[1,0],mach=0.2}}";
    let directory = tempfile::TempDir::new().unwrap();
    let warnings = |walls: &str| warnings_of(directory.path(), CHANNEL, &[exact, walls]);
    assert!(warnings("flow.boundary.others=\"slip_wall\"")["exact solution"].is_null());
    assert!(!warnings("flow.boundary.others={adiabatic_wall={}}")["exact solution"].is_null());
}
