//! The reference state, which sets the scales of a flow.

use crate::error::{InvalidParameter, positive};
use crate::gas::Gas;

/// A density, a flow speed and a sound speed that are typical of a flow.
///
/// In slow flow the state is a small disturbance of a uniform one. A velocity of the size U comes with an acoustic pressure
/// d p = rho c U, hence with d rho = d p / c^2 and d(rho E) = d p / (gamma - 1). These, not rho and rho E themselves, are
/// the scales that make the components of a residual comparable:
///
/// ```text
/// scales = ( rho U / c, rho U, ..., rho c U / (gamma - 1) )                                              (scales)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    density: f64,
    speed: f64,
    sound_speed: f64,
}

impl Reference {
    /// The scales of a flow of the given `density` rho, `speed` U (of the free stream or of a moving wall) and `pressure`.
    ///
    /// # Errors
    /// A number that is not positive. If nothing is known to move, choose the speed that the flow is expected to reach.
    pub fn new(gas: &Gas, density: f64, speed: f64, pressure: f64) -> Result<Self, InvalidParameter> {
        positive("reference density", density)?;
        positive("reference speed", speed)?;
        positive("reference pressure", pressure)?;
        Ok(Reference { density, speed, sound_speed: gas.sound_speed(density, pressure) })
    }

    /// The density.
    pub fn density(&self) -> f64 {
        self.density
    }

    /// The pressure, rho c^2 / gamma.
    pub fn pressure(&self, gas: &Gas) -> f64 {
        self.density * self.sound_speed * self.sound_speed / gas.gamma()
    }

    /// (scales), in the order of the unknowns.
    pub fn scales<const M: usize>(&self, gas: &Gas) -> [f64; M] {
        let mut scales = [self.density * self.speed; M];
        scales[0] = self.density * self.speed / self.sound_speed;
        scales[M - 1] = self.density * self.sound_speed * self.speed / (gas.gamma() - 1.0);
        scales
    }

    /// The temperature T = c^2 / (gamma R).
    pub fn temperature(&self, gas: &Gas) -> f64 {
        self.sound_speed * self.sound_speed / (gas.gamma() * gas.gas_constant())
    }

    /// The total temperature T + U^2 / (2 c_p).
    pub fn total_temperature(&self, gas: &Gas) -> f64 {
        self.temperature(gas) + 0.5 * self.speed * self.speed / gas.heat_capacity()
    }

    /// The dynamic pressure rho U^2 / 2.
    pub fn dynamic_pressure(&self) -> f64 {
        0.5 * self.density * self.speed * self.speed
    }

    /// The Mach number U / c.
    pub fn mach(&self) -> f64 {
        self.speed / self.sound_speed
    }

    /// The Reynolds number rho U L / mu of the `length` L, mu at the reference temperature; infinite without viscosity.
    pub fn reynolds(&self, gas: &Gas, length: f64) -> f64 {
        self.density * self.speed * length / gas.dynamic_viscosity(self.temperature(gas))
    }
}
