#![allow(clippy::unwrap_used)]
use super::*;
use crate::inner_product::{Euclidean, Weighted, axpy};
use crate::operator::{Identity, LinearOperator, Preconditioned, Preconditioner};
use crate::test_problems::{Action, Dense, Diagonal, bits, laplacian, scattered, with_threads};

const TIGHT: Settings = Settings {
    relative_tolerance: 1e-12,
    absolute_tolerance: 0.0,
    restart: 60,
    max_iterations: 300,
    stagnation: 0.999,
    precision: Precision::Double,
};

/// Solves from zero in the Euclidean norm.
fn run(
    operator: &mut dyn LinearOperator,
    preconditioner: &mut dyn Preconditioner,
    b: &[f64],
    settings: &Settings,
) -> (Vec<f64>, Result<Report, Error>, Workspace) {
    let (mut x, mut workspace) = (vec![0.0; b.len()], Workspace::default());
    let mut system = Preconditioned { operator, preconditioner, inner_product: &Euclidean };
    let result = solve(&mut system, b, &mut x, settings, &mut workspace);
    (x, result, workspace)
}

/// The largest difference of two vectors.
fn distance(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x_i, y_i)| (x_i - y_i).abs()).fold(0.0, f64::max)
}

/// |b - A x|
fn residual_norm(a: &mut Dense, x: &[f64], b: &[f64]) -> f64 {
    let mut r = vec![0.0; b.len()];
    a.apply(x, &mut r);
    xpay(b, -1.0, &mut r);
    Euclidean.norm(&r)
}

/// An unsymmetric matrix: n on the diagonal, scattered entries elsewhere.
fn unsymmetric(n: usize) -> Dense {
    let entries = scattered(n * n);
    Dense((0..n).map(|i| (0..n).map(|j| entries[i * n + j] + if i == j { 4.0 } else { 0.0 }).collect()).collect())
}

/// x_i := x_{i-1}, cyclic: GMRES makes no progress before the last iteration.
fn cyclic_shift(x: &[f64], y: &mut [f64]) {
    let n = x.len();
    (0..n).for_each(|i| y[i] = x[(i + n - 1) % n]);
}

#[test]
fn agrees_with_elimination() {
    let (mut a, b) = (unsymmetric(40), scattered(40));
    let (x, result, _) = run(&mut a, &mut Identity, &b, &TIGHT);
    assert!(distance(&x, &a.solve(&b)) <= 1e-12);
    assert!(result.unwrap().iterations <= 40);
}

#[test]
fn needs_as_many_iterations_as_there_are_eigenvalues() {
    for eigenvalues in 1..=6 {
        let mut a = Diagonal((0..50).map(|i| (1 + i % eigenvalues) as f64).collect());
        let (_, result, _) = run(&mut a, &mut Identity, &scattered(50), &TIGHT);
        assert_eq!(result.unwrap().iterations, eigenvalues);
    }
}

#[test]
fn the_history_is_the_known_one_and_stays_monotone() {
    let mut b = vec![0.0; 10];
    b[0] = 1.0;
    let (x, result, workspace) = run(&mut Action(cyclic_shift), &mut Identity, &b, &TIGHT);
    assert_eq!(workspace.history()[..10], [1.0; 10]);
    assert_eq!(workspace.history()[10], 0.0);
    assert_eq!((result.unwrap().iterations, x[9]), (10, 1.0));
    let (_, _, workspace) = run(&mut unsymmetric(40), &mut Identity, &scattered(40), &TIGHT);
    assert!(workspace.history().windows(2).all(|pair| pair[1] <= pair[0]));
}

#[test]
fn restarts_where_it_must_and_reports_stagnation_where_that_is_of_no_use() {
    let (mut a, b) = (unsymmetric(40), scattered(40));
    let restarted = Settings { restart: 6, ..TIGHT };
    let (x, result, _) = run(&mut a, &mut Identity, &b, &restarted);
    let report = result.unwrap();
    assert!(distance(&x, &a.solve(&b)) <= 1e-12);
    assert_eq!(report.restarts, (report.iterations - 1) / 6);
    assert!(report.restarts >= 2);
    let mut b = vec![0.0; 10];
    b[0] = 1.0;
    let (_, result, _) = run(&mut Action(cyclic_shift), &mut Identity, &b, &Settings { restart: 9, ..TIGHT });
    assert!(matches!(result, Err(Error::Stagnated(Report { iterations: 9, final_norm: 1.0, .. }))));
}

