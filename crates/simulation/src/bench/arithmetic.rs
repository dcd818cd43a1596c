//! Fused multiply-adds in registers, for the arithmetic peak of the machine.

use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};

/// Accumulators: enough to hide the latency of two units, and few enough for the registers of AVX2.
const CHAINS: usize = 12;

/// Steps of one burst, some hundred microseconds.
const STEPS: usize = 100_000;

/// Independent fused multiply-adds: x := a x + b in [`CHAINS`] registers. Returns the number of operations.
struct Chains(f64);

impl WithSimd for Chains {
    type Output = f64;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (a, b) = (simd.splat_f64s(1.0 - self.0), simd.splat_f64s(self.0));
        let mut x = [b; CHAINS];
        for _ in 0..STEPS {
            for chain in 0..CHAINS {
                x[chain] = simd.mul_add_f64s(x[chain], a, b);
            }
        }
        std::hint::black_box(x);
        (2 * CHAINS * STEPS * S::F64_LANES) as f64
    }
}

/// A burst of independent fused multiply-adds. Returns the number of floating-point operations, two for each.
pub fn multiply_and_add() -> f64 {
    Arch::new().dispatch(Chains(std::hint::black_box(1e-3)))
}
