//! Subsonic inflow from a reservoir.

use super::opening::{Facet, Reservoir};
use super::{Condition, nothing, through};
use crate::error::{InvalidParameter, finite};
use crate::flux::Stresses;
use crate::gas::Gas;
use crate::law::NavierStokes;
use crate::state::Primitive;
use fem::BoundaryPoint;
use tensor::{Over, Real, dot};

/// Total pressure p_0, total temperature T_0 and direction d of the gas that flows in, for an observer at rest: an opening to a
/// reservoir, see `opening`. Gas that is pushed back leaves at the static pressure p_0 with its own entropy and tangential velocity.
/// No viscous stress, no heat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inflow<const D: usize> {
    reservoir: Reservoir,
    direction: [f64; D],
}

impl<const D: usize> Inflow<D> {
    /// Inflow of the given total state along `direction`, a vector of any nonzero length that points into the domain.
    ///
    /// # Errors
    /// A total pressure or temperature that is not positive, a direction that is zero or not finite.
    pub fn new(total_pressure: f64, total_temperature: f64, direction: [f64; D]) -> Result<Self, InvalidParameter> {
        let reservoir = Reservoir::new(total_pressure, total_temperature)?;
        let length = tensor::norm(&finite("inflow direction", direction)?);
        if length == 0.0 {
            return Err(InvalidParameter::NoDirection { quantity: "inflow direction" });
        }
        Ok(Inflow { reservoir, direction: direction.map(|d| d / length) })
    }

    /// d, of unit length.
    pub fn direction(&self) -> [f64; D] {
        self.direction
    }

    /// The state on the facet.
    #[inline(always)]
    fn outside<T: Over<G>, G: Real, const M: usize>(
        &self,
        gas: &Gas,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> Primitive<T, D> {
        let BoundaryPoint { normal: n, velocity: v, .. } = at;
        let (mut direction, mut reservoir_velocity) = (*n, *n);
        for i in 0..D {
            direction[i] = n[i].constant(self.direction[i]);
            reservoir_velocity[i] = n[i].zero();
        }
        let facet = Facet { normal: *n, normal_velocity: dot(v, n), direction, reservoir_velocity };
        self.reservoir.state(gas, &Primitive::unpack(gas, minus), &facet)
    }
}

impl<const D: usize> Condition<D> for Inflow<D> {
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

    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
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
}
