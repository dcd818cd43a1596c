//! Sources: body forces and sponges.

use super::*;

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

in_both_dimensions!(of_forces_and_sponges);
