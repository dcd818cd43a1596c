//! Motions of boundaries and stiffness models, and their errors.

use super::*;
use coupled::{MeshMotion, MeshMover};
use mesh::NodeNumbering;
use std::f64::consts::FRAC_1_SQRT_2;

/// A square in a square; the last line defines the motion of `inner`.
const TURNING: &str = "[mesh]\norder = 3\ngenerate.rotating_box = { cells_per_side = 5 }\n[time]\norder = 2\nend = 1\nslabs = 2\n\
                       [motion]\nelasticity = {}\nboundary.outer = \"fixed\"\n";

fn turning(line: &str) -> Result<AnyCase, Box<CaseError>> {
    check_text(&format!("{TURNING}{line}"), &[])
}

/// The displacement of the inner square's C0 nodes at time 1, with their positions.
fn displacements(line: &str) -> Vec<([f64; 2], [f64; 2])> {
    let case = match turning(line) {
        Ok(AnyCase::Plane(case)) => *case,
        other => panic!("{other:?}"),
    };
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let inner = case.mesh.boundary_names().iter().position(|name| name == "inner").unwrap();
    let nodes = numbering.on_boundary(&case.mesh, inner);
    let Some(Motion::Elastic { boundary, .. }) = &case.motion else { panic!("elastic") };
    let motion = boundary[inner].as_ref().unwrap();
    let mesh = MeshMover::new(MeshMotion::Still, case.mesh.clone(), numbering, 1);
    let displacement = |node| (mesh.positions()[node], motion.displacement(node, &mesh.positions()[node], 1.0));
    nodes.into_iter().map(displacement).collect()
}

#[test]
fn a_boundary_turns_about_a_point_that_moves() {
    let line =
        "boundary.inner.rigid = [{ translate = [\"t\", 0] }, { rotate = { angle = \"pi*t\", centre = [\"t\", 0] } }]";
    for ([x, y], d) in displacements(line) {
        // Half a turn about the centre, which is at (1, 0).
        assert!((d[0] - (1.0 - 2.0 * x)).abs() < 1e-14 && (d[1] + 2.0 * y).abs() < 1e-14, "{d:?} at {x} {y}");
    }
}

#[test]
fn a_boundary_moves_along_its_normals() {
    for ([x, y], d) in displacements("boundary.inner.normal = \"0.01*t*(1 + s*(1 - s))\"") {
        let corner = x.abs() == y.abs();
        // Out of the mesh, into the square; s runs from the lower right corner upwards.
        let s = match (x > 0.0999, y > 0.0999, x < -0.0999) {
            (true, _, _) => (y + 0.1) / 0.8,
            (_, true, _) => 0.25 + (0.1 - x) / 0.8,
            (_, _, true) => 0.5 + (0.1 - y) / 0.8,
            _ => 0.75 + (x + 0.1) / 0.8,
        };
        let expected = -0.01 * (1.0 + s * (1.0 - s)) * if corner { FRAC_1_SQRT_2 } else { 1.0 };
        let found = if x.abs() >= y.abs() { d[0] * x.signum() } else { d[1] * y.signum() };
        assert!((found - expected).abs() < 1e-14, "{d:?} at {x} {y}");
    }
}

#[test]
fn a_mesh_is_stiff_by_the_distance_to_its_walls() {
    let given =
        "elasticity.stiffness.wall_distance = { distance = 0.05, inner = [\"inner\"] }\nboundary.inner = \"fixed\"";
    let text = TURNING.replace("elasticity = {}\n", "");
    let Ok(AnyCase::Plane(case)) = check_text(&format!("{text}{given}"), &[]) else { panic!("a case") };
    let Some(Motion::Elastic { stiffness, .. }) = case.motion else { panic!("elastic") };
    let inner = case.mesh.boundary_names().iter().position(|name| name == "inner").unwrap();
    let expected = Stiffness::WallDistance { amplitude: 100.0, distance: 0.05, inner: vec![inner], outer: vec![] };
    assert_eq!(stiffness, expected);
}

