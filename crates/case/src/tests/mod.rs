#![allow(clippy::unwrap_used)]

use super::*;
use crate::expression::Program;
use coupled::BoundaryField;
use fem::VectorField;
use navier_stokes::{Boundary, ExactState, Riemann};
use std::path::{Path, PathBuf};

mod all_errors;
mod bad_input;
mod bodies;
mod continuation;
mod controls;
mod in_flow;
mod meshes;
mod motions;
mod outflows;
mod over_run;
mod parallel;
mod reference;
mod rotation;
mod tables;

/// The smallest case with all parts that errors refer to.
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
left = { displacement = ["4*a*t*y*(1 - y)", 0] }
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

/// The same case with a boundary that rests in the place of the one that moves.
fn at_rest() -> String {
    BASE.replace("left = { displacement = [\"4*a*t*y*(1 - y)\", 0] }", "left = \"fixed\"")
}

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

/// The low-order preconditioner of a flow in three dimensions took twice the time of blocks where the flow moves a plate.
#[test]
fn flows_that_move_bodies_have_blocks_as_long_as_these_are_small() {
    let preconditioner = |name: &str, order: usize| {
        let file = case_files().into_iter().find(|file| file.ends_with(format!("{name}.toml"))).unwrap();
        match AnyCase::read(&file, &[format!("flow.order={order}")]).unwrap() {
            AnyCase::Space(case) => case.preconditioner(),
            AnyCase::Plane(case) => case.preconditioner(),
        }
    };
    assert_eq!(preconditioner("flexible_plate_3d", 3), Preconditioner::Blocks);
    assert_eq!(preconditioner("flexible_plate_3d", 8), Preconditioner::LowOrder, "4 GB of blocks");
    assert_eq!(preconditioner("taylor_green_3d", 3), Preconditioner::LowOrder);
    assert_eq!(preconditioner("taylor_green_3d", 2), Preconditioner::Blocks);
    assert_eq!(preconditioner("turek_hron_fsi1", 8), Preconditioner::Blocks);
}

#[test]
fn what_the_user_wrote_becomes_what_the_program_needs() {
    let case = plane(BASE, &[]);
    assert_eq!((case.about.name.as_str(), case.mesh.n_cells(), case.mesh.order()), ("base", 8, 3));
    assert_eq!((case.time.slabs, case.time.step, case.time.order), (4, 0.3, 2));
    let flow = case.flow.unwrap();
    assert_eq!((flow.order, flow.law.riemann, flow.is_manufactured()), (4, Riemann::Roe, false));
    assert_eq!(flow.exact, None);
    let walls: Vec<bool> = flow.boundary.iter().map(|data| data.condition.is_wall()).collect();
    assert_eq!(case.mesh.boundary_names(), ["left", "right", "bottom", "top"]);
    assert_eq!(walls, [true, false, false, false]);
    let Some(Motion::Elastic { poisson_ratio, stiffness, solver, boundary, .. }) = case.motion else {
        panic!("elastic")
    };
    assert_eq!((poisson_ratio, stiffness), (0.3, Stiffness::InverseJacobian { power: 1.0 }));
    assert_eq!(solver, elasticity::Solver::Automatic);
    let Some(BoundaryMotion::Formulas(left)) = &boundary[0] else { panic!("by formulas") };
    assert_eq!((left.value(&[0.0, 0.5], 2.0), left.rate(&[0.0, 0.5], 2.0)), ([0.2, 0.0], [0.1, 0.0]));
    assert_eq!(boundary[1..], [const { None }; 3]);
}

