//! Lines with errors in the sections of the mesh and of its motion.

use super::BadLine;

pub(super) const BAD: &[BadLine] = &[
    ("left = { displacement", "left = { displacement = [0, 0 }", &["expected"]),
    ("elasticity =", "displacement = [\n0,\n0", &["the bracket of line 9 is not closed"]),
    ("order = 3", "order = 17", &["`mesh.order = 17`", "2 to 16 nodes"]),
    ("others = \"fixed\"", "", &["`motion.boundary`", "boundaries `right`, ", "of the mesh have no motion"]),
    ("elasticity =", "elasticity = { poisson_ratio = 0.5 }", &["`motion.elasticity.poisson_ratio = 0.5`", "below 0.5"]),
    (
        "elasticity =",
        "elasticity = { stiffness = { expression = \"x-1\" } }",
        &["stiffness.expression = \"x-1\"`", "positive everywhere"],
    ),
    (
        "elasticity =",
        "elasticity = { law = \"neo_hokean\" }",
        &["`motion.elasticity.law = \"neo_hokean\"`", "unknown choice `neo_hokean`", "`linear`"],
    ),
    (
        "elasticity =",
        "elasticity = { law = \"neo_hookean\", reference = \"updated\" }",
        &["`motion.elasticity.reference = \"updated\"`", "no effect with the neo-Hookean law", "initial"],
    ),
    ("elasticity =", "elasticity = { tolerance = 1e-3 }", &["elasticity.tolerance`", "no effect with the linear law"]),
    (
        "elasticity =",
        "elasticity = { law = \"neo_hookean\", tolerance = 0 }",
        &["`motion.elasticity.tolerance = 0`", "a positive number"],
    ),
    (
        "elasticity =",
        "elasticity = { law = \"neo_hookean\", tolerance = 1e-2 }",
        &["`motion.elasticity.tolerance = 1e-2`", "at most 1e-3", "1e-6"],
    ),
    ("elasticity =", "elasticity = { stiffness = { expression = \"t\" } }", &["unknown name `t`"]),
    ("elasticity =", "elasticity = { solver = \"lu\" }", &["unknown choice `lu`", "`direct`", "`multigrid`"]),
    ("elasticity =", "displacement = [0, 0]", &["`motion.boundary`", "has no effect", "remove the other"]),
    (
        "left = { displacement",
        "left = { displacement = [\"1 + t\", 0] }",
        &["`motion.boundary.left.displacement[0] = \"1 + t\"`", "t = 0", "1e0", "zero everywhere at the start"],
    ),
    (
        "left = { displacement",
        "left = { displacement = [\"t/0\", \"0*t/0\"] }",
        &["displacement[0]", "has no value at"],
    ),
    (
        "left = { displacement",
        "left = { displacement = [\"sin(t\", 0] }",
        &["displacement[0] = \"sin(t\"`", "expected `,`, `)`", "^"],
    ),
    (
        "left = { displacement",
        "left = { displacement = [0, \"speed*t\"] }",
        &["displacement[1]", "unknown name `speed`", "known here: x, y, t, a, b, pi"],
    ),
    ("left = { displacement", "left = { displacement = [0] }", &["wrong number of entries: 1", "2 entries"]),
    (
        "left = { displacement",
        "left = { displacement = [0, true] }",
        &["displacement[1] = true", "a number or a formula"],
    ),
    (
        "generate.box",
        "generate.box = { lower = [0, 0], upper = [2, 0], cells = [4, 2] }",
        &["`mesh.generate.box.upper[1] = 0`", "more than"],
    ),
    (
        "generate.box",
        "generate.box = { lower = [0], upper = [2], cells = [4] }",
        &["`mesh.generate.box.lower = [0]`", "two or three"],
    ),
    (
        "generate.box",
        "generate.box = { lower = [0, 0], upper = [2, 1], cells = [4, 0] }",
        &["cells[1] = 0`", "1 or more"],
    ),
    (
        "generate.box",
        "generate.box = { lower = [0, 0], upper = [2, 1], cells = [900000, 900000] }",
        &["cells = [900000, 900000]`", "fewer cells"],
    ),
    (
        "generate.box",
        "generate.box = { lower = [0, 0], upper = [2, 1], cells = [4, 2], curving = { smooth = { amplitude = 0.5 } } }",
        &["curving.smooth.amplitude = 0.5`", "inverted", "a smaller amplitude"],
    ),
    (
        "generate.box",
        "generate.box = { lower = [0, 0], upper = [2, 1], cells = [4, 2], periodic = [\"z\"] }",
        &["periodic[0] = \"z\"`", "two-dimensional"],
    ),
    (
        "generate.box",
        "generate.box = { lower = [0, 0], upper = [2, 1], cells = [4, 2], size_ratio = [1, -1] }",
        &["size_ratio[1] = -1`", "positive"],
    ),
    (
        "generate.box",
        "generate.annulus = { inner_radius = 1, outer_radius = 2, first_cell = 0.1, cells = [8, 2, 7] }",
        &["`mesh.generate.annulus.cells = [8, 2, 7]`", "wrong number of entries: 3", "accepted: 2 entries"],
    ),
    (
        "generate.box",
        "generate.annulus = [1, 2, 0.1, [8, 2]]",
        &["`mesh.generate.annulus = [1", "a list", "`inner_radius`"],
    ),
    ("elasticity =", "elasticity = [0.3]", &["`motion.elasticity = [0.3]`", "a list", "a table", "`poisson_ratio`"]),
    (
        "generate.box",
        "generate.box = { lower = [0, 0], upper = [2, 1], cells = [4, 2], periodic = [\"y\", \"x\", \"y\"] }",
        &["periodic[2] = \"y\"`", "axis `y` is listed twice", "remove this one"],
    ),
    (
        "left = { displacement",
        "left = { rigid = [{ translate = [\"1e20*t\", 0] }] }",
        &["`motion.boundary.left", "times the size of the mesh", "digits", "a displacement below 2.2e6"],
    ),
    (
        "left = { displacement",
        "left = { displacement = [\"(sqrt(0.5-t)-sqrt(0.5))*y*(1-y)\", 0] }",
        &["has no value", "t = 0.618"],
    ),
    (
        "generate.box",
        "generate.box = { lower = [nan, 0], upper = [2, 1], cells = [4, 2] }",
        &["lower[0] = nan`", "finite"],
    ),
    (
        "generate.box",
        "generate.box = { lower = [0, 0], upper = [2, 1e-18], cells = [4, 2] }",
        &["`mesh.generate.box.upper[1] = 1e-18`", "aspect ratio"],
    ),
    (
        "left = { displacement",
        "left = { rigid = [] }",
        &["`motion.boundary.left.rigid = []`", "without a step", "\"fixed\""],
    ),
    (
        "elasticity =",
        "elasticity = { stiffness = { inverse_jacobian = { power = 1e30 } } }",
        &["inverse_jacobian.power = 1e30`", "-10 to 10"],
    ),
    (
        "elasticity =",
        "elasticity = { stiffness = { wall_distance = { distance = 1, inner = [\"left\"], outer = [\"left\"] } } }",
        &["wall_distance.outer[0] = \"left\"`", "in `inner` too"],
    ),
    (
        "left = { displacement",
        "left = { displacement = [\"1e300\", 0] }",
        &["`motion.boundary.left.displacement[0] = \"1e300\"`", "the formula, 1e300, is out of range", "1e60"],
    ),
];
