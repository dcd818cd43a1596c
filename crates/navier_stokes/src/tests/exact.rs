//! Exact states solve the equations, and sources equal the residual of other states.

use super::*;
use crate::exact::{Couette, FreeStream, Vortex, Waves};
use crate::manufactured::gradient;
use fem::StateField;
use tensor::Dual;

const SAMPLES: u64 = 40;

fn inviscid<const D: usize>() -> NavierStokes<D> {
    let gas = Gas::new(1.4, 1.0, 0.72, Viscosity::Inviscid).unwrap();
    NavierStokes { gas, ..law(Riemann::Roe) }
}

/// The vortex of the paper: U = rho = 1, M = 0.5, beta = 0.2, R = 1; the stream is not parallel to x.
fn vortex<const D: usize>(period: Option<[f64; 2]>) -> Vortex<D> {
    let mut velocity = [0.0; D];
    (velocity[0], velocity[1]) = (0.8, 0.6);
    let free_stream = Primitive { density: 1.0, velocity, pressure: 1.0 / (1.4 * 0.25) };
    Vortex::new(inviscid::<D>().gas, free_stream, [0.3; D], 1.0, 0.2, period).unwrap()
}

fn samples<const D: usize>() -> Vec<([f64; D], f64)> {
    let mut random = Random(3);
    (0..SAMPLES).map(|_| (random.vector(3.0), random.between(0.0, 2.0))).collect()
}

fn largest<const M: usize>(source: [f64; M]) -> f64 {
    source.iter().fold(0.0, |m: f64, s| m.max(s.abs()))
}

fn euler_solutions<const D: usize, const M: usize>() {
    let law = inviscid::<D>();
    for (x, t) in samples::<D>() {
        let exact = vortex(Some([4.0, 5.0]));
        let source: [f64; M] = Manufactured { law, exact }.value(&x, t);
        assert!(largest(source) <= 1e-13, "vortex: {source:?}");
        let exact = FreeStream::new(law.gas, Random(1).primitive()).unwrap();
        let source: [f64; M] = Manufactured { law, exact }.value(&x, t);
        assert_eq!(largest(source), 0.0);
    }
}

/// Couette flow solves the viscous equations, in any frame, for any viscosity.
fn couette_flow<const D: usize, const M: usize>() {
    let gas = Gas::new(1.4, 1.3, 0.72, Viscosity::Constant(0.2)).unwrap();
    let law = NavierStokes { gas, ..law::<D>(Riemann::Roe) };
    let exact = Couette::new(gas, 4.0, 0.9, [0.8, 0.85], 1.4, [0.3; D]).unwrap();
    for (mut x, t) in samples::<D>() {
        x[1] = x[1].abs() + 0.3 * t;
        let source: [f64; M] = Manufactured { law, exact }.value(&x, t);
        assert!(largest(source) <= 1e-13, "{source:?}");
    }
    // With another conductivity it does not.
    let other = Gas::new(1.4, 1.3, 0.9, Viscosity::Constant(0.2)).unwrap();
    let law = NavierStokes { gas: other, ..law };
    let source: [f64; M] = Manufactured { law, exact }.value(&[0.5; D], 0.0);
    assert!(largest(source) > 1e-3);
}

/// p / rho^gamma is constant, and the vortex seen from the free stream is steady.
fn isentropic_and_steady<const D: usize, const M: usize>() {
    let vortex = vortex::<D>(None);
    let gas = inviscid::<D>().gas;
    let entropy = |u: [f64; M]| {
        let state = Primitive::<f64, D>::unpack(&gas, &u);
        state.pressure / state.density.powf(1.4)
    };
    for (x, t) in samples::<D>() {
        assert!((entropy(vortex.state(&x, t)) * (1.4 * 0.25) - 1.0).abs() <= 1e-14);
        let along: [Dual<f64>; D] = std::array::from_fn(|i| Dual::new(x[i], [0.8, 0.6, 0.0][i]));
        let change: [f64; M] = vortex.state(&along, Dual::new(t, 1.0)).map(|u| u.derivative);
        assert!(largest(change) <= 1e-13);
    }
    // 1 - (gamma - 1) / 2 M^2 beta^2 at the centre.
    let state = Primitive::<f64, D>::unpack::<M>(&gas, &vortex.state(&[0.3; D], 0.0));
    assert!((state.pressure / state.density * (1.4 * 0.25) - (1.0 - 0.2 * 0.25 * 0.04)).abs() <= 1e-15);
}