/// Numbers and formulas of constants stay numbers, so that nothing is evaluated at points.
#[test]
fn values_of_conditions_are_numbers_or_data() {
    let data = |condition: &str| {
        let case = plane(&at_rest().replace("left = \"slip_wall\"", &format!("left = {{ {condition} }}")), &[]);
        let BoundaryData { condition, data, .. } = case.flow.unwrap().boundary.remove(0);
        assert_eq!(condition.takes_data(), data.is_some());
        data.map(|data| data.at::<4>(&[2.0, 3.0], 5.0))
    };
    let wall = "isothermal_wall = { temperature = TEMPERATURE, slide = [0, SLIDE] }";
    let with = |temperature: &str, slide: &str| wall.replace("TEMPERATURE", temperature).replace("SLIDE", slide);
    assert_eq!(data(&with("2", "\"a\"")), None);
    assert_eq!(data(&with("\"1 + y\"", "\"a\"")), Some([0.0, 0.0, 0.1, 4.0]));
    assert_eq!(data(&with("2", "\"t\"")), Some([0.0, 0.0, 5.0, 2.0]));
    assert_eq!(data("adiabatic_wall = { slide = [0, \"y*t\"] }"), Some([0.0, 0.0, 15.0, 0.0]));
    assert_eq!(data("outflow = { pressure = \"b\", total_temperature = 3 }"), None);
    assert_eq!(data("outflow = { pressure = \"1 + x\", total_temperature = 3 }"), Some([3.0, 0.0, 0.0, 3.0]));
    let inflow = "inflow = { total_pressure = 2, total_temperature = 3, direction = [1, \"y\"] }";
    assert_eq!(data(inflow), Some([2.0, 1.0, 3.0, 3.0]));
}

/// A body force and a sponge share the data of a source.
#[test]
fn sources_are_data_with_a_meaning() {
    let source = |keys: &str| {
        let flow = plane(&BASE.replace("order = 4", &format!("order = 4\n{keys}")), &[]).flow.unwrap();
        let data =
            flow.source.as_ref().and_then(Source::formulas).map(|data| data.evaluate::<f64, 4>(&[2.0, 3.0], 5.0));
        (data, flow.law.source, flow.conserves_mass())
    };
    let force = "source = { acceleration = [\"t\", 7] }";
    let sponge = "sponge = { strength = \"x\", target = { velocity = [0, 0], pressure = 1 } }";
    let target = navier_stokes::Conserved { density: 1.0, momentum: [0.0; 2], energy: 1.0 / (1.4 - 1.0) };
    let of_sponge = navier_stokes::Source::Sponge { target };
    assert_eq!(source(""), (None, navier_stokes::Source::Given, true));
    assert_eq!(source(force), (Some([0.0, 5.0, 7.0, 0.0]), navier_stokes::Source::Acceleration, true));
    assert_eq!(source(sponge), (Some([2.0, 0.0, 0.0, 0.0]), of_sponge, false));
    assert_eq!(source(&[force, sponge].join("\n")), (Some([2.0, 5.0, 7.0, 0.0]), of_sponge, false));
    let given = "source = { given = { density = \"y\", energy = 4 } }";
    assert_eq!(source(given), (Some([3.0, 0.0, 0.0, 4.0]), navier_stokes::Source::Given, false));
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
    let alone = ["flow.gas.gas_constant", "flow.reference", "flow.reference.length"];
    assert!(twice.about.defaults.iter().all(|(key, _)| alone.contains(&key.as_str())));
}

