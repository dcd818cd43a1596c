//! The isentropic vortex.

use super::ExactState;
use crate::error::{InvalidParameter, finite, positive};
use crate::gas::Gas;
use crate::state::Primitive;
use tensor::{Transcendental, norm};

/// A vortex in a free stream of density rho_inf, velocity w_inf, speed U = |w_inf| and pressure p_inf, an exact solution
/// of the Euler equations (in three dimensions, a column along z):
///
/// ```text
/// X = (x - x_c - w_inf t) / R,   Y likewise,   r^2 = X^2 + Y^2
/// w = w_inf + U beta exp(-r^2 / 2) (-Y, X)
/// p / rho = (p_inf / rho_inf) T,   T = 1 - (gamma - 1) / 2 (U beta / c_inf)^2 exp(-r^2)
/// p / rho^gamma = p_inf / rho_inf^gamma                                                                    (vortex)
/// ```
///
/// after Diosady & Murman, AIAA 2018-0919, (10)-(12), with their (12) corrected. Other forms differ only in the strength:
/// [`Vortex::strength_of_persson`], [`Vortex::strength_of_vincent`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vortex<const D: usize> {
    gas: Gas,
    free_stream: Primitive<f64, D>,
    centre: [f64; D],
    radius: f64,
    strength: f64,
    period: Option<[f64; 2]>,
}

impl<const D: usize> Vortex<D> {
    /// The vortex with `centre` x_c at t = 0, `radius` R and `strength` beta. In a domain of `period` in x and y the
    /// nearest image is taken; the exponential tails of the others are neglected.
    ///
    /// # Errors
    /// A free stream or a radius out of range, or a vortex so strong that its centre would be colder than absolute zero.
    pub fn new(
        gas: Gas,
        free_stream: Primitive<f64, D>,
        centre: [f64; D],
        radius: f64,
        strength: f64,
        period: Option<[f64; 2]>,
    ) -> Result<Self, InvalidParameter> {
        free_stream.checked()?;
        finite("centre of the vortex", centre)?;
        positive("radius of the vortex", radius)?;
        for length in period.into_iter().flatten() {
            positive("period of the domain", length)?;
        }
        let vortex = Vortex { gas, free_stream, centre, radius, strength, period };
        if vortex.cooling() < 1.0 {
            return Ok(vortex);
        }
        let mach = norm(&free_stream.velocity) / gas.sound_speed(free_stream.density, free_stream.pressure);
        let limit = (2.0 / (gas.gamma() - 1.0)).sqrt() / mach;
        Err(InvalidParameter::VortexTooStrong { strength, mach, gamma: gas.gamma(), limit })
    }

    /// beta = eps exp(1/2) / (2 pi), for the vortex of Persson, Bonet & Peraire (2009).
    pub fn strength_of_persson(eps: f64) -> f64 {
        eps * 0.5_f64.exp() / std::f64::consts::TAU
    }

    /// beta = -S exp(1 / (2 R^2)) / (2 pi), for the vortex of Vincent et al. (2011), which turns clockwise.
    pub fn strength_of_vincent(s: f64, radius: f64) -> f64 {
        -s * (0.5 / (radius * radius)).exp() / std::f64::consts::TAU
    }

    /// 1 - T at the centre: (gamma - 1) / 2 (U beta / c_inf)^2.
    fn cooling(&self) -> f64 {
        let free_stream = &self.free_stream;
        let c = self.gas.sound_speed(free_stream.density, free_stream.pressure);
        let swirl_mach = norm(&free_stream.velocity) * self.strength / c;
        0.5 * (self.gas.gamma() - 1.0) * swirl_mach * swirl_mach
    }

    /// X or Y of the nearest image.
    fn offset<T: Transcendental>(&self, x: &[T; D], t: T, axis: usize) -> T {
        let mut offset = x[axis] - t * self.free_stream.velocity[axis] - self.centre[axis];
        if let Some(period) = self.period {
            offset = offset - period[axis] * (offset.value() / period[axis]).round();
        }
        offset * (1.0 / self.radius)
    }
}

impl<const D: usize, const M: usize> ExactState<D, M> for Vortex<D> {
    fn state<T: Transcendental>(&self, x: &[T; D], t: T) -> [T; M] {
        let (dx, dy) = (self.offset(x, t, 0), self.offset(x, t, 1));
        let bell = ((dx * dx + dy * dy) * -0.5).exp();
        let swirl = bell * (norm(&self.free_stream.velocity) * self.strength);
        let temperature = -(bell * bell * self.cooling()) + 1.0;

        let gamma = self.gas.gamma();
        let mut state = self.free_stream.constant(t);
        state.velocity[0] -= swirl * dy;
        state.velocity[1] += swirl * dx;
        state.density = temperature.powf(1.0 / (gamma - 1.0)) * self.free_stream.density;
        state.pressure = temperature.powf(gamma / (gamma - 1.0)) * self.free_stream.pressure;
        state.pack(&self.gas)
    }
}