/// The last line of TURNING, and parts of the message.
const BAD: &[(&str, &[&str])] = &[
    ("boundary.inner.rigid = [{ turn = {} }]", &["unknown choice `turn`", "`rotate`"]),
    ("boundary.inner.rigid = [{ rotate = { centre = [0, 0] } }]", &["rigid[0].rotate", "missing key `angle`"]),
    (
        "boundary.inner.rigid = [{ rotate = { angle = \"x\" } }]",
        &["inner.rigid[0].rotate.angle = \"x\"`", "unknown name `x`", "known here: t"],
    ),
    ("boundary.inner.rigid = [{ rotate = { angle = 1 } }]", &["inner.rigid", "zero everywhere at the start"]),
    (
        "boundary.inner.rigid = [{ rotate = { angle = \"t\", centre = [0] } }]",
        &["inner.rigid[0].rotate.centre = [0]`", "2 entries"],
    ),
    (
        "boundary.inner.rigid = [{ rotate = { angle = \"t\", axis = [0, 0, 1] } }]",
        &["inner.rigid[0].rotate.axis = [0, 0, 1]`", "no axis but that along z"],
    ),
    (
        "boundary.inner.rigid = [{ translate = [0, \"1 + t\"] }]",
        &["inner.rigid", "1e0", "zero everywhere at the start"],
    ),
    (
        "boundary.inner.rigid = [{ translate = [\"t\", \"speed\"] }]",
        &["inner.rigid[0].translate[1] = \"speed\"`", "unknown name `speed`"],
    ),
    ("boundary.inner.normal = \"0.1\"", &["inner.normal = \"0.1\"`", "zero everywhere at the start"]),
    ("boundary.inner.normal = \"r*t\"", &["inner.normal = \"r*t\"`", "unknown name `r`", "known here: x, y, s, t"]),
    // A wave too much by a part moved one cell at the end of the curve, and the mesh was blamed.
    (
        "boundary.inner.normal = \"0.01*t*cos(3*pi*s)\"",
        &[
            "inner.normal",
            "the curve begins and ends at [0.09",
            "s = 0 moves by 2.361e-3 and s = 1 by -2.361e-3",
            "sin(2*pi*n*s)",
        ],
    ),
    ("boundary.inner.normal = [\"t\", 0]", &["inner.normal", "a number or a formula"]),
];

