//! Helpers of several tests.

use crate::Matrix;
use pulp::{Scalar, Simd, WithSimd};
use tensor::{Pack, WIDTH};

/// max |a - b|
pub(crate) fn distance(a: &Matrix, b: &Matrix) -> f64 {
    assert_eq!((a.rows(), a.cols()), (b.rows(), b.cols()));
    a.values().iter().zip(b.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// `n` packs of numbers in [-1, 1], the same for the same seed.
pub(crate) fn packs(n: usize, seed: usize) -> Vec<Pack> {
    let number = |k: usize| ((k * 7919 + seed * 104_729) as f64).sin();
    (0..n).map(|i| Pack(std::array::from_fn(|lane| number(i * WIDTH + lane)))).collect()
}

/// All (i, j, k) of a box, k fastest.
pub(crate) fn triples(ni: usize, nj: usize, nk: usize) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..ni * nj * nk).map(move |n| (n / (nj * nk), n / nk % nj, n % nk))
}

/// A kernel that can run with any registers.
pub(crate) trait OnEveryMachine {
    fn run<S: Simd>(&self, simd: S) -> Vec<Pack>;
}

/// Runs `kernel` with every kind of register of this machine and compares with `expected`, to `tolerance` relative to
/// the largest entry.
pub(crate) fn on_every_machine<K: OnEveryMachine>(kernel: &K, expected: &[Pack], tolerance: f64) {
    check(&kernel.run(Scalar), expected, tolerance);
    #[cfg(target_arch = "x86_64")]
    {
        use pulp::x86::{V3, V4};
        if let Some(simd) = V3::try_new() {
            check(&Simd::vectorize(simd, Run(kernel)), expected, tolerance);
        }
        if let Some(simd) = V4::try_new() {
            check(&Simd::vectorize(simd, Run(kernel)), expected, tolerance);
        }
    }
}

struct Run<'a, K>(&'a K);
impl<K: OnEveryMachine> WithSimd for Run<'_, K> {
    type Output = Vec<Pack>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<Pack> {
        self.0.run(simd)
    }
}

fn check(actual: &[Pack], expected: &[Pack], tolerance: f64) {
    let numbers = |packs: &[Pack]| -> Vec<f64> { packs.iter().flat_map(|pack| pack.0).collect() };
    let (actual, expected) = (numbers(actual), numbers(expected));
    assert_eq!(actual.len(), expected.len());
    let scale = expected.iter().fold(1.0, |largest: f64, e| largest.max(e.abs()));
    assert!(actual.iter().zip(&expected).all(|(a, e)| (a - e).abs() <= tolerance * scale));
}
