//! The speed of sum factorisation, in cache: `cargo run --release -p basis --example contraction`.
//!
//! Five components of a batch of cells are interpolated from N to N points along every axis.
#![allow(clippy::print_stdout)]

use basis::{AllAxes, Matrix, apply_all_axes, scratch_length};
use pulp::{Arch, Simd, WithSimd};
use std::time::Instant;
use tensor::{Pack, WIDTH, zeroed};

const COMPONENTS: usize = 5;

struct Interpolate<'a> {
    matrices: &'a [&'a Matrix],
    input: &'a [Pack],
    output: &'a mut [Pack],
    scratch: &'a mut [Pack],
    repetitions: usize,
}

impl WithSimd for Interpolate<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for _ in 0..self.repetitions {
            let axes = AllAxes { matrices: self.matrices, components: COMPONENTS };
            apply_all_axes(simd, axes, self.input, self.output, self.scratch, false);
        }
    }
}

/// GFLOP/s, the best of several bursts: 2 N^{D+1} D flops per component and cell.
fn speed(n: usize, dimension: usize) -> f64 {
    let matrix = Matrix::from_fn(n, n, |i, j| 1.0 / (1 + i + j) as f64);
    let matrices = vec![&matrix; dimension];
    let size = COMPONENTS * n.pow(dimension as u32);
    let (input, mut output) = (zeroed(size), zeroed(size));
    let mut scratch = zeroed(scratch_length(&matrices, COMPONENTS));
    let flops = (2 * WIDTH * size * n * dimension) as f64;
    let repetitions = 1 + (2e7 / flops) as usize;
    let mut best = f64::INFINITY;
    for _ in 0..50 {
        let start = Instant::now();
        let (matrices, output, scratch) = (&matrices[..], &mut output[..], &mut scratch[..]);
        Arch::new().dispatch(Interpolate { matrices, input: &input, output, scratch, repetitions });
        best = best.min(start.elapsed().as_secs_f64());
    }
    flops * repetitions as f64 / best / 1e9
}

fn main() {
    println!(" N   2-D   3-D   GFLOP/s");
    for n in (2..=16).chain([20, 24, 30]) {
        println!("{n:2} {:5.0} {:5.0}", speed(n, 2), speed(n, 3));
    }
}
