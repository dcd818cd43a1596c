//! All errors of a case at once, and none that only follow from others.

use super::*;

/// The messages of all errors, the first line of each.
fn errors_of(text: &str, options: &[&str]) -> Vec<String> {
    let error = check_text(text, options).unwrap_err();
    error.to_string().split("\nerror: ").map(|one| one.lines().next().unwrap_or_default().to_owned()).collect()
}

fn assert_all(errors: &[String], parts: &[&str]) {
    for part in parts {
        assert!(errors.iter().any(|error| error.contains(part)), "no {part} in:\n{}", errors.join("\n"));
    }
    assert_eq!(errors.len(), parts.len(), "{}", errors.join("\n"));
}

/// BASE with these replacements.
fn edited(edits: &[(&str, &str)]) -> String {
    edits.iter().fold(BASE.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    })
}

/// Keys, types, constants, formulas, numbers out of range and names of boundaries, in all sections.
#[test]
fn sixteen_mistakes_are_told_at_once() {
    let text = edited(&[
        ("b = \"2*a\"", "b = \"2*\""),
        ("[mesh]\norder = 3", "[mesh]\norder = 40"),
        ("poisson_ratio = 0.3", "poisson_ratio = 0.6"),
        ("left = { displacement = [\"4*a*t*y*(1 - y)\", 0] }", "wing = { displacement = [\"sin(t\", \"missing*t\"] }"),
        (
            "[flow]\norder = 4",
            "[flow]\norder = 4\nriemanm = \"hllc\"\ngas = { gamma = 0.5 }\nquadrature = { points = true }",
        ),
        ("velocity = [0.5, 0]\npressure = 1", "velocity = [1]\npressure = \"0.2*\""),
        ("left = \"slip_wall\"", "lfet = \"slip_wall\"\nright = { isothermal_wall = { temperature = \"1 +\" } }"),
        ("end = 1", "end = -1"),
    ]) + "[solver]\nkrylov_restart = 0\n[output]\nevery = 0\nprobes.p = { at = [0, 0, 0] }\n";
    let parts = [
        "`constants.b",
        "`mesh.order = 40`",
        "poisson_ratio = 0.6",
        "unknown boundary `wing`",
        "wing.displacement[0]",
        "wing.displacement[1]",
        "`riemanm`",
        "gamma = 0.5",
        "quadrature.points = true",
        "uniform.pressure",
        "unknown boundary `lfet`",
        "isothermal_wall.temperature",
        "`time.end = -1`",
        "solver.krylov_restart",
        "output.every",
        "probes.p.at",
    ];
    // The velocity is in the table of the pressure, whose error hides it.
    assert_all(&errors_of(&text, &[]), &parts);
}

#[test]
fn a_wrong_initial_state_does_not_hide_motion_and_output() {
    let text = edited(&[
        ("velocity = [0.5, 0]", "velocity = [1]"),
        ("poisson_ratio = 0.3", "poisson_ratio = 0.6"),
        ("others = \"fixed\"", "others = \"fixed\"\nwing = \"fixed\""),
    ]) + "[output]\nprobes.p = { at = [1, 2, 3] }\nsurfaces.walls = [\"wing\", \"right\"]\naverages = { from = \"q\" }\n";
    let parts = [
        "uniform.velocity",
        "poisson_ratio = 0.6",
        "unknown boundary `wing`",
        "probes.p.at",
        "walls[0]",
        "walls[1]",
        "averages.from",
    ];
    assert_all(&errors_of(&text, &[]), &parts);
}

