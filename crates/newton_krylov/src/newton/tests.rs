#![allow(clippy::unwrap_used)]
mod ends;

use super::*;
use crate::problem::Inadmissible;
use crate::test_problems::{Bratu, Small, bits, with_threads};

/// Linear systems solved so exactly that Newton is quadratic to round-off.
fn exact() -> Settings {
    let mut settings = Settings { relative_tolerance: 1e-12, ..Settings::default() };
    settings.forcing.minimum = 1e-9;
    settings.forcing.initial = 1e-9;
    settings
}

fn run(problem: &mut dyn NonlinearProblem, z: &mut [f64], settings: &Settings) -> Result<Report, Error> {
    solve(problem, z, None, settings, &mut Workspace::default())
}

/// The order p in e_{k+1} = c e_k^p, from each three consecutive norms above `floor`.
fn orders(history: &[f64], floor: f64) -> Vec<f64> {
    let order = |e: &[f64]| (e[2] / e[1]).ln() / (e[1] / e[0]).ln();
    history.windows(3).filter(|e| e[2] > floor * history[0]).map(order).collect()
}

// ---- Bratu and Broyden: smooth problems with known behaviour -----------------------------------------------------------

#[test]
fn bratu_converges_quadratically_to_the_solution_of_the_differential_equation() {
    let error = |n: usize| {
        let mut u = vec![0.0; n];
        run(&mut Bratu::new(n), &mut u, &exact()).unwrap();
        let x = |i: usize| (i + 1) as f64 / (n + 1) as f64;
        (0..n).map(|i| (u[i] - Bratu::exact(x(i))).abs()).fold(0.0, f64::max)
    };
    let order = (error(31) / error(63)).log2();
    assert!((order - 2.0).abs() <= 0.01, "order {order} of the second differences");

    let report = run(&mut Bratu::new(63), &mut [0.0; 63], &exact()).unwrap();
    let orders = orders(&report.residual_history(), 1e-12);
    assert!(orders.last().unwrap() > &1.9, "orders {orders:?}");
    assert!(report.final_norm() <= 1e-12 * report.initial_norm);
}

/// (3 - 2 x_i) x_i - x_{i-1} - 2 x_{i+1} + 1 (Broyden, Math. Comp. 19, 1965)
fn broyden(x: &[f64]) -> Result<Vec<f64>, Inadmissible> {
    let at = |i: usize| x.get(i).copied().unwrap_or(0.0);
    Ok((0..x.len()).map(|i| (3.0 - 2.0 * x[i]) * x[i] - at(i.wrapping_sub(1)) - 2.0 * at(i + 1) + 1.0).collect())
}

fn broyden_jacobian(x: &[f64]) -> Vec<Vec<f64>> {
    let entry = |i: usize, j: usize| match j.wrapping_sub(i) {
        0 => 3.0 - 4.0 * x[i],
        1 => -2.0,
        usize::MAX => -1.0,
        _ => 0.0,
    };
    (0..x.len()).map(|i| (0..x.len()).map(|j| entry(i, j)).collect()).collect()
}

#[test]
fn broyden_tridiagonal_takes_the_known_counts() {
    let mut problem = Small::new(50, broyden, broyden_jacobian);
    let counts = |report: Report| {
        let krylov: Vec<usize> = report.steps.iter().map(|step| step.krylov_iterations).collect();
        (krylov, report.residual_evaluations, report.jacobian_products)
    };
    let tight = run(&mut problem, &mut [-1.0; 50], &exact()).unwrap();
    assert!(orders(&tight.residual_history(), 1e-12).last().unwrap() > &1.9);
    assert_eq!(counts(tight), (vec![17, 4, 7, 13, 5], 6, 47));
    let inexact = run(&mut problem, &mut [-1.0; 50], &Settings::default()).unwrap();
    assert_eq!(counts(inexact), (vec![2, 3, 6, 7], 5, 18));
}

#[test]
fn same_bits_on_one_two_and_three_threads() {
    let run = || {
        let mut u = vec![0.0; 20_000];
        run(&mut Bratu::new(20_000), &mut u, &Settings::default()).unwrap();
        bits(&u)
    };
    let one = with_threads(1, run);
    assert_eq!(one, with_threads(2, run));
    assert_eq!(one, with_threads(3, run));
}

// ---- Admissibility: ln x = 0 -------------------------------------------------------------------------------------------

fn logarithm(x: &[f64]) -> Result<Vec<f64>, Inadmissible> {
    let undefined = |value| Inadmissible { quantity: "x".into(), value, location: "in the logarithm".into() };
    if x[0] > 0.0 { Ok(vec![x[0].ln()]) } else { Err(undefined(x[0])) }
}

fn logarithm_problem() -> Small {
    Small::new(1, logarithm, |x| vec![vec![1.0 / x[0]]])
}

