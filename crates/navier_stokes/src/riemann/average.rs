//! Roe's average of two states.

use super::Side;
use crate::gas::Gas;
use crate::state::{along, scaled};
use tensor::{Over, Real, dot};

/// The state at which the Jacobian of the flux maps the jump of the states to the jump of the fluxes.
pub(super) struct Average<T, const D: usize> {
    /// sqrt(rho- rho+)
    pub(super) density: T,
    /// w, weighted by sqrt(rho)
    pub(super) velocity: [T; D],
    /// w . n
    pub(super) w_n: T,
    /// H, weighted by sqrt(rho)
    pub(super) enthalpy: T,
    /// c^2 = (gamma - 1) (H - |w|^2 / 2)
    pub(super) sound_speed: T,
}

impl<T: Real, const D: usize> Average<T, D> {
    /// (sqrt(rho-) q- + sqrt(rho+) q+) / (sqrt(rho-) + sqrt(rho+)) for q = w and q = H.
    #[inline(always)]
    pub(super) fn new<G: Real, const M: usize>(
        gas: &Gas,
        minus: &Side<T, D, M>,
        plus: &Side<T, D, M>,
        n: &[G; D],
    ) -> Self
    where
        T: Over<G>,
    {
        let (root_minus, root_plus) = (minus.density.sqrt(), plus.density.sqrt());
        let inverse = (root_minus + root_plus).recip();
        let (of_minus, of_plus) = (root_minus * inverse, root_plus * inverse);
        let mut velocity = scaled(&minus.velocity, of_minus);
        for i in 0..D {
            velocity[i] += plus.velocity[i] * of_plus;
        }
        // H = (rho E + p) / rho. The reciprocal is that of the velocity: one division for both.
        let enthalpy = (minus.u[M - 1] + minus.pressure) * minus.density.recip() * of_minus
            + (plus.u[M - 1] + plus.pressure) * plus.density.recip() * of_plus;
        let sound_speed = ((enthalpy - dot(&velocity, &velocity) * 0.5) * (gas.gamma() - 1.0)).sqrt();
        Average { density: root_minus * root_plus, velocity, w_n: along(&velocity, n), enthalpy, sound_speed }
    }
}
