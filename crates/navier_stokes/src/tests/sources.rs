//! Sources: body forces and sponges.

use super::*;
use tensor::Dual;

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

/// Derivatives in the state and in the data, against central differences.
fn derivatives<const D: usize, const M: usize>() {
    const STEP: f64 = 1e-5;
    let target = Conserved { density: 1.2, momentum: [0.4; D], energy: 3.0 };
    for (seed, source) in (0..20).zip([Source::Acceleration, Source::Sponge { target }].into_iter().cycle()) {
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

in_both_dimensions!(of_forces_and_sponges, derivatives);