#[test]
fn the_preconditioner_may_change_in_every_iteration() {
    // P^-1 is the exact inverse, except for a part that changes each time.
    let (mut a, b) = (unsymmetric(40), scattered(40));
    let exact = a.clone();
    let mut calls = 0;
    let mut varying = Action(|r: &[f64], z: &mut [f64]| {
        calls += 1;
        let inverse = exact.solve(r);
        (0..r.len()).for_each(|i| z[i] = inverse[i] + 0.1 * ((i * calls) as f64).sin() * r[i]);
    });
    let (x, result, _) = run(&mut a, &mut varying, &b, &TIGHT);
    assert!(distance(&x, &exact.solve(&b)) <= 1e-12);
    assert_eq!(result.unwrap().iterations, 21);
}

#[test]
fn an_exact_preconditioner_needs_one_iteration() {
    let (mut a, b) = (unsymmetric(40), scattered(40));
    let exact = a.clone();
    let mut inverse = Action(|r: &[f64], z: &mut [f64]| z.copy_from_slice(&exact.solve(r)));
    let (_, result, _) = run(&mut a, &mut inverse, &b, &TIGHT);
    assert_eq!(result.unwrap().iterations, 1);
}

#[test]
fn minimises_the_weighted_norm() {
    // One iteration: x = s b with s = (b, A b) / (A b, A b) in the weighted inner product.
    let (mut a, b) = (unsymmetric(20), scattered(20));
    let inner_product = Weighted::new((1..=20).map(f64::from).collect());
    let mut a_b = vec![0.0; 20];
    a.apply(&b, &mut a_b);
    let s = inner_product.dot(&b, &a_b) / inner_product.dot(&a_b, &a_b);
    let mut x = vec![0.0; 20];
    let mut system = Preconditioned { operator: &mut a, preconditioner: &mut Identity, inner_product: &inner_product };
    let once = Settings { max_iterations: 1, ..TIGHT };
    let error = solve(&mut system, &b, &mut x, &once, &mut Workspace::default()).unwrap_err();
    let expected: Vec<f64> = b.iter().map(|b_i| s * b_i).collect();
    assert!(distance(&x, &expected) <= 1e-15);
    assert!(matches!(error, Error::MaxIterations(Report { iterations: 1, .. })));
}

/// If the residual fell far, a product computes its norm. Otherwise the estimate is as good and saves the product.
#[test]
fn the_reported_norm_is_that_of_the_true_residual() {
    let (mut a, b) = (unsymmetric(40), scattered(40));
    for (relative_tolerance, spent, error) in [(1e-3, 0, 1e-12), (1e-9, 1, 0.0)] {
        let (x, result, _) = run(&mut a, &mut Identity, &b, &Settings { relative_tolerance, ..TIGHT });
        let (report, norm) = (result.unwrap(), residual_norm(&mut a, &x, &b));
        assert!((report.final_norm - norm).abs() <= error * norm, "{} is not {norm}", report.final_norm);
        assert!(report.final_norm <= relative_tolerance * report.initial_norm);
        assert_eq!(report.products, report.iterations + spent);
    }
}

#[test]
fn starts_from_the_guess_and_stops_at_once_if_it_will_do() {
    let (mut a, b) = (unsymmetric(40), scattered(40));
    let mut x = a.solve(&b);
    let mut system = Preconditioned { operator: &mut a, preconditioner: &mut Identity, inner_product: &Euclidean };
    let report = solve(&mut system, &b, &mut x, &TIGHT, &mut Workspace::default()).unwrap();
    assert_eq!((report.iterations, report.products), (0, 1));
    let (x, result, _) = run(&mut a, &mut Identity, &[0.0; 40], &TIGHT);
    assert_eq!((x, result.unwrap().iterations), (vec![0.0; 40], 0));
}

#[test]
fn a_singular_system_keeps_its_best_iterate() {
    // The second equation is 0 x = 1: the least residual is 1.
    let (x, result, _) = run(&mut Diagonal(vec![2.0, 0.0]), &mut Identity, &[2.0, 1.0], &TIGHT);
    assert!((x[0] - 1.0).abs() <= 1e-15);
    assert!(matches!(result, Err(Error::Stagnated(Report { final_norm, .. })) if (final_norm - 1.0).abs() <= 1e-15));
}

