//! Subsonic inflow from a reservoir.

use super::given::{Given, Values};
use super::opening::{Facet, Opening, Reservoir};
use super::{BoundaryProblem, Condition, InviscidProblem, zero_flux};
use crate::error::{InvalidParameter, finite, positive};
use crate::flux::Stresses;
use crate::law::NavierStokes;
use fem::BoundaryPoint;
use tensor::{Over, Real, dot};

/// Total pressure p_0, total temperature T_0 and direction d of the gas that flows in, for an observer at rest: an opening to a
/// reservoir, see `opening`. Gas that is pushed back leaves at the static pressure p_0 with its own entropy and tangential velocity.
/// No viscous stress, no heat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inflow<const D: usize> {
    given: Given<D>,
}

impl<const D: usize> Inflow<D> {
    /// Inflow of the given total state along `direction`, a vector of any nonzero length that points into the domain.
    ///
    /// # Errors
    /// A total pressure or temperature that is not positive, a direction that is zero or not finite.
    pub fn new(total_pressure: f64, total_temperature: f64, direction: [f64; D]) -> Result<Self, InvalidParameter> {
        let pressure = positive("total pressure", total_pressure)?;
        let temperature = positive("total temperature", total_temperature)?;
        let length = tensor::norm(&finite("inflow direction", direction)?);
        if length == 0.0 {
            return Err(InvalidParameter::NoDirection { quantity: "inflow direction" });
        }
        let vector = direction.map(|d| d / length);
        Ok(Inflow { given: Given::Uniform(Values { pressure, vector, temperature }) })
    }

    /// Inflow of a total state that is given at every point: data = [p_0, direction of any length, T_0].
    pub fn at_points() -> Self {
        Inflow { given: Given::AtPoints }
    }

    /// d, of unit length, if it is the same everywhere.
    pub fn direction(&self) -> Option<[f64; D]> {
        match self.given {
            Given::Uniform(Values { vector, .. }) => Some(vector),
            Given::AtPoints => None,
        }
    }
}

impl<const D: usize> Condition<D> for Inflow<D> {
    #[inline(always)]
    fn problem<T: Over<G>, G: Real, const M: usize>(
        &self,
        _law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> BoundaryProblem<T, G, D, M> {
        let BoundaryPoint { normal: n, velocity: v, .. } = at;
        let Values { pressure, vector, temperature } = self.given.values(&at);
        let reservoir_velocity = [n[0].zero(); D];
        let direction = self.given.unit(&vector);
        let facet = Facet { normal: *n, normal_velocity: dot(v, n), direction, reservoir_velocity };
        let reservoir = Reservoir { total_pressure: T::lift(pressure), total_temperature: temperature };
        BoundaryProblem {
            state: *minus,
            inviscid: InviscidProblem::Opening(Opening { reservoir, facet, lets_supersonic_pass: false }),
        }
    }

    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
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
