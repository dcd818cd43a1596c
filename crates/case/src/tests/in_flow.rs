//! Bodies and structures that a flow moves, and their errors.

use super::*;

/// Gas in a box with a bar of the height of the box.
const BAR: &str = r#"
time = { order = 2, end = 1, slabs = 2 }
motion.boundary.others = "fixed"
[mesh]
order = 2
generate.box = { lower = [0, 0], upper = [3, 1], cells = [3, 1], regions.bar = { lower = [1, 0], upper = [2, 1] } }
[flow]
order = 2
initial.uniform = { velocity = [0, 0], pressure = 1 }
reference = { density = 1, speed = 1, pressure = 1 }
boundary.others = "slip_wall"
[structure]
regions = ["bar"]
density = 1
young_modulus = 1
poisson_ratio = 0.3
boundary.bottom = "fixed"
boundary.top = "fixed"
"#;

/// Gas in a box; the right wall is a body.
const PISTON: &str = r#"
time = { order = 2, end = 1, slabs = 2 }
[mesh]
order = 2
generate.box = { lower = [0, 0], upper = [1, 1], cells = [1, 1] }
[flow]
order = 2
initial.uniform = { velocity = [0, 0], pressure = 1 }
reference = { density = 1, speed = 1, pressure = 1 }
boundary.others = "slip_wall"
[bodies.right]
mass = 1
mesh = { weight = "x" }
"#;

/// BAR without its gas.
fn bar_alone() -> String {
    let (before, rest) = BAR.split_once("[flow]").unwrap();
    let (mesh, structure) =
        (before.replace("motion.boundary.others = \"fixed\"", ""), rest.split_once("[structure]").unwrap().1);
    format!("{mesh}[structure]{structure}boundary.rest = \"free\"\n")
}

/// Walls that a structure moves wanted an entry, and the message listed motions that were refused then.
#[test]
fn walls_of_a_structure_need_no_motion() {
    let others =
        |motion: &str| BAR.replace("motion.boundary.others = \"fixed\"", &format!("motion.boundary = {motion}"));
    let sides = ["left", "right", "bottom", "top"].map(|side| format!("{side} = \"fixed\"")).join(", ");
    assert_accepted(&others(&format!("{{ {sides} }}")), &[&[]]);
    let Ok(AnyCase::Plane(case)) = check_text(&others("{ others = \"slide\" }"), &[]) else { panic!("refused") };
    let Some(Motion::Elastic { slides, .. }) = &case.motion else { panic!("elastic") };
    let names = case.mesh.boundary_names();
    let held: Vec<&str> =
        names.iter().zip(slides).filter(|(_, held)| held.is_none()).map(|(name, _)| &**name).collect();
    assert_eq!(held, ["bar"]);
    let missing = "{ left = \"fixed\" }";
    assert_refused(&others(missing), &[(&[], &["`motion.boundary`", "boundaries `right`, ", "have no motion"])]);
}

const EQUILIBRIUM: &str = "solver.steady.bodies=\"equilibrium\"";

/// Checks that `text` with the options of each entry is refused, with the parts of the message.
fn assert_refused(text: &str, refused: &[(&[&str], &[&str])]) {
    for (options, parts) in refused {
        let message = check_text(text, options).unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "{options:?}: no {part} in:\n{message}"));
    }
}

fn assert_accepted(text: &str, accepted: &[&[&str]]) {
    for options in accepted {
        let checked = check_text(text, options);
        assert!(checked.is_ok(), "{options:?}: {}", checked.unwrap_err());
    }
}

/// A load on `others` was lost, because walls to the flow are free where they are not named.
#[test]
fn others_of_a_structure_stand_for_a_boundary() {
    let whole = "structure.boundary={others=\"fixed\"}";
    let load = "structure.boundary.rest={follower_pressure=-10}";
    assert_accepted(BAR, &[&[], &[whole], &[load]]);
    let lost = "structure.boundary.others={follower_pressure=-10}";
    let at_others: &[&str] = &["structure.boundary.others", "stands for no boundary", "by name, `rest`"];
    assert_refused(BAR, &[(&[lost], at_others), (&[lost, load], at_others)]);
    let alone = bar_alone();
    let accepted: &[&str] = &["stands for no boundary", "accepted: no such key"];
    assert_accepted(&alone, &[&[]]);
    assert_refused(&alone, &[(&["structure.boundary.others=\"free\""], accepted)]);
}

