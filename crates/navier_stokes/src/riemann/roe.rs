//! Roe's flux (1981) with smoothed wave speeds.

use super::Side;
use super::average::Average;
use crate::gas::Gas;
use crate::state::{components, scaled};
use tensor::{Over, Real, dot};

/// Wave speeds below this fraction of the sound speed are smoothed; for slow flows, of z c in (low Mach).
const SMOOTHING: f64 = 1e-2;

/// (F- + F+) / 2 - |A - v_n| (u+ - u-) / 2, with A the Jacobian of F_c . n at Roe's average. With a `speed` U of the flow
///
/// ```text
/// d w_n := z d w_n,     z = min(1, max(U, |w_n - v_n|) / c)                                                  (low Mach)
/// ```
///
/// in the waves of sound. Without z they damp a slow flow with the speed of sound (Rieper, J. Comput. Phys. 230, 2011, with |w| / c for z,
/// which depends on the observer).
#[inline(always)]
pub(super) fn flux<T: Over<G>, G: Real, const D: usize, const M: usize>(
    (gas, speed): (&Gas, Option<f64>),
    minus: &Side<T, D, M>,
    plus: &Side<T, D, M>,
    n: &[G; D],
    v_n: G,
) -> [T; M] {
    let upwind = dissipation((gas, speed), minus, plus, n, v_n);
    let mut flux = minus.flux;
    for c in 0..M {
        flux[c] = (minus.flux[c] + plus.flux[c] - upwind[c]) * 0.5;
    }
    flux
}

/// |A - v_n| (u+ - u-), the sum over the waves of |speed| strength eigenvector, with the jumps d rho, d w, d p:
///
/// ```text
/// w_n - v_n - c :  (d p - rho c d w_n) / (2 c^2)   [1 ; w - c n ; H - c w_n]
/// w_n - v_n + c :  (d p + rho c d w_n) / (2 c^2)   [1 ; w + c n ; H + c w_n]
/// w_n - v_n     :  d rho - d p / c^2               [1 ; w ; |w|^2 / 2]
/// w_n - v_n     :  rho                             [0 ; d w - d w_n n ; w . d w - w_n d w_n]
/// ```
#[inline(always)]
fn dissipation<T: Over<G>, G: Real, const D: usize, const M: usize>(
    (gas, speed): (&Gas, Option<f64>),
    minus: &Side<T, D, M>,
    plus: &Side<T, D, M>,
    n: &[G; D],
    v_n: G,
) -> [T; M] {
    let Average { density, velocity: w, w_n, enthalpy, sound_speed: c } = Average::new(gas, minus, plus, n);
    let mut w_jump = plus.velocity;
    for i in 0..D {
        w_jump[i] -= minus.velocity[i];
    }
    let (p_jump, w_n_jump) = (plus.pressure - minus.pressure, plus.w_n - minus.w_n);
    let inverse = (c * c).recip();
    let relative = w_n.minus(v_n);

    let sound = speed.map_or(c, |speed| slowed(c, relative, speed));
    let width = sound * SMOOTHING;
    let convected = smooth_abs(relative, width);
    let push = density * sound * w_n_jump;
    let left = smooth_abs(relative - c, width) * (p_jump - push) * inverse * 0.5;
    let right = smooth_abs(relative + c, width) * (p_jump + push) * inverse * 0.5;
    let entropy = convected * (plus.density - minus.density - p_jump * inverse);
    let shear = convected * density;

    // Grouped by the vectors [1 ; w ; .], [0 ; n ; .] and [0 ; d w ; .].
    let (sum, difference) = (left + right + entropy, c * (right - left) - shear * w_n_jump);
    let mut momentum = scaled(&w, sum);
    for i in 0..D {
        momentum[i] += difference.scale(n[i]) + shear * w_jump[i];
    }
    let energy = (left + right) * enthalpy + entropy * dot(&w, &w) * 0.5 + difference * w_n + shear * dot(&w, &w_jump);
    components(sum, &momentum, energy)
}

/// z c of (low Mach).
#[inline(always)]
fn slowed<T: Real>(c: T, relative: T, speed: f64) -> T {
    relative.abs().max(c.zero() + speed).min(c)
}

/// |x|, replaced by (x^2 / width + width) / 2 where |x| < width: continuously differentiable (Harten 1983).
#[inline(always)]
fn smooth_abs<T: Real>(x: T, width: T) -> T {
    let size = x.abs();
    size.select_ge(width, size, (x * x / width + width) * 0.5)
}
