#![allow(clippy::unwrap_used)]

use super::*;
use crate::random::SplitMix64;
use basis::{gauss_lobatto, right_radau};
use std::array::from_fn;

/// A cell that moves and curves at random: an affine image of [-1, 1]^D plus a polynomial whose coefficients decay with the degree.
/// `roughness` is drawn too, so that about half of the cells are invalid.
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
                let xi: [f64; D] = from_fn(|a| nodes[k / order.pow(a as u32) % order]);
                let bump: [f64; D] = from_fn(|i| modes.iter().map(|mode| mode.value(&xi, *s, i)).sum());
                positions.extend((0..D).map(|i| 100.0 + stretch[i] * (xi[i] + bump[i])));
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

    /// The smallest det J on a dense grid with both ends, by another route than the check: nodes interpolated in time one by one.
    fn dense_min(&self, n: usize, n_times: usize) -> f64 {
        let points: Vec<f64> = (0..n).map(|i| -1.0 + 2.0 * i as f64 / (n - 1) as f64).collect();
        let map = CellMap::<D>::on_grid(self.order, &points);
        let lagrange = Lagrange::new(self.times.clone());
        let length = self.positions.len() / self.times.len();
        let mut lowest = f64::INFINITY;
        for step in 0..n_times {
            let l = lagrange.values(step as f64 / (n_times.max(2) - 1) as f64);
            let x: Vec<f64> = (0..length).map(|k| (0..l.len()).map(|m| l[m] * self.positions[m * length + k]).sum()).collect();
            lowest = map.determinants(&x).into_iter().fold(lowest, f64::min);
        }
        lowest
    }
}

/// weight_i (1 + speed s) prod_a cos(k_a acos(xi_a))
struct BumpMode<const D: usize> {
    degree: [usize; D],
    speed: f64,
    weight: [f64; D],
}

impl<const D: usize> BumpMode<D> {
    fn value(&self, xi: &[f64; D], s: f64, i: usize) -> f64 {
        let shape: f64 = (0..D).map(|a| (self.degree[a] as f64 * xi[a].clamp(-1.0, 1.0).acos()).cos()).product();
        self.weight[i] * (1.0 + self.speed * s) * shape
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
    let t=std::time::Instant::now();
    let count = compare_with_sampling::<2>(1000, 8, 21);
    eprintln!("{count:?} {:?}", t.elapsed());
    assert_sharp(&count, 1000);
}

#[test]
fn no_false_proof_on_random_hexahedra() {
    let t=std::time::Instant::now();
    let count = compare_with_sampling::<3>(300, 8, 11);
    eprintln!("{count:?} {:?}", t.elapsed());
    assert_sharp(&count, 300);
}
