//! Outflow to a given static pressure.

use super::Condition;
use crate::error::{InvalidParameter, positive};
use crate::flux::{Stresses, inviscid_normal};
use crate::gas::Gas;
use crate::law::NavierStokes;
use crate::state::{Primitive, along};
use tensor::{Over, Real, dot};

/// The static pressure outside. Viscous stress and heat pass as they come from inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outflow {
    pressure: f64,
}

impl Outflow {
    /// Outflow to the static `pressure`.
    ///
    /// # Errors
    /// A pressure that is not positive.
    pub fn new(pressure: f64) -> Result<Self, InvalidParameter> {
        Ok(Outflow { pressure: positive("pressure of the outflow", pressure)? })
    }

    /// The state of the pressure p outside with the entropy, the tangential velocity and the outgoing acoustic invariant
    /// w_n + 2 c / (gamma - 1) of `minus`; `minus` itself where w_n - v_n >= c, since no wave comes in there.
    #[inline(always)]
    fn outside<T: Over<G>, G: Real, const D: usize, const M: usize>(
        &self,
        gas: &Gas,
        minus: &[T; M],
        n: &[G; D],
        v_n: G,
    ) -> Primitive<T, D> {
        let inside = Primitive::unpack(gas, minus);
        let c = gas.sound_speed(inside.density, inside.pressure);
        let subsonic_pressure = c.constant(self.pressure);
        let pressure = along(&inside.velocity, n).minus(v_n).select_ge(c, inside.pressure, subsonic_pressure);

        let density = inside.density * (pressure / inside.pressure).powf(1.0 / gas.gamma());
        let gain = (c - gas.sound_speed(density, pressure)) * (2.0 / (gas.gamma() - 1.0));
        let mut velocity = inside.velocity;
        for i in 0..D {
            velocity[i] += gain.scale(n[i]);
        }
        Primitive { density, velocity, pressure }
    }
}

impl<const D: usize> Condition<D> for Outflow {
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
        let v_n = dot(v, n);
        let outside = self.outside(&law.gas, minus, n, v_n);
        inviscid_normal(&outside.pack(&law.gas), along(&outside.velocity, n), outside.pressure, n, v_n)
    }

    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        state: &[T; M],
        gradient: &[[T; M]; D],
        n: &[G; D],
        _v: &[G; D],
    ) -> [T; M] {
        Stresses::new(&law.gas, state, gradient).normal_flux(n)
    }

    #[inline(always)]
    fn asked<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        n: &[G; D],
        v: &[G; D],
        _data: &[G; M],
    ) -> [T; M] {
        self.outside(&law.gas, minus, n, dot(v, n)).pack(&law.gas)
    }
}