#[test]
fn what_is_wrong_with_a_motion_is_named_by_its_key() {
    for (line, expected) in BAD {
        let message = turning(line).unwrap_err().to_string();
        assert!(message.starts_with("dir/base.toml:11:"), "{message}");
        expected.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
    let open = "boundary = { others = { normal = \"s*t\" } }";
    let text = "[mesh]\norder = 2\ngenerate.box = { lower = [0, 0], upper = [1, 1], cells = [1, 1] }\n[time]\norder = 1\nend = 1\nslabs = 1\n[motion]\n";
    let message = check_text(&format!("{text}{open}"), &[]).unwrap_err().to_string();
    assert!(message.contains("others.normal = \"s*t\"`") && message.contains("along a closed curve"), "{message}");
    let periodic = text.replace("[1, 1] }", "[1, 1], periodic = [\"x\"] }");
    let message =
        check_text(&format!("{periodic}boundary.others.normal = \"t*sin(pi*x/2)\""), &[]).unwrap_err().to_string();
    assert!(message.contains("others.normal = ") && message.contains("is not periodic"), "{message}");
}

#[test]
fn what_is_wrong_with_the_wall_distance_is_named_by_its_key() {
    for (keys, expected) in [
        ("distance = 0.05, inner = []", ["wall_distance.inner = []`", "the name of a boundary"]),
        ("distance = 0.05, inner = [\"iner\"]", ["wall_distance.inner[0] = \"iner\"`", "did you mean `inner`"]),
        ("distance = 0.05, inner = [\"inner\"], outer = [\"far\"]", ["outer[0] = \"far\"`", "unknown boundary `far`"]),
        ("distance = 0, inner = [\"inner\"]", ["wall_distance.distance = 0`", "a positive number"]),
        ("distance = 1, amplitude = -1, inner = [\"inner\"]", ["wall_distance.amplitude = -1`", "a positive number"]),
        ("inner = [\"inner\"]", ["wall_distance`", "missing key `distance`"]),
    ] {
        let stiffness = format!("elasticity.stiffness.wall_distance = {{ {keys} }}");
        let text = TURNING.replace("elasticity = {}", &stiffness);
        let message = check_text(&format!("{text}boundary.inner = \"fixed\""), &[]).unwrap_err().to_string();
        assert!(message.starts_with("dir/base.toml:9:"), "{message}");
        expected.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}

#[test]
fn boundaries_that_share_a_node_must_agree_where_it_goes() {
    let square = "[mesh]\norder = 3\ngenerate.box = { lower = [0, 0], upper = [1, 2], cells = [1, 1] }\n[time]\norder = 1\nend = 1\nslabs = 1\n";
    let mesh = |left: &str, others: &str| {
        check_text(&format!("{square}[motion.boundary]\nleft.displacement = [{left}]\nothers = {others}\n"), &[])
    };
    for (left, others) in [("\"t*y\", 0", "\"fixed\""), ("\"t\", \"t\"", "{ rigid = [{ translate = [0, \"t\"] }] }")] {
        let message = mesh(left, others).unwrap_err().to_string();
        for part in [
            "dir/base.toml:10:",
            "`motion.boundary.others",
            "boundaries `left` and `",
            "share the node at [0.0, ",
            "motions that agree",
        ] {
            assert!(message.contains(part), "no {part} in:\n{message}");
        }
    }
    // They agree: zero at both corners, the same on both, or a motion that the others continue.
    assert!(mesh("\"t*y*(2 - y)\", 0", "\"fixed\"").is_ok());
    assert!(mesh("\"t\", 0", "{ rigid = [{ translate = [\"t\", 0] }] }").is_ok());
    assert!(mesh("\"t\", 0", "{ displacement = [\"t*(1 - x)\", 0] }").is_ok());
    let structure = |left: &str, top: &str| {
        let body = "[structure]\nyoung_modulus = 1\npoisson_ratio = 0.3\ndensity = 1\n[structure.boundary]\nothers = \"free\"\n";
        check_text(&format!("{square}{body}left = {left}\ntop = {top}\n"), &[])
    };
    let moves = "{ displacement = [\"t\", 0] }";
    let message = structure(moves, "\"fixed\"").unwrap_err().to_string();
    assert!(
        message.contains("`structure.boundary.top = \"fixed\"`") && message.contains("share the node at [0.0, 2.0]"),
        "{message}"
    );
    assert!(structure(moves, "{ held = [\"y\"] }").is_ok(), "the top is free along x");
}

const COLUMN: &str = "[mesh]\norder = 3\ngenerate.box = { lower = [0, 0], upper = [1, 2], cells = [2, 2] }\n[time]\norder = 1\nend = 1\nslabs = 1\n";

#[test]
fn walls_slide_in_their_planes_and_corners_move_with_their_neighbours() {
    let column = |motion: &str| check_text(&format!("{COLUMN}[motion.boundary]\n{motion}"), &[]);
    let Ok(AnyCase::Plane(case)) = column("left.displacement = [\"t/4\", 0]\nright = \"fixed\"\nothers = \"slide\"\n")
    else {
        panic!("a case")
    };
    let Some(Motion::Elastic { slides, .. }) = &case.motion else { panic!("elastic") };
    let numbering = NodeNumbering::new(&case.mesh, 3);
    let constrained = constrained(&case.mesh, &numbering, slides);
    let mesh = MeshMover::new(MeshMotion::Still, case.mesh.clone(), numbering, 1);
    for (x, constrained) in mesh.positions().iter().zip(&constrained) {
        let (at_end, at_side) = ([0.0, 1.0].contains(&x[0]), [0.0, 2.0].contains(&x[1]));
        assert_eq!(*constrained, [at_end, at_end || at_side], "{x:?}");
    }
    // 5 x 5 nodes: 15 do not lie on the ends; all are free along x, and the 9 inside along y.
    assert_eq!(case.mesh_unknowns(), Some(15 + 9));
    // The corners would leave the planes of the walls that slide.
    let message = column("left.displacement = [0, \"t/4\"]\nothers = \"slide\"\n").unwrap_err().to_string();
    for part in ["boundaries `left` and `bottom`", "share the node at [0.0, 0.0]", "[free, 0.000e0]"] {
        assert!(message.contains(part), "no {part} in:\n{message}");
    }
}

#[test]
fn what_cannot_slide_is_named() {
    let round = TURNING.replace(
        "rotating_box = { cells_per_side = 5 }",
        "annulus = { inner_radius = 1, outer_radius = 2, cells = [8, 2], first_cell = 0.5 }",
    );
    let round = round.replace("boundary.outer = \"fixed\"", "boundary.others = \"fixed\"");
    let gas = "[flow]\norder = 2\ninitial.uniform = { velocity = [0.5, 0], pressure = 1 }\nboundary.others = { adiabatic_wall = {} }\n";
    for (text, parts) in [
        (
            format!("{round}boundary.wall = \"slide\""),
            ["`motion.boundary.wall = \"slide\"`", "not in a plane normal to an axis"],
        ),
        (
            format!(
                "{}[motion.boundary]\nothers = \"slide\"",
                COLUMN.replace("[2, 2] }", "[2, 2], periodic = [\"x\"] }")
            ),
            ["`motion.boundary", "nothing holds the mesh along x"],
        ),
        (
            format!("{COLUMN}[motion.boundary]\nleft = \"fixed\"\nothers = \"slide\"\n{gas}"),
            ["`motion.boundary", "is a wall without slip"],
        ),
    ] {
        let message = check_text(&text, &[]).unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}
