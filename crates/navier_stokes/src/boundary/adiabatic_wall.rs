//! The adiabatic no-slip wall.

use super::given::{Given, Values};
use super::no_slip::wall_velocity;
use super::{BoundaryProblem, Condition, InviscidProblem};
use crate::error::{InvalidParameter, finite};
use crate::flux::Stresses;
use crate::law::NavierStokes;
use crate::state::{Primitive, along, components, lifted};
use fem::BoundaryPoint;
use tensor::{Over, Real};

/// A no-slip wall through which no heat flows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdiabaticWall<const D: usize> {
    given: Given<D>,
}

impl<const D: usize> AdiabaticWall<D> {
    /// A wall that slides with the velocity `slide` relative to the mesh; only its tangential part counts.
    ///
    /// # Errors
    /// A velocity that is not finite.
    pub fn new(slide: [f64; D]) -> Result<Self, InvalidParameter> {
        let vector = finite("sliding velocity of the wall", slide)?;
        Ok(AdiabaticWall { given: Given::Uniform(Values { pressure: 0.0, vector, temperature: 0.0 }) })
    }

    /// Its sliding velocity; None if it is given at every point.
    pub fn slide(&self) -> Option<[f64; D]> {
        self.given.uniform().map(|values| values.vector)
    }

    /// A wall whose sliding velocity is given at every point: data = [_, slide, _].
    pub fn at_points() -> Self {
        AdiabaticWall { given: Given::AtPoints }
    }
}

impl<const D: usize> Condition<D> for AdiabaticWall<D> {
    /// Density and temperature from inside, the velocity of the wall.
    #[inline(always)]
    fn problem<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> BoundaryProblem<T, G, D, M> {
        let inside = Primitive::unpack(&law.gas, minus);
        let velocity = lifted(&self.velocity(at));
        BoundaryProblem { state: Primitive { velocity, ..inside }.pack(&law.gas), inviscid: InviscidProblem::Wall }
    }

    /// [0 ; tau n ; (tau n) . w_b]: friction does work on the moving wall; there is no heat.
    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        let traction = stresses.traction(at.normal);
        let work = along(&traction, &self.velocity(at));
        components(work.zero(), &traction, work)
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
