//! A calorically perfect gas.

use crate::error::{InvalidParameter, positive};
use crate::state::{Conserved, Primitive};
use tensor::{Real, dot, norm};

/// The dependence of the dynamic viscosity mu on the temperature T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Viscosity {
    /// mu = 0: the Euler equations.
    Inviscid,
    /// A constant mu.
    Constant(f64),
    /// Sutherland's law, mu = mu_0 (T / T_0)^(3/2) (T_0 + S) / (T + S).
    Sutherland {
        /// mu_0, the viscosity at T_0.
        viscosity: f64,
        /// T_0.
        temperature: f64,
        /// S (air: 110.4 K).
        constant: f64,
    },
}

/// A perfect gas with constant specific heats c_v = R / (gamma - 1), c_p = gamma c_v, in any consistent system of units:
///
/// ```text
/// p = (gamma - 1) rho e = rho R T,   e = E - |w|^2 / 2,   kappa = mu c_p / Pr                               (gas)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gas {
    gamma: f64,
    gas_constant: f64,
    prandtl: f64,
    viscosity: Viscosity,
}

impl Gas {
    /// A gas with the ratio of specific heats `gamma`, the specific gas constant R, the Prandtl number and a viscosity law.
    ///
    /// # Errors
    /// gamma not above 1, or another number that is not positive.
    pub fn new(gamma: f64, gas_constant: f64, prandtl: f64, viscosity: Viscosity) -> Result<Self, InvalidParameter> {
        if !(gamma > 1.0 && gamma.is_finite()) {
            return Err(InvalidParameter::Gamma { value: gamma });
        }
        positive("gas constant", gas_constant)?;
        positive("Prandtl number", prandtl)?;
        match viscosity {
            Viscosity::Inviscid => {}
            Viscosity::Constant(mu) => _ = positive("viscosity", mu)?,
            Viscosity::Sutherland { viscosity, temperature, constant } => {
                positive("reference viscosity", viscosity)?;
                positive("reference temperature of the viscosity", temperature)?;
                positive("Sutherland constant", constant)?;
            }
        }
        Ok(Gas { gamma, gas_constant, prandtl, viscosity })
    }

    /// gamma = c_p / c_v.
    #[inline(always)]
    pub fn gamma(&self) -> f64 {
        self.gamma
    }
    /// The specific gas constant R = c_p - c_v.
    #[inline(always)]
    pub fn gas_constant(&self) -> f64 {
        self.gas_constant
    }
    /// Pr = mu c_p / kappa.
    #[inline(always)]
    pub fn prandtl(&self) -> f64 {
        self.prandtl
    }
    /// The law of the viscosity.
    #[inline(always)]
    pub fn viscosity(&self) -> Viscosity {
        self.viscosity
    }
    /// c_p = gamma R / (gamma - 1), the specific heat at constant pressure.
    #[inline(always)]
    pub fn heat_capacity(&self) -> f64 {
        self.gamma * self.gas_constant / (self.gamma - 1.0)
    }

    /// p = (gamma - 1) (rho E - rho |w|^2 / 2), with `velocity` w = momentum / rho.
    #[inline(always)]
    pub fn pressure<T: Real, const D: usize>(&self, u: &Conserved<T, D>, velocity: &[T; D]) -> T {
        (u.energy - dot(&u.momentum, velocity) * 0.5) * (self.gamma - 1.0)
    }
    /// T = p / (rho R).
    #[inline(always)]
    pub fn temperature<T: Real>(&self, density: T, pressure: T) -> T {
        pressure / (density * self.gas_constant)
    }
    /// rho = p / (R T).
    #[inline(always)]
    pub fn density<T: Real>(&self, pressure: T, temperature: T) -> T {
        pressure / (temperature * self.gas_constant)
    }
    /// c = sqrt(gamma p / rho).
    #[inline(always)]
    pub fn sound_speed<T: Real>(&self, density: T, pressure: T) -> T {
        (pressure / density * self.gamma).sqrt()
    }
    /// The Mach number |w| / c.
    pub fn mach<const D: usize>(&self, state: &Primitive<f64, D>) -> f64 {
        norm(&state.velocity) / self.sound_speed(state.density, state.pressure)
    }
    /// s = ln p - gamma ln rho.
    pub fn entropy(&self, density: f64, pressure: f64) -> f64 {
        pressure.ln() - self.gamma * density.ln()
    }
    /// mu(T).
    #[inline(always)]
    pub fn dynamic_viscosity<T: Real>(&self, temperature: T) -> T {
        match self.viscosity {
            Viscosity::Inviscid => temperature.zero(),
            Viscosity::Constant(mu) => temperature.constant(mu),
            Viscosity::Sutherland { viscosity, temperature: t_0, constant: s } => {
                let ratio = temperature * (1.0 / t_0);
                ratio * ratio.sqrt() * (viscosity * (t_0 + s)) / (temperature + s)
            }
        }
    }
}
