#![allow(clippy::unwrap_used)]

use super::*;
use crate::lattice::digit;
use crate::random::SplitMix64;
use basis::{gauss_lobatto, right_radau};
use std::array::from_fn;

/// Cells do not lie at the origin.
const OFFSET: f64 = 100.0;

/// A cell that moves and curves at random: an affine image of [-1, 1]^D plus a polynomial whose coefficients decay with
/// the degree. `roughness` is drawn too, so that about half of the cells are invalid.
struct RandomCell<const D: usize> {
    order: usize,
    times: Vec<f64>,
    positions: Vec<f64>,
}

impl<const D: usize> RandomCell<D> {
    fn new(random: &mut SplitMix64, order: usize, n_times: usize) -> Self {
        let roughness = 1.5 * random.unit();
        let times: Vec<f64> = right_radau(n_times).points.iter().map(|x| 0.5 + 0.5 * x).collect();
        let modes = Self::modes(random, order, roughness);
        let stretch: [f64; D] = from_fn(|_| 10_f64.powf(1.5 * random.symmetric()));
        let nodes = gauss_lobatto(order).points;
        let mut positions = Vec::new();
        for s in &times {
            for k in 0..order.pow(D as u32) {
                let xi: [f64; D] = from_fn(|a| nodes[digit(k, order, a)]);
                let bump: [f64; D] = from_fn(|i| modes.iter().map(|mode| mode.value(&xi, *s, i)).sum());
                positions.extend((0..D).map(|i| OFFSET + stretch[i] * (xi[i] + bump[i])));
            }
        }
        RandomCell { order, times, positions }
    }

    fn modes(random: &mut SplitMix64, order: usize, roughness: f64) -> Vec<BumpMode<D>> {
        let mode = |random: &mut SplitMix64| {
            let degree: [usize; D] = from_fn(|_| random.below(order));
            let decay = degree.iter().map(|k| 1.0 / ((1 + k) as f64)).product::<f64>();
            BumpMode { degree, speed: random.symmetric(), weight: from_fn(|_| roughness * decay * random.symmetric()) }
        };
        (0..8).map(|_| mode(random)).collect()
    }

    fn check(&self) -> ValidityCheck<D> {
        ValidityCheck::new(self.order, &self.times)
    }

    /// The smallest det J on a dense grid with both ends, by another route than the check: nodes interpolated in time
    /// one by one. The common offset is taken off first, exactly, because it would cost the oracle its last digits.
    fn dense_min(&self, n: usize, n_times: usize) -> f64 {
        let points: Vec<f64> = (0..n).map(|i| -1.0 + 2.0 * i as f64 / (n - 1) as f64).collect();
        let map = CellMap::<D>::on_grid(self.order, &points);
        let lagrange = Lagrange::new(self.times.clone());
        let length = self.positions.len() / self.times.len();
        let mut lowest = f64::INFINITY;
        for step in 0..n_times {
            let l = lagrange.values(step as f64 / (n_times.max(2) - 1) as f64);
            let x: Vec<f64> = (0..length)
                .map(|k| (0..l.len()).map(|m| l[m] * (self.positions[m * length + k] - OFFSET)).sum())
                .collect();
            lowest = map.determinants(&x).into_iter().fold(lowest, f64::min);
        }
        lowest
    }
}

/// weight_i (1 + speed sin 3 s) prod_a cos(k_a acos(xi_a))
struct BumpMode<const D: usize> {
    degree: [usize; D],
    speed: f64,
    weight: [f64; D],
}

impl<const D: usize> BumpMode<D> {
    fn value(&self, xi: &[f64; D], s: f64, i: usize) -> f64 {
        let shape: f64 = (0..D).map(|a| (self.degree[a] as f64 * xi[a].clamp(-1.0, 1.0).acos()).cos()).product();
        self.weight[i] * (1.0 + self.speed * (3.0 * s).sin()) * shape
    }
}

