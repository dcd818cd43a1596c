//! Identities of the parts from which kernels are made.

use crate::tables::{Line, Orders, Quadrature};
use crate::tensor_product::{Parts, Scratch, evaluate, integrate};
use crate::traces::FaceMaps;
use basis::gauss;
use tensor::pulp::{Arch, Simd, WithSimd};
use tensor::{Pack, WIDTH, zeroed};

fn packs(n: usize, phase: f64) -> Vec<Pack> {
    (0..n).map(|i| Pack(std::array::from_fn(|lane| (1.7 * i as f64 + 0.9 * lane as f64 + phase).sin()))).collect()
}

/// <a, b> in every lane.
fn inner_product(a: &[Pack], b: &[Pack]) -> [f64; WIDTH] {
    std::array::from_fn(|lane| a.iter().zip(b).map(|(a, b)| a.0[lane] * b.0[lane]).sum())
}

/// <E u, f> and <u, E^T f>, with E values and gradients at the points.
struct BothSides<'a> {
    line: &'a Line,
    dimension: usize,
}

impl WithSimd for BothSides<'_> {
    type Output = [[f64; WIDTH]; 2];
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let (d, components) = (self.dimension, 3);
        let (n, q) = (self.line.order.pow(d as u32), self.line.values.rows().pow(d as u32));
        let (u, f, g) = (packs(components * n, 0.1), packs(components * q, 0.2), packs(d * components * q, 0.3));
        let mut room = Scratch::new(d, components, self.line.values.rows().max(self.line.order));
        let (mut values, mut gradients, mut back) = (zeroed(f.len()), zeroed(g.len()), zeroed(u.len()));
        evaluate(simd, self.line, d, components, Parts::Both, &u, &mut values, &mut gradients, &mut room);
        integrate(simd, self.line, d, components, Parts::Both, &f, &g, &mut back, &mut room);
        let (value, gradient) = (inner_product(&values, &f), inner_product(&gradients, &g));
        [std::array::from_fn(|lane| value[lane] + gradient[lane]), inner_product(&u, &back)]
    }
}

#[test]
fn integration_is_the_transpose_of_evaluation() {
    for dimension in 1..=3 {
        for order in [2, 3, 5] {
            let line = Line::new(order, &gauss(order + 2).points);
            let [left, right] = Arch::new().dispatch(BothSides { line: &line, dimension });
            for lane in 0..WIDTH {
                assert!(
                    (left[lane] - right[lane]).abs() < 1e-11 * left[lane].abs().max(1.0),
                    "{dimension}-D, N = {order}"
                );
            }
        }
    }
}

#[test]
fn lifting_is_the_transpose_of_taking_traces() {
    for dimension in [2, 3] {
        let order = 4;
        let maps = FaceMaps::new(&Line::new(order, &[0.0]), dimension);
        let (nodes, face_nodes) = (order.pow(dimension as u32), order.pow(dimension as u32 - 1));
        let u: Vec<f64> = (0..2 * nodes).map(|i| (0.7 * i as f64).sin()).collect();
        let f: Vec<f64> = (0..4 * face_nodes).map(|i| (1.1 * i as f64).cos()).collect();
        for face in 0..2 * dimension {
            let (mut values, mut derivatives) = (vec![0.0; 2 * face_nodes], vec![0.0; 2 * face_nodes]);
            maps.extract(face, &u, &mut values, &mut derivatives);
            let mut lifted = vec![0.0; u.len()];
            maps.lift(face, &f[..2 * face_nodes], &f[2 * face_nodes..], &mut lifted);
            let traces = values.iter().chain(&derivatives).zip(&f).map(|(a, b)| a * b).sum::<f64>();
            let cell = u.iter().zip(&lifted).map(|(a, b)| a * b).sum::<f64>();
            assert!((traces - cell).abs() < 1e-11, "{dimension}-D, face {face}: {traces} {cell}");
        }
    }
}

/// The figures of the design: 2n - 1 >= 3p - 1 in 2-D and 4p - 1 in 3-D; 3 (N_t - 1) + 1 and 4 (N_t - 1) + 2 in time.
#[test]
fn conserving_quadrature_has_the_fewest_points() {
    for n in 2..=16 {
        for time in 1..=4 {
            let orders = Orders { flow: n, mesh: n, time };
            for (dimension, space_degree, time_degree) in
                [(2, 3 * (n - 1) - 1, 3 * (time - 1) + 1), (3, 4 * (n - 1) - 1, 4 * (time - 1) + 2)]
            {
                let (q, t) = (
                    Quadrature::Conserving.space_points(dimension, orders),
                    Quadrature::Conserving.time_points(dimension, orders),
                );
                assert!(2 * q > space_degree && (q == n || 2 * (q - 1) <= space_degree), "{dimension}-D, N = {n}: {q}");
                assert!(
                    2 * t > time_degree && (t == time || 2 * (t - 1) <= time_degree),
                    "{dimension}-D, N_t = {time}: {t}"
                );
            }
        }
    }
}
