//! Errors of a case name their cause.

use super::super::error::Place;
use super::*;

/// A line of BASE, its replacement, and parts of the message besides file and line.
const BAD: &[(&str, &str, &[&str])] = &[
    ("order = 4", "ordr = 4", &["`flow.ordr = 4`", "unknown key `ordr`", "`quadrature`", "did you mean `order`"]),
    ("order = 4", "order = \"four\"", &["`flow.order = \"four\"`", "unknown name `four`"]),
    ("order = 4", "order = 1", &["`flow.order = 1`", "2 to 16 nodes"]),
    ("order = 4", "order = 17", &["`flow.order = 17`", "2 to 16 nodes"]),
    ("order = 4", "order = -4", &["`flow.order = -4`", "a whole number"]),
    ("order = 4", "order = 18446744073709551615", &["`flow.order = 18446744073709551615`", "below 2^63"]),
    ("order = 4", "order = 1000000000000000000000", &["1000000000000000000000`", "below 2^63"]),
    ("order = 4", "", &["`flow`", "missing key `order`"]),
    ("order = 4", "order = ", &["expected"]),
    ("left = { displacement", "left = { displacement = [0, 0 }", &["expected"]),
    ("elasticity =", "displacement = [\n0,\n0", &["the bracket of line 9 is not closed"]),
    ("order = 4", "order = 4\norder = 5", &["duplicate key"]),
    ("order = 3", "order = 17", &["`mesh.order = 17`", "2 to 16 nodes"]),
    ("order = 2", "order = 0", &["`time.order = 0`", "1 to 16 nodes"]),
    (
        "left = \"slip_wall\"",
        "lfet = \"slip_wall\"",
        &["`flow.boundary.lfet", "unknown boundary `lfet`", "`right`", "did you mean `left`"],
    ),
    (
        "left = \"slip_wall\"",
        "left = \"slip\"",
        &["`flow.boundary.left = \"slip\"`", "unknown choice `slip`", "`slip_wall`"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { supersonic_outflow = {} }",
        &["unknown choice `supersonic_outflow`", "did you mean `outflow`"],
    ),
    ("left = \"slip_wall\"", "left = \"adiabatic_wall\"", &["settings in a table"]),
    (
        "left = \"slip_wall\"",
        "left = \"exact\"",
        &["`flow.boundary.left = \"exact\"`", "no exact solution", "`flow.exact`"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { isothermal_wall = { temperature = 0 } }",
        &["`flow.boundary.left.isothermal_wall.temperature = 0`", "a positive number"],
    ),
    ("left = \"slip_wall\"", "left = { outflow = { pressure = -1 } }", &["outflow.pressure", "positive"]),
    (
        "left = \"slip_wall\"",
        "left = { adiabatic_wall = { slide = [1] } }",
        &["adiabatic_wall.slide = [1]`", "2 entries"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { outflow = { pressure = \"x - 1\" } }",
        &["outflow.pressure = \"x - 1\"`", "the pressure at [0.0, 0.0] and t = 0, -1,", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { isothermal_wall = { temperature = \"1 - 2*t\" } }",
        &["isothermal_wall.temperature = \"1 - 2*t\"`", "t = 0.618", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = \"1 + y\", total_temperature = 1, direction = [1] } }",
        &["inflow.direction = [1]`", "2 entries"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = 1, total_temperature = \"y\", direction = [1, 0] } }",
        &["total_temperature = \"y\"`", "the temperature at [0.0, 0.0] and t = 0, 0,", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = 1, total_temperature = 1, direction = [\"y\", 0] } }",
        &["inflow.direction", "the direction at [0.0, 0.0]", "points somewhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = 1, total_temperature = 1, direction = [\"-1 - y\", 0] } }",
        &["inflow.direction", "a vector into the domain"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { adiabatic_wall = { slide = [\"y\", 0] } }",
        &["adiabatic_wall.slide", "does not slide in its plane"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { adiabatic_wall = { slide = [0, \"1/y\"] } }",
        &["adiabatic_wall.slide", "the vector at [0.0, 0.0] and t = 0", "finite everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { adiabatic_wall = { slide = [\"t\", 0] } }",
        &["adiabatic_wall.slide", "does not slide in its plane", "t = 0.236068"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { isothermal_wall = { temperature = \"1 - 2*t*y\" } }",
        &["isothermal_wall.temperature", "the temperature at", "t = 0.618034", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { outflow = { pressure = \"1 - 2*t*y\" } }",
        &["outflow.pressure", "the pressure at", "t = 0.618034", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = \"1 - 2*t*y\", total_temperature = 1, direction = [1, 0] } }",
        &["inflow.total_pressure", "the pressure at", "t = 0.618034", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = 1, total_temperature = 1, direction = [\"1 - 2*t\", 0] } }",
        &["inflow.direction", "the direction at t = 0.618034", "a vector into the domain"],
    ),
    ("others = {", "", &["`flow.boundary`", "boundaries `right`, ", "of the mesh have no flow condition", "`others`"]),
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
        &["displacement[0]", "zero everywhere at the start"],
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
    ("velocity = [0.5, 0]", "velocity = [0.5, inf]", &["velocity[1] = inf`", "finite"]),
    ("velocity = [0.5, 0]", "velocity = [0, 0]", &["`flow.reference`", "cannot be told", "typical"]),
    ("pressure = 1", "pressure = 0", &["`flow.initial.uniform.pressure = 0`", "positive"]),
    ("pressure = 1", "", &["`flow.initial.uniform`", "the pressure is missing", "`mach`"]),
    ("pressure = 1", "pressure = 1\nmach = 0.5", &["more than once", "one of"]),
    ("pressure = 1", "mach = 0", &["`flow.initial.uniform.mach = 0`", "positive"]),
    ("order = 4", "order = 4\ngas.gamma = 1", &["`flow.gas.gamma = 1`", "above 1"]),
    ("order = 4", "order = 4\ngas = { mach = 0.5, gas_constant = 1 }", &["`flow.gas`", "given twice"]),
    (
        "order = 4",
        "order = 4\nquadrature = { points = 3 }",
        &["`flow.quadrature.points = 3`", "4, the order of the flow"],
    ),
    ("order = 4", "order = 4\nsource = \"manufactured\"", &["`flow.source", "`exact`"]),
    ("order = 4", "order = 4\nsource = { given = { momentum = [1] } }", &["source.given.momentum = [1]`", "2 entries"]),
    (
        "order = 4",
        "order = 4\nsource = { given = { density = \"1/x\" } }",
        &["source.given.density", "the source of density at [0.0, 0.0] and t = 0", "finite everywhere"],
    ),
    (
        "order = 4",
        "order = 4\nsponge = { strength = \"1 - x\", target = { velocity = [0.5, 0], pressure = 1 } }",
        &["`flow.sponge.strength = \"1 - x\"`", "the strength at", "0 or positive everywhere"],
    ),
    (
        "order = 4",
        "order = 4\nsponge = { strength = 1, target = { velocity = [0.5, 0], pressure = -1 } }",
        &["`flow.sponge.target.pressure = -1`", "positive"],
    ),
    (
        "order = 4",
        "order = 4\nsource = { given = { energy = 1 } }\nsponge = { strength = 1, target = { velocity = [1, 0], pressure = 1 } }",
        &["`flow.sponge", "no place beside this source", "acceleration"],
    ),
    ("end = 1", "end = 0", &["`time.end = 0`", "after the start, 0"]),
    ("end = 1", "end = nan", &["`time.end = nan`", "finite"]),
    ("step = 0.3", "step = 0", &["`time.step = 0`", "a positive number"]),
    ("step = 0.3", "step = -0.1", &["`time.step = -0.1`", "a positive number"]),
    ("step = 0.3", "", &["`time`", "missing", "`step` or `slabs`"]),
    ("step = 0.3", "slabs = 3\nadaptive = { tolerance = 1e-3 }", &["`time.slabs = 3`", "same length", "`time.step`"]),
    ("step = 0.3", "step = 0.3\nadaptive = { tolerance = 0 }", &["`time.adaptive.tolerance = 0`", "positive"]),
    (
        "step = 0.3",
        "step = 0.3\nadaptive = { tolerance = 1e-3, smallest = 1 }",
        &["`time.adaptive.smallest = 1`", "at most the step, 0.3"],
    ),
    (
        "step = 0.3",
        "step = 0.3\nadaptive = { tolerance = 1e-3, largest = 0.1 }",
        &["`time.adaptive.largest = 0.1`", "at least the step, 0.3"],
    ),
    ("step = 0.3", "step = 0.3\nslabs = 3", &["`time`", "twice", "`step` or `slabs`"]),
    (
        "step = 0.3",
        "step = 0.3\n[solver]\nnewton_tolerance = 0.99",
        &["`solver.newton_tolerance = 0.99`", "at most 0.1"],
    ),
    (
        "step = 0.3",
        "step = 0.3\n[solver]\nnewton_absolute_tolerance = 0.2",
        &["`solver.newton_absolute_tolerance = 0.2`", "from 0 to 0.1"],
    ),
    (
        "step = 0.3",
        "step = 0.3\n[solver]\nsteady = { tolerance = 0.5 }",
        &["`solver.steady.tolerance = 0.5`", "at most 0.1"],
    ),
    ("step = 0.3", "step = 0.3\n[output]\nfields = [\"mass\"]", &["`output.fields[0] = \"mass\"`", "`mach`"]),
    ("[flow]", "[folw]", &["`folw`", "unknown key `folw`", "did you mean `flow`"]),
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
    ("order = 4", "order = 4\ngas.viscosity.sutherland = [1, 2, 3]", &["sutherland = [1, 2, 3]`", "a table"]),
    (
        "generate.box",
        "generate.box = { lower = [0, 0], upper = [2, 1], cells = [4, 2], periodic = [\"y\", \"x\", \"y\"] }",
        &["periodic[2] = \"y\"`", "axis `y` is listed twice", "remove this one"],
    ),
    (
        "step = 0.3",
        "step = 0.3\n[output]\nfields = [\"density\", \"density\"]",
        &["`output.fields[1] = \"density\"`", "field `density` is listed twice"],
    ),
    (
        "order = 4",
        "order = 4\nforces.left.point = [0, \"sqrt(0.5-t)\"]",
        &["`flow.forces.left.point[1]", "t = 0.618", "NaN", "finite over the whole run"],
    ),
    ("step = 0.3", "step = 1e-30", &["`time.step = 1e-30`", "round-off of the time", "2.2e-13 or more"]),
    ("step = 0.3", "slabs = 1000000000000000", &["`time.slabs = 1000000000000000`", "round-off of the time"]),
    (
        "step = 0.3",
        "step = 0.3\nadaptive = { tolerance = 1e-3, smallest = 1e-30 }",
        &["`time.adaptive.smallest = 1e-30`", "round-off of the time", "2.2e-13 or more"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { adiabatic_wall = { slide = [1, 0.5] } }",
        &["adiabatic_wall.slide = [1, 0.5]`", "does not slide in its plane", "[0.0, 0.0]", "along the wall"],
    ),
    (
        "others = {",
        "others = { far_field = { velocity = [1e6, 0], pressure = 1 } }",
        &["`flow.boundary.others.far_field.velocity = [1e6, 0]`", "the Mach number, 8.4515e5", "at most 100 times"],
    ),
    (
        "others = {",
        "others = { prescribed_state = { expression = { density = \"sqrt(-1-x)\", velocity = [0.5, 0], pressure = 1 } } }",
        &["prescribed_state.expression.density = \"sqrt(-1-x)\"`", "in cell 3", "NaN", "positive everywhere"],
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
    ("order = 4", "order = 4\ngas.gamma = 1e30", &["`flow.gas.gamma = 1e30`", "1.0001 to 100"]),
    ("order = 4", "order = 4\ngas.viscosity = 0.1", &["`flow.gas.viscosity = 0.1`", "wrong type", "`sutherland`"]),
    ("order = 4", "order = 4\nreference = { speed = 1e30, pressure = 1 }", &["`flow.reference.speed = 1e30`", "Mach"]),
    (
        "order = 4",
        "order = 4\nforces.left.drag_direction = [0, 0]",
        &["`flow.forces.left.drag_direction = [0, 0]`", "infinite"],
    ),
    (
        "step = 0.3",
        "step = 0.3\n[solver]\nslab_halvings = 4294967297",
        &["`solver.slab_halvings = 4294967297`", "0 to 40"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { isothermal_wall = { temperature = 1e300 } }",
        &["isothermal_wall.temperature = 1e300`", "the number is out of range", "1e-60 to 1e60"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { outflow = { pressure = 1e-300 } }",
        &["outflow.pressure = 1e-300`", "the number is out of range", "1e-60 to 1e60"],
    ),
    ("order = 4", "order = 4\ngas.viscosity = { constant = 1e300 }", &["viscosity.constant = 1e300`", "1e-60 to 1e60"]),
    (
        "left = { displacement",
        "left = { displacement = [\"1e300\", 0] }",
        &["`motion.boundary.left.displacement[0] = \"1e300\"`", "the formula, 1e300, is out of range", "1e60"],
    ),
    (
        "others = {",
        "others = { prescribed_state = { expression = { density = 1, velocity = [\"exp(300+x)\", 0], pressure = 1 } } }",
        &["expression.velocity[0] = \"exp(300+x)\"`", "the velocity in cell", "at most 1e60"],
    ),
    ("b = ", "c = \"exp(300)\"", &["`constants.c", "the formula, 1.9424263952412558e130,"]),
    ("step = 0.3", "step = 0.3\n[output]\ndirectory = \"\"", &["`output.directory = \"\"`", "empty"]),
    (
        "step = 0.3",
        "step = 0.3\n[tables]\nh = { t = [0, 1, 1, 3], values = [0, 1, 2, 3] }",
        &["`tables.h.t = [0, 1, 1, 3]`", "times must increase"],
    ),
];

#[test]
fn bad_input_is_named_with_file_line_key_value_and_what_is_accepted() {
    for (line, replacement, expected) in BAD {
        let message = message_with(line, replacement);
        let (file, rest) = message.split_once(':').unwrap();
        let number: usize = rest.split(':').next().unwrap().parse().unwrap_or_else(|_| panic!("no line: {message}"));
        assert_eq!(file, "dir/base.toml");
        assert!(message.contains(&format!("\n {number} | ")), "{message}");
        for part in *expected {
            assert!(message.contains(part), "no {part} in:\n{message}");
        }
    }
}

/// The excerpt of a long line contains the error, and the message stays short.
#[test]
fn a_long_line_is_shown_where_it_is_wrong() {
    let sum = |terms: usize| (0..terms).map(|k| format!("a*sin({k}*t)+")).collect::<String>();
    let formula = format!("{}sni(t)+{}0", sum(300), sum(300));
    let message = message_with("left = { displacement", &format!("left = {{ displacement = [\"{formula}\", 0] }}"));
    assert!(message.contains("sni(t)+a*sin(0*t)") && message.len() < 2000, "{message}");
    let list = format!("cells = [{}4, \"two\"]", "4,".repeat(1000));
    let message = message_with("generate.box", &format!("generate.box = {{ lower = [0, 0], upper = [2, 1], {list} }}"));
    assert!(message.contains("4, \"two\"] }") && message.contains("^^^^^") && message.len() < 2000, "{message}");
}

/// Without a limit, `check` would evaluate such a formula for hours.
#[test]
fn a_formula_of_200000_terms_is_refused_at_once() {
    let formula = (0..200_000).map(|k| format!("a*sin({k}*t)+")).collect::<String>() + "0";
    let message = message_with("left = { displacement", &format!("left = {{ displacement = [\"{formula}\", 0] }}"));
    assert!(message.contains("too long: at most 50000 operations") && message.contains("`[tables]`"), "{message}");
    assert!(message.len() < 2000, "{} characters", message.len());
}

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

#[test]
fn an_error_points_at_its_line_and_column() {
    let error = check_text(&BASE.replace("order = 4", "order = 99"), &[]).unwrap_err();
    let Place::File { line, column, text, length, .. } = error.place else { panic!("in the file") };
    assert_eq!((line, column, text.as_str(), length), (14, 9, "order = 99", 2));
}

#[test]
fn errors_of_options_name_the_option() {
    for (option, expected) in [
        ("flow.order=99", "--set flow.order=99: the order of the flow"),
        ("flow.riemann=rou", "--set flow.riemann = \"rou\": unknown choice `rou`"),
        ("flow.ordr=4", "--set flow.ordr=4: unknown key `ordr`"),
        ("flow.order.x=4", "--set flow.order.x=4: `order` is not a table"),
        ("flow.order", "--set flow.order: "),
        ("=4", "--set =4: "),
        ("a=1\nb=2", "--set a=1\nb=2: an option sets one key"),
    ] {
        let message = check_text(BASE, &[option]).unwrap_err().to_string();
        assert!(message.starts_with(expected), "{option}: {message}");
    }
}

/// Lines that are missing, doubled, cut or misspelt give an error with a place, or still a case; never a panic.
#[test]
fn damaged_cases_are_refused_with_a_place_or_are_cases() {
    let mut refused = 0;
    for file in case_files() {
        // The lowest order makes meshes quickly.
        let text =
            std::fs::read_to_string(&file).unwrap().replace("order = 4", "order = 2").replace("order = 8", "order = 2");
        let lines: Vec<&str> = text.lines().collect();
        for (number, line) in lines.iter().enumerate().filter(|(_, line)| !line.is_empty() && !line.starts_with('#')) {
            let middle = line.char_indices().nth(line.chars().count() / 2).unwrap().0;
            let swapped = format!("{}q{}", &line[..middle], &line[middle..]);
            for replacement in [
                "",
                &line[..middle],
                &swapped,
                &line.replace('=', ":"),
                &format!("{line}\n{line}"),
                &line.replace(|c: char| c.is_ascii_digit(), "-7"),
            ] {
                let damaged: Vec<&str> =
                    (0..lines.len()).map(|i| if i == number { replacement } else { lines[i] }).collect();
                let document = Document::parse(&file, damaged.join("\n"), &[]);
                if let Err(error) = document.and_then(|document| AnyCase::check(&document)) {
                    assert!(matches!(&error.place, Place::File { line, .. } if *line <= lines.len() + 1), "{error}");
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > 400, "{refused} refused");
}

/// The header of a table names the full path; the error concerns the part that offers a choice.
#[test]
fn two_choices_are_named() {
    let text = BASE
        .replace("generate.box = {", "[mesh.generate.box]\n#")
        .replace("[motion]\n", "lower = [0, 0]\nupper = [1, 1]\ncells = [1, 1]\n[motion]\n");
    for (text, option, place) in [
        (text.as_str(), "mesh.generate.disk={}", "`mesh.generate`"),
        (BASE, "mesh.generate={box={},disk={}}", "--set mesh.generate="),
    ] {
        let message = check_text(text, &[option]).unwrap_err().to_string();
        let parts = [place, "one choice is needed here", "there are `box`, `disk`"];
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}

/// The error lists the choices.
#[test]
fn choices_are_listed_where_none_is_made() {
    let none = check_text(&BASE.replace("generate.box = {", "generate = {}\n#"), &[]).unwrap_err().to_string();
    let no_motion = check_text(&BASE.replace("others = \"fixed\"", ""), &[]).unwrap_err().to_string();
    for (message, parts) in
        [(none, ["there is none", "`box`", "`airfoil`"]), (no_motion, ["`others`", "`fixed`", "`rigid`"])]
    {
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}

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

/// A wrong time does not hide what is wrong with the flow.
#[test]
fn a_bad_time_does_not_hide_the_flow() {
    let error = check_text(BASE, &["time.order=99", "flow.order=0", "flow.gas.gamma=0.5"]).unwrap_err().to_string();
    for part in ["time.order=99", "flow.order=0", "flow.gas.gamma=0.5"] {
        assert!(error.contains(part), "no {part} in {error}");
    }
}
