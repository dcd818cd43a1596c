//! `[controls]`

use super::*;

fn with_controls(controls: &str, options: &[&str]) -> Result<AnyCase, Box<CaseError>> {
    check_text(&format!("{BASE}{controls}"), options)
}

const FORCE: &str = "[controls.force]\ninitial = \"2*a\"\nmeasure = \"mass\"\nrate = \"(measured - value)/(1 + t)\"\n";
const USED: &str = "flow.source={ acceleration = [\"3*force\", 0] }";

#[test]
fn a_control_changes_the_formulas_that_contain_it() {
    let Ok(AnyCase::Plane(case)) = with_controls(FORCE, &[USED]) else { panic!("refused") };
    let control = &case.controls[0];
    assert_eq!((control.name.as_str(), control.measure.as_str(), control.initial), ("force", "mass", 0.2));
    // c + dt (m - c) / (1 + t) with c = 0.2, m = 1.2, t = 1 and dt = 0.5.
    assert!((control.next(1.2, 1.0, 0.5) - 0.45).abs() < 1e-15);
    let source = case.flow.as_ref().unwrap().source.clone();
    let acceleration = || format!("{source:?}");
    let before = acceleration();
    control.value.set(7.0);
    assert_eq!(control.value.get(), 7.0);
    // Formulas share the number.
    assert_ne!(acceleration(), before);
}

#[test]
fn names_and_places_of_controls_are_checked() {
    for (controls, options, parts) in [
        ("[controls.a]\nmeasure = \"mass\"\nrate = 0\n", &[][..], &["controls.a", "another name"][..]),
        (FORCE, &["motion.boundary.left={ displacement = [\"force\", 0] }"], &["force"]),
        ("[controls.force]\nmeasure = \"mass\"\nrate = \"x\"\n", &[], &["controls.force.rate", "measured"]),
        ("[controls.force]\nrate = 0\n", &[], &["measure"]),
        // The message had no line, and did not say what makes the column.
        (
            "[controls.force]\nmeasure = \"momentum_x\"\nrate = 0\n",
            &[],
            &["base.toml:26", "controls.force.measure", "`output.integrals = [\"momentum_x\"]`"],
        ),
        // It was always zero, so that the control grew without limit.
        (
            "[controls.force]\nmeasure = \"momentum_z\"\nrate = \"1 - measured\"\n",
            &["output.integrals=[\"entropy\",\"momentum_z\"]"],
            &["output.integrals[1]", "the mesh is two-dimensional", "`momentum_x`, `momentum_y`"],
        ),
    ] {
        let message = with_controls(controls, options).unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
    let measures = "[controls.force]\nmeasure = \"momentum_x\"\nrate = 0\n";
    assert!(with_controls(measures, &["output.integrals=[\"entropy\",\"momentum_x\"]"]).is_ok());
}
