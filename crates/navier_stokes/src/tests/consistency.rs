//! Numerical fluxes and boundary conditions against the flux that they stand for.

use super::*;

/// (F_c(u) - u v) . n, by the flux of the law without viscosity.
fn normal_flux<const D: usize, const M: usize>(u: &[f64; M], n: &[f64; D], v: &[f64; D]) -> [f64; M] {
    let gas = Gas::new(gas().gamma(), gas().gas_constant(), 1.0, Viscosity::Inviscid).unwrap();
    let flux = NavierStokes { gas, ..law::<D>(Riemann::Roe) }.flux(u, &[[f64::NAN; M]; D], v);
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

/// What leaves one side enters the other, so that a moving facet neither makes nor loses mass, momentum or energy.
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

/// Where all waves run from minus to plus, faster than the facet, the flux is that of minus.
fn supersonic<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let v = p.n.map(|n| -6.0 * n);
        let expected = normal_flux(&p.minus, &p.n, &v);
        for riemann in [Riemann::Hllc, Riemann::Roe] {
            let flux = law::<D>(riemann).numerical_flux(&p.minus, &p.plus, &p.n, -6.0);
            let error = difference(&flux, &expected);
            assert!(error <= 1e-13, "{riemann:?}: {error:e}");
        }
    }
}

/// HLLC keeps a contact that moves with the facet: pressure and its work pass, nothing else, whatever the density and the
/// tangential velocity of the sides.
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

/// HLLC keeps a shock that moves with the facet.
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
        // The relations of Rankine and Hugoniot.
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
        let matching = [
            (Boundary::FarField(FarField::new(inside).unwrap()), v),
            (Boundary::PrescribedState(PrescribedState), v),
            (Boundary::Outflow(Outflow::new(inside.pressure).unwrap()), v),
            (Boundary::SlipWall(SlipWall), inside.velocity),
            (Boundary::AdiabaticWall(AdiabaticWall::new([0.0; D]).unwrap()), inside.velocity),
        ];
        for (condition, v) in matching {
            let flux = law.boundary_flux(condition, &u, &n, &v, &u);
            let error = difference(&flux, &normal_flux(&u, &n, &v));
            assert!(error <= 1e-14, "{condition:?}: {error:e}");
            let state = law.boundary_state(condition, &u, &n, &v, &u);
            assert!(difference(&state, &u) <= 1e-14, "{condition:?}: {state:?}");
            let asked = condition.asked(&law, &u, &n, &v, &u);
            assert!(difference(&asked, &u) <= 1e-14, "{condition:?}: {asked:?}");
        }
    }
}

/// What a condition asks for is its own, whatever the gas inside does.
fn of_what_is_asked<const D: usize, const M: usize>() {
    let (gas, law) = (gas(), law::<D>(Riemann::Hllc));
    for seed in 0..100 {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let stream = random.primitive::<D>();
        let asked = |condition: Boundary<D>| condition.asked(&law, &p.minus, &p.n, &p.v, &stream.pack(&gas));
        let far_field = asked(Boundary::FarField(FarField::new(stream).unwrap()));
        assert!(difference(&far_field, &stream.pack(&gas)) <= 1e-14);
        assert_eq!(asked(Boundary::PrescribedState(PrescribedState)), far_field);
        let wall =
            Primitive::<f64, D>::unpack(&gas, &asked(Boundary::AdiabaticWall(AdiabaticWall::new([0.0; D]).unwrap())));
        assert!((0..D).all(|i| (wall.velocity[i] - p.v[i]).abs() <= 1e-13), "{wall:?}");
    }
}

/// Gas that comes from the reservoir passes the inflow unchanged, from any angle below 80 degrees and at any Mach number
/// below 0.9.
fn of_inflow<const D: usize, const M: usize>() {
    let gas = gas();
    let mut tried = 0;
    for seed in 0..200 {
        let mut random = Random(seed);
        let (n, direction, v): ([f64; D], [f64; D], [f64; D]) = (random.unit(), random.unit(), random.vector(1.0));
        if dot(&n, &direction) > -0.17 {
            continue;
        }
        tried += 1;
        let (p_0, t_0, mach) = (2.0, 2.5, random.between(-0.2, 0.9));
        let t = t_0 / (1.0 + 0.5 * (gas.gamma() - 1.0) * mach * mach);
        let pressure = p_0 * (t / t_0).powf(gas.gamma() / (gas.gamma() - 1.0));
        let density = gas.density(pressure, t);
        let q = mach * gas.sound_speed(density, pressure);
        let u: [f64; M] = Primitive { density, velocity: direction.map(|d| q * d), pressure }.pack(&gas);
        let inflow = Boundary::Inflow(Inflow::new(p_0, t_0, direction.map(|d| 3.0 * d)).unwrap());
        let flux = law::<D>(Riemann::Roe).boundary_flux(inflow, &u, &n, &v, &u);
        assert!(difference(&flux, &normal_flux(&u, &n, &v)) <= 1e-13, "Mach number {mach}");
        let asked = inflow.asked(&law(Riemann::Roe), &u, &n, &v, &u);
        assert!(difference(&asked, &u) <= 1e-13, "Mach number {mach}");
    }
    assert!(tried > 50);
}

