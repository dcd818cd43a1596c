//! Inflows of a given velocity, mass flux or state.

use super::consistency::normal_flux;
use super::openings::{along_x, invariant};
use super::*;

/// For any gas inside, a velocity inflow passes the given velocity and temperature, or the given mass flux, to round-off. The acoustic
/// invariant is that of the gas inside.
fn velocity_inflow_passes_what_is_given<const D: usize, const M: usize>() {
    let (gas, n, t) = (gas(), along_x::<D>(-1.0), 1.7);
    for seed in 0..100 {
        let mut random = Random(seed);
        let inside = Primitive { velocity: random.vector(0.8), ..random.primitive::<D>() };
        let mut given: [f64; D] = random.vector(0.6);
        given[0] = random.between(0.05, 0.6);
        let u: [f64; M] = inside.pack(&gas);
        let data: [f64; M] = values(0.0, given, t);
        for kind in [VelocityInflow::OfVelocity, VelocityInflow::OfMassFlux] {
            let condition = Boundary::VelocityInflow(kind);
            let law = law::<D>(Riemann::Roe);
            let flux: [f64; M] = law.impose(condition, &u, at(&n, &[0.0; D], &data)).flux;
            let state = Primitive::<f64, D>::unpack(&gas, &condition.target_state(&law, &u, at(&n, &[0.0; D], &data)));
            let vector = match kind {
                VelocityInflow::OfVelocity => state.velocity,
                VelocityInflow::OfMassFlux => state.velocity.map(|w| state.density * w),
            };
            assert!((0..D).all(|i| (vector[i] - given[i]).abs() <= 1e-13), "{kind:?}");
            assert!((gas.temperature(state.density, state.pressure) - t).abs() <= 1e-12);
            assert!((flux[0] + state.density * state.velocity[0]).abs() <= 1e-13);
            if kind == VelocityInflow::OfMassFlux {
                assert!((flux[0] + given[0]).abs() <= 1e-13);
                continue;
            }
            let (c, plus) = invariant(&inside, -inside.velocity[0], state.pressure);
            assert!((-given[0] + 2.0 * c / (gas.gamma() - 1.0) - plus).abs() <= 1e-12);
        }
    }
}

/// A mass flux that fits the state inside passes that state. Where the given vector points out of the domain, gas leaves with its own
/// entropy and tangential velocity.
fn velocity_inflow_lets_gas_leave<const D: usize, const M: usize>() {
    let (gas, law) = (gas(), law::<D>(Riemann::Roe));
    for seed in 0..100 {
        let mut random = Random(seed);
        let (n, inside): ([f64; D], _) = (random.unit(), random.primitive::<D>());
        let u: [f64; M] = inside.pack(&gas);
        let momentum = inside.velocity.map(|w| inside.density * w);
        let fits: [f64; M] = values(0.0, momentum, gas.temperature(inside.density, inside.pressure));
        let mass_flux = Boundary::VelocityInflow(VelocityInflow::OfMassFlux);
        let flux = law.impose(mass_flux, &u, at(&n, &[0.0; D], &fits)).flux;
        assert!(difference(&flux, &normal_flux(&u, &n, &[0.0; D])) <= 1e-13);
        if dot(&momentum, &n) > 0.0 {
            // Gas that leaves had the pressure of gas at the given temperature.
            let suction: [f64; M] = values(0.0, momentum, 9.0);
            let flux = law.impose(mass_flux, &u, at(&n, &[0.0; D], &suction)).flux;
            assert!(difference(&flux, &normal_flux(&u, &n, &[0.0; D])) <= 1e-13);
        }

        let out = random.between(0.1, 0.5);
        let data: [f64; M] = values(0.0, n.map(|n| out * n), 9.0);
        for kind in [VelocityInflow::OfVelocity, VelocityInflow::OfMassFlux] {
            let target_state = Boundary::VelocityInflow(kind).target_state(&law, &u, at(&n, &[0.0; D], &data));
            let state = Primitive::<f64, D>::unpack(&gas, &target_state);
            let entropy = |state: &Primitive<f64, D>| state.pressure / state.density.powf(gas.gamma());
            assert!((entropy(&state) / entropy(&inside) - 1.0).abs() <= 1e-12);
            let gain: [f64; D] = std::array::from_fn(|i| state.velocity[i] - inside.velocity[i]);
            let normal = dot(&gain, &n);
            assert!((0..D).all(|i| (gain[i] - normal * n[i]).abs() <= 1e-12));
        }
    }
}

/// A supersonic inflow passes the given state for any gas inside.
fn supersonic_inflow_passes_its_state<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let inflow = Boundary::SupersonicInflow(SupersonicInflow);
        let flux = law::<D>(Riemann::Roe).impose(inflow, &p.minus, at(&p.n, &p.v, &p.data)).flux;
        assert!(difference(&flux, &normal_flux(&p.data, &p.n, &p.v)) <= 1e-14);
    }
}

in_both_dimensions!(
    velocity_inflow_passes_what_is_given,
    velocity_inflow_lets_gas_leave,
    supersonic_inflow_passes_its_state,
);
