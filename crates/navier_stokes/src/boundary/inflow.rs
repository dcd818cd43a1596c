//! Subsonic inflow from a reservoir.

use super::{Condition, nothing, projection};
use crate::error::{InvalidParameter, finite, positive};
use crate::flux::inviscid_normal;
use crate::gas::Gas;
use crate::law::NavierStokes;
use crate::state::{Primitive, along};
use tensor::{Over, Real, dot};

/// Total pressure p_0, total temperature T_0 and direction d of the gas that flows in, as seen by an observer at rest.
/// No viscous stress, no heat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inflow<const D: usize> {
    total_pressure: f64,
    total_temperature: f64,
    direction: [f64; D],
}

impl<const D: usize> Inflow<D> {
    /// Inflow of the given total state along `direction`, of any length but zero, into the domain.
    ///
    /// # Errors
    /// A total pressure or temperature that is not positive, a direction that is zero or not finite.
    pub fn new(total_pressure: f64, total_temperature: f64, direction: [f64; D]) -> Result<Self, InvalidParameter> {
        positive("total pressure", total_pressure)?;
        positive("total temperature", total_temperature)?;
        let length = tensor::norm(&finite("inflow direction", direction)?);
        if length == 0.0 {
            return Err(InvalidParameter::NoDirection { quantity: "inflow direction" });
        }
        Ok(Inflow { total_pressure, total_temperature, direction: direction.map(|d| d / length) })
    }

    /// The state w = q d that has the total state of the reservoir and the outgoing acoustic invariant of `minus`: with
    /// k = (gamma - 1) / 2, c_0 the total sound speed and a = d . n < 0,
    ///
    /// ```text
    /// c^2 + k q^2 = c_0^2,   q a + c / k = I = w_n + c / k of minus
    /// q = ( k I a + sqrt(c_0^2 / k + a^2 c_0^2 - k I^2) ) / (1 + k a^2)
    /// ```
    ///
    /// I is kept below the bound (k I / c_0)^2 = 1 + k a^2 at which the root is lost: gas that is pushed back into the
    /// reservoir chokes there.
    #[inline(always)]
    fn reservoir<T: Over<G>, G: Real, const M: usize>(&self, gas: &Gas, minus: &[T; M], n: &[G; D]) -> Primitive<T, D> {
        let inside = Primitive::unpack(gas, minus);
        let like = inside.pressure;
        let k = 0.5 * (gas.gamma() - 1.0);
        let c_0_squared = gas.gamma() * gas.gas_constant() * self.total_temperature;

        let a = T::lift(projection(&self.direction, n));
        let choking = ((a * a * (0.99 * k) + 1.0) * (c_0_squared / (k * k))).sqrt();
        let c = gas.sound_speed(inside.density, inside.pressure);
        let invariant = (along(&inside.velocity, n) + c * (1.0 / k)).max(like.zero()).min(choking);
        let root = ((a * a + 1.0 / k) * c_0_squared - invariant * invariant * k).sqrt();
        let q = (invariant * a * k + root) / (a * a * k + 1.0);

        let temperature_ratio = -(q * q * (k / c_0_squared)) + 1.0;
        let pressure = temperature_ratio.powf(gas.gamma() / (gas.gamma() - 1.0)) * self.total_pressure;
        let density = gas.density(pressure, temperature_ratio * self.total_temperature);
        let mut velocity = [q; D];
        for i in 0..D {
            velocity[i] = q * self.direction[i];
        }
        Primitive { density, velocity, pressure }
    }
}

impl<const D: usize> Condition<D> for Inflow<D> {
    #[inline(always)]
    fn state<T: Over<G>, G: Real, const M: usize>(
        &self,
        _law: &NavierStokes<D>,
        minus: &[T; M],
        _n: &[G; D],
        _v: &[G; D],
        _data: &[G; M],
    ) -> [T; M] {
        *minus
    }

    #[inline(always)]
    fn flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        n: &[G; D],
        v: &[G; D],
        _data: &[G; M],
    ) -> [T; M] {
        let reservoir = self.reservoir(&law.gas, minus, n);
        let w_n = along(&reservoir.velocity, n);
        inviscid_normal(&reservoir.pack(&law.gas), w_n, reservoir.pressure, n, dot(v, n))
    }

    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        _law: &NavierStokes<D>,
        state: &[T; M],
        _gradient: &[[T; M]; D],
        _n: &[G; D],
        _v: &[G; D],
    ) -> [T; M] {
        nothing(state[0])
    }

    #[inline(always)]
    fn asked<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        n: &[G; D],
        _v: &[G; D],
        _data: &[G; M],
    ) -> [T; M] {
        self.reservoir(&law.gas, minus, n).pack(&law.gas)
    }
}