/// Whatever the gas inside does, even if it rushes out, what flows in has the total enthalpy and the total pressure of the
/// reservoir and its direction.
fn inflow_keeps_the_total_state<const D: usize, const M: usize>() {
    let gas = gas();
    let (p_0, t_0, exponent) = (2.0, 2.5, gas.gamma() / (gas.gamma() - 1.0));
    let mut direction = [0.0; D];
    (direction[0], direction[1]) = (0.8, 0.6);
    let mut n = [0.0; D];
    n[0] = -1.0;
    let inflow = Boundary::Inflow(Inflow::new(p_0, t_0, direction).unwrap());
    for seed in 0..100 {
        let mut random = Random(seed);
        let inside = Primitive { velocity: random.vector(8.0), ..random.primitive::<D>() };
        let u: [f64; M] = inside.pack(&gas);
        let flux = law::<D>(Riemann::Roe).boundary_flux(inflow, &u, &n, &[0.0; D], &u);
        let mass = flux[0];
        // Tangential momentum gives the speed, normal momentum then the pressure.
        let q = flux[2] / mass / direction[1];
        let p = (flux[1] - mass * q * direction[0]) / n[0];
        let t = t_0 - 0.5 * q * q / gas.heat_capacity();
        assert!((flux[M - 1] / mass / (gas.heat_capacity() * t_0) - 1.0).abs() <= 1e-12);
        assert!((p / (p_0 * (t / t_0).powf(exponent)) - 1.0).abs() <= 1e-11);
        assert!((mass / (gas.density(p, t) * q * n[0] * direction[0]) - 1.0).abs() <= 1e-11);
    }
}

/// Gas leaves at the pressure outside, with the entropy and the acoustic invariant that it had inside.
fn outflow_keeps_what_leaves<const D: usize, const M: usize>() {
    let (gas, p) = (gas(), 0.9);
    let mut n = [0.0; D];
    n[0] = 1.0;
    let outflow = Boundary::Outflow(Outflow::new(p).unwrap());
    for seed in 0..100 {
        let mut random = Random(seed);
        let mut inside = random.primitive::<D>();
        inside.velocity[0] = random.between(0.2, 0.5);
        inside.pressure = random.between(0.95, 2.0);
        let u: [f64; M] = inside.pack(&gas);
        let flux = law::<D>(Riemann::Roe).boundary_flux(outflow, &u, &n, &[0.0; D], &u);
        let w_n = (flux[1] - p) / flux[0];
        let density = flux[0] / w_n;
        let entropy = |p: f64, density: f64| p / density.powf(gas.gamma());
        let invariant = |w_n: f64, c: f64| w_n + 2.0 * c / (gas.gamma() - 1.0);
        let (c_in, c_out) = (gas.sound_speed(inside.density, inside.pressure), gas.sound_speed(density, p));
        assert!((entropy(p, density) / entropy(inside.pressure, inside.density) - 1.0).abs() <= 1e-11);
        assert!((invariant(w_n, c_out) / invariant(inside.velocity[0], c_in) - 1.0).abs() <= 1e-12);
    }
}

/// An outflow that is supersonic relative to the boundary imposes nothing.
fn of_supersonic_outflow<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let v = p.n.map(|n| -6.0 * n);
        let outflow = Boundary::Outflow(Outflow::new(10.0).unwrap());
        let flux = law::<D>(Riemann::Roe).boundary_flux(outflow, &p.minus, &p.n, &v, &p.data);
        assert!(difference(&flux, &normal_flux(&p.minus, &p.n, &v)) <= 1e-14);
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
    of_inflow,
    inflow_keeps_the_total_state,
    outflow_keeps_what_leaves,
    of_supersonic_outflow,
);
