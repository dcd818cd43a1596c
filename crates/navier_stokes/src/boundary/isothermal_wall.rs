//! The isothermal no-slip wall.

use super::given::{Given, Values};
use super::no_slip::wall_velocity;
use super::{BoundaryProblem, Condition, InviscidProblem};
use crate::error::{InvalidParameter, finite, positive};
use crate::flux::Stresses;
use crate::law::NavierStokes;
use crate::state::{Primitive, along, components, lifted};
use fem::BoundaryPoint;
use tensor::{Over, Real};

/// A no-slip wall of given temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsothermalWall<const D: usize> {
    given: Given<D>,
}

impl<const D: usize> IsothermalWall<D> {
    /// A wall of the given `temperature` that slides with the velocity `slide` relative to the mesh; only its
    /// tangential part counts.
    ///
    /// # Errors
    /// A temperature that is not positive, a velocity that is not finite.
    pub fn new(temperature: f64, slide: [f64; D]) -> Result<Self, InvalidParameter> {
        let temperature = positive("temperature of the wall", temperature)?;
        let vector = finite("sliding velocity of the wall", slide)?;
        Ok(IsothermalWall { given: Given::Uniform(Values { pressure: 0.0, vector, temperature }) })
    }

    /// Its temperature; None if it is given at every point.
    pub fn temperature(&self) -> Option<f64> {
        self.given.uniform().map(|values| values.temperature)
    }

    /// Its sliding velocity; None if it is given at every point.
    pub fn slide(&self) -> Option<[f64; D]> {
        self.given.uniform().map(|values| values.vector)
    }

    /// A wall whose sliding velocity and temperature are given at every point: data = [_, slide, temperature].
    pub fn at_points() -> Self {
        IsothermalWall { given: Given::AtPoints }
    }
}

impl<const D: usize> Condition<D> for IsothermalWall<D> {
    /// The velocity and the temperature of the wall, and the pressure from inside, which the arriving acoustic wave
    /// carries.
    #[inline(always)]
    fn problem<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> BoundaryProblem<T, G, D, M> {
        let pressure = Primitive::<T, D>::unpack(&law.gas, minus).pressure;
        let density = law.gas.density(pressure, T::lift(self.given.values(&at).temperature));
        let velocity = lifted(&self.velocity(at));
        BoundaryProblem {
            state: Primitive { density, velocity, pressure }.pack(&law.gas),
            inviscid: InviscidProblem::Wall,
        }
    }

    /// [0 ; tau n ; (tau n) . w_b + kappa T_,n]
    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        let traction = stresses.traction(at.normal);
        let work = along(&traction, &self.velocity(at));
        components(work.zero(), &traction, work + along(&stresses.heat, at.normal))
    }

    #[inline(always)]
    fn velocity<G: Real, const M: usize>(&self, at: BoundaryPoint<'_, G, D, M>) -> [G; D] {
        wall_velocity(&self.given.values(&at).vector, at.normal, at.velocity)
    }

    #[inline(always)]
    fn takes_data(&self) -> bool {
        self.given.is_at_points()
    }
}