/// From x > e the full step leads to x (1 - ln x) < 0.
#[test]
fn the_line_search_keeps_the_state_admissible() {
    let mut x = [20.0];
    let report = run(&mut logarithm_problem(), &mut x, &exact()).unwrap();
    assert!((x[0] - 1.0).abs() <= 1e-12);
    assert_eq!(report.steps[0].step_length, 0.25, "1 - a ln 20 > 0 and |ln| falls");
    assert_eq!(report.steps.last().unwrap().step_length, 1.0);
    assert!(report.residual_evaluations > report.steps.len() + 1);
}

/// Steps of a twentieth leave 0.81 of the residual after four of them, steps of a fifth 0.41.
#[test]
fn a_solve_whose_steps_stay_short_is_given_up() {
    let rule = Some(FruitlessSteps { steps: 4, left: 0.8 });
    let solve = |largest_step, fruitless_steps| {
        let mut problem = logarithm_problem();
        problem.largest_step = largest_step;
        run(&mut problem, &mut [20.0], &Settings { fruitless_steps, max_steps: 1000, ..Settings::default() })
    };
    let error = solve(0.05, rule).unwrap_err();
    assert!(matches!(error, Error::Fruitless { steps: 4, .. }) && error.report().steps.len() == 4, "{error}");
    assert!(solve(0.05, None).is_ok() && solve(0.2, rule).is_ok());
}

#[test]
fn no_step_is_longer_than_the_problem_allows() {
    let mut problem = logarithm_problem();
    problem.largest_step = 0.3;
    let report = run(&mut problem, &mut [2.0], &Settings { max_steps: 200, ..exact() }).unwrap();
    assert!(report.steps.iter().all(|step| step.step_length == 0.3));
}

#[test]
fn an_inadmissible_guess_is_an_error_with_its_cause() {
    let mut z = [-2.0];
    let error = run(&mut logarithm_problem(), &mut z, &exact()).unwrap_err();
    assert!(matches!(&error, Error::Inadmissible { source: Inadmissible { value: -2.0, .. }, .. }));
    let cause = std::error::Error::source(&error).unwrap().to_string();
    assert_eq!(cause, "inadmissible state: x = -2e0 in the logarithm");
}

// ---- Pseudo-time: x^3 - 2 x + 2 = 0 has a local minimum of |R| between the guess and its only root ---------------------

fn valley(x: &[f64]) -> Result<Vec<f64>, Inadmissible> {
    Ok(vec![x[0].powi(3) - 2.0 * x[0] + 2.0, x[1] - 1.0])
}

fn valley_problem() -> Small {
    let jacobian = |x: &[f64]| vec![vec![3.0 * x[0] * x[0] - 2.0, 0.0], vec![0.0, 1.0]];
    Small::with_fields(&[("cubic", 1), ("linear", 1)], valley, jacobian)
}

const ROOT: f64 = -1.769_292_354_238_631_4;

#[test]
fn plain_newton_is_trapped_and_says_so() {
    let mut settings = exact();
    settings.pseudo_time.restart_inverse = 0.0;
    let mut z = [2.0, 1.0];
    let error = run(&mut valley_problem(), &mut z, &settings).unwrap_err();
    assert!(matches!(error, Error::LineSearch { source: line_search::Error::NoDecrease { .. }, .. }), "{error:?}");
    assert!((z[0] - (2.0_f64 / 3.0).sqrt()).abs() < 0.1, "stuck at {z:?}");
    assert_eq!(valley(&z).unwrap()[0].abs(), error.report().final_norm(), "z is the last accepted iterate");
}

#[test]
fn a_failed_line_search_switches_pseudo_time_on_and_convergence_switches_it_off() {
    let mut z = [2.0, 1.0];
    let report = run(&mut valley_problem(), &mut z, &Settings { max_steps: 100, ..exact() }).unwrap();
    assert!((z[0] - ROOT).abs() <= 1e-12 && z[1] == 1.0);
    let damping: Vec<f64> = report.steps.iter().map(|step| step.inverse_pseudo_time[0]).collect();
    assert_eq!(damping[0], 0.0);
    assert!(damping.iter().any(|&inverse| inverse > 0.0));
    assert_eq!(damping.last(), Some(&0.0));
    assert!(report.steps.iter().any(|step| step.rejections > 0));
    assert!(report.steps.iter().all(|step| step.inverse_pseudo_time[1] == 0.0), "the converged field is left alone");
    assert!(orders(&report.residual_history(), 1e-12).last().unwrap() > &1.8);
}

