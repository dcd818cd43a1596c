//! The isothermal no-slip wall.

use super::no_slip::{lifted, wall_velocity};
use super::wall_pressure::wall_pressure;
use super::{Condition, pressure_flux};
use crate::error::{InvalidParameter, finite, positive};
use crate::flux::Stresses;
use crate::law::NavierStokes;
use crate::state::{Primitive, along, components};
use fem::BoundaryPoint;
use tensor::{Over, Real};

/// A no-slip wall of given temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsothermalWall<const D: usize> {
    temperature: f64,
    slide: [f64; D],
}

impl<const D: usize> IsothermalWall<D> {
    /// A wall of the given `temperature` that slides with the velocity `slide` relative to the mesh; only its
    /// tangential part counts.
    ///
    /// # Errors
    /// A temperature that is not positive, a velocity that is not finite.
    pub fn new(temperature: f64, slide: [f64; D]) -> Result<Self, InvalidParameter> {
        let temperature = positive("temperature of the wall", temperature)?;
        Ok(IsothermalWall { temperature, slide: finite("sliding velocity of the wall", slide)? })
    }
}

impl<const D: usize> Condition<D> for IsothermalWall<D> {
    /// The velocity and the temperature of the wall, and the pressure from inside, which the arriving acoustic wave
    /// carries.
    #[inline(always)]
    fn state<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        let BoundaryPoint { normal: n, velocity: v, .. } = at;
        let pressure = Primitive::<T, D>::unpack(&law.gas, minus).pressure;
        let density = law.gas.density(pressure, pressure.constant(self.temperature));
        let velocity = lifted(&wall_velocity(&self.slide, n, v));
        Primitive { density, velocity, pressure }.pack(&law.gas)
    }

    #[inline(always)]
    fn flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        let BoundaryPoint { normal: n, velocity: v, .. } = at;
        pressure_flux(wall_pressure(law, minus, at), n, v)
    }

    /// [0 ; tau n ; (tau n) . w_b + kappa T_,n]
    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        let BoundaryPoint { normal: n, velocity: v, .. } = at;
        let traction = stresses.traction(n);
        let work = along(&traction, &wall_velocity(&self.slide, n, v));
        components(work.zero(), &traction, work + along(&stresses.heat, n))
    }

    #[inline(always)]
    fn velocity<G: Real>(&self, n: &[G; D], v: &[G; D]) -> [G; D] {
        wall_velocity(&self.slide, n, v)
    }
}