/// The vortex of Persson, Bonet & Peraire (2009): 20 x 15, eps = 0.3, r_c = 1.5, M = 0.5.
#[test]
fn persson() {
    let (u_inf, v_inf, eps, r_c, p_inf, mach) = (2.0 / 5_f64.sqrt(), 1.0 / 5_f64.sqrt(), 0.3, 1.5, 20.0 / 7.0, 0.5);
    let gas = inviscid::<2>().gas;
    let free_stream = Primitive { density: 1.0, velocity: [u_inf, v_inf], pressure: p_inf };
    let beta = Vortex::<2>::strength_of_persson(eps);
    let vortex = Vortex::new(gas, free_stream, [5.0, 5.0], r_c, beta, None).unwrap();
    for (offset, t) in samples::<2>() {
        let [x, y] = offset;
        let f0 = 1.0 - (x * x + y * y) / (r_c * r_c);
        let pi = std::f64::consts::PI;
        let f1 = 1.0 - eps * eps * 0.4 * mach * mach * f0.exp() / (8.0 * pi * pi);
        let swirl = eps * (0.5 * f0).exp() / (2.0 * pi * r_c);
        let velocity = [u_inf - swirl * y, v_inf + swirl * x];
        let expected = Primitive { density: f1.powf(2.5), velocity, pressure: p_inf * f1.powf(3.5) };
        let state: [f64; 4] = vortex.state(&[5.0 + x + u_inf * t, 5.0 + y + v_inf * t], t);
        assert!(difference(&state, &expected.pack(&gas)) <= 1e-14);
    }
}

/// The vortex of Vincent, Castonguay & Jameson (2011): S = 13.5, M = 0.4, R = 1.5, carried along y through a periodic
/// square of side 20 in a time of 20.
#[test]
fn vincent() {
    let (s, mach, radius) = (13.5, 0.4, 1.5);
    let gas = inviscid::<2>().gas;
    let p_inf = 1.0 / (1.4 * mach * mach);
    let free_stream = Primitive { density: 1.0, velocity: [0.0, 1.0], pressure: p_inf };
    let beta = Vortex::<2>::strength_of_vincent(s, radius);
    let vortex = Vortex::new(gas, free_stream, [0.0, 0.0], radius, beta, Some([20.0, 20.0])).unwrap();
    for ([x, y], t) in samples::<2>() {
        let f = (1.0 - x * x - y * y) / (2.0 * radius * radius);
        let pi = std::f64::consts::PI;
        let density = (1.0 - s * s * mach * mach * 0.4 * (2.0 * f).exp() / (8.0 * pi * pi)).powf(2.5);
        let swirl = s * f.exp() / (2.0 * pi * radius);
        let velocity = [swirl * y, 1.0 - swirl * x];
        let expected = Primitive { density, velocity, pressure: density.powf(1.4) * p_inf }.pack(&gas);
        let state: [f64; 4] = vortex.state(&[x, y + t], t + 20.0);
        assert!(difference(&state, &expected) <= 1e-13);
    }
}

fn waves<const D: usize>() -> Manufactured<Waves<D>, D> {
    let mean = Primitive { density: 1.0, velocity: [0.2; D], pressure: 1.0 };
    Manufactured { law: law(Riemann::Roe), exact: Waves::new(gas(), mean, 0.1, 2.0).unwrap() }
}

/// The source by nested duals against central differences of state and flux.
fn manufactured_source<const D: usize, const M: usize>() {
    let (field, h) = (waves::<D>(), 1e-4);
    for (x, t) in samples::<D>() {
        let flux = |x: [f64; D]| -> [[f64; M]; D] {
            field.law.flux(&field.exact.state(&x, t), &gradient(&field.exact, &x, t), &[0.0; D])
        };
        let (later, earlier): ([f64; M], [f64; M]) = (field.exact.state(&x, t + h), field.exact.state(&x, t - h));
        let mut expected: [f64; M] = std::array::from_fn(|c| (later[c] - earlier[c]) / (2.0 * h));
        for i in 0..D {
            let at = |step: f64| flux(std::array::from_fn(|k| if k == i { x[k] + step } else { x[k] }))[i];
            let (right, left) = (at(h), at(-h));
            for c in 0..M {
                expected[c] += (right[c] - left[c]) / (2.0 * h);
            }
        }
        let source: [f64; M] = field.value(&x, t);
        assert!(difference(&source, &expected) <= 1e-6);
        assert!(largest(source) > 0.1);
    }
}

/// Fields return the derivative along a motion of the point.
fn duals_of_fields<const D: usize, const M: usize>() {
    fn check<const D: usize, const M: usize>(field: impl StateField<D, M>) {
        for ((x, t), (direction, _)) in samples::<D>().into_iter().zip(samples::<D>().into_iter().rev()) {
            let dual = field.dual(&std::array::from_fn(|i| Dual::new(x[i], direction[i])), t);
            let at = |h: f64| field.value(&std::array::from_fn(|i| x[i] + h * direction[i]), t);
            let (there, back) = (at(1e-5), at(-1e-5));
            let expected = std::array::from_fn(|c| (there[c] - back[c]) / 2e-5);
            assert!(difference(&dual.map(|u| u.value), &field.value(&x, t)) <= 1e-14);
            assert!(difference(&dual.map(|u| u.derivative), &expected) <= 1e-7);
        }
    }
    check::<D, M>(Exact(vortex::<D>(Some([4.0, 5.0]))));
    check::<D, M>(Exact(waves::<D>().exact));
    check::<D, M>(waves::<D>());
}

in_both_dimensions!(euler_solutions, couette_flow, isentropic_and_steady, manufactured_source, duals_of_fields);