/// Both were told that they need a point in the mesh, in which they were.
#[test]
fn points_lie_in_the_structure_and_probes_in_the_flow() {
    assert_accepted(BAR, &[&["structure.points.p=[1.5,0.5]", "output.probes.p.at=[0.5,0.5]"]]);
    assert_refused(
        BAR,
        &[
            (&["structure.points.p=[0.5,0.5]"], &["structure.points.p", "a point inside the structure"]),
            (&["output.probes.p.at=[1.5,0.5]"], &["output.probes.p.at", "a point inside the flow"]),
        ],
    );
}

/// The rate of sqrt(t) at t = 0 is infinite. Those of sqrt(t^3), and of a root whose argument does not change, were taken for 0/0.
#[test]
fn prescribed_motions_have_a_rate() {
    let driven = |motion: &str| format!("bodies.right.x={{motion=\"{motion}\"}}");
    assert_accepted(PISTON, &[&[&driven("0.05*t^1.5")], &[&driven("0.05*t^2")], &[&driven("0.05*sqrt(t^3)")]]);
    let parts: &[&str] = &["bodies.right.x.motion", "the rate of the motion at t = 0, inf,", "rate is finite"];
    assert_refused(PISTON, &[(&[&driven("0.05*sqrt(t)")], parts)]);
    let alone = bar_alone();
    let moved = |motion: &str| format!("structure.boundary.top={{displacement=[0,\"{motion}\"]}}");
    let parts: &[&str] =
        &["structure.boundary.top.displacement[1]", "the rate of the displacement at [1.0, 1.0] at t = 0, inf,"];
    let accepted: &[&[&str]] =
        &[&[&moved("t^1.5")], &[&moved("t*sqrt(x-x)")], &[&moved("sqrt(t)"), "structure.analysis=\"static\""]];
    assert_accepted(&alone, accepted);
    assert_refused(&alone, &[(&[&moved("sqrt(t)")], parts)]);
}

/// Radians are not compared with the size of the mesh.
#[test]
fn an_angle_starts_at_zero_in_meshes_of_any_size() {
    let large = PISTON.replace("upper = [1, 1]", "upper = [1e9, 1e9]").replace("\"x\"", "\"x/1e9\"");
    let jump: &[&str] = &["bodies.right.moment_of_inertia=1", "bodies.right.rotation={motion=\"1e-4+t\"}"];
    assert_refused(&large, &[(jump, &["the motion at the start, 0.0001,", "zero at the start"])]);
    assert_accepted(&large, &[&["bodies.right.x={motion=\"1e-4+t\"}"]]);
}

/// The flow was blamed for a force without a value.
#[test]
fn a_force_has_a_value_over_the_whole_run() {
    let force = |x: &str| format!("bodies.right.force=[\"{x}\",0]");
    let parts: &[&str] = &["bodies.right.force[0]", "the force at t = 0, ", "finite over the whole run"];
    let free = "bodies.right.x={}";
    assert_accepted(PISTON, &[&[free, &force("1/(1+t)")]]);
    assert_refused(PISTON, &[(&[free, &force("sqrt(-1)")], parts), (&[free, &force("1/t")], parts)]);
    let table = "tables.gust={t=[0,0.1,0.3,0.5],values=[1,2,2,1]}";
    assert_refused(
        PISTON,
        &[(&[free, table, &force("gust(t)")], &["bodies.right.force[0]", "the force at t = 0.618"])],
    );
}

/// The run starts at rest.
#[test]
fn rates_have_no_effect_on_a_start_in_equilibrium() {
    let body = "bodies.right.x={spring=1,rate=0.5}";
    let structure = "structure.initial.velocity=[\"0\",\"y*(1-y)\"]";
    assert_accepted(PISTON, &[&[body]]);
    assert_accepted(BAR, &[&[structure], &[EQUILIBRIUM]]);
    let parts: &[&str] = &["bodies.right.x.rate", "has no effect with `solver.steady.bodies", "remove it"];
    assert_refused(PISTON, &[(&[EQUILIBRIUM, body], parts)]);
    let parts: &[&str] = &["structure.initial.velocity", "has no effect with `solver.steady.bodies", "remove it"];
    assert_refused(BAR, &[(&[EQUILIBRIUM, structure], parts)]);
}
