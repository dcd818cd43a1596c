//! Conditions of boundaries over the run.

use super::*;

/// A box that moves by `displacement`, with a `condition` on its right side.
fn moved_box(displacement: &str, condition: &str) -> Result<AnyCase, Box<CaseError>> {
    let text = format!(
        r#"
        mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [2, 1], cells = [4, 2] }} }}
        motion.displacement = [{displacement}]
        time = {{ order = 2, end = 1, slabs = 1 }}
        [flow]
        order = 4
        initial = {{ uniform = {{ velocity = [0.1, 0], pressure = 1 }} }}
        [flow.boundary]
        right = {{ {condition} }}
        others = "slip_wall"
        "#
    );
    check_text(&text, &[])
}

/// A quarter turn about the origin.
const TURN: &str = r#""x*cos(pi/2*t^2) - y*sin(pi/2*t^2) - x", "x*sin(pi/2*t^2) + y*cos(pi/2*t^2) - y""#;

fn refused(displacement: &str, condition: &str, parts: [&str; 3]) {
    let message = moved_box(displacement, condition).unwrap_err().to_string();
    parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
}

/// Walls were compared with their normals at the start alone.
#[test]
fn walls_slide_in_their_present_plane() {
    let slide = |formulas: &str| format!("adiabatic_wall = {{ slide = [{formulas}] }}");
    moved_box(TURN, &slide(r#""-sin(pi/2*t^2)", "cos(pi/2*t^2)""#)).unwrap();
    let parts = ["flow.boundary.right.adiabatic_wall.slide", "does not slide in its plane", "t = 0.236068"];
    refused(TURN, &slide("0, 1"), parts);
    let message = message_with("left = \"slip_wall\"", "left = { adiabatic_wall = { slide = [0, 1] } }");
    assert!(message.contains("does not slide in its plane"), "the wall of BASE bends: {message}");
}

/// Formulas are taken at the present position.
#[test]
fn values_are_checked_where_the_boundary_is() {
    let wall = "isothermal_wall = { temperature = \"2.5 - x\" }";
    moved_box("0, \"t^2\"", wall).unwrap();
    let parts = ["flow.boundary.right.isothermal_wall.temperature", "t = 0.854102", "positive everywhere"];
    refused("\"t^2\", 0", wall, parts);
}

/// The velocity outside followed the normal at the start while the boundary turned.
#[test]
fn outflows_with_a_relaxation_keep_their_direction() {
    let outflow = "outflow = { pressure = 1, velocity = [0.1, 0], relaxation = 1 }";
    moved_box("\"t^2\", \"t^2\"", outflow).unwrap();
    refused(TURN, outflow, ["flow.boundary.right.outflow.relaxation", "the boundary turns", "t = 0.236068"]);
}

/// A control keeps its first number in the checks.
#[test]
fn controls_are_checked_with_their_first_number() {
    let with = |formula: &str| {
        let controls = "[controls.c]\ninitial = 1\nmeasure = \"mass\"\nrate = \"-9\"\n[flow]\norder";
        let condition = format!("left = {{ outflow = {{ pressure = \"{formula}\" }} }}");
        check_text(&BASE.replace("left = \"slip_wall\"", &condition).replace("[flow]\norder", controls), &[])
    };
    with("c + y - 0.9*t").unwrap();
    assert!(with("c - y - 0.9*t").unwrap_err().to_string().contains("positive everywhere"));
}
