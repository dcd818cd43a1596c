#![allow(clippy::unwrap_used, clippy::print_stdout)]

use super::*;
use std::f64::consts::PI;
use tensor::Dual;

/// n points of `f` on [0, 2], not evenly spaced.
fn sampled(f: fn(f64) -> f64, n: usize, ends: Ends) -> Table {
    let t = |k: usize| {
        let s = k as f64 / (n - 1) as f64;
        2.0 * (s + 0.15 * s * (1.0 - s))
    };
    let t: Vec<f64> = (0..n).map(t).collect();
    let y = t.iter().map(|t| f(*t)).collect();
    Table::new(t, y, ends).unwrap()
}

/// The largest errors of value and slope between the points.
fn errors(table: &Table, f: fn(f64) -> f64, slope: fn(f64) -> f64) -> [f64; 2] {
    let mut errors = [0.0_f64; 2];
    for i in 0..=1000 {
        let t = 2.0 * f64::from(i) / 1000.0;
        let found = table.evaluate(Dual::new(t, 1.0));
        errors[0] = errors[0].max((found.value() - f(t)).abs());
        errors[1] = errors[1].max((found.derivative - slope(t)).abs());
    }
    errors
}

#[test]
fn values_are_of_order_four_and_slopes_of_order_three() {
    // At rest at 0 and 2, and of period 2.
    let cosine: [fn(f64) -> f64; 2] = [|t| (PI * t).cos(), |t| -PI * (PI * t).sin()];
    let exponential: [fn(f64) -> f64; 2] =
        [|t| (-t).exp() * (3.0 * t).sin(), |t| (-t).exp() * (3.0 * (3.0 * t).cos() - (3.0 * t).sin())];
    for (ends, [f, slope]) in [(Ends::Free, exponential), (Ends::AtRest, cosine), (Ends::Periodic, cosine)] {
        let [coarse, fine] = [21, 41].map(|n| errors(&sampled(f, n, ends), f, slope));
        let orders = [0, 1].map(|i| (coarse[i] / fine[i]).log2());
        println!("{ends:?}: errors {fine:?}, orders {orders:.2?}");
        assert!(orders[0] > 3.7 && orders[1] > 2.7, "{ends:?}: {orders:?}");
    }
}

#[test]
fn cubics_are_met_exactly() {
    let f = |t: f64| 1.0 - 2.0 * t + 3.0 * t * t - 0.5 * t * t * t;
    let slope = |t: f64| -2.0 + 6.0 * t - 1.5 * t * t;
    let [value, derivative] = errors(&sampled(f, 7, Ends::Free), f, slope);
    assert!(value < 1e-13 && derivative < 1e-12, "{value:e} {derivative:e}");
}

#[test]
fn two_derivatives_are_continuous() {
    // At inner points, and across the end of a period.
    let second =
        |table: &Table, t: f64| table.evaluate(Dual::new(Dual::new(t, 1.0), Dual::new(1.0, 0.0))).derivative.derivative;
    for ends in [Ends::Free, Ends::AtRest, Ends::Periodic] {
        let table = sampled(|t| (PI * t).sin() + (2.0 * PI * t).cos(), 9, ends);
        for k in 1..table.t.len() - usize::from(ends != Ends::Periodic) {
            let (before, after) = (table.t[k] - 1e-9, table.t[k] + 1e-9);
            for (order, jump) in [
                (0, table.evaluate(after) - table.evaluate(before)),
                (
                    1,
                    table.evaluate(Dual::new(after, 1.0)).derivative
                        - table.evaluate(Dual::new(before, 1.0)).derivative,
                ),
                (2, second(&table, after) - second(&table, before)),
            ] {
                assert!(jump.abs() < 1e-5, "{ends:?}: derivative {order} jumps by {jump} at point {k}");
            }
        }
    }
}

#[test]
fn beyond_its_ends_a_table_rests_repeats_or_has_no_value() {
    let f: fn(f64) -> f64 = |t| 1.0 - (PI * t).cos();
    let table = |ends| sampled(f, 9, ends);
    let at_rest = table(Ends::AtRest).evaluate(Dual::new(7.0, 1.0));
    assert_eq!((at_rest.value(), at_rest.derivative), (f(2.0), 0.0));
    let periodic = table(Ends::Periodic);
    for t in [0.3, 1.7] {
        let (once, later) = (periodic.evaluate(Dual::new(t, 1.0)), periodic.evaluate(Dual::new(t + 6.0, 1.0)));
        assert!((once.value() - later.value()).abs() < 1e-14 && (once.derivative - later.derivative).abs() < 1e-13);
        assert!((periodic.evaluate(t - 4.0) - once.value()).abs() < 1e-14);
    }
    let free = table(Ends::Free);
    assert!(free.evaluate(2.001).is_nan() && free.evaluate(-0.001).is_nan());
    assert!((free.evaluate(2.0 + 1e-12) - f(2.0)).abs() < 1e-10, "round-off is not beyond");
}

#[test]
fn what_is_no_function_is_refused() {
    let error = |t: &[f64], y: &[f64], ends| Table::new(t.to_vec(), y.to_vec(), ends).unwrap_err();
    assert_eq!(error(&[0.0, 1.0], &[0.0], Ends::Free), TableError::Lengths { times: 2, values: 1 });
    assert_eq!(error(&[0.0, 1.0, 2.0], &[0.0; 3], Ends::Free), TableError::TooFew { found: 3, needed: 4 });
    assert_eq!(error(&[0.0, f64::NAN], &[0.0; 2], Ends::AtRest), TableError::NotFinite(2));
    assert_eq!(error(&[0.0, 0.0], &[0.0; 2], Ends::AtRest), TableError::NotIncreasing { earlier: 0.0, later: 0.0 });
    let periodic = error(&[0.0, 1.0, 2.0, 3.0], &[0.0, 1.0, 2.0, 0.1], Ends::Periodic);
    assert_eq!(periodic, TableError::NotPeriodic { first: 0.0, last: 0.1 });
}

/// A step that is steeper than the rest of a table makes the spline swing far beyond it.
#[test]
fn a_spline_far_beyond_its_points_is_found() {
    let steep = Table::new(vec![0.0, 0.2, 0.2001, 0.6, 1.0], vec![0.0, 0.0, 0.2, 0.2, 0.1], Ends::AtRest).unwrap();
    let Overshoot { t, value, between } = steep.overshoot(0.5).unwrap();
    assert!(value.abs() > 10.0 && between[0] == between[1] && !(0.2..=0.2001).contains(&t), "{value} at {t}");
    for ends in [Ends::Free, Ends::Periodic] {
        assert_eq!(sampled(|t| (PI * t).sin(), 5, ends).overshoot(0.5), None);
    }
}