#[test]
fn numbers_that_are_not_finite_are_an_error_and_do_not_reach_x() {
    let mut calls = 0;
    let mut breaking = Action(|x: &[f64], y: &mut [f64]| {
        calls += 1;
        laplacian(x, y);
        y[3] += if calls == 4 { f64::NAN } else { 0.0 };
    });
    let (x, result, _) = run(&mut breaking, &mut Identity, &scattered(30), &TIGHT);
    assert!(x.iter().all(|x_i| x_i.is_finite()));
    let Err(Error::NotFinite(report)) = result else { panic!("{result:?}") };
    assert!(report.final_norm < report.initial_norm);
    assert_eq!(report.iterations, 4);
}

#[test]
fn same_bits_on_one_two_and_three_threads() {
    let b = scattered(50_001);
    let settings = Settings { relative_tolerance: 1e-6, restart: 15, ..TIGHT };
    let run = || {
        let mut a = Action(|x: &[f64], y: &mut [f64]| {
            laplacian(x, y);
            axpy(0.5, x, y);
        });
        let (x, result, _) = run(&mut a, &mut Identity, &b, &settings);
        (bits(&x), result.unwrap().iterations)
    };
    let one = with_threads(1, run);
    assert_eq!(one, with_threads(2, run));
    assert_eq!(one, with_threads(3, run));
    assert_eq!(one.1, 21, "one restart");
}

/// w = v + 1e-12 d: one pass of Gram-Schmidt leaves (v, w) at about 1e-4.
#[test]
fn a_vector_that_nearly_depends_on_the_basis_is_made_orthogonal_to_round_off() {
    let (mut v, mut w) = (scattered(50), scattered(100)[50..].to_vec());
    let length = Euclidean.norm(&v);
    scale(1.0 / length, &mut v);
    scale(1e-12, &mut w);
    axpy(1.0, &v, &mut w);
    let mut work = Work { w, ..Work::default() };
    work.least_squares.start(1.0);
    let norm = orthonormalise(&Euclidean, std::slice::from_ref(&v), &mut work).unwrap();
    assert!(Euclidean.dot(&v, &work.w).abs() <= 1e-15);
    assert!((Euclidean.norm(&work.w) - 1.0).abs() <= 1e-15 && norm < 1e-11);
}

const SINGLE: Settings = Settings { precision: Precision::Single, ..TIGHT };

#[test]
fn a_basis_in_single_precision_costs_no_iteration_at_moderate_tolerances() {
    let (mut a, b) = (unsymmetric(40), scattered(40));
    for relative_tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
        let iterations = [SINGLE, TIGHT].map(|settings| {
            let (_, result, _) = run(&mut a, &mut Identity, &b, &Settings { relative_tolerance, ..settings });
            result.unwrap().iterations
        });
        assert_eq!(iterations[0], iterations[1], "{relative_tolerance}");
    }
}

#[test]
fn a_basis_in_single_precision_reaches_double_precision_in_more_cycles() {
    let (mut a, b) = (unsymmetric(40), scattered(40));
    let (x, result, workspace) = run(&mut a, &mut Identity, &b, &SINGLE);
    let report = result.unwrap();
    assert!(distance(&x, &a.solve(&b)) <= 1e-11);
    assert!((1..=2).contains(&report.restarts), "{report:?}");
    assert!(workspace.double.basis.is_empty() && workspace.single.basis[0].len() == 40);
}

/// z_j is rounded before the product, so that the estimate is that of the vector stored.
#[test]
fn the_norm_is_that_of_the_true_residual_in_single_precision() {
    let (mut a, b) = (unsymmetric(40), scattered(40));
    for (relative_tolerance, error) in [(1e-2, 1e-4), (1e-5, 0.0)] {
        let (x, result, _) = run(&mut a, &mut Identity, &b, &Settings { relative_tolerance, ..SINGLE });
        let (report, norm) = (result.unwrap(), residual_norm(&mut a, &x, &b));
        assert!((report.final_norm - norm).abs() <= error * norm, "{} is not {norm}", report.final_norm);
    }
}

/// A relative tolerance of an infinite right-hand side is infinite too.
#[test]
fn an_infinite_right_hand_side_is_an_error() {
    for large in [1e200, f64::INFINITY, f64::NAN] {
        let (_, result, _) = run(&mut Dense(vec![vec![1.0]]), &mut Identity, &[large], &TIGHT);
        assert!(matches!(result, Err(Error::NotFinite(_))), "{large}: {result:?}");
    }
}
