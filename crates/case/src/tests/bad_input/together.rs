//! Errors that do not depend on each other are told together.

use super::*;

/// Sections that do not depend on each other have their errors reported at once, each with its place.
#[test]
fn errors_of_several_sections_are_told_at_once() {
    let text = BASE.replace("order = 2", "order = 0").replace("order = 4", "order = 4\nquadrature = { points = 2 }");
    let error = check_text(&text, &["solver.krylov_restart=0", "output.every=0"]).unwrap_err();
    let message = error.to_string();
    assert_eq!(error.also.len(), 3, "{message}");
    for part in ["flow.quadrature.points", "`time.order = 0`", "solver.krylov_restart", "output.every"] {
        assert!(message.contains(part), "{message}");
    }
    let error = check_text(&text.replace("order = 0", "order = 2"), &["output.every=0"]).unwrap_err();
    assert!(error.to_string().contains("flow.quadrature.points") && error.also.len() == 1, "{error}");
}

/// Errors of keys and types are reported at once, in the order of their lines, and nothing that only follows from them.
#[test]
fn errors_of_keys_and_types_are_told_at_once() {
    let text = BASE
        .replace("order = 2", "order = 2\nstepp = 1")
        .replace("order = 4", "order = \"four\"\nriemann = \"hlc\"\ngas.gama = 1.3\ngas.prandtl = true")
        + "\n[solver]\nnewton_stepps = 4\n";
    let error = check_text(&text, &["output.every=0.5"]).unwrap_err();
    let message = error.to_string();
    for part in [
        "`flow.order",
        "unknown choice `hlc`",
        "`gama`",
        "flow.gas.prandtl",
        "`stepp`",
        "`newton_stepps`",
        "output.every",
    ] {
        assert!(message.contains(part), "no {part} in:\n{message}");
    }
    assert_eq!(error.also.len(), 6, "{message}");
    let lines: Vec<usize> = std::iter::once(&*error)
        .chain(&error.also)
        .filter_map(|error| if let Place::File { line, .. } = &error.place { Some(*line) } else { None })
        .collect();
    assert!(lines.is_sorted() && lines.len() == 6, "{lines:?}");
}

/// A misspelt key of a section on which nothing depends does not hide errors of values.
#[test]
fn a_misspelt_key_of_the_output_does_not_hide_wrong_values() {
    let text = BASE.replace("order = 2", "order = 0");
    let error = check_text(&text, &["output.evry=2"]).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("time.order = 0") && message.contains("unknown key `evry`"), "{message}");
    assert_eq!(error.also.len(), 1, "{message}");
}

/// Boundaries, and parts of the flow that do not depend on each other.
#[test]
fn errors_within_the_flow_are_told_at_once() {
    let text = BASE.replace("order = 4", "order = 17\nquadrature = { points = 99 }").replace(
        "left = \"slip_wall\"",
        "left = { outflow = { pressure = -1 } }\nright = { adiabatic_wall = { slide = [1] } }",
    );
    let error = check_text(&text, &[]).unwrap_err();
    let message = error.to_string();
    for part in ["flow.order = 17", "quadrature.points = 99", "left.outflow.pressure", "right.adiabatic_wall.slide"] {
        assert!(message.contains(part), "no {part} in:\n{message}");
    }
    assert_eq!(error.also.len(), 3, "{message}");
}

/// A mesh that cannot be made does not hide the errors of sections without a mesh.
#[test]
fn a_bad_mesh_does_not_hide_the_time() {
    let text = BASE.replace("order = 3", "order = 17").replace("order = 2", "order = 0");
    let error = check_text(&text, &[]).unwrap_err();
    assert!(error.to_string().contains("mesh.order = 17") && error.to_string().contains("time.order = 0"), "{error}");
}

/// `others` is checked for each boundary that it stands for, and its error is reported once.
#[test]
fn an_error_of_all_other_boundaries_is_told_once() {
    let text = BASE.replace(
        "others = { far_field = { velocity = [0.5, 0], pressure = 1 } }",
        "others = { outflow = { pressure = -1 } }",
    );
    let error = check_text(&text, &[]).unwrap_err();
    let message = error.to_string();
    assert_eq!(message.matches("flow.boundary.others.outflow").count(), 1, "{message}");
    assert!(error.also.is_empty(), "{message}");
    // Different errors of the same kind stay.
    let both = text.replace("left = \"slip_wall\"", "left = { outflow = { pressure = -2 } }");
    assert_eq!(check_text(&both, &[]).unwrap_err().also.len(), 1);
}

/// A wrong time does not hide what is wrong with the flow.
#[test]
fn a_bad_time_does_not_hide_the_flow() {
    let error = check_text(BASE, &["time.order=99", "flow.order=0", "flow.gas.gamma=0.5"]).unwrap_err().to_string();
    for part in ["time.order=99", "flow.order=0", "flow.gas.gamma=0.5"] {
        assert!(error.contains(part), "no {part} in {error}");
    }
}
