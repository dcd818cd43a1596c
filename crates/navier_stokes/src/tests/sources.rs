//! Sources: body forces, sponges and rotating frames.

use super::*;
use tensor::{Dual, cross};

/// A body force changes the momentum and does work. A sponge adds - sigma (u - u_t), and nothing at its target.
fn of_forces_and_sponges<const D: usize, const M: usize>() {
    for seed in 0..20 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let with =
            |source| -> [f64; M] { NavierStokes { source, ..law::<D>(Riemann::Roe) }.source(&p.minus, &p.values) };
        let a: [f64; D] = std::array::from_fn(|i| p.values[1 + i]);
        let u = Conserved::<f64, D>::unpack(&p.minus);
        let force = Conserved { density: 0.0, momentum: a.map(|a| u.density * a), energy: dot(&u.momentum, &a) };
        assert!(difference(&with(Source::Acceleration), &force.pack()) <= 1e-15);
        let at_target: [f64; M] = with(Source::Sponge { target: u });
        assert!(difference(&at_target, &force.pack()) <= 1e-15);
        let target = Conserved::unpack(&p.plus);
        let drawn: [f64; M] = with(Source::Sponge { target });
        let expected: [f64; M] = std::array::from_fn(|c| force.pack::<M>()[c] - p.values[0] * (p.minus[c] - p.plus[c]));
        assert!(difference(&drawn, &expected) <= 1e-14);
        assert_eq!(with(Source::Given), p.values);
    }
}

/// The Coriolis force does no work, and its data-free part is - 2 Omega x rho w.
fn of_rotating_frames<const D: usize, const M: usize>() {
    for seed in 0..20 {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let mut omega = random.vector::<3>(2.0);
        if D == 2 {
            (omega[0], omega[1]) = (0.0, 0.0);
        }
        let rotation = Rotation::<D>::new(omega).unwrap();
        let with =
            |source| -> [f64; M] { NavierStokes { source, ..law::<D>(Riemann::Roe) }.source(&p.minus, &p.values) };
        let (still, turning) = (with(Source::Acceleration), with(Source::Rotating(rotation)));
        let coriolis = cross(&omega, &in_space(Conserved::<f64, D>::unpack(&p.minus).momentum));
        let added = |c: usize| if (1..=D).contains(&c) { -2.0 * coriolis[c - 1] } else { 0.0 };
        let expected: [f64; M] = std::array::from_fn(|c| still[c] + added(c));
        assert!(difference(&turning, &expected) <= 1e-14);

        let r: [f64; D] = random.vector(2.0);
        let inwards = cross(&omega, &cross(&omega, &in_space(r)));
        let found = rotation.centrifugal(r);
        assert!((0..D).all(|i| (found[i] + inwards[i]).abs() <= 1e-13), "{found:?}");
    }
    assert!(Rotation::<D>::new([0.0, 0.0, f64::NAN]).is_err());
}

fn in_space<const D: usize>(a: [f64; D]) -> [f64; 3] {
    std::array::from_fn(|i| a.get(i).copied().unwrap_or(0.0))
}

/// Derivatives in the state and in the data, against central differences.
fn derivatives<const D: usize, const M: usize>() {
    const STEP: f64 = 1e-5;
    let target = Conserved { density: 1.2, momentum: [0.4; D], energy: 3.0 };
    let rotating = Source::Rotating(Rotation::new([0.7, -0.3, 1.9]).unwrap());
    let sources = [Source::Acceleration, Source::Sponge { target }, rotating];
    for (seed, source) in (0..30).zip(sources.into_iter().cycle()) {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let direction = Point::direction(&mut random);
        let law = NavierStokes { source, ..law::<D>(Riemann::Roe) };
        let at = |h: f64| -> [f64; M] {
            let p = p.zip(&direction, |a, d| a + h * d, |a, d| a + h * d);
            law.source(&p.minus, &p.values)
        };
        let (ahead, behind) = (at(STEP), at(-STEP));
        let expected = std::array::from_fn(|c| (ahead[c] - behind[c]) / (2.0 * STEP));
        let duals = p.zip(&direction, Dual::new, Dual::new);
        let found: [Dual<f64>; M] = law.source(&duals.minus, &duals.values);
        let error = difference(&found.map(|s| s.derivative), &expected);
        assert!(error <= 1e-9, "{source:?}: {error:e}");
    }
}

in_both_dimensions!(of_forces_and_sponges, of_rotating_frames, derivatives);
