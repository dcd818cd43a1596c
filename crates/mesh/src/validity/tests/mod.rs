#![allow(clippy::unwrap_used)]

mod moving;
mod oracle;
mod random_cells;

use super::*;
use crate::lattice::digit;
use crate::random::SplitMix64;
use basis::gauss_lobatto;
use std::array::from_fn;

/// Positions `[time][node][D]` of a map, for tests with known determinants.
fn positions<const D: usize>(order: usize, times: &[f64], x: impl Fn(&[f64; D], f64) -> [f64; D]) -> Vec<f64> {
    let nodes = gauss_lobatto(order).points;
    let xi = |k: usize| from_fn(|a| nodes[digit(k, order, a)]);
    times.iter().flat_map(|s| (0..order.pow(D as u32)).flat_map(|k| x(&xi(k), *s)).collect::<Vec<_>>()).collect()
}

#[test]
fn the_bound_of_an_affine_cell_is_its_determinant() {
    for order in [2, 5, 8, 16] {
        let x = positions::<3>(order, &[0.0], |xi, _| [2.0 * xi[0] + xi[1], 3.0 * xi[1] - xi[2], 50.0 + 0.5 * xi[2]]);
        let bound = ValidityCheck::<3>::new(order, &[0.0]).bound(&x);
        assert!(bound.lower <= 3.0 && bound.lower > 3.0 * (1.0 - 1e-7), "order {order}: {bound:?}");
        assert!((bound.scaled_jacobian() - 1.0).abs() < 1e-11);
    }
}

/// A square beside a trapezium whose det J falls from 3 / 4 to 1 / 4.
#[test]
fn the_smallest_scaled_jacobian_names_its_cell() {
    let corners = vec![0, 1, 2, 3, 1, 4, 3, 5];
    let [square, trapezium] = [[0.0, 0.0, 1.0, 0.0, 0.0, 3.0, 1.0, 3.0], [1.0, 0.0, 2.0, 0.0, 1.0, 3.0, 2.0, 1.0]];
    let side = |(cell, face)| crate::Side { cell, face };
    let sides = [(0, 0), (0, 2), (0, 3), (1, 1), (1, 2), (1, 3)].map(side).to_vec();
    let boundaries = vec![("wall".to_owned(), sides)];
    let mesh = Mesh::<2>::new(2, corners, [square, trapezium].concat(), boundaries, vec![]).unwrap();
    let (cell, value) = mesh.smallest_scaled_jacobian();
    assert_eq!(cell, 1);
    // Samples are at Gauss-Lobatto points, so at the corners.
    assert!((value - 1.0 / 3.0).abs() < 1e-12, "{value}");
}

#[test]
fn proves_thin_turned_cells_far_from_the_origin() {
    // Aspect ratio 1e6, turned by 30 degrees: rounding of the given positions alone is 1e-8 of the thickness.
    let (sine, cosine) = (0.5, 0.75_f64.sqrt());
    let turned = |xi: &[f64; 2], _| [1.0 + cosine * xi[0] - 1e-6 * sine * xi[1], sine * xi[0] + 1e-6 * cosine * xi[1]];
    let x = positions(6, &[0.0], turned);
    assert!(matches!(ValidityCheck::<2>::new(6, &[0.0]).decide(&x), Validity::Valid(bound) if bound.lower > 0.99e-6));
}

#[test]
fn finds_a_determinant_that_is_negative_for_a_moment_only() {
    // det J = (1 + a s)(1 + b s) with roots close together in the middle of the slab: positive at 0, 1/2 and 1.
    let times = [0.0, 1.0];
    let (a, b) = (-1.0 / 0.30, -1.0 / 0.31);
    let x = positions::<2>(3, &times, |xi, s| [(1.0 + a * s) * xi[0], (1.0 + b * s) * xi[1]]);
    let answer = ValidityCheck::<2>::new(3, &times).decide(&x);
    assert!(matches!(answer, Validity::Invalid(bound) if (0.3..=0.31).contains(&bound.at.s)), "{answer:?}");
    // With both roots beyond the end of the slab it is proved positive: det J >= 0.1 * 0.2.
    let x = positions::<2>(3, &times, |xi, s| [(1.0 - 0.9 * s) * xi[0], (1.0 - 0.8 * s) * xi[1]]);
    assert!(ValidityCheck::<2>::new(3, &times).decide(&x).is_valid());
}

