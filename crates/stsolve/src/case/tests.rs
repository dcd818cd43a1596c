#![allow(clippy::unwrap_used)]

use super::error::Place;
use super::*;
use crate::expression::Program;
use fem::VectorField;
use navier_stokes::{Boundary, ExactState, Riemann};
use std::path::{Path, PathBuf};

/// The smallest case with everything that errors are about.
const BASE: &str = r#"
[constants]
a = 0.1
b = "2*a"
[mesh]
order = 3
generate.box = { lower = [0, 0], upper = [2, 1], cells = [4, 2] }
[motion]
elasticity = { poisson_ratio = 0.3 }
[motion.boundary]
left = { displacement = ["a*t", 0] }
others = "fixed"
[flow]
order = 4
[flow.initial.uniform]
velocity = [0.5, 0]
pressure = 1
[flow.boundary]
left = "slip_wall"
others = { far_field = { velocity = [0.5, 0], pressure = 1 } }
[time]
order = 2
end = 1
step = 0.3
"#;

fn check_text(text: &str, options: &[&str]) -> Result<AnyCase, Box<CaseError>> {
    let options: Vec<String> = options.iter().map(|option| (*option).to_owned()).collect();
    AnyCase::check(&Document::parse(Path::new("dir/base.toml"), text.to_owned(), &options)?)
}

fn plane(text: &str, options: &[&str]) -> Case<2> {
    match check_text(text, options) {
        Ok(AnyCase::Plane(case)) => *case,
        Ok(AnyCase::Space(_)) => panic!("three dimensions"),
        Err(error) => panic!("{error}"),
    }
}

/// The message for BASE with the line that starts with `key` replaced.
fn message_with(line: &str, replacement: &str) -> String {
    let number = BASE.lines().position(|l| l.starts_with(line)).unwrap_or_else(|| panic!("no line {line}"));
    let text: Vec<&str> = BASE.lines().enumerate().map(|(i, l)| if i == number { replacement } else { l }).collect();
    check_text(&text.join("\n"), &[]).unwrap_err().to_string()
}

fn case_files() -> Vec<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    let mut files: Vec<_> = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    assert!(files.len() >= 6, "{files:?}");
    files
}

#[test]
fn what_the_user_wrote_becomes_what_the_program_needs() {
    let case = plane(BASE, &[]);
    assert_eq!((case.about.name.as_str(), case.mesh.n_cells(), case.mesh.order()), ("base", 8, 3));
    assert_eq!((case.time.slabs, case.time.step, case.time.order), (4, 0.3, 2));
    let flow = case.flow.unwrap();
    assert_eq!((flow.order, flow.law.riemann, flow.manufactured), (4, Riemann::Roe, false));
    assert_eq!(flow.exact, None);
    let walls: Vec<bool> = flow.boundary.iter().map(|data| data.condition.is_wall()).collect();
    assert_eq!(case.mesh.boundary_names(), ["left", "right", "bottom", "top"]);
    assert_eq!(walls, [true, false, false, false]);
    let Some(Motion::Elastic { poisson_ratio, stiffness, boundary }) = case.motion else { panic!("elastic") };
    assert_eq!((poisson_ratio, stiffness), (0.3, Stiffness::InverseJacobian { power: 1.0 }));
    let left = boundary[0].as_ref().unwrap();
    assert_eq!((left.value(&[0.0, 0.5], 2.0), left.rate(&[0.0, 0.5], 2.0)), ([0.2, 0.0], [0.1, 0.0]));
    assert_eq!(boundary[1..], [const { None }; 3]);
}

#[test]
fn defaults_taken_are_listed_and_given_values_are_not() {
    let defaults = plane(BASE, &["solver.newton_steps=7"]).about.defaults;
    let of = |key: &str| defaults.iter().find(|(k, _)| k == key).map(|(_, value)| value.as_str());
    assert_eq!(of("flow.gas.gamma"), Some("1.4"));
    assert_eq!(of("solver.newton_tolerance"), Some("1e-8"));
    assert_eq!(of("flow.initial.uniform.density"), Some("1.0"));
    assert_eq!(of("flow.gas.gas_constant"), Some("1.0"));
    for given in ["solver.newton_steps", "flow.order", "motion.elasticity.poisson_ratio", "time.step"] {
        assert_eq!(of(given), None, "{given}");
    }
}

#[test]
fn the_case_in_full_is_a_case_without_defaults() {
    let once = plane(BASE, &["time.end=2"]);
    let twice = plane(&once.about.resolved, &[]);
    assert_eq!(once.about.resolved, twice.about.resolved);
    assert_eq!((once.flow, once.time), (twice.flow, twice.time));
    assert!(twice.about.defaults.iter().all(|(key, _)| key == "flow.gas.gas_constant" || key == "flow.reference"));
}

