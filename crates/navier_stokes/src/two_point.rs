//! Symmetric fluxes between two states of a cell, for (split) of `fem::split_form`.
//!
//! ```text
//! f# = m [ 1 ; w ; e ] + p~ [ 0 ; A ; 0 ] + [ 0 ; 0 ; P ],    m = rho~ ( {w} . A - g )                              (two-point flux)
//!
//! kinetic energy   rho~ = {rho},  w = {w},  p~ = {p},  e = {E},  P = {p} {w} . A
//! entropy          rho~ = rho_log,  w = {w},  p~ = {p},  e = w_a . w_b / 2 + 1 / ((gamma - 1) (rho / p)_log),
//!                  P = ( p_a w_b + p_b w_a ) . A / 2
//! ```
//!
//! between states a and b, with the mean { }, the logarithmic mean x_log = (x_a - x_b) / (ln x_a - ln x_b), the area vector A and the volume
//! g that the mesh sweeps per time. Both keep the balance of kinetic energy; the second keeps that of entropy too. Kennedy & Gruber, J.
//! Comput. Phys. 227 (2008); Ranocha, thesis, Braunschweig (2018).

use crate::gas::Gas;
use crate::state::{Primitive, along};
use tensor::{Over, Real, dot};

/// The flux between nodes of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VolumeFlux {
    /// No split form: the flux of each point.
    #[default]
    Central,
    /// It keeps the balance of kinetic energy.
    KineticEnergy,
    /// It keeps the balances of kinetic energy and of entropy.
    Entropy,
    /// The flux of each point, and a viscosity per cell where it would lose entropy.
    EntropyViscosity,
}

impl VolumeFlux {
    /// Whether it is a flux between two nodes.
    pub fn is_split(self) -> bool {
        matches!(self, VolumeFlux::KineticEnergy | VolumeFlux::Entropy)
    }
}

/// (two-point flux)
#[inline(always)]
pub(crate) fn flux<T: Over<G>, G: Real, const D: usize, const M: usize>(
    (gas, volume_flux): (&Gas, VolumeFlux),
    [u_a, u_b]: [&[T; M]; 2],
    area: &[G; D],
    grid_flux: G,
) -> [T; M] {
    let (a, b) = (Primitive::<T, D>::unpack(gas, u_a), Primitive::<T, D>::unpack(gas, u_b));
    let mut w = a.velocity;
    for d in 0..D {
        w[d] = (a.velocity[d] + b.velocity[d]) * 0.5;
    }
    let (through, pressure) = (along(&w, area), (a.pressure + b.pressure) * 0.5);
    let (density, energy, work) = if volume_flux == VolumeFlux::Entropy {
        let inverse_temperature = logarithmic_mean(a.density / a.pressure, b.density / b.pressure);
        let internal = (inverse_temperature * (gas.gamma() - 1.0)).recip();
        let crossed = a.pressure * along(&b.velocity, area) + b.pressure * along(&a.velocity, area);
        let energy = dot(&a.velocity, &b.velocity) * 0.5 + internal;
        (logarithmic_mean(a.density, b.density), energy, crossed * 0.5)
    } else {
        let energy = (u_a[M - 1] / a.density + u_b[M - 1] / b.density) * 0.5;
        ((a.density + b.density) * 0.5, energy, pressure * through)
    };
    let mass = density * through.minus(grid_flux);
    let mut flux = [mass; M];
    for d in 0..D {
        flux[1 + d] = pressure.scale_add(area[d], mass * w[d]);
    }
    flux[M - 1] = mass * energy + work;
    flux
}