/// At the bottom of the valley attempts are rejected until the damping is strong enough, and no step may be longer than a fifth.
#[test]
fn rejected_attempts_count_as_fruitless_steps() {
    let (mut problem, mut z) = (valley_problem(), [0.82, 1.0]);
    problem.largest_step = 0.2;
    let rule = FruitlessSteps { steps: 3, left: 0.0 };
    let mut settings = Settings { fruitless_steps: Some(rule), max_steps: 100, ..exact() };
    settings.line_search.max_trials = 2;
    let error = run(&mut problem, &mut z, &settings).unwrap_err();
    let (steps, Error::Fruitless { steps: count, .. }) = (&error.report().steps, &error) else { panic!("{error}") };
    let attempts: usize = steps.iter().map(|step| 1 + step.rejections).sum();
    assert!(*count == steps.len() && steps.len() < 3 && attempts >= 3, "{steps:?}");
}

/// The way through the valley leads uphill, by damped steps that are not short.
#[test]
fn damped_steps_that_raise_the_residual_count_as_fruitless_steps() {
    let mut settings = Settings { max_steps: 100, ..exact() };
    settings.pseudo_time.initial_inverse = 4.0;
    let mut solve = |steps| {
        settings.fruitless_steps = Some(FruitlessSteps { steps, left: 0.8 });
        run(&mut valley_problem(), &mut [0.5, 1.0], &settings)
    };
    let error = solve(2).unwrap_err();
    let (report, Error::Fruitless { steps: 2, before, .. }) = (error.report(), &error) else { panic!("{error}") };
    let last = report.steps.last().unwrap();
    assert!(last.is_damped() && last.step_length > 0.25 && last.residual_norm > *before, "{last:?}");
    assert!(solve(50).is_ok());
}

/// A line search without limit takes shorter and shorter steps towards the minimum; damping starts earlier.
#[test]
fn short_steps_in_a_row_switch_pseudo_time_on() {
    let mut settings = Settings { max_steps: 100, ..exact() };
    settings.line_search.max_trials = 40;
    let mut z = [2.0, 1.0];
    let report = run(&mut valley_problem(), &mut z, &settings).unwrap();
    assert!((z[0] - ROOT).abs() <= 1e-12);
    let lengths: Vec<f64> = report.steps[..5].iter().map(|step| step.step_length).collect();
    assert_eq!(lengths, [1.0, 1.0, 0.0625, 0.015625, 2.0_f64.powi(-16)]);
    assert!(report.steps[..5].iter().all(|step| step.inverse_pseudo_time[0] == 0.0));
    assert_eq!((report.steps[5].inverse_pseudo_time[0], report.steps[5].rejections), (1.0, 0));
}

#[test]
fn pseudo_time_from_the_start_passes_the_valley_without_a_rejection() {
    let mut settings = exact();
    settings.pseudo_time.initial_inverse = 4.0;
    settings.max_steps = 100;
    let mut z = [2.0, 1.5];
    let report = run(&mut valley_problem(), &mut z, &settings).unwrap();
    assert!((z[0] - ROOT).abs() <= 1e-12);
    assert!(report.steps.iter().all(|step| step.rejections == 0));
    assert_eq!(report.steps.last().unwrap().inverse_pseudo_time, [0.0, 0.0]);
}

// ---- Two fields of very different size ---------------------------------------------------------------------------------

/// x^2 - 4 = 0, and, a million times smaller, y^3 - x = 0.
fn unequal_problem() -> Small {
    let residual = |z: &[f64]| Ok(vec![z[0] * z[0] - 4.0, 1e-6 * (z[1].powi(3) - z[0])]);
    let jacobian = |z: &[f64]| vec![vec![2.0 * z[0], 0.0], vec![-1e-6, 3e-6 * z[1] * z[1]]];
    Small::with_fields(&[("large", 1), ("small", 1)], residual, jacobian)
}

#[test]
fn no_field_hides_behind_another() {
    let settings = Settings { relative_tolerance: 1e-6, ..Settings::default() };
    let mut z = [3.0, 5.0];
    let report = run(&mut unequal_problem(), &mut z, &settings).unwrap();
    let hidden = |step: &&StepReport| step.residual_norm <= 1e-6 * report.initial_norm;
    assert!(report.steps.iter().filter(hidden).count() > 1, "the total norm alone would have stopped earlier");
    for (last, first) in report.final_field_norms().iter().zip(&report.initial_field_norms) {
        assert!(*last <= 1e-6 * first);
    }
    // |y^3 - 2| <= 1e-6 x 122, and the derivative of y^3 there is 4.76.
    assert!((z[1] - 2.0_f64.cbrt()).abs() <= 1.22e-4 / 4.76);
}

#[test]
fn references_replace_the_norms_at_the_guess() {
    let settings = Settings { relative_tolerance: 1e-6, ..Settings::default() };
    let solve_from = |references: Option<&[f64]>| {
        let mut problem = unequal_problem();
        solve(&mut problem, &mut [2.0 + 1e-9, 1.25], references, &settings, &mut Workspace::default()).unwrap()
    };
    assert!(solve_from(Some(&[5.0, 1.0])).steps.is_empty());
    assert!(!solve_from(None).steps.is_empty());
}
