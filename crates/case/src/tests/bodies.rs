//! Rotations of rigid bodies in space, and their errors.

use super::*;
use coupled::blocks::rigid_body::Freedom as Direction;

/// A box of gas; the lines of the body `right` follow.
const BOX: &str = r#"
[mesh]
order = 2
generate.box = { lower = [0, 0, 0], upper = [1, 1, 1], cells = [1, 1, 1] }
[flow]
order = 2
initial.uniform = { velocity = [0, 0, 0], pressure = 1 }
boundary.others = { adiabatic_wall = {} }
reference = { density = 1, speed = 1, pressure = 1 }
[time]
order = 2
end = 1
slabs = 2
[bodies.right]
mass = 2
mesh = { weight = "x" }
"#;

fn of_body(lines: &str) -> Result<AnyCase, Box<CaseError>> {
    check_text(&format!("{BOX}{lines}"), &[])
}

fn body(lines: &str) -> RigidBody<3> {
    match of_body(lines) {
        Ok(AnyCase::Space(case)) => case.bodies[0].clone(),
        Ok(AnyCase::Plane(_)) => panic!("two dimensions"),
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn a_body_turns_about_the_axes_of_space() {
    let body_of = body("inertia = [1, \"2\", 3]\nx = {}\nrotation_y = {}\nrotation_z = { spring = 4, rate = 0.1 }");
    let given: Vec<_> = body_of.freedoms.iter().map(|freedom| (freedom.name, freedom.direction)).collect();
    let expected = [
        ("x", Direction::Translation([1.0, 0.0, 0.0])),
        ("rotation_y", Direction::Rotation([0.0, 1.0, 0.0])),
        ("rotation_z", Direction::Rotation([0.0, 0.0, 1.0])),
    ];
    assert_eq!(given, expected);
    assert_eq!((body_of.freedoms[2].spring, body_of.freedoms[2].rate), (4.0, 0.1));
    assert_eq!(body_of.inertia, [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]);
    let full = body("inertia = [[2, 0.1, 0], [0.1, 2, \"-1/4\"], [0, -0.25, 3]]\nrotation_x = {}");
    assert_eq!(full.inertia, [[2.0, 0.1, 0.0], [0.1, 2.0, -0.25], [0.0, -0.25, 3.0]]);
}

#[test]
fn a_rotation_about_one_axis_has_one_moment() {
    let body = body("moment_of_inertia = 3\naxis = [0, 3, 4]\nrotation = {}");
    assert_eq!(body.freedoms[0].direction, Direction::Rotation([0.0, 0.6, 0.8]));
    assert_eq!(body.inertia, [[3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 3.0]]);
}

/// After its release nothing is asked of the motion.
#[test]
fn a_motion_needs_values_until_its_release() {
    let motion = |release: &str| format!("x = {{ motion = \"0.1*t^2*sqrt(0.7-t)\"{release} }}");
    assert!(of_body(&motion(", release = 0.5")).is_ok());
    assert!(of_body(&motion("")).is_err());
}

/// Lines of the body, and parts of the message.
const BAD: &[(&str, &[&str])] = &[
    ("rotation_x = {}", &["bodies.right", "a body with `rotation_x` has no tensor of inertia", "`inertia`, about"]),
    ("moment_of_inertia = 1\nrotation_z = {}", &["a body with `rotation_z` has no tensor of inertia"]),
    (
        "inertia = [1, 2, 3]\nrotation = {}\nrotation_y = {}",
        &["bodies.right.rotation", "`rotation` and `rotation_y` both turn the body", "`rotation` about `axis`, or"],
    ),
    (
        "inertia = [1, 2, 3]\naxis = [0, 0, 1]\nrotation_y = {}",
        &["bodies.right.axis", "`rotation_y` is about an axis of space"],
    ),
    (
        "inertia = [1, 2, 3]\nmoment_of_inertia = 1\nrotation_y = {}",
        &["bodies.right.inertia", "both say how hard", "`moment_of_inertia` with `rotation`"],
    ),
    ("inertia = [1, 2]\nrotation_x = {}", &["right.inertia = [1, 2]`", "wrong number of entries: 2", "3 entries"]),
    ("inertia = [1, -2, 3]\nrotation_x = {}", &["right.inertia[1] = -2`", "inertia, -2,", "a positive number"]),
    ("inertia = [1, [0, 2, 0], 3]\nrotation_x = {}", &["right.inertia", "numbers stand beside rows", "three rows"]),
    (
        "inertia = [[1, 0, 0], [0, 1], [0, 0, 1]]\nrotation_x = {}",
        &["right.inertia[1] = [0, 1]`", "wrong number of entries: 2"],
    ),
    (
        "inertia = [[1, 0, 0], [0.5, 1, 0], [0, 0, 1]]\nrotation_x = {}",
        &["right.inertia[1][0] = 0.5`", "other side of the diagonal is 0", "a symmetric tensor"],
    ),
    (
        "inertia = [[1, 2, 0], [2, 1, 0], [0, 0, 1]]\nrotation_x = {}",
        &["right.inertia", "leading minors [1.0, -3.0, -3.0]", "a positive definite tensor"],
    ),
    (
        "inertia = [0.1, 0.1, 0.5]\nrotation_x = {}",
        &["right.inertia", "no moment is larger than the sum of the other two"],
    ),
    // Its principal moments are 0.59, 0.01 and 0.02; the diagonal alone was compared.
    (
        "inertia = [[0.3, 0.29, 0], [0.29, 0.3, 0], [0, 0, 0.02]]\nrotation_x = {}",
        &["right.inertia", "no principal moment is larger than the sum of the other two"],
    ),
    (
        "inertia = [1, 1, 1]\nrotation_x = { rest = 0.1 }",
        &["right.rotation_x.rest", "no effect", "`spring` or `cubic_spring`"],
    ),
    (
        "inertia = [1, 1, 1]\nrotation_x = { motion = \"0\", release = -1 }",
        &["right.rotation_x.release", "comes before the run", "neither of the two keys"],
    ),
    ("moment_of_inertia = 1\ny = {}", &["right.moment_of_inertia", "has no effect", "`rotation = {}`"]),
    ("inertia = [1, 1, 1]\ny = {}", &["right.inertia", "has no effect", "together with `rotation`"]),
    ("axis = [1, 0, 0]\ny = {}", &["right.axis", "no coordinate that turns it"]),
    ("inertia = true\nrotation_x = {}", &["right.inertia = true`", "wrong type"]),
    ("inertia = [true, 1, 1]\nrotation_x = {}", &["right.inertia[0] = true`", "a number, a formula in quotes"]),
];

#[test]
fn what_is_wrong_with_a_rotation_is_named_by_its_key() {
    for (lines, expected) in BAD {
        let message = of_body(lines).unwrap_err().to_string();
        expected.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}

#[test]
fn in_the_plane_a_body_turns_about_z_alone() {
    let plane = BOX.replace("[0, 0, 0]", "[0, 0]").replace("[1, 1, 1]", "[1, 1]");
    let message = |lines: &str| check_text(&format!("{plane}{lines}"), &[]).unwrap_err().to_string();
    let turning = message("inertia = [1, 1, 1]\nrotation_x = {}");
    assert!(turning.contains("right.rotation_x") && turning.contains("two-dimensional"), "{turning}");
    let tensor = message("inertia = [1, 1, 1]\nrotation = {}");
    assert!(tensor.contains("right.inertia") && tensor.contains("`moment_of_inertia`"), "{tensor}");
}
