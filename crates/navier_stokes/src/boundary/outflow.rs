//! Outflow to a given static pressure.

use super::given::{Given, Values};
use super::opening::{Facet, Reservoir};
use super::{Condition, nothing, through};
use crate::error::{InvalidParameter, positive};
use crate::flux::Stresses;
use crate::gas::Gas;
use crate::law::NavierStokes;
use crate::state::{Primitive, along};
use fem::BoundaryPoint;
use tensor::{Over, Real, dot};

/// Outflow to the static pressure p_b outside. Gas that comes back is the gas of a reservoir, see `opening`. It has the total pressure
/// p_b and the total temperature T_0 relative to the facet, and enters along the normal. Viscous stress and heat pass as they come
/// from inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outflow<const D: usize> {
    given: Given<D>,
}

impl<const D: usize> Outflow<D> {
    /// Outflow to the static `pressure`; gas that comes back has the total temperature `total_temperature`.
    ///
    /// # Errors
    /// A pressure or a temperature that is not positive.
    pub fn new(pressure: f64, total_temperature: f64) -> Result<Self, InvalidParameter> {
        positive("pressure of the outflow", pressure)?;
        let temperature = positive("total temperature", total_temperature)?;
        Ok(Outflow { given: Given::Uniform(Values { pressure, vector: [0.0; D], temperature }) })
    }

    /// Outflow to a pressure that is given at every point: data = [p_b, _, T_0].
    pub fn at_points() -> Self {
        Outflow { given: Given::AtPoints }
    }

    /// The state on the facet: `minus` itself if w_n - v_n >= c, since then no wave comes in.
    #[inline(always)]
    fn outside<T: Over<G>, G: Real, const M: usize>(
        &self,
        gas: &Gas,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> Primitive<T, D> {
        let BoundaryPoint { normal: n, velocity: v, .. } = at;
        let inside = Primitive::unpack(gas, minus);
        let mut direction = *n;
        for i in 0..D {
            direction[i] = -n[i];
        }
        let v_n = dot(v, n);
        let facet = Facet { normal: *n, normal_velocity: v_n, direction, reservoir_velocity: *v };
        let Values { pressure, temperature, .. } = self.given.values(&at);
        let reservoir = Reservoir { total_pressure: pressure, total_temperature: temperature };
        let mut outside = reservoir.state(gas, &inside, &facet);

        let c = gas.sound_speed(inside.density, inside.pressure);
        let relative = along(&inside.velocity, n).minus(v_n);
        outside.density = relative.select_ge(c, inside.density, outside.density);
        outside.pressure = relative.select_ge(c, inside.pressure, outside.pressure);
        for i in 0..D {
            outside.velocity[i] = relative.select_ge(c, inside.velocity[i], outside.velocity[i]);
        }
        outside
    }
}

impl<const D: usize> Condition<D> for Outflow<D> {
    #[inline(always)]
    fn flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        let BoundaryPoint { normal: n, velocity: v, .. } = at;
        through(&law.gas, &self.outside(&law.gas, minus, at), n, v)
    }

    /// None: from inside it would feed energy into a compression that the mesh does not resolve.
    #[inline(always)]
    fn artificial_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        _at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        nothing(stresses.velocity[0])
    }

    #[inline(always)]
    fn target_state<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        self.outside(&law.gas, minus, at).pack(&law.gas)
    }

    #[inline(always)]
    fn takes_data(&self) -> bool {
        self.given.is_at_points()
    }
}