#[test]
fn finds_where_a_cell_folds() {
    // x = xi + c xi^2, dx/dxi = 1 + 2 c xi: negative for xi < -1 / (2 c).
    let x = |c: f64| positions::<2>(3, &[0.0], move |xi, _| [xi[0] + c * xi[0] * xi[0], xi[1]]);
    let check = ValidityCheck::<2>::new(3, &[0.0]);
    assert!(matches!(check.decide(&x(0.49)), Validity::Valid(bound) if bound.lower >= 0.01 && bound.lower < 0.0201));
    let folded = check.decide(&x(0.51));
    assert!(matches!(folded, Validity::Invalid(bound) if bound.at.xi[0] < -0.98 && bound.sampled_min < -0.0199));
    // det J = 0 on a side, neither positive nor negative beyond round-off: not valid.
    assert!(!check.decide(&x(0.5)).is_valid());
}

#[test]
fn not_a_number_is_not_valid() {
    let mut x = positions::<2>(3, &[0.0], |xi, _| *xi);
    x[7] = f64::NAN;
    assert!(!ValidityCheck::<2>::new(3, &[0.0]).decide(&x).is_valid());
}

#[test]
fn the_relative_bound_ignores_grading_of_the_reference() {
    // The reference cell is strongly graded; the motion is a uniform shrinking to 0.6 in each direction.
    let graded = |xi: &[f64; 2], _: f64| [xi[0] + 0.45 * xi[0] * xi[0], xi[1] + 0.3 * xi[0] * xi[1]];
    let reference = positions(4, &[0.0], graded);
    let times = [0.0, 0.5, 1.0];
    let x = positions(4, &times, |xi, s| graded(xi, s).map(|x| x * (1.0 - 0.4 * s)));
    let check = ValidityCheck::<2>::new(4, &times);
    let bound = *check.search(&x, Some(&reference)).decide(&check.directions, f64::INFINITY).bound();
    assert!((bound.sampled_min - 0.36).abs() < 1e-12 && bound.lower <= 0.36 && bound.lower >= 0.18, "{bound:?}");
    assert!((bound.sampled_max - 1.0).abs() < 1e-12 && bound.at.s == 1.0);
}

#[test]
fn cells_are_decided_in_their_order() {
    let check = ValidityCheck::<2>::new(2, &[0.0]);
    let unit = positions::<2>(2, &[0.0], |xi, _| *xi);
    let answers = check.decide_cells(20, |cell, x| {
        x.iter_mut().zip(&unit).for_each(|(x, u)| *x = u * (cell + 1) as f64);
    });
    for (cell, answer) in answers.iter().enumerate() {
        assert!((answer.bound().sampled_min - ((cell + 1) as f64).powi(2)).abs() < 1e-10);
    }
}

/// Thin bilinear cells with coordinates on a grid of 2^-40: det J takes its minimum at a corner, known exactly in
/// integers.
#[test]
fn the_bound_covers_round_off() {
    let mut random = SplitMix64::new(21);
    let check = ValidityCheck::<2>::new(2, &[0.0]);
    for _ in 0..2000 {
        let mut draw = |scale: f64| (scale * random.symmetric() * 2_f64.powi(40)) as i128;
        let (long, thin) = ([draw(1.0), draw(1.0)], 1e-6);
        let corner = |k: i128, draw: &mut dyn FnMut(f64) -> i128| long.map(|x| k % 2 * x + draw(thin));
        let x: Vec<[i128; 2]> = (0..4).map(|k| corner(k, &mut draw)).collect();
        let edge = |a: usize, b: usize| [x[b][0] - x[a][0], x[b][1] - x[a][1]];
        let cross = |a: [i128; 2], b: [i128; 2]| a[0] * b[1] - a[1] * b[0];
        let corners = [(0, 1, 0, 2), (0, 1, 1, 3), (2, 3, 0, 2), (2, 3, 1, 3)];
        let exact = corners.into_iter().map(|(a, b, c, d)| cross(edge(a, b), edge(c, d))).min().unwrap_or(0);
        let positions: Vec<f64> = x.iter().flatten().map(|x| *x as f64 * 2_f64.powi(-40)).collect();
        // det J = (1/4) cross product in units of 2^-80; compared in integers of 2^-130.
        let lower = (check.bound(&positions).lower * 2_f64.powi(130)).ceil() as i128;
        assert!(lower <= exact << 48, "{lower} against {}", exact << 48);
    }
}