#[test]
fn options_write_over_the_file() {
    let case = plane(BASE, &["flow.riemann=hllc", "time={order=1,end=2,slabs=5}", "constants.a=0.5", "mesh.order = 4"]);
    assert_eq!((case.flow.unwrap().law.riemann, case.time.slabs, case.mesh.order()), (Riemann::Hllc, 5, 4));
    let Some(Motion::Elastic { boundary, .. }) = case.motion else { panic!("elastic") };
    assert_eq!(boundary[0].as_ref().unwrap().displacement(0, &[0.0, 0.5], 1.0), [0.5, 0.0]);
    let cg = plane(BASE, &["motion.elasticity.solver=cg"]).motion;
    assert!(matches!(cg, Some(Motion::Elastic { solver: elasticity::Solver::ConjugateGradients, .. })));
    let replaced = plane(BASE, &[r#"flow.boundary={others="symmetry"}"#]).flow.unwrap();
    assert!(replaced.boundary.iter().all(|data| matches!(data.condition, Boundary::Symmetry(_))));
}

/// The key ended at the `=` in the name, and the whole table `output` was replaced.
#[test]
fn an_equals_sign_in_a_quoted_name_does_not_end_the_key() {
    let case =
        plane(BASE, &["output.every=3", r#"output.probes."p=1".at=[0.5,0.5]"#, "output.probes.'q=2'.at=[0.5,0.5]"]);
    assert_eq!(case.output.every, 3);
    let names: Vec<&str> = case.observed.probes.iter().map(|probe| &probe.name[..]).collect();
    assert_eq!(names, ["p=1", "q=2"]);
}

/// In two dimensions the sign of the moment is chosen. In three the moment is a vector, and the axis of its coefficient is
/// chosen.
#[test]
fn moments_are_positive_about_the_axis_that_is_asked_for() {
    let force = navier_stokes::WallForce::<2> { moment: [0.0, 0.0, 3.0], ..Default::default() };
    for (choice, moment) in [("counter_clockwise", 3.0), ("nose_up", -3.0)] {
        let wall = plane(BASE, &[&format!("flow.forces.left.moment_positive={choice}")]).flow.unwrap().walls.remove(0);
        assert_eq!((wall.moments(&force), wall.scales.coefficients(&force).moment), (vec![moment], moment / 0.125));
    }
    assert_eq!(plane(BASE, &[]).flow.unwrap().walls[0].moments(&force), [3.0]);
    let axis = ["flow.forces.left.moment_positive={ axis = [0, 0, -1] }"];
    let message = check_text(BASE, &axis).unwrap_err().to_string();
    assert!(message.contains("a moment has no axis but that along z"), "{message}");

    let text = "[mesh]\norder = 2\ngenerate.box = { lower = [0, 0, 0], upper = [1, 1, 1], cells = [1, 1, 1] }\n[flow]\norder = 2\ninitial.uniform = { velocity = [1, 0, 0], pressure = 1 }\nboundary.others = \"slip_wall\"\n[time]\norder = 1\nend = 1\nslabs = 1\n";
    let force = navier_stokes::WallForce::<3> { moment: [1.0, 2.0, 3.0], ..Default::default() };
    for (choice, moment) in [("nose_up", -3.0), ("{ axis = [0, -5, 0] }", -2.0)] {
        let options = [format!("flow.forces.others.moment_positive={choice}")];
        let Ok(AnyCase::Space(case)) = check_text(text, &[&options[0]]) else { panic!("in space") };
        let wall = case.flow.unwrap().walls.remove(0);
        assert_eq!(wall.moments(&force), [1.0, 2.0, 3.0]);
        assert_eq!(wall.scales.coefficients(&force).moment, moment / 0.5);
    }
    let message =
        check_text(text, &["flow.forces.others.moment_positive={ axis = [0, 0, 0] }"]).unwrap_err().to_string();
    assert!(message.contains("three numbers that are not all zero"), "{message}");
}

#[test]
fn constants_may_use_those_above_them() {
    let bound = |options: &[&str]| match plane(BASE, options).motion {
        Some(Motion::Elastic { boundary, .. }) => boundary[0].as_ref().unwrap().displacement(0, &[0.0, 0.5], 1.0)[0],
        _ => panic!("elastic"),
    };
    let displacement = r#"motion.boundary.left.displacement=["4*b*t*y*(1 - y)", 0]"#;
    assert_eq!(bound(&[displacement]), 0.2);
    assert_eq!(bound(&[displacement, "constants.a=1"]), 2.0, "an option keeps the place of its constant");
    assert!(message_with("a =", "a = \"2*b\"").contains("unknown name `b`"), "not those below");
    assert!(message_with("a =", "a = \"1/0\"").contains("finite"));
    assert!(message_with("a =", "sin = 1").contains("a constant cannot be called `sin`"));
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
fn the_end_is_the_number_that_a_longer_run_passes() {
    let end = |end: &str| plane(BASE, &["time.step=0.1", &format!("time.end={end}")]).time.end;
    assert_eq!([end("0.3"), end("0.35"), end("0.7")], [0.1 * 3.0, 0.35, 0.1 * 7.0]);
    assert_ne!(0.1 * 3.0, 0.3);
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

/// A formula may have values as small as the tail of a smooth bump.
#[test]
fn the_tail_of_a_bump_is_no_extreme_number() {
    let uniform = "[flow.initial.uniform]\nvelocity = [0.5, 0]\npressure = 1";
    let bump = "[flow.initial.expression]\ndensity = 1\npressure = 1\nvelocity = [\"1e-20*exp(-100*(x^2+1))\", 0]\n\
                [flow.reference]\ndensity = 1\nspeed = 1\npressure = 1";
    assert!(BASE.contains(uniform));
    let checked = check_text(&BASE.replace(uniform, bump), &[]);
    assert!(checked.is_ok(), "{}", checked.unwrap_err());
}

/// Angles by `deg`, times by periods: formulas of constants stand for numbers, and the resolved case holds the numbers.
#[test]
fn formulas_of_constants_stand_for_numbers() {
    let options = [
        "constants.period=0.5",
        "time.end=\"4*period\"",
        "flow.initial.uniform.velocity=[\"0.5*cos(deg(60))\", \"0.5*sin(deg(60))\"]",
        "flow.boundary.others.far_field.pressure=\"a + 0.9\"",
        "solver.steady={ stability_time = \"b\" }",
    ];
    let case = plane(BASE, &options);
    assert_eq!(case.time.end, 2.0);
    let velocity = case.flow.as_ref().unwrap().uniform_velocity.unwrap();
    assert!((velocity[0] - 0.25).abs() < 1e-15 && (velocity[1] - 0.5 * 0.75_f64.sqrt()).abs() < 1e-15);
    assert_eq!(case.solver.steady.unwrap().stability_time, Some(0.2));
    let again = plane(&case.about.resolved, &[]);
    assert_eq!((again.time, again.flow.unwrap().uniform_velocity), (case.time, Some(velocity)));
}

/// Formulas stand for counts too, if their value is whole up to rounding, as 0.3 * 10 is.
#[test]
fn formulas_of_constants_stand_for_whole_numbers() {
    let step = "step = 0.3";
    assert!(BASE.contains(step));
    let with_slabs = |slabs: &str| check_text(&BASE.replace(step, &format!("slabs = \"{slabs}\"")), &[]);
    let Ok(AnyCase::Plane(case)) = with_slabs("(0.1 + 0.2)/a") else { panic!("refused") };
    assert_eq!(case.time.slabs, 3);
    let cells = plane(BASE, &["mesh.generate.box.cells=[\"20*a\", 2]"]).mesh.n_cells();
    assert_eq!(cells, 4);
    for (slabs, part) in
        [("25*a", "the number, 2.5"), ("-3", "time.slabs"), ("1/0", "time.slabs"), ("1e30", "a whole number")]
    {
        let message = with_slabs(slabs).unwrap_err().to_string();
        assert!(message.contains(part), "{slabs}: {message}");
    }
}

#[test]
fn a_reynolds_number_gives_the_viscosity() {
    let viscosity = |options: &[&str]| {
        let gas = plane(BASE, options).flow.unwrap().law.gas;
        gas.dynamic_viscosity(1.0)
    };
    let reynolds = "flow.gas.viscosity={ reynolds = 50 }";
    assert!((viscosity(&[reynolds]) - 0.01).abs() < 1e-17, "of the stream, and the length 1");
    let reference = "flow.reference={ density = 2, speed = 3, pressure = 1, length = 5 }";
    assert!((viscosity(&[reynolds, reference]) - 0.6).abs() < 1e-15);
    let gas = plane(BASE, &[]).flow.unwrap().law.gas;
    assert_eq!(gas.dynamic_viscosity(1.0), 0.0);
    let message = check_text(BASE, &["flow.gas.viscosity={ reynolds = 0 }"]).unwrap_err().to_string();
    assert!(message.contains("the Reynolds number is out of range"), "{message}");
    let message = check_text(BASE, &[reynolds, "flow.initial.uniform.velocity=[0,0]"]).unwrap_err().to_string();
    assert!(message.contains("reference = { density, speed, pressure }"), "{message}");
}

#[test]
fn the_schema_for_editors_accepts_formulas_for_numbers() {
    let text = serde_json::to_string(&crate::editor_schema()).unwrap();
    for kind in ["number", "integer"] {
        let (alone, both) = (format!("\"type\":\"{kind}\""), format!("\"type\":[\"{kind}\",\"string\"]"));
        assert!(!text.contains(&alone) && text.contains(&both), "{kind}");
    }
    assert!(text.contains("\"$id\""));
}
