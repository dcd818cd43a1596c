//! Lanes against scalars, duals against differences.
#![allow(clippy::unwrap_used)]

use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Dual, LaneNumber, Lanes, Over, Pack, Real, Transcendental, WIDTH, cofactor, determinant, dot, zeroed};

/// Uses every operation of `Real` once.
#[inline(always)]
fn every_operation<T: Real>(x: T, y: T) -> T {
    let a = (x + y * 2.0 - 0.5) / (y.recip() + x.abs());
    let b = x.max(y).min(x * y).select_ge(x.constant(0.3), -x, y.powf(1.4));
    a.mul_add(b, (x * x + y * y).sqrt().ln()) + x.zero()
}

struct InLanes<'a, T> {
    input: &'a [Pack],
    output: &'a mut [Pack],
    kind: std::marker::PhantomData<T>,
}
struct Values;
struct Derivatives;

macro_rules! run {
    ($kind:ty, $number:ty) => {
        impl WithSimd for InLanes<'_, $kind> {
            type Output = ();
            #[inline(always)]
            fn with_simd<S: Simd>(self, simd: S) {
                for part in 0..Lanes::<S>::PARTS {
                    let x = <$number as LaneNumber<S>>::load(simd, self.input, 2, 0, part);
                    let y = <$number as LaneNumber<S>>::load(simd, self.input, 2, 1, part);
                    every_operation(x, y).store(self.output, 1, 0, part);
                }
            }
        }
    };
}
run!(Values, Lanes<S>);
run!(Derivatives, Dual<Lanes<S>>);

/// Values and directions, different in every lane.
fn input() -> Vec<Pack> {
    let entry = |k: usize, lane: usize| 0.4 + (1.3 * k as f64 + 0.7 * lane as f64).sin().abs();
    (0..4).map(|k| Pack(std::array::from_fn(|lane| entry(k, lane)))).collect()
}

#[test]
fn lanes_are_scalars_side_by_side() {
    let (input, mut output) = (input(), zeroed(2));
    Arch::new().dispatch(InLanes { input: &input, output: &mut output, kind: std::marker::PhantomData::<Values> });
    for lane in 0..WIDTH {
        let scalar = every_operation(input[0].0[lane], input[1].0[lane]);
        assert!((output[0].0[lane] - scalar).abs() <= 1e-14 * scalar.abs(), "lane {lane}");
    }
}

#[test]
fn duals_of_lanes_are_duals_side_by_side() {
    let (input, mut output) = (input(), zeroed(2));
    Arch::new().dispatch(InLanes { input: &input, output: &mut output, kind: std::marker::PhantomData::<Derivatives> });
    for lane in 0..WIDTH {
        let dual = |k: usize| Dual::new(input[k].0[lane], input[2 + k].0[lane]);
        let scalar = every_operation(dual(0), dual(1));
        assert!((output[0].0[lane] - scalar.value).abs() <= 1e-14 * scalar.value.abs(), "lane {lane}");
        assert!(
            (output[1].0[lane] - scalar.derivative).abs() <= 1e-13 * (1.0 + scalar.derivative.abs()),
            "lane {lane}"
        );
    }
}

#[test]
fn duals_are_derivatives() {
    fn f<T: Transcendental>(x: T) -> T {
        every_operation((x.sin() + 2.0).ln() + x.cos(), x.exp() * 0.3 + x.atan()) + x.tanh()
    }
    for x in [0.2, 0.9, 1.7] {
        let h = 1e-5;
        let difference = (f(x + h) - f(x - h)) / (2.0 * h);
        let dual = f(Dual::new(x, 1.0));
        assert!(
            (dual.derivative - difference).abs() < 1e-8 * (1.0 + difference.abs()),
            "{} {difference}",
            dual.derivative
        );
        // The derivative of the derivative, by duals of duals.
        let second = f(Dual::new(Dual::new(x, 1.0), Dual::new(1.0, 0.0))).derivative.derivative;
        let slope = |x: f64| f(Dual::new(x, 1.0)).derivative;
        let difference = (slope(x + h) - slope(x - h)) / (2.0 * h);
        assert!((second - difference).abs() < 1e-6 * (1.0 + difference.abs()), "{second} {difference}");
    }
}

/// A dual over its values costs less and says the same as over a dual with derivative zero.
#[test]
fn over_a_simpler_number_is_the_same() {
    let (x, g) = (Dual::new(0.7, -1.3), 2.5);
    let lifted = Dual::new(g, 0.0);
    assert_eq!(Over::<f64>::scale(x, g), x * lifted);
    assert_eq!(Over::<f64>::minus(x, g), x - lifted);
    assert_eq!(Over::<f64>::plus(x, g), x + lifted);
    assert_eq!(Over::<f64>::scale_add(x, g, x), x.mul_add(lifted, x));
    assert_eq!(<Dual<f64> as Over<f64>>::lift(g), lifted);
}

#[test]
fn cofactors_are_derivatives_of_the_determinant() {
    let m = [[1.2, -0.3, 0.4], [0.5, 0.9, -0.7], [-0.2, 0.6, 1.1]];
    let cof = cofactor(&m);
    let det = determinant(&m, &cof);
    for i in 0..3 {
        for j in 0..3 {
            let mut dual = m.map(|row| row.map(|x| Dual::new(x, 0.0)));
            dual[i][j].derivative = 1.0;
            let derivative = determinant(&dual, &cofactor(&dual)).derivative;
            assert!((derivative - cof[i][j]).abs() < 1e-15, "{i}, {j}");
            let expected = if i == j { det } else { 0.0 };
            assert!((dot(&m[i], &cof[j]) - expected).abs() < 1e-15, "row {i} . cofactors of row {j}");
        }
    }
    let plane = [[2.0, 1.0], [3.0, 5.0]];
    assert_eq!(determinant(&plane, &cofactor(&plane)), 7.0);
}
