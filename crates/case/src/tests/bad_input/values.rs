//! Formulas, numbers, names and sections that a case cannot use are refused.

use super::*;

/// A displacement of the whole mesh is checked over the run, like the displacement of boundaries.
#[test]
fn a_displacement_everywhere_has_a_value_that_coordinates_can_hold() {
    for (formula, parts) in [
        ("sqrt(0.5-t)-sqrt(0.5)", ["has no value at [0.0, 0.0], t = 0.618034", "over the whole run"]),
        ("1e20*t", ["times the size of the mesh", "digits"]),
    ] {
        let message =
            check_text(BASE, &[&format!("motion={{displacement=[\"{formula}\",0]}}")]).unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}

/// The initial state is checked at the nodes of the flow, not only at those of the mesh.
#[test]
fn a_state_at_the_start_that_is_none_is_named_with_cell_and_value() {
    let start = |pressure: &str| {
        let state = format!("{{expression={{density=1,velocity=[0.5,0],pressure=\"{pressure}\"}}}}");
        check_text(BASE, &[&format!("flow.initial={state}"), "flow.reference={speed=1,pressure=1}"])
    };
    let message = start("sqrt(-1-x)").unwrap_err().to_string();
    let parts =
        ["`flow.initial.expression.pressure = \"sqrt(-1-x)\"`", "the pressure in cell 0 at [0.0, 0.0], t = 0, NaN"];
    parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    // Of the nodes on a line of the first cell only those of the flow, of order 4, lie near x = 0.138.
    let message = start("1 - 2*(abs(x - 0.138) < 0.01)").unwrap_err().to_string();
    assert!(message.contains("in cell 0 at [0.138") && message.contains(", -1,"), "{message}");
}

/// Formulas of constants where numbers are needed.
#[test]
fn wrong_formulas_of_numbers_are_refused() {
    for (option, part) in [
        ("time.end=\"2*periode\"", "unknown name `periode`"),
        ("time.end=\"2*t\"", "unknown name `t`"),
        ("time.end=\"1/0\"", "inf"),
        ("flow.gas.gamma=\"1.4 1\"", "flow.gas.gamma"),
        ("flow.gas.gamma=\"1.4 - 1\"", "out of range"),
        ("time.order=\"1.5+1\"", "a whole number"),
    ] {
        let message = check_text(BASE, &[option]).unwrap_err().to_string();
        assert!(message.contains(part), "{option}: {message}");
    }
}

/// A number where a choice with a number is needed.
#[test]
fn a_number_alone_is_shown_where_it_belongs() {
    let text = BASE.replace("order = 4", "order = 4\ngas.viscosity = 0.002");
    let message = check_text(&text, &[]).unwrap_err().to_string();
    assert!(message.contains("`{ constant = 0.002 }`"), "{message}");
    let text = BASE.replace("order = 4", "order = 4\ngas.viscosity = \"1/500\"");
    let message = check_text(&text, &[]).unwrap_err().to_string();
    assert!(message.contains("`{ constant = \"1/500\" }`"), "{message}");
}

#[test]
fn a_line_that_moves_with_the_mesh_lies_in_it() {
    let line = |rest: &str| format!("output.lines.a={{from=[3,0],to=[4,1],points=5{rest}}}");
    let message = check_text(BASE, &[&line(",carried=true")]).unwrap_err().to_string();
    assert!(message.contains("output.lines.a") && message.contains("no point of it lies in the mesh"), "{message}");
    // In space it has values if the mesh comes there.
    assert!(!plane(BASE, &[&line("")]).observed.lines[0].meets(&plane(BASE, &[]).mesh));
    let across = plane(BASE, &["output.lines.a={from=[-1,0.5],to=[1,0.5],carried=true}"]);
    assert!(across.observed.lines[0].meets(&across.mesh));
}

/// Controls, a restart and stresses belong to a flow or a structure.
#[test]
fn sections_without_what_they_belong_to_are_refused() {
    let (before, rest) = BASE.split_once("[flow]").unwrap();
    let without_flow = before.to_owned() + "[time]" + rest.split_once("[time]").unwrap().1;
    for (text, option, key, accepted) in [
        (&without_flow[..], "controls.push={measure=\"t\",initial=1,rate=0}", "`controls.push", "together with [flow]"),
        (&without_flow, "restart.from=\"runs/a\"", "`restart", "together with [flow]"),
        (BASE, "output.fields=[\"density\",\"von_mises\"]", "`output.fields.1", "a section [structure]"),
        (&without_flow, "output.lines.a={from=[0,0],to=[1,1]}", "`output.lines", "together with [flow]"),
    ] {
        let message = check_text(text, &[option]).unwrap_err().to_string();
        assert!(message.contains(accepted) && (message.contains(key) || message.contains("--set")), "{message}");
    }
}

/// Two series of the same name were a failure of HDF5 in the middle of a run, or one of them was lost.
#[test]
fn names_that_the_program_gives_to_others_are_refused() {
    for name in ["mean_density", "rms_pressure", "reynolds_stress_xx", "production"] {
        let message = check_text(BASE, &[&format!("output.formulas.{name}=\"2*density\"")]).unwrap_err().to_string();
        assert!(message.contains("that no field has, nor an average"), "{message}");
    }
}
