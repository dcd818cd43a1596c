//! Outflows that let sound pass.

use super::*;
use crate::checked::Data;
use navier_stokes::Outflow;

fn with_outflow(keys: &str) -> Result<AnyCase, Box<CaseError>> {
    check_text(
        &at_rest().replace("left = \"slip_wall\"", &format!("left = {{ outflow = {{ pressure = 1, {keys} }} }}")),
        &[],
    )
}

fn outflow(keys: &str) -> Case<2> {
    match with_outflow(keys) {
        Ok(AnyCase::Plane(case)) => *case,
        Ok(AnyCase::Space(_)) => panic!("three dimensions"),
        Err(error) => panic!("{error}"),
    }
}

/// The data of the left boundary at x = 2, y = 3 and t = 5.
fn data(case: &Case<2>) -> [f64; 4] {
    case.flow.as_ref().unwrap().boundary[0].data.as_ref().map(|data: &Data<2>| data.at(&[2.0, 3.0], 5.0)).unwrap()
}

#[test]
fn the_velocity_outside_is_data() {
    let case = outflow("total_temperature = 3, velocity = [\"-y\", \"t\"]");
    assert_eq!(case.flow.as_ref().unwrap().boundary[0].condition, Boundary::Outflow(Outflow::of_velocity()));
    assert_eq!(data(&case), [1.0, -3.0, 5.0, 3.0]);
    assert!(case.controls.is_empty());
}

/// On the left boundary the normal is [-1, 0].
#[test]
fn with_a_relaxation_the_velocity_outside_follows_the_mean() {
    let case = outflow("total_temperature = 3, velocity = [-2.5, 0], relaxation = 4");
    let [control] = &case.controls[..] else { panic!("{:?}", case.controls) };
    assert_eq!((control.name.as_str(), control.measure.as_str()), ("left_stream", "left_velocity"));
    assert!((control.initial - 2.5).abs() < 1e-14, "{}", control.initial);
    let [pressure, x, y, temperature] = data(&case);
    assert_eq!((pressure, y.abs(), temperature), (1.0, 0.0, 3.0));
    assert!((x + 2.5).abs() < 1e-14);
    // An exponential memory, which no step can make swing.
    assert!((control.next(1.5, 0.0, 4.0) - (1.5 + (-1.0_f64).exp())).abs() < 1e-14);
    assert!((control.next(1.5, 0.0, 4e3) - 1.5).abs() < 1e-14);
    control.value.set(0.75);
    assert_eq!(data(&case)[1], -0.75);
}

/// The profile and the velocity along the boundary were dropped. The normal velocity at the start is 2 + y, with a mean of 2.5.
#[test]
fn with_a_relaxation_the_velocity_outside_keeps_its_profile() {
    let case = outflow("velocity = [\"-2 - y\", 7], relaxation = 4");
    let control = &case.controls[0];
    assert!((control.initial - 2.5).abs() < 1e-14, "{}", control.initial);
    let check = |expected: [f64; 2]| {
        let [_, x, y, _] = data(&case);
        assert!((x - expected[0]).abs() < 1e-14 && y == expected[1], "{x} {y}");
    };
    check([-5.0, 7.0]);
    control.value.set(3.0);
    check([-5.5, 7.0]);
    let uniform = outflow("velocity = [-2.5, 7], relaxation = 4");
    assert_eq!(data(&uniform)[1..3], [-2.5, 7.0]);
}

/// The mean over nodes was 0.052 on these cells, which are 20 times as small at the walls. The mean over the area is 0.6 / 6.
#[test]
fn the_velocity_outside_is_at_first_a_mean_over_the_area() {
    let case = plane(
        r#"
        mesh = { order = 2, generate.channel = { extent = [1, 1], cells = [2, 16], wall_ratio = 20 } }
        time = { order = 2, end = 1, slabs = 1 }
        [flow]
        order = 4
        initial = { uniform = { velocity = [0.1, 0], pressure = 1 } }
        [flow.boundary]
        outflow = { outflow = { pressure = 1, velocity = ["0.6*y*(1-y)", 0], relaxation = 50 } }
        others = "slip_wall"
        "#,
        &[],
    );
    assert!((case.controls[0].initial - 0.1).abs() < 1e-14, "{}", case.controls[0].initial);
}

#[test]
fn relaxations_that_cannot_be_are_refused() {
    for (keys, parts) in [
        ("relaxation = 4", ["flow.boundary.left.outflow.relaxation", "together with `velocity`"]),
        ("velocity = [1, 0], relaxation = 0", ["flow.boundary.left.outflow.relaxation", "positive"]),
        ("velocity = [\"-1-t\", 0], relaxation = 4", ["flow.boundary.left.outflow.velocity[0]", "without `t`"]),
        ("velocity = [1]", ["flow.boundary.left.outflow.velocity", "2"]),
        ("velocity = [\"1/y\", 0]", ["flow.boundary.left.outflow.velocity", "finite everywhere"]),
    ] {
        let message = with_outflow(keys).unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
    let round = BASE
        .replace(
            "generate.box = { lower = [0, 0], upper = [2, 1], cells = [4, 2] }",
            "generate.disc = { radius = 1, core_cells = 2, radial_cells = 1 }",
        )
        .replace(
            "far_field = { velocity = [0.5, 0], pressure = 1 }",
            "outflow = { pressure = 1, velocity = [1, 0], relaxation = 1 }",
        );
    let round: Vec<&str> = round.lines().filter(|line| !line.starts_with("left")).collect();
    let message = check_text(&round.join("\n"), &[]).unwrap_err().to_string();
    assert!(message.contains("a plane boundary, the same normal everywhere"), "{message}");
}
