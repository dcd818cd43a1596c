//! The ends of a solve other than convergence: rounding, too few steps, linear solves that fall short, residuals that grow or stand still.

use super::*;

#[test]
fn a_tolerance_below_round_off_ends_at_round_off() {
    let settings = Settings { relative_tolerance: 0.0, ..exact() };
    let report = run(&mut Bratu::new(63), &mut [0.0; 63], &settings).unwrap();
    assert_eq!(report.convergence, Some(Convergence::RoundOff));
    assert!(report.final_norm() <= 1e-13 * report.initial_norm);
}

/// x^2 - 2 whose last digit is 1e-6: f(x) is rounded to multiples of it, and sqrt(2) is not a computed root.
fn coarse_problem() -> Small {
    let rounded = |x: &[f64]| Ok(vec![1e-6 * ((x[0] * x[0] - 2.0) / 1e-6 + 0.3).round() + 4e-7]);
    Small::new(1, rounded, |x| vec![vec![2.0 * x[0]]])
}

#[test]
fn without_an_estimate_of_rounding_a_solve_fails_at_it() {
    assert!(run(&mut coarse_problem(), &mut [2.0], &exact()).is_err());
}

#[test]
fn a_solve_ends_at_the_rounding_that_the_problem_estimates() {
    let mut problem = coarse_problem();
    problem.rounding = Some(vec![2e-6]);
    let mut x = [2.0];
    let report = run(&mut problem, &mut x, &exact()).unwrap();
    assert_eq!((report.convergence, report.round_off), (Some(Convergence::RoundOff), Some(2e-6)));
    assert!((x[0] - 2.0_f64.sqrt()).abs() <= 1e-6, "{x:?}");
    assert!(report.steps.iter().all(|step| step.rejections == 0), "no damping against rounding: {report:?}");
}

/// An estimate far above the true rounding does not end a solve that still makes progress.
#[test]
fn an_estimate_of_rounding_does_not_end_a_solve_that_makes_progress() {
    let mut problem = Small::new(1, |x| Ok(vec![x[0] * x[0] - 2.0]), |x| vec![vec![2.0 * x[0]]]);
    problem.rounding = Some(vec![1.0]);
    let mut x = [1.5];
    let report = run(&mut problem, &mut x, &exact()).unwrap();
    assert_eq!(report.convergence, Some(Convergence::Tolerance));
    assert!((x[0] - 2.0_f64.sqrt()).abs() <= 1e-13, "{x:?}");
}

#[test]
fn a_solution_as_guess_takes_no_step() {
    let report = run(&mut logarithm_problem(), &mut [1.0], &exact()).unwrap();
    assert_eq!((report.steps.len(), report.convergence), (0, Some(Convergence::Tolerance)));
}

#[test]
fn too_few_steps_are_an_error_that_carries_the_report() {
    let error = run(&mut Bratu::new(63), &mut [0.0; 63], &Settings { max_steps: 1, ..exact() }).unwrap_err();
    assert!(matches!(error, Error::MaxSteps { .. }));
    assert_eq!(error.report().steps.len(), 1);
    assert!(error.to_string().starts_with("Newton: no convergence in 1 steps: the residual norm went from"));
}

#[test]
fn a_linear_solve_that_falls_short_is_used_if_it_reduces_the_residual() {
    let mut settings = Settings { max_steps: 100, ..Settings::default() };
    settings.krylov.max_iterations = 2;
    let report = run(&mut Small::new(50, broyden, broyden_jacobian), &mut [-1.0; 50], &settings).unwrap();
    assert!(report.steps.iter().any(|step| step.linear_residual > step.forcing));
}

/// x^2 - 1 from x = 0, where the derivative vanishes.
#[test]
fn a_singular_jacobian_is_cured_by_pseudo_time() {
    let mut problem = Small::new(1, |x| Ok(vec![x[0] * x[0] - 1.0]), |x| vec![vec![2.0 * x[0]]]);
    let mut x = [0.0];
    let report = run(&mut problem, &mut x, &exact()).unwrap();
    assert!((x[0] - 1.0).abs() <= 1e-12);
    assert_eq!((report.steps[0].rejections, report.steps[0].inverse_pseudo_time[0]), (1, 1.0));
    let undamped =
        Settings { pseudo_time: pseudo_time::Settings { restart_inverse: 0.0, ..Default::default() }, ..exact() };
    let error = run(&mut problem, &mut [0.0], &undamped).unwrap_err();
    assert!(matches!(error, Error::Krylov { source: fgmres::Error::Stagnated(_), .. }));
}

