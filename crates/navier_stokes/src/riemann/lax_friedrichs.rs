//! The local Lax-Friedrichs flux.

use super::Side;
use crate::gas::Gas;
use tensor::{Over, Real};

/// (F- + F+) / 2 - s (u+ - u-) / 2, where s is the larger |w_n - v_n| + c of the two sides.
#[inline(always)]
pub(super) fn flux<T: Over<G>, G: Real, const D: usize, const M: usize>(
    gas: &Gas,
    minus: &Side<T, D, M>,
    plus: &Side<T, D, M>,
    v_n: G,
) -> [T; M] {
    let s_minus = minus.w_n.minus(v_n).abs() + minus.sound_speed(gas);
    let s_plus = plus.w_n.minus(v_n).abs() + plus.sound_speed(gas);
    let s = s_minus.max(s_plus);
    let mut flux = minus.flux;
    for c in 0..M {
        flux[c] = (minus.flux[c] + plus.flux[c] - s * (plus.u[c] - minus.u[c])) * 0.5;
    }
    flux
}
