//! SIMD lanes against plain numbers.

use super::*;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Dual, Lanes, Pack, WIDTH};

/// Evaluates all point functions at one point per lane, on duals over plain geometry as the Jacobian does.
struct InLanes<'a, const D: usize, const M: usize> {
    conditions: &'a [Boundary<D>],
    points: &'a [Point<f64, f64, D, M>],
    directions: &'a [Point<f64, f64, D, M>],
}

type Point8<const D: usize, const M: usize> = Vec<Point<f64, f64, D, M>>;

impl<const D: usize, const M: usize> WithSimd for InLanes<'_, D, M> {
    /// `[lane][function]`: value and derivative.
    type Output = Vec<Vec<[[f64; M]; 2]>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut results = vec![Vec::new(); WIDTH];
        for part in 0..Lanes::<S>::PARTS {
            let read = |pick: &dyn Fn(&Point<f64, f64, D, M>) -> f64, points: &[Point<f64, f64, D, M>]| {
                let pack = Pack(std::array::from_fn(|lane| pick(&points[lane])));
                Lanes::read(simd, &pack, part)
            };
            let state = |pick: &dyn Fn(&Point<f64, f64, D, M>) -> f64| {
                Dual::new(read(pick, self.points), read(pick, self.directions))
            };
            let geometry = |pick: &dyn Fn(&Point<f64, f64, D, M>) -> f64| read(pick, self.points);
            let point = Point {
                minus: std::array::from_fn(|c| state(&|p| p.minus[c])),
                plus: std::array::from_fn(|c| state(&|p| p.plus[c])),
                gradient: std::array::from_fn(|i| std::array::from_fn(|c| state(&|p| p.gradient[i][c]))),
                n: std::array::from_fn(|i| geometry(&|p| p.n[i])),
                v: std::array::from_fn(|i| geometry(&|p| p.v[i])),
                data: std::array::from_fn(|c| geometry(&|p| p.data[c])),
                values: std::array::from_fn(|c| geometry(&|p| p.values[c])),
            };
            let first = part * S::F64_LANES;
            for (_, value) in evaluate(self.conditions, &point) {
                let values = value.map(|v| unpack(v.value));
                let derivatives = value.map(|v| unpack(v.derivative));
                for lane in 0..S::F64_LANES {
                    results[first + lane].push([values.map(|v| v[lane]), derivatives.map(|v| v[lane])]);
                }
            }
        }
        results
    }
}

fn unpack<S: Simd>(lanes: Lanes<S>) -> [f64; WIDTH] {
    let mut pack = Pack::ZERO;
    lanes.write(&mut pack, 0);
    pack.0
}

/// Equal up to the round-off of fused products and sums, which the root of an opening amplifies.
fn equal_plain_numbers<const D: usize, const M: usize>() {
    let conditions = Conditions::<D>::sample().list();
    for seed in 0..10 {
        let mut random = Random(seed);
        let points: Point8<D, M> = (0..WIDTH).map(|_| Point::random(&mut random)).collect();
        let directions: Point8<D, M> = (0..WIDTH).map(|_| Point::direction(&mut random)).collect();
        let kernel = InLanes { conditions: &conditions, points: &points, directions: &directions };
        let results = Arch::new().dispatch(kernel);
        for lane in 0..WIDTH {
            let plain = evaluate(&conditions, &points[lane].zip(&directions[lane], Dual::new, |g, _| g));
            assert_eq!(results[lane].len(), plain.len());
            for ((name, expected), [value, derivative]) in plain.iter().zip(&results[lane]) {
                let of_value = difference(value, &expected.map(|e| e.value));
                let of_derivative = difference(derivative, &expected.map(|e| e.derivative));
                assert!(of_value <= 1e-14 && of_derivative <= 5e-14, "{name}: {of_value:e}, {of_derivative:e}");
            }
        }
    }
}

in_both_dimensions!(equal_plain_numbers);
