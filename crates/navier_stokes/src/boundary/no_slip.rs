//! Functions shared by no-slip walls.
//!
//! A wall moves with the mesh and may slide in its own plane: w_b = v + slide - (slide . n) n. No mass crosses it. The gas
//! loses the energy p v_n - (tau n) . w_b - kappa T_,n of pressure, friction and heat to it. This is exactly zero for an
//! adiabatic wall at rest.

use tensor::{Real, dot};

/// w_b, the velocity of the wall.
#[inline(always)]
pub(super) fn wall_velocity<G: Real, const D: usize>(slide: &[G; D], n: &[G; D], v: &[G; D]) -> [G; D] {
    let normal_part = dot(slide, n);
    let mut w_b = *v;
    for i in 0..D {
        w_b[i] = v[i] + slide[i] - normal_part * n[i];
    }
    w_b
}