#[test]
fn cases_that_may_continue_each_other_agree_in_their_numerics() {
    let numerics = |options: &[&str]| plane(BASE, options).about.numerics;
    assert_eq!(numerics(&[]), numerics(&["time.end=5", "output.every=3", "title=longer"]));
    assert_ne!(numerics(&[]), numerics(&["time.step=0.25"]));
    assert_ne!(numerics(&[]), numerics(&["flow.riemann=hllc"]));
}

#[test]
fn options_write_over_the_file() {
    let case = plane(BASE, &["flow.riemann=hllc", "time={order=1,end=2,slabs=5}", "constants.a=0.5", "mesh.order = 4"]);
    assert_eq!((case.flow.unwrap().law.riemann, case.time.slabs, case.mesh.order()), (Riemann::Hllc, 5, 4));
    let Some(Motion::Elastic { boundary, .. }) = case.motion else { panic!("elastic") };
    assert_eq!(boundary[0].as_ref().unwrap().value(&[0.0; 2], 1.0), [0.5, 0.0]);
    let replaced = plane(BASE, &[r#"flow.boundary={others="symmetry"}"#]).flow.unwrap();
    assert!(replaced.boundary.iter().all(|data| matches!(data.condition, Boundary::Symmetry(_))));
}

#[test]
fn constants_may_use_those_above_them() {
    let bound = |options: &[&str]| match plane(BASE, options).motion {
        Some(Motion::Elastic { boundary, .. }) => boundary[0].as_ref().unwrap().value(&[0.0; 2], 1.0)[0],
        _ => panic!("elastic"),
    };
    let displacement = r#"motion.boundary.left.displacement=["b*t", 0]"#;
    assert_eq!(bound(&[displacement]), 0.2);
    assert_eq!(bound(&[displacement, "constants.a=1"]), 2.0, "an option keeps the place of its constant");
    assert!(message_with("a =", "a = \"2*b\"").contains("unknown name `b`"), "not those below");
    assert!(message_with("a =", "a = \"1/0\"").contains("finite"));
    assert!(message_with("a =", "sin = 1").contains("a constant cannot be called `sin`"));
}

/// A line of BASE, what it is replaced by, and what the message must contain beside file and line.
const BAD: &[(&str, &str, &[&str])] = &[
    ("order = 4", "ordr = 4", &["`flow.ordr = 4`", "unknown key `ordr`", "`quadrature`", "did you mean `order`"]),
    ("order = 4", "order = \"four\"", &["`flow.order = \"four\"`", "wrong type", "a whole number"]),
    ("order = 4", "order = 1", &["`flow.order = 1`", "2 to 16 nodes"]),
    ("order = 4", "order = 17", &["`flow.order = 17`", "2 to 16 nodes"]),
    ("order = 4", "order = -4", &["`flow.order = -4`", "a whole number"]),
    ("order = 4", "", &["`flow`", "missing key `order`"]),
    ("order = 4", "order = ", &["expected"]),
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
    ("others = {", "", &["`flow.boundary`", "boundary `right` of the mesh has no flow condition", "`others`"]),
    ("others = \"fixed\"", "", &["`motion.boundary`", "boundary `right` of the mesh has no motion"]),
    ("elasticity =", "elasticity = { poisson_ratio = 0.5 }", &["`motion.elasticity.poisson_ratio = 0.5`", "below 0.5"]),
    (
        "elasticity =",
        "elasticity = { stiffness = { expression = \"x-1\" } }",
        &["stiffness.expression = \"x-1\"`", "positive everywhere"],
    ),
    ("elasticity =", "elasticity = { stiffness = { expression = \"t\" } }", &["unknown name `t`"]),
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
    ("step = 0.3", "step = 0.3\nslabs = 3", &["`time`", "twice", "`step` or `slabs`"]),
    ("step = 0.3", "step = 0.3\n[solver]\nnewton_tolerance = 1", &["`solver.newton_tolerance = 1`", "below 1"]),
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

#[test]
fn a_case_without_anything_to_solve_is_refused() {
    let text = "[mesh]\norder = 2\ngenerate.box = { lower = [0,0], upper = [1,1], cells = [1,1] }\n[time]\norder = 1\nend = 1\nslabs = 1\n";
    assert!(check_text(text, &[]).unwrap_err().to_string().contains("nothing to solve"));
    assert!(check_text("", &[]).unwrap_err().to_string().contains("missing key `mesh`"));
}

#[test]
fn an_initial_state_by_formulas_must_be_a_state() {
    let initial = |density: &str| {
        let option = format!("flow.initial={{expression={{density={density:?},velocity=[0.1,\"a*y\"],pressure=1}}}}");
        check_text(BASE, &[&option, "flow.reference={speed=0.1,pressure=1}"])
    };
    assert!(initial("1 + x").is_ok());
    let message = initial("1 - x").unwrap_err().to_string();
    assert!(message.contains("density") && message.contains("positive everywhere"), "{message}");
}

#[test]
fn slabs_cover_the_time() {
    for (step, end, slabs) in [("0.1", "1", 10), ("0.3", "1", 4), ("2", "1", 1), ("0.1", "8", 80), ("0.3", "0.9", 3)] {
        let time = plane(BASE, &[&format!("time.step={step}"), &format!("time.end={end}")]).time;
        assert_eq!(time.slabs, slabs, "{step} {end}");
        assert!(time.step * (time.slabs as f64 - 1.0) < time.end && time.step * time.slabs as f64 > time.end - 1e-12);
    }
}

#[test]
fn a_state_by_formulas_is_the_uniform_one_where_they_are_constant() {
    let velocity = [0.3, -0.2];
    let uniform = r#"flow.initial={uniform={density=1.2,velocity=[0.3,-0.2],pressure=0.8}}"#;
    let formulas = r#"flow.initial={expression={density="1.2",velocity=["0.3",-0.2],pressure=0.8}}"#;
    let reference = "flow.reference={speed=1,pressure=1}";
    let state =
        |option: &str| -> [f64; 4] { plane(BASE, &[option, reference]).flow.unwrap().initial.state(&[0.4, 0.1], 0.2) };
    assert_eq!(state(uniform), state(formulas));
    let energy = 0.8 / 0.4 + 0.5 * 1.2 * velocity.iter().map(|w| w * w).sum::<f64>();
    assert!((state(uniform)[3] - energy).abs() < 1e-15);
}

#[test]
fn the_rate_of_a_vector_is_its_time_derivative() {
    let names = crate::expression::Names::constants_only().with_coordinates(2).with_time();
    let program = |text| Program::compile(text, &names).unwrap();
    let vector = Vector::new([program("x*sin(3*t)"), program("t^2*y")]);
    let (x, t) = ([0.7, 0.2], 0.4);
    let (found, expected) = (vector.rate(&x, t), [x[0] * (3.0_f64 * t).cos() * 3.0, 2.0 * t * x[1]]);
    assert!((0..2).all(|axis| (found[axis] - expected[axis]).abs() < 1e-15), "{found:?} {expected:?}");
}

#[test]
fn every_shipped_case_is_valid_and_says_what_it_shows() {
    for file in case_files() {
        let case = AnyCase::read(&file, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(!case.about().title.is_empty(), "{file:?}");
        let text = std::fs::read_to_string(&file).unwrap();
        for part in ["What it shows", "here it comes from", "hat to expect", "What it costs"] {
            assert!(text.contains(part), "{file:?}: {part}");
        }
    }
}

#[test]
fn settings_reach_the_newton_driver() {
    let newton = |options: &[&str]| plane(BASE, options).solver.newton();
    assert_eq!(newton(&[]), newton_krylov::newton::Settings::default());
    let changed = newton(&["solver.krylov_tolerance=1e-4", "solver.newton_steps=3", "solver.pseudo_time.power=2"]);
    assert_eq!((changed.forcing.initial, changed.forcing.minimum, changed.forcing.maximum), (1e-4, 1e-4, 1e-4));
    assert_eq!((changed.max_steps, changed.pseudo_time.power), (3, 2.0));
}

/// Lines left out, doubled, cut, misspelt: refused with a place, or still a case; never a panic.
#[test]
fn damaged_cases_are_refused_with_a_place_or_are_cases() {
    let mut refused = 0;
    for file in case_files() {
        let text = std::fs::read_to_string(&file).unwrap();
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

#[test]
fn the_schema_describes_every_key() {
    let schema = serde_json::to_value(schema()).unwrap();
    let mut keys = 0;
    undescribed(&schema, "case", &mut keys);
    assert!(keys > 100, "{keys} keys");
    let text = schema.to_string();
    for key in [
        "poisson_ratio",
        "newton_tolerance",
        "checkpoint_every",
        "far_field",
        "strength",
        "inverse_jacobian",
        "lax_friedrichs",
    ] {
        assert!(text.contains(&format!("\"{key}\"")), "{key}");
    }
    assert_eq!(schema["$defs"]["Gas"]["properties"]["gamma"]["default"], 1.4);
    assert_eq!(schema["$defs"]["Gas"]["additionalProperties"], false);
}

/// Counts properties and choices, each of which must have a description.
fn undescribed(schema: &serde_json::Value, path: &str, keys: &mut usize) {
    if let Some(properties) = schema["properties"].as_object() {
        for (name, property) in properties {
            let described = property["description"].is_string() || schema["description"].is_string();
            assert!(described, "{path}.{name} has no description");
            *keys += 1;
        }
    }
    for choice in schema["oneOf"].as_array().into_iter().flatten() {
        assert!(choice["description"].is_string(), "a choice of {path} has no description: {choice}");
    }
    let inner = schema.as_object().into_iter().flatten().filter(|(name, _)| *name != "default");
    for (name, value) in inner {
        match value {
            serde_json::Value::Object(_) => undescribed(value, &format!("{path}.{name}"), keys),
            serde_json::Value::Array(entries) => entries.iter().for_each(|entry| undescribed(entry, path, keys)),
            _ => {}
        }
    }
}
