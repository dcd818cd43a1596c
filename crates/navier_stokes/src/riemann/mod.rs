//! Numerical fluxes between two states on a moving facet.
//!
//! All are consistent with F_c(u) . n - v_n u and upwind by the wave speeds relative to the facet, w_n - v_n and w_n -
//! v_n +- c. So they are invariant under a common velocity of gas and facet.

mod average;
mod hllc;
mod lax_friedrichs;
mod roe;

use crate::flux::inviscid_normal;
use crate::gas::Gas;
use crate::state::{Conserved, along};
use tensor::{Over, Real};

/// The choice of the numerical flux.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Riemann {
    /// Local Lax-Friedrichs (Rusanov): the fastest wave damps all components; the simplest and most dissipative flux.
    LaxFriedrichs,
    /// Three waves; contact and shear layers are preserved (Toro, Spruce & Speares 1994).
    Hllc,
    /// Linearised by Roe's average (Roe 1981), wave speeds smoothed near zero (Harten 1983).
    Roe,
    /// The same for flows that are slow beside sound (Rieper 2011).
    LowMachRoe {
        /// The speed of the flow, U.
        speed: f64,
    },
}

/// The data of one side of the facet for the Riemann solvers.
struct Side<T, const D: usize, const M: usize> {
    u: [T; M],
    density: T,
    velocity: [T; D],
    pressure: T,
    /// w_n = w . n
    w_n: T,
    /// F_c(u) . n - v_n u
    flux: [T; M],
}

impl<T: Real, const D: usize, const M: usize> Side<T, D, M> {
    #[inline(always)]
    fn new<G: Real>(gas: &Gas, u: &[T; M], n: &[G; D], v_n: G) -> Self
    where
        T: Over<G>,
    {
        let state = Conserved::unpack(u);
        let velocity = state.velocity();
        let pressure = gas.pressure(&state, &velocity);
        let w_n = along(&velocity, n);
        let flux = inviscid_normal(u, w_n, pressure, n, v_n);
        Side { u: *u, density: state.density, velocity, pressure, w_n, flux }
    }
    #[inline(always)]
    fn sound_speed(&self, gas: &Gas) -> T {
        gas.sound_speed(self.density, self.pressure)
    }
}

impl Riemann {
    /// Its name in words.
    pub fn name(self) -> &'static str {
        match self {
            Riemann::LaxFriedrichs => "Lax-Friedrichs",
            Riemann::Hllc => "HLLC",
            Riemann::Roe => "Roe",
            Riemann::LowMachRoe { .. } => "Roe for low Mach numbers",
        }
    }

    /// The flux between the gas and a state outside. Waves of sound leave through it, as the characteristics demand: with less damping
    /// they are reflected.
    #[inline(always)]
    pub(crate) fn on_boundaries(self) -> Self {
        if let Riemann::LowMachRoe { .. } = self { Riemann::Roe } else { self }
    }

    /// The speed of a slow flow.
    #[inline(always)]
    fn slow(self) -> Option<f64> {
        if let Riemann::LowMachRoe { speed } = self { Some(speed) } else { None }
    }

    /// The flux from minus to plus through a facet with normal `n` and normal velocity `v_n`.
    #[inline(always)]
    pub(crate) fn flux<T: Over<G>, G: Real, const D: usize, const M: usize>(
        self,
        gas: &Gas,
        minus: &[T; M],
        plus: &[T; M],
        n: &[G; D],
        v_n: G,
    ) -> [T; M] {
        let (minus, plus) = (Side::new(gas, minus, n, v_n), Side::new(gas, plus, n, v_n));
        match self {
            Riemann::LaxFriedrichs => lax_friedrichs::flux(gas, &minus, &plus, v_n),
            Riemann::Hllc => hllc::flux(gas, &minus, &plus, n, v_n),
            // One call: it is compiled into every kernel.
            Riemann::Roe | Riemann::LowMachRoe { .. } => roe::flux((gas, self.slow()), &minus, &plus, n, v_n),
        }
    }
}