#[test]
fn a_jacobian_that_is_not_finite_is_a_krylov_failure() {
    let mut problem = Small::new(1, |x| Ok(vec![x[0] - 1.0]), |_| vec![vec![f64::NAN]]);
    let error = run(&mut problem, &mut [0.0], &exact()).unwrap_err();
    assert!(matches!(error, Error::Krylov { source: fgmres::Error::NotFinite(_), .. }));
}

#[test]
fn a_residual_that_grows_beyond_all_bounds_is_divergence() {
    // Unlimited damping for x' = exp(x): the merit function falls in every step while the residual grows.
    let mut settings = exact();
    settings.pseudo_time.initial_inverse = 10.0;
    settings.pseudo_time.power = 0.0;
    settings.max_steps = 1000;
    let mut problem = Small::new(1, |x| Ok(vec![-1.0 - x[0] * x[0]]), |x| vec![vec![-2.0 * x[0]]]);
    let error = run(&mut problem, &mut [0.0], &settings).unwrap_err();
    assert!(matches!(error, Error::Diverged { .. }), "{error}");
}

// ---- stalls --------------------------------------------------------------------------------------------------------------

/// x^2 + 1 has no root: without a stall criterion the driver would use all its steps.
#[test]
fn a_residual_that_no_longer_falls_ends_the_solve_at_the_best_iterate() {
    let no_root = |x: &[f64]| Ok(vec![x[0] * x[0] + 1.0]);
    let mut problem = Small::new(1, no_root, |x: &[f64]| vec![vec![2.0 * x[0]]]);
    let mut settings = Settings { max_steps: 100, stall: Some(Stall { steps: 5, factor: 0.9 }), ..Settings::default() };
    // Unlimited damping: an implicit Euler step always reduces |G|.
    settings.pseudo_time = pseudo_time::Settings { initial_inverse: 10.0, switch_off: 0.0, ..settings.pseudo_time };
    let mut x = [2.0];
    let error = run(&mut problem, &mut x, &settings).unwrap_err();
    let Error::Stalled { least, report, .. } = &error else { panic!("{error}") };
    assert!(report.steps.len() < 40, "{} steps", report.steps.len());
    let history = report.residual_history();
    let best = history.iter().copied().fold(f64::INFINITY, f64::min);
    assert_eq!(x[0] * x[0] + 1.0, best, "back at the best iterate");
    assert!(*least >= best && *least <= best / 0.9);
    assert!(error.to_string().contains("has not fallen enough in the last 5 steps"), "{error}");
}

#[test]
fn a_solve_that_converges_does_not_feel_the_watch_for_stalls() {
    let solve = |stall| {
        let mut u = vec![0.0; 63];
        run(&mut Bratu::new(63), &mut u, &Settings { stall, ..exact() }).unwrap();
        bits(&u)
    };
    assert_eq!(solve(None), solve(Some(Stall { steps: 1, factor: 0.9 })));
}

#[test]
fn a_solve_ends_before_the_step_that_its_caller_does_not_want() {
    let asked = std::cell::Cell::new(0);
    let is_stopped = || asked.replace(asked.get() + 1) == 2;
    let (mut u, mut problem, settings) = (vec![0.0; 63], Bratu::new(63), exact());
    let error =
        solve_until(&mut problem, &mut u, None, (&settings, &is_stopped), &mut Workspace::default()).unwrap_err();
    assert!(matches!(error, Error::Stopped { .. }) && error.report().steps.len() == 2, "{error}");
    let mut two = vec![0.0; 63];
    run(&mut Bratu::new(63), &mut two, &Settings { max_steps: 2, ..settings }).unwrap_err();
    assert_eq!(bits(&u), bits(&two));
}

/// A relative tolerance of an infinite residual is infinite too.
#[test]
fn an_infinite_residual_has_not_converged() {
    let mut problem = Small::new(1, |z: &[f64]| Ok(vec![1e200 * (z[0] - 1.0)]), |_| vec![vec![1e200]]);
    let result = solve(&mut problem, &mut [0.0], None, &Settings::default(), &mut Workspace::default());
    assert!(matches!(result, Err(Error::Diverged { .. })), "{result:?}");
}
