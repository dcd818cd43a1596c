//! Numerical fluxes and boundary conditions against the physical flux.

use super::*;

/// (F_c(u) - u v) . n, by the flux of the law without viscosity.
pub(super) fn normal_flux<const D: usize, const M: usize>(u: &[f64; M], n: &[f64; D], v: &[f64; D]) -> [f64; M] {
    let gas = Gas::new(gas().gamma(), gas().gas_constant(), 1.0, Viscosity::Inviscid).unwrap();
    let flux = NavierStokes { gas, shock_capturing: None, ..law::<D>(Riemann::Roe) }.flux(u, &[[f64::NAN; M]; D], v);
    std::array::from_fn(|c| (0..D).map(|i| flux[i][c] * n[i]).sum())
}

fn of_equal_states<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let expected = normal_flux(&p.minus, &p.n, &p.v);
        for riemann in SOLVERS {
            let flux = law::<D>(riemann).numerical_flux(&p.minus, &p.minus, &p.n, dot(&p.v, &p.n));
            let error = difference(&flux, &expected);
            assert!(error <= 1e-14, "{riemann:?}: {error:e}");
        }
    }
}

/// The flux out of one side enters the other, so that a moving facet conserves mass, momentum and energy.
fn antisymmetry<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let v_n = dot(&p.v, &p.n);
        for riemann in SOLVERS {
            let law = law::<D>(riemann);
            let there = law.numerical_flux(&p.minus, &p.plus, &p.n, v_n);
            let back = law.numerical_flux(&p.plus, &p.minus, &p.n.map(|n| -n), -v_n);
            let error = difference(&there, &back.map(|f| -f));
            assert!(error <= 1e-14, "{riemann:?}: {error:e}");
        }
    }
}

/// If all waves run from minus to plus, faster than the facet, the flux is that of minus.
fn supersonic<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let v = p.n.map(|n| -6.0 * n);
        let expected = normal_flux(&p.minus, &p.n, &v);
        for riemann in [Riemann::Hllc, Riemann::Roe, Riemann::LowMachRoe { speed: 0.7 }] {
            let flux = law::<D>(riemann).numerical_flux(&p.minus, &p.plus, &p.n, -6.0);
            let error = difference(&flux, &expected);
            assert!(error <= 1e-13, "{riemann:?}: {error:e}");
        }
    }
}

/// HLLC preserves a contact that moves with the facet: only pressure and its work pass, for any density and tangential
/// velocity of the sides.
fn contact<const D: usize, const M: usize>() {
    let gas = gas();
    for seed in 0..100 {
        let mut random = Random(seed);
        let (n, v_n, pressure): ([f64; D], _, _) = (random.unit(), random.between(-1.0, 1.0), 0.8);
        let mut side = || {
            let a: [f64; D] = random.vector(1.0);
            let velocity: [f64; D] = std::array::from_fn(|i| a[i] + (v_n - dot(&a, &n)) * n[i]);
            Primitive { density: random.between(0.5, 2.0), velocity, pressure }.pack::<M>(&gas)
        };
        let flux = law::<D>(Riemann::Hllc).numerical_flux(&side(), &side(), &n, v_n);
        let push = Conserved { density: 0.0, momentum: n.map(|n| pressure * n), energy: pressure * v_n };
        assert!(difference(&flux, &push.pack()) <= 1e-14);
    }
}