/// (a - b) / (ln a - ln b) of positive numbers, by a series where they are close. After Ismail & Roe, J. Comput. Phys. 228 (2009).
#[inline(always)]
fn logarithmic_mean<T: Real>(a: T, b: T) -> T {
    let f = (a - b) / (a + b);
    let square = f * f;
    // ln(a / b) / (2 f) = 1 + f^2 / 3 + f^4 / 5 + ..., to round-off below the bound.
    let series = ((square * (1.0 / 9.0) + 1.0 / 7.0) * square + 1.0 / 5.0) * square;
    let series = (series + 1.0 / 3.0) * square + 1.0;
    let quotient = (a / b).ln() / (f * 2.0);
    let bound = square.constant(1e-3);
    (a + b) * 0.5 / square.select_ge(bound, quotient, series)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::flux::inviscid_normal;
    use crate::gas::Viscosity;

    const FLUXES: [VolumeFlux; 2] = [VolumeFlux::KineticEnergy, VolumeFlux::Entropy];
    const AREA: [f64; 2] = [0.7, -0.4];
    const GRID_FLUX: f64 = 0.3;

    fn gas() -> Gas {
        Gas::new(1.4, 1.0, 0.72, Viscosity::Inviscid).unwrap()
    }

    fn state(density: f64, velocity: [f64; 2], pressure: f64) -> [f64; 4] {
        Primitive { density, velocity, pressure }.pack(&gas())
    }

    fn states() -> [[f64; 4]; 2] {
        [state(1.2, [0.5, -0.3], 0.9), state(0.8, [-0.2, 0.6], 1.4)]
    }

    fn between(volume_flux: VolumeFlux, a: &[f64; 4], b: &[f64; 4]) -> [f64; 4] {
        flux((&gas(), volume_flux), [a, b], &AREA, GRID_FLUX)
    }

    #[test]
    fn fluxes_are_consistent_and_symmetric() {
        let [a, b] = states();
        for volume_flux in FLUXES {
            let Primitive { velocity, pressure, .. } = Primitive::<f64, 2>::unpack(&gas(), &a);
            let through = velocity[0] * AREA[0] + velocity[1] * AREA[1];
            let exact = inviscid_normal(&a, through, pressure, &AREA, GRID_FLUX);
            let [same, there, back] = [(a, a), (a, b), (b, a)].map(|(a, b)| between(volume_flux, &a, &b));
            for m in 0..4 {
                assert!((same[m] - exact[m]).abs() < 1e-14, "{volume_flux:?}, {m}: {} {}", same[m], exact[m]);
                assert!((there[m] - back[m]).abs() < 1e-15, "{volume_flux:?}, {m}: {} {}", there[m], back[m]);
            }
        }
    }

    /// Tadmor's condition on a mesh that moves: [v] . f# = [rho w] . A - g [rho], with the entropy variables v of -rho s / (gamma - 1).
    #[test]
    fn the_entropy_flux_creates_none() {
        let variables = |u: &[f64; 4]| {
            let Primitive { density, velocity: [x, y], pressure } = Primitive::<f64, 2>::unpack(&gas(), u);
            let beta = density / pressure;
            let s = pressure.ln() - 1.4 * density.ln();
            [(1.4 - s) / 0.4 - 0.5 * beta * (x * x + y * y), beta * x, beta * y, -beta]
        };
        let [a, b] = states();
        let jump = |of: &dyn Fn(&[f64; 4]) -> f64| of(&a) - of(&b);
        let expected = jump(&|u| u[1] * AREA[0] + u[2] * AREA[1] - GRID_FLUX * u[0]);
        let created = |volume_flux: VolumeFlux| {
            let f = between(volume_flux, &a, &b);
            (0..4).map(|m| jump(&|u| variables(u)[m]) * f[m]).sum::<f64>() - expected
        };
        assert!(created(VolumeFlux::Entropy).abs() < 1e-14, "{:e}", created(VolumeFlux::Entropy));
        assert!(created(VolumeFlux::KineticEnergy).abs() > 1e-4, "the test tells fluxes apart");
    }

    #[test]
    fn logarithmic_mean_on_both_sides_of_the_bound() {
        for ratio in [1.0, 1.0 + 1e-9, 1.01, 1.06, 1.07, 2.0, 30.0] {
            // (a - b) / (ln a - ln b) = b (e^x - 1) / x with x = ln(a / b).
            let x = f64::ln(ratio);
            let exact = 0.7 * if ratio == 1.0 { 1.0 } else { x.exp_m1() / x };
            let found = logarithmic_mean(0.7 * ratio, 0.7);
            assert!((found / exact - 1.0).abs() < 1e-12, "{ratio}: {found} {exact}");
        }
    }
}
