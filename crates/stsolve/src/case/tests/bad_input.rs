//! What is wrong with a case is named.

use super::super::error::Place;
use super::*;

/// A line of BASE, what it is replaced by, and what the message must contain beside file and line.
const BAD: &[(&str, &str, &[&str])] = &[
    ("order = 4", "ordr = 4", &["`flow.ordr = 4`", "unknown key `ordr`", "`quadrature`", "did you mean `order`"]),
    ("order = 4", "order = \"four\"", &["`flow.order = \"four\"`", "wrong type", "a whole number"]),
    ("order = 4", "order = 1", &["`flow.order = 1`", "2 to 16 nodes"]),
    ("order = 4", "order = 17", &["`flow.order = 17`", "2 to 16 nodes"]),
    ("order = 4", "order = -4", &["`flow.order = -4`", "a whole number"]),
    ("order = 4", "order = 18446744073709551615", &["`flow.order = 18446744073709551615`", "below 2^63"]),
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
    ("end = 1", "end = 0", &["`time.end = 0`", "after the start, 0"]),
    ("end = 1", "end = nan", &["`time.end = nan`", "after the start"]),
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

/// Lines left out, doubled, cut, misspelt: refused with a place, or still a case; never a panic.
#[test]
fn damaged_cases_are_refused_with_a_place_or_are_cases() {
    let mut refused = 0;
    for file in case_files() {
        // The lowest order, for meshes that are made quickly.
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

/// The header of a table names its way; the error is about the part that offers a choice.
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

/// Who does not know the choices is told.
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