/// HLLC preserves a shock that moves with the facet.
fn shock<const D: usize, const M: usize>() {
    let (gas, gamma) = (gas(), gas().gamma());
    for seed in 0..100 {
        let mut random = Random(seed);
        let n = random.unit();
        let (mach, v_n) = (random.between(1.1, 4.0), random.between(-1.0, 1.0));
        let ahead = random.primitive::<D>();
        let c = gas.sound_speed(ahead.density, ahead.pressure);
        let with_normal = |w_n: f64| -> [f64; D] {
            std::array::from_fn(|i| ahead.velocity[i] + (w_n - dot(&ahead.velocity, &n)) * n[i])
        };
        // The Rankine-Hugoniot relations.
        let squeeze = (gamma + 1.0) * mach * mach / ((gamma - 1.0) * mach * mach + 2.0);
        let rise = 1.0 + 2.0 * gamma / (gamma + 1.0) * (mach * mach - 1.0);
        let minus = Primitive { velocity: with_normal(v_n + mach * c), ..ahead };
        let plus = Primitive {
            density: ahead.density * squeeze,
            velocity: with_normal(v_n + mach * c / squeeze),
            pressure: ahead.pressure * rise,
        };
        let (minus, plus) = (minus.pack::<M>(&gas), plus.pack::<M>(&gas));
        let flux = law::<D>(Riemann::Hllc).numerical_flux(&minus, &plus, &n, v_n);
        let expected = normal_flux(&minus, &n, &n.map(|n| v_n * n));
        assert!(difference(&flux, &expected) <= 1e-13);
        assert!(difference(&flux, &normal_flux(&plus, &n, &n.map(|n| v_n * n))) <= 1e-13);
    }
}

/// A boundary condition that the state satisfies passes the flux of that state.
fn of_boundary_conditions<const D: usize, const M: usize>() {
    let gas = gas();
    let law = law::<D>(Riemann::Hllc);
    for seed in 0..100 {
        let mut random = Random(seed);
        let Point { n, v, .. } = Point::<f64, f64, D, M>::random(&mut random);
        let inside = random.primitive::<D>();
        let u: [f64; M] = inside.pack(&gas);
        // Only gas that leaves an outflow keeps its state: the facet is slower.
        let slower = random.between(0.01, 0.99) * gas.sound_speed(inside.density, inside.pressure);
        let behind = std::array::from_fn(|i| inside.velocity[i] - slower * n[i]);
        let matching = [
            (Boundary::FarField(FarField::new(inside).unwrap()), v),
            (Boundary::PrescribedState(PrescribedState), v),
            (Boundary::Outflow(Outflow::new(inside.pressure, 1.0).unwrap()), behind),
            (Boundary::VelocityInflow(VelocityInflow::OfVelocity), v),
            (Boundary::SupersonicInflow(SupersonicInflow), v),
            (Boundary::SlipWall(SlipWall), inside.velocity),
            (Boundary::AdiabaticWall(AdiabaticWall::new([0.0; D]).unwrap()), inside.velocity),
        ];
        for (condition, v) in matching {
            let of_gas = values(0.0, inside.velocity, gas.temperature(inside.density, inside.pressure));
            let at = at(&n, &v, if matches!(condition, Boundary::VelocityInflow(_)) { &of_gas } else { &u });
            let Imposed { flux, state } = law.impose(condition, &u, at);
            let error = difference(&flux, &normal_flux(&u, &n, &v));
            assert!(error <= 1e-14, "{condition:?}: {error:e}");
            assert!(difference(&state, &u) <= 1e-14, "{condition:?}: {state:?}");
            let target_state = condition.target_state(&law, &u, at);
            assert!(difference(&target_state, &u) <= 1e-14, "{condition:?}: {target_state:?}");
        }
    }
}

/// The target state of a condition does not depend on the gas inside.
fn of_what_is_asked<const D: usize, const M: usize>() {
    let (gas, law) = (gas(), law::<D>(Riemann::Hllc));
    for seed in 0..100 {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let stream = random.primitive::<D>();
        let target_state =
            |condition: Boundary<D>| condition.target_state(&law, &p.minus, at(&p.n, &p.v, &stream.pack(&gas)));
        let far_field = target_state(Boundary::FarField(FarField::new(stream).unwrap()));
        assert!(difference(&far_field, &stream.pack(&gas)) <= 1e-14);
        assert_eq!(target_state(Boundary::PrescribedState(PrescribedState)), far_field);
        let wall = Primitive::<f64, D>::unpack(
            &gas,
            &target_state(Boundary::AdiabaticWall(AdiabaticWall::new([0.0; D]).unwrap())),
        );
        assert!((0..D).all(|i| (wall.velocity[i] - p.v[i]).abs() <= 1e-13), "{wall:?}");
    }
}

in_both_dimensions!(
    of_equal_states,
    antisymmetry,
    supersonic,
    contact,
    shock,
    of_boundary_conditions,
    of_what_is_asked,
);
