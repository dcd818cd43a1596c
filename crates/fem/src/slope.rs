//! The penalty on jumps of slope between two cells, for quantities that the viscous flux does not diffuse.
//!
//! ```text
//! R_a += int_I int_F phi_a [psi_,n] delta X({u}, [u_,n]) dS,   delta = 2 h^2 / N_s^5 = 8 / (N_s sigma^2)             (slope)
//! ```
//!
//! h = 2 N_s^2 / sigma is the smaller height of the two cells, X the law's [`ConservationLaw::slope_flux`]. The term vanishes for a
//! smooth state, and for constant test functions, so it is conservative.
//!
//! For odd N_s, the Legendre polynomial of the highest degree has the same value at both ends of a cell. Repeated from cell to cell it
//! does not jump, and no numerical flux damps it; but its slope jumps. For even N_s its value jumps, and the penalty is not needed. With
//! N_s^5 the decay rate of that polynomial, about speed / h, does not depend on N_s.

use crate::conservation_law::ConservationLaw;
use crate::point::{Kernel, KernelTypes};
use tensor::{Over, Real};

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> Kernel<'_, D, M, T> {
    /// Whether the order of the flow needs the penalty.
    #[inline(always)]
    pub(crate) fn penalises_slopes(self) -> bool {
        self.tables.orders.flow % 2 == 1
    }

    /// delta X({u}, [u_,n]) between the states and the gradients `[direction][component]` of minus and plus.
    #[inline(always)]
    pub(crate) fn slope_penalty(
        self,
        [minus, plus]: [&[T::State; M]; 2],
        [gradient_minus, gradient_plus]: [&[[T::State; M]; D]; 2],
        n: &[T::Geometry; D],
        sigma: T::Geometry,
    ) -> [T::State; M] {
        let (mut mean, mut slope) = (*minus, *minus);
        for m in 0..M {
            mean[m] = (minus[m] + plus[m]) * 0.5;
            slope[m] = (gradient_minus[0][m] - gradient_plus[0][m]).scale(n[0]);
            for k in 1..D {
                slope[m] = (gradient_minus[k][m] - gradient_plus[k][m]).scale_add(n[k], slope[m]);
            }
        }
        let mut flux = self.law.slope_flux(&mean, &slope, sigma);
        let delta = (sigma * sigma).recip() * (8.0 / self.tables.orders.flow as f64);
        for m in 0..M {
            flux[m] = flux[m].scale(delta);
        }
        flux
    }
}

/// Adds (slope) to the fluxes that (sip) tests with gradients of minus and plus, -1/2 times each.
#[inline(always)]
pub(crate) fn join<const D: usize, const M: usize, T: Over<G>, G: Real>(
    flux: &[T; M],
    n: &[G; D],
    minus: &mut [[T; M]; D],
    plus: &mut [[T; M]; D],
) {
    for k in 0..D {
        for m in 0..M {
            let along = flux[m].scale(n[k]) * 2.0;
            minus[k][m] -= along;
            plus[k][m] += along;
        }
    }
}
