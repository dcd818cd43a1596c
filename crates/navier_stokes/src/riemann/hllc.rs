//! The HLLC flux of Toro, Spruce & Speares (1994), with the outer wave speeds of Einfeldt (1988).

use super::Side;
use super::average::Average;
use crate::gas::Gas;
use tensor::{Over, Real};

/// With outer waves S- < S+ and the contact S* between them, the flux of the side K from which the contact moves away is
///
/// ```text
/// F_K + s_K (u*_K - u_K),   s- = min(S- - v_n, 0),  s+ = max(S+ - v_n, 0)
/// u*_K = (S_K - w_n) / (S_K - S*) ( u_K + (S* - w_n) [0 ; rho n ; rho S* + p / (S_K - w_n)] )
/// ```
///
/// s_K = 0 if all waves move away from the side.
#[inline(always)]
pub(super) fn flux<T: Over<G>, G: Real, const D: usize, const M: usize>(
    gas: &Gas,
    minus: &Side<T, D, M>,
    plus: &Side<T, D, M>,
    n: &[G; D],
    v_n: G,
) -> [T; M] {
    let (slow, fast) = outer_waves(gas, minus, plus, n);
    let contact = contact_speed(minus, plus, slow, fast);
    let v_n = T::lift(v_n);
    let (s_minus, s_plus) = ((slow - v_n).min(v_n.zero()), (fast - v_n).max(v_n.zero()));

    // The upwind side of the contact, lane by lane: minus if S* >= v_n.
    let outer = contact.select_ge(v_n, slow, fast);
    let s = contact.select_ge(v_n, s_minus, s_plus);
    let w_n = contact.select_ge(v_n, minus.w_n, plus.w_n);
    let p = contact.select_ge(v_n, minus.pressure, plus.pressure);
    let (mut u, mut flux) = (minus.u, minus.flux);
    for c in 0..M {
        u[c] = contact.select_ge(v_n, minus.u[c], plus.u[c]);
        flux[c] = contact.select_ge(v_n, minus.flux[c], plus.flux[c]);
    }

    let (lag, shift) = (outer - w_n, contact - w_n);
    let compression = lag / (outer - contact);
    let mut star = u;
    for i in 0..D {
        star[1 + i] += (u[0] * shift).scale(n[i]);
    }
    star[M - 1] += shift * (u[0] * contact + p / lag);
    for c in 0..M {
        flux[c] += s * (star[c] * compression - u[c]);
    }
    flux
}

/// S- = min(w_n - c of minus, of the average), S+ = max(w_n + c of plus, of the average).
#[inline(always)]
fn outer_waves<T: Over<G>, G: Real, const D: usize, const M: usize>(
    gas: &Gas,
    minus: &Side<T, D, M>,
    plus: &Side<T, D, M>,
    n: &[G; D],
) -> (T, T) {
    let average = Average::new(gas, minus, plus, n);
    let slow = (minus.w_n - minus.sound_speed(gas)).min(average.w_n - average.sound_speed);
    let fast = (plus.w_n + plus.sound_speed(gas)).max(average.w_n + average.sound_speed);
    (slow, fast)
}

/// S* = (p+ - p- + a- w_n- - a+ w_n+) / (a- - a+) with the mass a_K = rho_K (S_K - w_n) that crosses wave K: the speed at
/// which the pressures behind both waves agree.
#[inline(always)]
fn contact_speed<T: Real, const D: usize, const M: usize>(
    minus: &Side<T, D, M>,
    plus: &Side<T, D, M>,
    slow: T,
    fast: T,
) -> T {
    let a_minus = minus.density * (slow - minus.w_n);
    let a_plus = plus.density * (fast - plus.w_n);
    let push = plus.pressure - minus.pressure + a_minus * minus.w_n - a_plus * plus.w_n;
    push / (a_minus - a_plus)
}
