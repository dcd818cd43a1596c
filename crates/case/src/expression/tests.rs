#![allow(clippy::unwrap_used)]

use super::*;
use proptest::prelude::*;
use tensor::{Dual, Transcendental};

fn names() -> Names {
    let mut names = Names::constants_only();
    assert!(names.define("amplitude", 0.3));
    names.with_coordinates(3).with_time()
}

fn compile(text: &str) -> Program {
    Program::compile(text, &names()).unwrap()
}

fn value(text: &str, x: [f64; 3], t: f64) -> f64 {
    compile(text).evaluate(&x, t)
}

fn problem(text: &str) -> (usize, usize, Problem) {
    let error = Program::compile(text, &names()).unwrap_err();
    (error.position, error.length, error.problem)
}

/// A formula and the same in Rust, as functions of (x, y, z) and t.
type Sample = (&'static str, fn([f64; 3], f64) -> f64);

const SAMPLES: &[Sample] = &[
    ("x + 0.1*sin(pi*t/4)*exp(-(x^2+y^2))", |x, t| {
        x[0] + 0.1 * (std::f64::consts::PI * t / 4.0).sin() * (-(x[0] * x[0] + x[1] * x[1])).exp()
    }),
    ("amplitude*(x - 5)*cos(t) - y/z", |x, t| 0.3 * (x[0] - 5.0) * t.cos() - x[1] / x[2]),
    ("-x^2 + 2^3^2 - -y", |x, _| -(x[0] * x[0]) + 512.0 + x[1]),
    ("x^-3 * y^0.5 + z**2.5", |x, _| x[0].powi(-3) * x[1].sqrt() + x[2].powf(2.5)),
    ("x^t", |x, t| x[0].powf(t)),
    ("if(x < y, min(x, t), max(y, t)) + (x >= y) - (x != y)*2", |x, t| {
        let chosen = if x[0] < x[1] { x[0].min(t) } else { x[1].max(t) };
        chosen + f64::from(u8::from(x[0] >= x[1])) - 2.0 * f64::from(u8::from(x[0] != x[1]))
    }),
    ("abs(x - y) + sqrt(z) + log(y)", |x, _| (x[0] - x[1]).abs() + x[2].sqrt() + x[1].ln()),
    ("tan(x) + atan(y) + tanh(z)", |x, _| x[0].tan() + x[1].atan() + x[2].tanh()),
    ("asin(x/2) - acos(-y/3)", |x, _| (x[0] / 2.0).asin() - (-x[1] / 3.0).acos()),
    ("atan2(y - 1, x - 1) + atan2(-z, -x)", |x, _| (x[1] - 1.0).atan2(x[0] - 1.0) + (-x[2]).atan2(-x[0])),
    ("x - 0.5*floor(x/0.5)", |x, _| x[0].rem_euclid(0.5)),
    ("deg(90*x)", |x, _| (90.0 * x[0]).to_radians()),
    ("sinh(x) * cosh(y) / 1.5e1", |x, _| x[0].sinh() * x[1].cosh() / 15.0),
    ("(((x)))*.5 - 1.e-1", |x, _| x[0] * 0.5 - 0.1),
];

const POINTS: [([f64; 3], f64); 3] = [([0.3, 0.7, 1.1], 0.4), ([1.2, 0.4, 0.6], 2.3), ([0.9, 2.1, 0.2], 0.8)];

#[test]
fn formulas_have_the_values_of_native_functions() {
    for (text, native) in SAMPLES {
        for (x, t) in POINTS {
            let (found, expected) = (value(text, x, t), native(x, t));
            assert!(
                (found - expected).abs() <= 4e-15 * (1.0 + expected.abs()),
                "{text} at {x:?}, {t}: {found} {expected}"
            );
        }
    }
}

#[test]
fn duals_are_the_derivatives_along_every_variable() {
    let h = 1e-5;
    for (text, native) in SAMPLES {
        let program = compile(text);
        for (x, t) in POINTS {
            for variable in 0..4 {
                let shifted = |h: f64| {
                    let (mut x, mut t) = (x, t);
                    if variable < 3 {
                        x[variable] += h
                    } else {
                        t += h
                    }
                    native(x, t)
                };
                let seed = |v: usize, a: f64| Dual::new(a, f64::from(u8::from(v == variable)));
                let duals = [seed(0, x[0]), seed(1, x[1]), seed(2, x[2])];
                let found = program.evaluate(&duals, seed(3, t)).derivative;
                let expected = (shifted(h) - shifted(-h)) / (2.0 * h);
                assert!(
                    (found - expected).abs() < 1e-8 * (1.0 + expected.abs()),
                    "{text}, variable {variable}: {found} {expected}"
                );
            }
        }
    }
}

#[test]
fn nested_duals_are_second_derivatives() {
    // d^2/dt^2 of sin(2 t) x^3 is -4 sin(2 t) x^3.
    let t = Dual::new(Dual::new(0.6, 1.0), Dual::new(1.0, 0.0));
    let x = Dual::from(1.3);
    let found = compile("sin(2*t)*x^3").evaluate(&[x], t).derivative.derivative;
    assert!((found + 4.0 * 1.2_f64.sin() * 1.3_f64.powi(3)).abs() < 1e-14);
}

#[test]
fn derivatives_at_zero_are_finite_where_they_exist() {
    let slope = |text: &str| compile(text).evaluate(&[Dual::new(0.0, 1.0)], Dual::from(0.0)).derivative;
    assert_eq!(slope("x^1.5"), 0.0);
    assert_eq!(slope("x^2"), 0.0);
    assert_eq!(slope("x^1"), 1.0);
    assert_eq!(slope("abs(x)"), 1.0);
    // These were NaN, infinity times 0: the Jacobian product of a flow with such an inflow was, too.
    for root in ["sqrt(t)", "sqrt(max(0, t-1))", "t^0.5", "t^(1/7)", "t^(0.2+x)", "sqrt(x^3)", "x*sqrt(t)"] {
        assert_eq!(slope(root), 0.0, "{root}");
    }
    assert_eq!(slope("sqrt(x)"), f64::INFINITY);
    assert_eq!(slope("-x^0.2"), f64::NEG_INFINITY);
}

/// e^a - e^-a left eight digits.
#[test]
fn sinh_of_small_numbers_has_all_digits() {
    assert!((value("sinh(1e-8*x)/1e-8", [1.0, 0.0, 0.0], 0.0) - 1.0).abs() < 1e-15);
    assert!((value("sinh(x)", [0.999999, 0.0, 0.0], 0.0) - 0.999999_f64.sinh()).abs() < 1e-15);
}

#[test]
fn a_branch_that_is_not_taken_does_not_spoil_the_result() {
    assert_eq!(value("if(x > 0, log(x), 7)", [-1.0, 0.0, 0.0], 0.0), 7.0);
    assert_eq!(value("if(x == 0, 1, sin(x)/x)", [0.0; 3], 0.0), 1.0);
}

#[test]
fn constants_are_folded_and_powers_of_them_are_known() {
    assert_eq!(compile("2*pi/4").instructions.len(), 1);
    assert_eq!(compile("x^(1+1)").instructions.len(), 2);
    assert_eq!(value("x^(1+1)", [-3.0, 0.0, 0.0], 0.0), 9.0);
}

#[test]
fn errors_say_where_and_what() {
    let unexpected = |expected, found: &str| Problem::Unexpected { expected, found: found.to_owned() };
    assert_eq!(problem("x + $"), (4, 1, Problem::Character { character: '$' }));
    assert_eq!(problem("1.2.3"), (0, 5, Problem::Number("1.2.3".into())));
    assert_eq!(problem("2 x"), (2, 1, unexpected("an operator such as `*`, or the end of the expression", "`x`")));
    assert_eq!(
        problem("sin(x"),
        (5, 1, unexpected("`,`, `)` or an operator such as `*`", "the end of the expression"))
    );
    assert_eq!(problem("x +"), (3, 1, unexpected("a number, a name or `(`", "the end of the expression")));
    assert_eq!(problem(""), (0, 1, unexpected("a number, a name or `(`", "the end of the expression")));
    let arguments = |name: &str, takes, found| Problem::Arguments { name: name.into(), takes, found };
    assert_eq!(problem("1 + min(x)"), (4, 3, arguments("min", 2, 1)));
    assert_eq!(problem("sin()"), (0, 3, arguments("sin", 1, 0)));
    let both = Program::compile("(x > 0) && (y > 0)", &names()).unwrap_err().to_string();
    assert!(both.contains("`a*b` is 1 where both comparisons hold"), "{both}");
    assert!(matches!(problem("x(1)"), (0, 1, Problem::Misused { is: "number, not a function", .. })));
    assert!(matches!(problem("1 - cos"), (4, 3, Problem::Misused { is: "function", .. })));
}

/// A choice or a comparison hid that a table had ended, or that a root had no value.
#[test]
fn what_has_no_value_is_not_hidden() {
    for text in ["max(sqrt(x), 1)", "max(1, sqrt(x))", "min(sqrt(x), 1)", "sqrt(x) > 1", "if(sqrt(x) > 1, 1, 2)"] {
        assert!(value(text, [-1.0, 0.0, 0.0], 0.0).is_nan(), "{text}");
    }
    assert_eq!(value("if(x > 0, sqrt(x), 2)", [-1.0, 0.0, 0.0], 0.0), 2.0);
}

#[test]
fn unknown_names_come_with_the_nearest_known_one() {
    let nearest = |text| match problem(text).2 {
        Problem::UnknownName { nearest, .. } => nearest,
        other => panic!("{other}"),
    };
    assert_eq!(nearest("ampltude*x").as_deref(), Some("amplitude"));
    assert_eq!(nearest("cso(x)").as_deref(), Some("cos"));
    assert_eq!((nearest("velocity"), nearest("ln(x)").as_deref()), (None, Some("log")));
    let error = Program::compile("z", &Names::constants_only().with_coordinates(2)).unwrap_err();
    assert!(matches!(error.problem, Problem::UnknownName { .. }), "there is no z in two dimensions");
    assert!(Program::compile("t", &Names::constants_only().with_coordinates(2)).is_err(), "nor t without time");
}

#[test]
fn the_message_marks_the_place_with_carets() {
    let message = Program::compile("1 + sni(x)", &names()).unwrap_err().to_string();
    assert!(message.starts_with("at character 5: unknown name `sni`, did you mean `sin`?"), "{message}");
    assert!(message.ends_with("\n    1 + sni(x)\n        ^^^"), "{message}");
}

#[test]
fn what_would_overflow_the_stack_is_refused() {
    let parentheses = "(".repeat(5000) + "x" + &")".repeat(5000);
    assert!(matches!(problem(&parentheses).2, Problem::TooDeep(_)));
    assert!(matches!(problem(&"2^".repeat(5000)).2, Problem::TooDeep(_)));
    let operands = "x + (y * ".repeat(40) + "1" + &")".repeat(40);
    assert!(matches!(problem(&operands).2, Problem::TooDeep(_)));
    assert_eq!(value(&("-".repeat(5001) + "x"), [2.0, 0.0, 0.0], 0.0), -2.0);
}

#[test]
fn constants_cannot_take_a_name_that_means_something() {
    let mut names = Names::constants_only();
    for taken in ["x", "z", "t", "pi", "sin", "if", "", "2a", "a b", "a-b"] {
        assert!(!names.define(taken, 1.0), "{taken}");
    }
    assert!(names.define("u_inf2", 1.0));
    assert!(!names.define("u_inf2", 2.0), "nor one that is defined");
}

proptest! {
    #[test]
    fn any_text_compiles_or_is_refused(text in "\\PC{0,60}") {
        let _ = Program::compile(&text, &names());
    }

    #[test]
    fn anything_made_of_our_tokens_compiles_or_is_refused(
        tokens in prop::collection::vec(
            prop::sample::select(vec![
                "x", "y", "t", "pi", "amplitude", "2", "0.5", "1e9", "-", "+", "*", "/", "^", "(", ")", ",", "<", "==", "sin",
                "sqrt", "min", "if", "log", " ",
            ]),
            0..40,
        )
    ) {
        if let Ok(program) = Program::compile(&tokens.concat(), &names()) {
            let dual = program.evaluate(&[Dual::new(0.4, 1.0), Dual::from(-0.2), Dual::from(0.0)], Dual::from(0.7));
            let plain = program.evaluate(&[0.4, -0.2, 0.0], 0.7);
            // Duals are divided by multiplication with 1 / b, so they agree up to round-off, which may be amplified.
            prop_assert!(dual.value() == plain || dual.value().is_nan() || plain.abs() > 1e6 || (dual.value() - plain).abs() < 1e-6);
        }
    }
}
