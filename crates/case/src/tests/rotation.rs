//! Rotating frames.

use super::*;

fn with_rotation(keys: &str) -> Result<AnyCase, Box<CaseError>> {
    check_text(&BASE.replace("order = 4", &format!("order = 4\n{keys}")), &[])
}

/// The data of the source at x = 2, y = 3 and t = 5 contain the centrifugal acceleration Omega^2 r and the given one.
#[test]
fn a_rotating_frame_is_a_source() {
    let of = |keys: &str| {
        let Ok(AnyCase::Plane(case)) = with_rotation(keys) else { panic!("refused: {keys}") };
        let flow = case.flow.unwrap();
        assert!(flow.conserves_mass());
        assert_eq!(
            flow.law.source,
            navier_stokes::Source::Rotating(navier_stokes::Rotation::new([0.0, 0.0, 3.0]).unwrap())
        );
        flow.source.as_ref().and_then(Source::formulas).unwrap().evaluate::<f64, 4>(&[2.0, 3.0], 5.0)
    };
    assert_eq!(of("rotation = { rate = 3 }"), [0.0, 18.0, 27.0, 0.0]);
    assert_eq!(of("rotation = { rate = 3, centre = [1, 5] }"), [0.0, 9.0, -18.0, 0.0]);
    let with_force = "rotation = { rate = \"30*a\", centre = [1, 5] }\nsource = { acceleration = [\"t\", 7] }";
    let [_, x, y, _] = of(with_force);
    assert!((x - 14.0).abs() < 1e-13 && (y + 11.0).abs() < 1e-13, "{x} {y}");
}

/// A uniform stream is no solution in a rotating frame, nor with a force.
#[test]
fn only_without_a_source_is_a_uniform_exact_state_a_free_stream() {
    let has_free_stream = |keys: &str| {
        let exact = "exact = { uniform = { velocity = [0.5, 0], pressure = 1 } }";
        let Ok(AnyCase::Plane(case)) = with_rotation(&format!("{exact}\n{keys}")) else { panic!("refused: {keys}") };
        case.flow.unwrap().free_stream().is_some()
    };
    assert!(has_free_stream("") && has_free_stream("source = \"manufactured\""));
    assert!(!has_free_stream("rotation = { rate = 3 }") && !has_free_stream("source = { acceleration = [1, 0] }"));
}

#[test]
fn rotations_that_cannot_be_are_refused() {
    let sponge = "sponge = { strength = 1, target = { velocity = [0, 0], pressure = 1 } }";
    for (keys, parts) in [
        (&*format!("rotation = {{ rate = 3 }}\n{sponge}"), ["flow.sponge", "the rotation alone"]),
        ("rotation = { rate = 3 }\nsource = { given = { density = 1 } }", ["flow.source", "the rotation alone"]),
        ("rotation = { rate = 3, axis = [0, 0, 1] }", ["flow.rotation.axis", "two dimensions"]),
        ("rotation = { rate = 3, centre = [1] }", ["flow.rotation.centre", "2"]),
        ("rotation = { rate = inf }", ["flow.rotation.rate", "inf"]),
        ("rotation = { speed = 3 }", ["speed", "rate"]),
    ] {
        let message = with_rotation(keys).unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}
