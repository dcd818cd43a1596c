//! Walls pass no mass, and energy only as work and heat.

use super::*;

fn walls<const D: usize>(slide: [f64; D]) -> [Boundary<D>; 4] {
    [
        Boundary::AdiabaticWall(AdiabaticWall::new(slide).unwrap()),
        Boundary::IsothermalWall(IsothermalWall::new(1.3, slide).unwrap()),
        Boundary::SlipWall(SlipWall),
        Boundary::Symmetry(SlipWall),
    ]
}

/// Exactly, not up to round-off, for any motion of the wall.
fn no_mass<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let law = law::<D>(Riemann::Roe);
        for wall in walls(random.vector(1.0)) {
            let flux = law.impose(wall, &p.minus, at(&p.n, &p.v, &p.data)).flux;
            let viscous = law.boundary_viscous_flux(wall, &p.minus, &p.gradient, at(&p.n, &p.v, &p.data));
            assert_eq!((flux[0], viscous[0]), (0.0, 0.0), "{wall:?}");
        }
    }
}

/// The gas between walls at rest keeps its energy exactly, unless one of them is isothermal.
fn no_energy_at_rest<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let law = law::<D>(Riemann::Roe);
        for wall in walls([0.0; D]) {
            let flux = law.impose(wall, &p.minus, at(&p.n, &[0.0; D], &p.data)).flux;
            let viscous = law.boundary_viscous_flux(wall, &p.minus, &p.gradient, at(&p.n, &[0.0; D], &p.data));
            assert_eq!(flux[M - 1], 0.0, "{wall:?}");
            if !matches!(wall, Boundary::IsothermalWall(_)) {
                assert_eq!(viscous[M - 1], 0.0, "{wall:?}");
            }
        }
    }
}

/// The energy that crosses an adiabatic wall is the work of the force on it: p n . v - (tau n) . w_b.
fn energy_is_work<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let (law, slide) = (law::<D>(Riemann::Roe), random.vector(1.0));
        let w_b: [f64; D] = std::array::from_fn(|i| p.v[i] + slide[i] - dot(&slide, &p.n) * p.n[i]);
        for (wall, velocity) in [(walls(slide)[0], w_b), (walls(slide)[2], p.v)] {
            let Imposed { flux, state } = law.impose(wall, &p.minus, at(&p.n, &p.v, &p.data));
            let viscous = law.boundary_viscous_flux(wall, &state, &p.gradient, at(&p.n, &p.v, &p.data));
            let net: [f64; M] = std::array::from_fn(|c| flux[c] - viscous[c]);
            let force = Conserved::<f64, D>::unpack(&net).momentum;
            assert!((net[M - 1] - dot(&force, &velocity)).abs() <= 1e-14 * (1.0 + net[M - 1].abs()), "{wall:?}");
        }
    }
}

/// The states that walls impose have the velocity of the wall and pressure from inside. The temperature is given at an
/// isothermal wall, and otherwise that of the gas.
fn imposed_states<const D: usize, const M: usize>() {
    let gas = gas();
    for seed in 0..100 {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let slide = random.vector(1.0);
        let w_b: [f64; D] = std::array::from_fn(|i| p.v[i] + slide[i] - dot(&slide, &p.n) * p.n[i]);
        let inside = Primitive::<f64, D>::unpack(&gas, &p.minus);
        let relative = dot(&inside.velocity, &p.n) - dot(&p.v, &p.n);
        let sliding = std::array::from_fn(|i| inside.velocity[i] - relative * p.n[i]);
        let expected = [
            Primitive { velocity: w_b, ..inside },
            Primitive { velocity: w_b, density: gas.density(inside.pressure, 1.3), ..inside },
            Primitive { velocity: sliding, ..inside },
        ];
        for (wall, expected) in walls(slide).into_iter().zip(expected) {
            let state = law::<D>(Riemann::Roe).impose(wall, &p.minus, at(&p.n, &p.v, &p.data)).state;
            assert!(difference(&state, &expected.pack(&gas)) <= 1e-14, "{wall:?}");
        }
    }
}

/// The viscous flux through a wall is the flux in the gas, without the heat if the wall is adiabatic, and without heat
/// and shear if the gas slips.
fn viscous_flux<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let law = law::<D>(Riemann::Roe);
        let [adiabatic, isothermal, slip, _] = walls([0.0; D]);
        let through = |wall| {
            let state = law.impose(wall, &p.minus, at(&p.n, &p.v, &p.data)).state;
            (state, law.boundary_viscous_flux(wall, &state, &p.gradient, at(&p.n, &p.v, &p.data)))
        };
        let full = |state: [f64; M]| -> [f64; M] {
            let flux = law.viscous_flux(&state, &p.gradient);
            std::array::from_fn(|c| (0..D).map(|i| flux[i][c] * p.n[i]).sum())
        };
        let (state, flux) = through(isothermal);
        assert!(difference(&flux, &full(state)) <= 1e-13);

        let (state, flux) = through(adiabatic);
        let mut without_heat = full(state);
        let traction = Conserved::<f64, D>::unpack(&without_heat).momentum;
        without_heat[M - 1] = dot(&traction, &p.v);
        assert!(difference(&flux, &without_heat) <= 1e-13);

        let (state, flux) = through(slip);
        let traction = Conserved::<f64, D>::unpack(&full(state)).momentum;
        let normal = p.n.map(|n| n * dot(&traction, &p.n));
        let pushed = Conserved { density: 0.0, momentum: normal, energy: dot(&normal, &p.v) };
        assert!(difference(&flux, &pushed.pack()) <= 1e-13);
    }
}

in_both_dimensions!(no_mass, no_energy_at_rest, energy_is_work, imposed_states, viscous_flux);
