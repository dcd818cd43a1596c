//! Structures without a flow, and their errors.

use super::*;

/// A comparison with NaN is false, so NaN needs a check of its own.
#[test]
fn the_start_of_a_structure_is_finite() {
    let text = "[mesh]\norder = 2\ngenerate.box = { lower = [0,0], upper = [1,1], cells = [1,1] }\n[time]\norder = 1\nend = 1\nslabs = 1\n\
                [structure]\nyoung_modulus = 1\npoisson_ratio = 0.3\ndensity = 1\nboundary.others = \"free\"\n";
    assert!(check_text(text, &[]).is_ok());
    for name in ["displacement", "velocity"] {
        let message =
            check_text(text, &[&format!("structure.initial.{name}=[0,\"sqrt(-1)\"]")]).unwrap_err().to_string();
        let parts = [format!("structure.initial.{name}[1]"), format!("the {name} in cell 0 at [0.0, 0.0], NaN")];
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}

/// Independent errors of a structure are told together.
#[test]
fn all_errors_of_a_structure_are_told() {
    let text = "[mesh]\norder = 2\ngenerate.box = { lower = [0,0], upper = [1,1], cells = [1,1] }\n[time]\norder = 1\nend = 1\nslabs = 1\n\
                [structure]\nyoung_modulus = -1\npoisson_ratio = 0.3\nboundary.others = \"free\"\n\
                initial.displacement = [\"a\", 0]\npoints.tip = [7, 0]\n";
    let message = check_text(text, &[]).unwrap_err().to_string();
    for part in ["structure.young_modulus = -1", "`density`", "unknown name `a`", "structure.points.tip"] {
        assert!(message.contains(part), "no {part} in:\n{message}");
    }
}

/// Keys of structures that exclude each other, and numbers out of range.
#[test]
fn laws_and_damping_of_a_structure() {
    let text = "[mesh]\norder = 2\ngenerate.box = { lower = [0,0], upper = [1,1], cells = [1,1] }\n[time]\norder = 1\nend = 1\nslabs = 1\n\
                [structure]\nyoung_modulus = 1\npoisson_ratio = 0.3\ndensity = 1\nboundary.others = \"free\"\n";
    let good = [
        "structure.law=\"neo_hookean\"",
        "structure.damping={mass=0.1}",
        "structure.boundary.left={follower_pressure=\"t\"}",
    ];
    assert!(check_text(text, &good).is_ok());
    let (stress, fixed) = ("structure.plane=\"stress\"", "structure.analysis=\"static\"");
    let cases: [(&[&str], &str); 3] = [
        (
            &["structure.law=\"st_venant_kirchhoff\"", stress],
            "`structure.plane = \"stress\"` is for the linear law only",
        ),
        (&["structure.damping={stiffness=1e-3}", fixed], "`structure.damping` has no effect on a static analysis"),
        (&["structure.damping={mass=-1}"], "structure.damping.mass"),
    ];
    for (options, part) in cases {
        let message = check_text(text, options).unwrap_err().to_string();
        assert!(message.contains(part), "no {part} in:\n{message}");
    }
}
