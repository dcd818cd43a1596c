//! Subsonic inflow of given velocity, or mass flux, and temperature.

use super::given::Values;
use super::{BoundaryProblem, Condition, InviscidProblem, zero_flux};
use crate::flux::Stresses;
use crate::law::NavierStokes;
use crate::state::{Primitive, along};
use fem::BoundaryPoint;
use tensor::{Over, Real, dot};

/// Velocity and temperature given at every point and time. The pressure comes from inside, with the acoustic wave that leaves. Viscous
/// terms take the state on the facet as Dirichlet data. The condition reflects sound.
///
/// Data = [_, w_g or rho w_g, T_g]. T_g plays no part where gas leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VelocityInflow {
    /// The velocity w_g is given.
    OfVelocity,
    /// The mass flux rho w_g is given: the gas flows in with exactly this flux at any pressure.
    OfMassFlux,
}

impl VelocityInflow {
    /// The bounds of c* / c. A mass flux at a low pressure is a high velocity, hence its closer bounds: p* / p is then between 0.5
    /// and 2.
    #[inline(always)]
    fn bounds(self) -> [f64; 2] {
        match self {
            VelocityInflow::OfVelocity => [0.5, 2.0],
            VelocityInflow::OfMassFlux => [0.9, 1.1],
        }
    }

    /// The factor from the given vector to a velocity: 1 / rho for a mass flux, 1 for a velocity.
    #[inline(always)]
    fn specific_volume<T: Real>(self, inverse_density: T) -> T {
        match self {
            VelocityInflow::OfVelocity => inverse_density.constant(1.0),
            VelocityInflow::OfMassFlux => inverse_density,
        }
    }
}

/// The flux `entering` where gas enters through the facet, and `leaving` elsewhere.
#[inline(always)]
fn where_entering<T: Over<G>, G: Real, const D: usize, const M: usize>(
    stresses: &Stresses<T, D>,
    BoundaryPoint { normal: n, velocity: v, .. }: BoundaryPoint<'_, G, D, M>,
    entering: [T; M],
    leaving: [T; M],
) -> [T; M] {
    let inward = -along(&stresses.velocity, n).minus(dot(v, n));
    let mut flux = entering;
    for m in 0..M {
        flux[m] = inward.select_ge(inward.zero(), entering[m], leaving[m]);
    }
    flux
}

impl<const D: usize> Condition<D> for VelocityInflow {
    /// Gas that leaves through the facet has no data for its heat and its tangential velocity.
    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        let n = at.normal;
        where_entering(stresses, at, stresses.normal_flux(n), stresses.leaving_flux(n))
    }

    /// None where gas leaves: see [`super::Outflow`].
    #[inline(always)]
    fn artificial_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        where_entering(stresses, at, stresses.normal_flux(at.normal), zero_flux(stresses.velocity[0]))
    }

    /// The state on the facet. With k = (gamma - 1) / 2 and R+ = w_n + c / k of the gas inside at its own entropy,
    ///
    /// ```text
    /// c* = c + k (w_n - w_gn), within its bounds,   p* = p (c* / c)^(gamma / k)
    /// ```
    ///
    /// Gas that enters has the given velocity and temperature. Gas that leaves has the given normal velocity, and its own entropy and
    /// tangential velocity. A given mass flux is converted to a velocity, first at the pressure inside for c*, then at p* for the state. The two
    /// pressures differ only by the jump at the facet, and the mass flux is exact. At the pressure inside, gas that enters has the given temperature,
    /// and gas that leaves its own density.
    #[inline(always)]
    fn problem<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> BoundaryProblem<T, G, D, M> {
        let (BoundaryPoint { normal: n, velocity: v, data }, gas) = (at, &law.gas);
        let inside: Primitive<T, D> = Primitive::unpack(gas, minus);
        let given = Values::of_data(data);
        let k = 0.5 * (gas.gamma() - 1.0);
        let c = gas.sound_speed(inside.density, inside.pressure);
        let (w_n, given_n) = (along(&inside.velocity, n), T::lift(dot(&given.vector, n)));
        let specific_pressure = T::lift(given.temperature * gas.gas_constant());

        let entering_n = given_n * self.specific_volume(specific_pressure / inside.pressure);
        let leaving_n = given_n * self.specific_volume(inside.density.recip());
        let into_domain = T::lift(dot(v, n)) - entering_n;
        let expected_n = into_domain.select_ge(c.zero(), entering_n, leaving_n);
        let [lowest, highest] = self.bounds();
        let c_here = (c + (w_n - expected_n) * k).max(c * lowest).min(c * highest);
        let pressure = inside.pressure * (c_here / c).powf(gas.gamma() / k);

        let entering_density = pressure / specific_pressure;
        let leaving_density = pressure * gas.gamma() / (c_here * c_here);
        let entering = self.specific_volume(entering_density.recip());
        let gain = given_n * self.specific_volume(leaving_density.recip()) - w_n;
        let mut velocity = inside.velocity;
        for i in 0..D {
            let leaves = inside.velocity[i] + gain.scale(n[i]);
            velocity[i] = into_domain.select_ge(c.zero(), entering.scale(given.vector[i]), leaves);
        }
        let density = into_domain.select_ge(c.zero(), entering_density, leaving_density);
        let state = Primitive { density, velocity, pressure };
        BoundaryProblem { state: state.pack(gas), inviscid: InviscidProblem::OfState(state) }
    }

    #[inline(always)]
    fn takes_data(&self) -> bool {
        true
    }
}
