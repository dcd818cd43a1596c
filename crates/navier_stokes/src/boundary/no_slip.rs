//! Functions shared by no-slip walls.
//!
//! A wall moves with the mesh and may slide in its own plane: w_b = v + slide - (slide . n) n. No mass crosses it. The gas
//! loses the energy p v_n - (tau n) . w_b - kappa T_,n of pressure, friction and heat to it. This is exactly zero for an
//! adiabatic wall at rest.

use tensor::{Over, Real};

/// w_b, the velocity of the wall.
#[inline(always)]
pub(super) fn wall_velocity<G: Real, const D: usize>(slide: &[G; D], n: &[G; D], v: &[G; D]) -> [G; D] {
    let normal_part = projection(slide, n);
    let mut w_b = *v;
    for i in 0..D {
        w_b[i] = v[i] + slide[i] - normal_part * n[i];
    }
    w_b
}

/// `a` as a vector of the state.
#[inline(always)]
pub(super) fn lifted<T: Over<G>, G: Real, const D: usize>(a: &[G; D]) -> [T; D] {
    let mut lifted = [T::lift(a[0]); D];
    for i in 1..D {
        lifted[i] = T::lift(a[i]);
    }
    lifted
}

/// a . n
#[inline(always)]
fn projection<G: Real, const D: usize>(a: &[G; D], n: &[G; D]) -> G {
    let mut sum = n[0] * a[0];
    for i in 1..D {
        sum += n[i] * a[i];
    }
    sum
}
