//! The peak of the machine: the two roofs of the roofline model (Williams, Waterman & Patterson, Comm. ACM 52, 2009).

use super::stopwatch::best;
use newton_krylov::inner_product::xpay;
use rayon::ThreadPool;
use serde::Serialize;
use simulation::bench::{bytes, multiply_and_add};
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};

/// Peak and bandwidth, on one core and on all.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Machine {
    /// The number of threads of "all".
    pub(super) threads: usize,
    /// Lanes of double precision in a register.
    pub(super) lanes: usize,
    /// Billion floating-point operations per second in fused multiply-adds, one core.
    pub(super) gflops_one: f64,
    /// The same, all cores at once.
    pub(super) gflops_all: f64,
    /// Billion bytes per second of y := x + a y on vectors in memory, one core.
    pub(super) gbytes_one: f64,
    /// The same, all cores at once.
    pub(super) gbytes_all: f64,
}

impl Machine {
    /// Measures for `seconds` each.
    pub(super) fn measure([one, all]: &[ThreadPool; 2], seconds: f64) -> Self {
        let mut memory = Stream::new();
        Machine {
            threads: all.current_num_threads(),
            lanes: Arch::new().dispatch(Lanes),
            gflops_one: peak(one, seconds),
            gflops_all: peak(all, seconds),
            gbytes_one: one.install(|| memory.measure(seconds)),
            gbytes_all: all.install(|| memory.measure(seconds)),
        }
    }
}

struct Lanes;

impl WithSimd for Lanes {
    type Output = usize;
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F64_LANES
    }
}

/// Billion operations per second of all threads of a pool.
fn peak(pool: &ThreadPool, seconds: f64) -> f64 {
    let rate = |_: rayon::BroadcastContext<'_>| {
        let mut operations = 0.0;
        let time = best(seconds, || operations = multiply_and_add());
        operations / time
    };
    pool.broadcast(rate).iter().sum::<f64>() * 1e-9
}

/// The length of each of the two vectors: 270 MB together, more than caches hold.
const LENGTH: usize = 1 << 24;

/// y := x + a y: two numbers are read and one is written; none is read only to be overwritten.
struct Stream {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Stream {
    fn new() -> Self {
        Stream { x: vec![1.0; LENGTH], y: vec![2.0; LENGTH] }
    }

    /// Billion bytes per second of the current pool.
    fn measure(&mut self, seconds: f64) -> f64 {
        let time = best(seconds, || xpay(&self.x, 0.5, &mut self.y));
        bytes(3 * LENGTH) / time * 1e-9
    }
}
