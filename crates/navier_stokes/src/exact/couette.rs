//! Couette flow with heat conduction.

use super::ExactState;
use crate::error::{InvalidParameter, finite, positive};
use crate::gas::Gas;
use crate::state::Primitive;
use tensor::Transcendental;

/// Flow between the plates y = 0, at rest and of temperature T_0, and y = H, of velocity U and temperature T_1. With
/// eta = y / H,
///
/// ```text
/// w = (U eta, 0),   T = T_0 + (T_1 - T_0) eta + Pr U^2 / (2 c_p) eta (1 - eta),   p constant             (couette)
/// ```
///
/// This is a steady exact solution for any constant viscosity. `frame` is the velocity of the plate y = 0 for the observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Couette<const D: usize> {
    gas: Gas,
    height: f64,
    speed: f64,
    temperatures: [f64; 2],
    pressure: f64,
    frame: [f64; D],
}

impl<const D: usize> Couette<D> {
    /// The flow with gap `height` H, `speed` U, `temperatures` T_0 and T_1, and `pressure` p, in the given `frame`.
    ///
    /// # Errors
    /// A height, temperature or pressure that is not positive, a velocity that is not finite.
    pub fn new(
        gas: Gas,
        height: f64,
        speed: f64,
        temperatures: [f64; 2],
        pressure: f64,
        frame: [f64; D],
    ) -> Result<Self, InvalidParameter> {
        positive("distance of the plates", height)?;
        finite("speed of the plate", [speed])?;
        positive("temperature of the lower plate", temperatures[0])?;
        positive("temperature of the upper plate", temperatures[1])?;
        positive("pressure", pressure)?;
        finite("velocity of the frame", frame)?;
        Ok(Couette { gas, height, speed, temperatures, pressure, frame })
    }
}

impl<const D: usize, const M: usize> ExactState<D, M> for Couette<D> {
    fn state<T: Transcendental>(&self, x: &[T; D], t: T) -> [T; M] {
        let eta = (x[1] - t * self.frame[1]) * (1.0 / self.height);
        let [t_0, t_1] = self.temperatures;
        let friction = self.gas.prandtl() * self.speed * self.speed / (2.0 * self.gas.heat_capacity());
        let temperature = eta * (t_1 - t_0) + eta * (-eta + 1.0) * friction + t_0;

        let pressure = T::from(self.pressure);
        let mut velocity = self.frame.map(T::from);
        velocity[0] += eta * self.speed;
        Primitive { density: self.gas.density(pressure, temperature), velocity, pressure }.pack(&self.gas)
    }
}