/// Signs, dimensions and names of boundaries are told beside errors on which other parts of the same sections depend.
#[test]
fn signs_dimensions_and_names_are_told_beside_damage() {
    let text = edited(&[
        ("order = 4", "order = 4\ngas.viscosity = 0.002"),
        (
            "left = \"slip_wall\"",
            "left = { no_slip = {} }\nright = { far_field = { velocity = [1, 0, 0], mach = -0.2 } }",
        ),
    ]) + "[output]\nfields = [\"cp\"]\nsurfaces.walls = [\"wing\"]\nslices.a = { point = [0, 0], normal = [0, 1] }\n";
    let parts = [
        "`flow.gas.viscosity = 0.002`",
        "unknown choice `no_slip`",
        "far_field.velocity = [1, 0, 0]",
        "far_field.mach = -0.2",
        "unknown choice `cp`",
        "unknown wall `wing`",
        "a plane through a two-dimensional mesh",
    ];
    assert_all(&errors_of(&text, &[]), &parts);
}

/// One mistake is one error, whatever depends on it.
#[test]
fn one_mistake_is_one_error() {
    for (from, to) in [
        ("a = 0.1", "a = true"),
        ("a = 0.1", "a = \"1 +\""),
        ("a = 0.1", "a = \"1/0\""),
        ("[mesh]\norder = 3", "[mesh]\nordr = 3"),
        ("[mesh]\norder = 3", "[mesh]\norder = 40"),
        ("generate.box", "generate.bax"),
        ("cells = [4, 2]", "cells = [4, 0]"),
        ("cells = [4, 2]", "cells = [4]"),
        ("upper = [2, 1]", "uper = [2, 1]"),
        ("[motion]", "[moton]"),
        ("[motion.boundary]\nleft", "[motion.boundary]\nlfet"),
        ("[flow]\norder = 4", "[flow]\nodrer = 4"),
        ("[flow]\norder = 4", "[flow]\norder = \"four\""),
        ("pressure = 1\n", "presure = 1\n"),
        ("velocity = [0.5, 0]\n", "velocity = [0.5, true]\n"),
        ("velocity = [0.5, 0]\n", "velocity = [0.5, inf]\n"),
        ("[flow.boundary]\nleft", "[flow.boundary]\nlfet"),
        ("left = \"slip_wall\"", "left = \"slip\""),
        ("end = 1", "edn = 1"),
        ("end = 1", "end = inf"),
        ("end = 1", "end = \"2*q\""),
        ("step = 0.3", "stpe = 0.3"),
        ("[time]", "[tiem]"),
        ("\"fixed\"", "\"fixd\""),
    ] {
        let errors = errors_of(&edited(&[(from, to)]), &["output.surfaces.walls=[\"left\"]"]);
        assert_eq!(errors.len(), 1, "{to}:\n{}", errors.join("\n"));
    }
}

/// A choice without settings is a name, or a name with an empty table.
#[test]
fn choices_without_settings_are_names() {
    for (from, to) in [("left = \"slip_wall\"", "left = { slip_wall = {} }"), ("\"fixed\"", "{ fixed = {} }")] {
        let case = plane(&edited(&[(from, to)]), &["flow.riemann={ hllc = {} }"]);
        assert!(case.about.resolved.contains("riemann = \"hllc\""), "{}", case.about.resolved);
    }
    let message = check_text(&edited(&[("\"slip_wall\"", "{ slip_wall = { a = 1 } }")]), &[]).unwrap_err().to_string();
    assert!(message.contains("no settings") && message.contains("\"slip_wall\""), "{message}");
}

/// The form of a value, and the place of a misplaced key, come from the schema.
#[test]
fn choices_are_shown_as_they_are_written() {
    for (edit, part) in [
        ("gas = { viscosity = \"reynolds\" }", "`{ reynolds = 1.0 }`"),
        ("gas = { viscosity = \"sutherland\" }", "`{ sutherland = { ... } }`"),
        ("gas = { reynolds = 1000 }", "`viscosity = { reynolds = ... }`"),
        ("reynolds = 1000", "`gas.viscosity = { reynolds = ... }`"),
    ] {
        let message =
            check_text(&edited(&[("order = 4", &format!("order = 4\n{edit}"))]), &[]).unwrap_err().to_string();
        assert!(message.contains(part), "no {part} in:\n{message}");
    }
}
