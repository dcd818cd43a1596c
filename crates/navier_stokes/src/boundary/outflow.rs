//! Outflow to a static pressure.
//!
//! Sound that leaves has p + rho c w_n from inside. No sound comes back if the state on the facet (*) obeys
//!
//! ```text
//! p* - p_b = rho c (w*_n - W_n),   hence   p* = ( p + p_b + rho c (w_n - W_n) ) / 2                              (sound)
//! ```
//!
//! with the velocity W of the stream outside, and all that has no index from inside. `far_field` does the same with sound. A sound of angular
//! frequency omega comes back with the amplitude R = -1 / (1 + 2 i omega T) if W follows the mean velocity of the gas with the memory T.
//!
//! This pressure rises with w_n, so that the condition takes energy from sound. It stays between p_b / 2 and 2 p_b. Since it is a total pressure
//! where gas enters, data bound the energy that comes in, see `opening`.

use super::given::{Given, Values};
use super::opening::{Facet, Opening, Reservoir};
use super::{BoundaryProblem, Condition, InviscidProblem, zero_flux};
use crate::error::{InvalidParameter, positive};
use crate::flux::Stresses;
use crate::gas::Gas;
use crate::law::NavierStokes;
use crate::state::{Primitive, along};
use fem::BoundaryPoint;
use tensor::{Over, Real, dot};

/// Outflow to the static pressure p_b outside. Gas that comes back is the gas of a reservoir, see `opening`. It has the total pressure
/// p_b and the total temperature T_0 relative to the facet, and enters along the normal. Viscous stress and heat are those of leaving
/// gas, see `Stresses::leaving_flux`.
///
/// If it lets sound pass, the pressure of (sound) takes the place of p_b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outflow<const D: usize> {
    given: Given<D>,
    non_reflecting: bool,
}

impl<const D: usize> Outflow<D> {
    /// Outflow to the static `pressure`; gas that comes back has the total temperature `total_temperature`.
    ///
    /// # Errors
    /// A pressure or a temperature that is not positive.
    pub fn new(pressure: f64, total_temperature: f64) -> Result<Self, InvalidParameter> {
        positive("pressure of the outflow", pressure)?;
        let temperature = positive("total temperature", total_temperature)?;
        let given = Given::Uniform(Values { pressure, vector: [0.0; D], temperature });
        Ok(Outflow { given, non_reflecting: false })
    }

    /// Outflow to a pressure that is given at every point: data = [p_b, _, T_0].
    pub fn at_points() -> Self {
        Outflow { given: Given::AtPoints, non_reflecting: false }
    }

    /// Outflow that lets sound pass, to a stream of given pressure and velocity: data = [p_b, W, T_0].
    pub fn of_velocity() -> Self {
        Outflow { given: Given::AtPoints, non_reflecting: true }
    }
}

/// The pressure of (sound), within its bounds.
#[inline(always)]
fn pressure_of_sound<T: Over<G>, G: Real, const D: usize>(
    gas: &Gas,
    inside: &Primitive<T, D>,
    stream: &Values<G, D>,
    n: &[G; D],
) -> T {
    let impedance = inside.density * gas.sound_speed(inside.density, inside.pressure);
    let excess = impedance * along(&inside.velocity, n).minus(dot(&stream.vector, n));
    let pressure = (inside.pressure + excess).plus(stream.pressure) * 0.5;
    pressure.max(T::lift(stream.pressure * 0.5)).min(T::lift(stream.pressure * 2.0))
}

impl<const D: usize> Condition<D> for Outflow<D> {
    #[inline(always)]
    fn problem<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> BoundaryProblem<T, G, D, M> {
        let (BoundaryPoint { normal: n, velocity: v, .. }, gas) = (at, &law.gas);
        let mut direction = *n;
        for i in 0..D {
            direction[i] = -n[i];
        }
        let facet = Facet { normal: *n, normal_velocity: dot(v, n), direction, reservoir_velocity: *v };
        let stream = self.given.values(&at);
        let total_pressure = if self.non_reflecting {
            pressure_of_sound(gas, &Primitive::unpack(gas, minus), &stream, n)
        } else {
            T::lift(stream.pressure)
        };
        let reservoir = Reservoir { total_pressure, total_temperature: stream.temperature };
        BoundaryProblem {
            state: *minus,
            inviscid: InviscidProblem::Opening(Opening { reservoir, facet, lets_supersonic_pass: true }),
        }
    }

    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        let BoundaryPoint { normal: n, .. } = at;
        stresses.leaving_flux(n)
    }

    /// None: from inside it would feed energy into a compression that the mesh does not resolve.
    #[inline(always)]
    fn artificial_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        _at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        zero_flux(stresses.velocity[0])
    }

    #[inline(always)]
    fn takes_data(&self) -> bool {
        self.given.is_at_points()
    }
}
