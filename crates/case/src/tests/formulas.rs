//! Formulas and constants as values of a case.

use super::*;
use crate::expression::Program;
use navier_stokes::ExactState;

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
fn constants_may_use_those_above_them() {
    let bound = |options: &[&str]| match plane(BASE, options).motion {
        Some(Motion::Elastic { boundary, .. }) => boundary[0].as_ref().unwrap().displacement(0, &[0.0, 0.5], 1.0)[0],
        _ => panic!("elastic"),
    };
    let displacement = r#"motion.boundary.left.displacement=["4*b*t*y*(1 - y)", 0]"#;
    assert_eq!(bound(&[displacement]), 0.2);
    assert_eq!(bound(&[displacement, "constants.a=1"]), 2.0, "an option keeps the place of its constant");
    let circle = message_with("a =", "a = \"2*b\"");
    assert!(circle.contains("constants need each other: `b` needs this one"), "{circle}");
    assert!(message_with("a =", "a = \"1/0\"").contains("finite"));
    assert!(message_with("a =", "sin = 1").contains("a constant cannot be called `sin`"));
}

/// They were unknown names.
#[test]
fn a_name_that_has_no_meaning_at_a_place_is_told_so() {
    let table = "tables.way={t=[0,1,2],values=[0,1,0]}";
    let message = |options: &[&str]| check_text(BASE, options).unwrap_err().to_string();
    let of_number = message(&[table, "time.end=\"2*way(1)\""]);
    assert!(of_number.contains("`way` is a table, and numbers are computed before tables"), "{of_number}");
    let control = "controls.c={measure=\"mass\",rate=\"1 - measured\"}";
    let of_motion = message(&[control, "motion.boundary.left.displacement=[\"c*t\",0]"]);
    assert!(of_motion.contains("`c` is a control"), "{of_motion}");
}

/// `--set constants.amplitud=2` was a new constant, and the run that of the file.
#[test]
fn a_constant_that_only_an_option_has_must_be_of_use() {
    let text = BASE.replace("b =", "amplitude =");
    let message = check_text(&text, &["constants.amplitud=2"]).unwrap_err().to_string();
    assert!(
        message.contains("in no formula: `amplitud`") && message.contains("did you mean `amplitude`?"),
        "{message}"
    );
    let used = plane(BASE, &["constants.speed=2", "flow.initial.uniform.velocity=[\"0.25*speed\",0]"]);
    assert_eq!(used.about.unused, ["b"]);
}

/// The other key was given twice.
#[test]
fn an_option_with_one_of_two_keys_replaces_the_other() {
    let slabs = |options: &[&str]| plane(BASE, options).time.slabs;
    assert_eq!((slabs(&["time.slabs=8"]), slabs(&["time.slabs=8", "time.step=0.5"])), (8, 2));
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
