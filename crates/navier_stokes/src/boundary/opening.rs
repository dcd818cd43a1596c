//! The opening to a reservoir, shared by inflow and outflow.
//!
//! The waves at a boundary, by their speed relative to it along the outward normal n:
//!
//! | speed | carries | data or inside |
//! |---|---|---|
//! | w_n + c | R+ = w_n + 2 c / (gamma - 1) | inside |
//! | w_n | entropy, tangential velocity | inside if gas leaves, **data if it enters** |
//! | w_n - c | R- | data |
//!
//! The middle row decides stability. Let a be the amplitude of entropy or tangential velocity in the cell at the boundary. Its energy
//! a^2 / 2 loses |w_n| a^2 / 2 if data are taken exactly where gas enters. It gains as much if data are imposed on gas that leaves, or
//! if gas enters with the values of the inside. An opening therefore has a complete state outside: gas at rest, of total pressure p_0
//! and total temperature T_0, which enters along the direction d. Gas that leaves does so at the static pressure p_0. Since p_0 is a
//! total pressure where gas enters, data bound the energy that comes in.

use crate::gas::Gas;
use crate::state::{Primitive, along};
use tensor::{Over, Real, dot};

/// Gas at rest of the total pressure p_0 and the total temperature T_0. The pressure is a datum, or follows from the gas inside.
#[derive(Clone, Copy)]
pub(crate) struct Reservoir<T, G> {
    pub(super) total_pressure: T,
    pub(super) total_temperature: G,
}

/// A facet in the gas: its unit normal n, its normal velocity v_n, the direction d in which gas enters and the velocity of the
/// reservoir.
#[derive(Clone, Copy)]
pub(crate) struct Facet<G, const D: usize> {
    pub(super) normal: [G; D],
    pub(super) normal_velocity: G,
    pub(super) direction: [G; D],
    pub(super) reservoir_velocity: [G; D],
}

/// A facet that is open to a reservoir.
#[derive(Clone, Copy)]
pub(crate) struct Opening<T, G, const D: usize> {
    pub(super) reservoir: Reservoir<T, G>,
    pub(super) facet: Facet<G, D>,
    /// Whether gas that leaves faster than sound, w_n - v_n >= c, leaves as it is, since no wave comes in. If not, it leaves as a rarefaction
    /// that is sonic at the facet.
    pub(super) lets_supersonic_pass: bool,
}

impl<T: Over<G>, G: Real, const D: usize> Opening<T, G, D> {
    /// The state on the facet.
    #[inline(always)]
    pub(crate) fn state(&self, gas: &Gas, inside: &Primitive<T, D>) -> Primitive<T, D> {
        let mut state = self.reservoir.state(gas, inside, &self.facet);
        if self.lets_supersonic_pass {
            let c = gas.sound_speed(inside.density, inside.pressure);
            let relative = along(&inside.velocity, &self.facet.normal).minus(self.facet.normal_velocity);
            state.density = relative.select_ge(c, inside.density, state.density);
            state.pressure = relative.select_ge(c, inside.pressure, state.pressure);
            for i in 0..D {
                state.velocity[i] = relative.select_ge(c, inside.velocity[i], state.velocity[i]);
            }
        }
        state
    }
}

impl<T: Over<G>, G: Real> Reservoir<T, G> {
    /// The state on a facet between the gas `inside` and the reservoir.
    ///
    /// Let k = (gamma - 1) / 2, c_0 the sound speed of the reservoir, and a = d . n < 0. Let w_n and I = R+ belong to the gas inside, in
    /// the frame of the reservoir, and let c_s be the sound speed of that gas at the pressure p_0. Then
    ///
    /// ```text
    /// q a + (c_s / k) sqrt(1 - k q^2 / c_0^2) = I                      gas that enters with speed q: R+ across the contact    (q)
    /// p* = p_0 theta^(gamma / (gamma - 1)),   theta = (1 - k q^2 / c_0^2) (b / c_s)^2                                       (p*)
    /// w*_n = q a + max(I - b / k, 0),   b = max(c_s, I k / (1 + k))                                                        (w*)
    /// ```
    ///
    /// Gas enters if I < c_s / k. R+ is constant only at the entropy of the gas inside, hence c_s and not c_0 in (q). Gas that enters
    /// chokes if q |a| is its sound speed. Gas that leaves chokes if b is its sound speed (a rarefaction that is sonic at the facet).
    #[inline(always)]
    pub(crate) fn state<const D: usize>(
        &self,
        gas: &Gas,
        inside: &Primitive<T, D>,
        facet: &Facet<G, D>,
    ) -> Primitive<T, D> {
        let Facet { normal: n, normal_velocity, direction, reservoir_velocity } = facet;
        let k = 0.5 * (gas.gamma() - 1.0);
        let zero = inside.pressure.zero();
        let frame_n = dot(reservoir_velocity, n);
        let w_n = along(&inside.velocity, n).minus(frame_n);
        let c = gas.sound_speed(inside.density, inside.pressure);

        let c_0_squared = self.total_temperature * (gas.gamma() * gas.gas_constant());
        let c_s = c * (inside.pressure * self.total_pressure.recip()).powf(-k / gas.gamma());
        let invariant = w_n + c * (1.0 / k);
        let a = T::lift(dot(direction, n));
        let q = entering_speed(a, c_s, invariant, k, c_0_squared);

        let b = c_s.max(invariant * (k / (1.0 + k)));
        let push = (invariant - b * (1.0 / k)).max(zero);
        let choking = b / c_s;
        let theta = (-(q * q).scale(c_0_squared.constant(k) / c_0_squared) + 1.0) * (choking * choking);
        let pressure = theta.powf(gas.gamma() / (gas.gamma() - 1.0)) * self.total_pressure;

        let normal_velocity_here = q * a + push;
        let relative = normal_velocity_here.plus(frame_n).minus(*normal_velocity);
        let c_squared = relative.select_ge(zero, c_s * c_s, T::lift(c_0_squared)) * theta;
        let mut velocity = inside.velocity;
        for i in 0..D {
            let leaves = inside.velocity[i] + (normal_velocity_here - w_n).scale(n[i]);
            let enters = (q.scale(direction[i]) + push.scale(n[i])).plus(reservoir_velocity[i]);
            velocity[i] = relative.select_ge(zero, leaves, enters);
        }
        Primitive { density: pressure * gas.gamma() / c_squared, velocity, pressure }
    }
}

/// q, the speed of the gas that enters, or 0 if none does: the larger root of the quadratic equation (q).
#[inline(always)]
fn entering_speed<T: Over<G>, G: Real>(a: T, c_s: T, invariant: T, k: f64, c_0_squared: G) -> T {
    /// Keeps the root differentiable if d lies in the facet.
    const LEAST: f64 = 1e-24;
    let (a_squared, c_s_squared) = (a * a, c_s * c_s);
    let ratio = c_s_squared.scale(c_0_squared.recip());
    let entering = invariant.max(a.zero()).min(c_s * (1.0 / k));
    let discriminant = c_s_squared * (a_squared + ratio * (1.0 / k)) - ratio * entering * entering * k;
    let root = discriminant.max(c_s_squared * LEAST).sqrt();
    let q = (entering * a * k + root) / (a_squared * k + ratio);
    let sonic = (a_squared + k).recip().scale(c_0_squared).sqrt();
    q.max(a.zero()).min(sonic)
}