#[derive(Default, Debug)]
struct Count {
    valid: usize,
    invalid: usize,
    undecided: usize,
}

/// Decides random cells of all orders up to `max_order` and compares with dense sampling.
fn compare_with_sampling<const D: usize>(cells: usize, max_order: usize, dense: usize) -> Count {
    let mut random = SplitMix64::new(D as u64);
    let mut count = Count::default();
    for number in 0..cells {
        let order = 2 + number % (max_order - 1);
        let n_times = 1 + random.below(3);
        let cell = RandomCell::<D>::new(&mut random, order, n_times);
        let sampled = cell.dense_min(dense, if n_times == 1 { 1 } else { 5 });
        let check = cell.check();
        let whole = check.bound(&cell.positions);
        assert!(whole.lower <= sampled, "cell {number}: {whole:?} against {sampled}");
        match check.decide(&cell.positions) {
            Validity::Valid(bound) => {
                assert!(0.0 < bound.lower && bound.lower <= sampled, "cell {number}: {bound:?} against {sampled}");
                count.valid += 1;
            }
            Validity::Invalid(bound) => {
                assert!(bound.sampled_min <= 0.0, "cell {number}: {bound:?}");
                count.invalid += 1;
            }
            Validity::Undecided(_) => count.undecided += 1,
        }
    }
    count
}
fn assert_sharp(count: &Count, cells: usize) {
    assert!(count.valid > cells / 5 && count.invalid > cells / 5, "not a test of both answers: {count:?}");
    assert!(count.undecided * 100 < cells, "too many undecided: {count:?}");
}

#[test]
fn no_false_proof_on_random_quadrilaterals() {
    assert_sharp(&compare_with_sampling::<2>(1000, 8, 21), 1000);
}

#[test]
fn no_false_proof_on_random_hexahedra() {
    assert_sharp(&compare_with_sampling::<3>(1000, 8, 11), 1000);
}

#[test]
#[ignore = "a minute: ten times the cells of the tests above, on denser grids"]
fn no_false_proof_on_many_random_cells() {
    assert_sharp(&compare_with_sampling::<2>(10_000, 12, 41), 10_000);
    assert_sharp(&compare_with_sampling::<3>(10_000, 8, 15), 10_000);
}

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
    let bound = *ValidityCheck::<2>::new(4, &times).decide_relative(&x, &reference).bound();
    assert!((bound.sampled_min - 0.36).abs() < 1e-12 && bound.lower <= 0.36 && bound.lower >= 0.18, "{bound:?}");
    assert!((bound.sampled_max - 1.0).abs() < 1e-12 && bound.at.s == 1.0);
}

#[test]
fn relative_bounds_hold_against_sampling() {
    let mut random = SplitMix64::new(11);
    let mut proved = 0;
    for _ in 0..100 {
        let cell = RandomCell::<2>::new(&mut random, 4, 2);
        let length = cell.positions.len() / 2;
        let at_rest = |x: &[f64]| ValidityCheck::<2>::new(4, &[0.0]).decide(x).is_valid();
        if !at_rest(&cell.positions[..length]) {
            continue;
        }
        let bound = *cell.check().decide_relative(&cell.positions, &cell.positions[..length]).bound();
        for _ in 0..200 {
            let (xi, s) = (from_fn(|_| random.symmetric()), random.unit());
            let l = Lagrange::new(cell.times.clone()).values(s);
            let x: Vec<f64> =
                (0..length).map(|k| l[0] * cell.positions[k] + l[1] * cell.positions[length + k]).collect();
            let det = |x: &[f64]| CellMap::<2>::at(4, &xi).determinants(x)[0];
            assert!(det(&x) / det(&cell.positions[..length]) >= bound.lower);
        }
        proved += usize::from(bound.lower > 0.0);
    }
    assert!(proved > 10, "only {proved} cells tested");
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
