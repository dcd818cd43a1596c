//! Identities of the parts from which kernels are made.

use crate::tables::{Orders, Quadrature, Shape1d, Tables};
use crate::tensor_product::{AtPoints, Lattice, Scratch, evaluate, integrate};
use crate::traces::FaceMaps;
use basis::gauss;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};
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
    line: &'a Shape1d,
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
        let lattice = Lattice::whole(self.line, d, components);
        evaluate(simd, lattice, &u, AtPoints::Both(&mut values, &mut gradients), &mut room);
        integrate(simd, lattice, AtPoints::Both(&f[..], &g[..]), &mut back, &mut room, false);
        let (value, gradient) = (inner_product(&values, &f), inner_product(&gradients, &g));
        [std::array::from_fn(|lane| value[lane] + gradient[lane]), inner_product(&u, &back)]
    }
}

#[test]
fn integration_is_the_transpose_of_evaluation() {
    for dimension in 1..=3 {
        for order in [2, 3, 5] {
            let line = Shape1d::new(order, &gauss(order + 2).points);
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
        let (order, tensors) = (4, 2);
        let maps = FaceMaps::new(&Shape1d::new(order, &[0.0]), dimension);
        let (nodes, face_nodes) = (order.pow(dimension as u32), order.pow(dimension as u32 - 1));
        let (u, f) = (packs(tensors * nodes, 0.1), packs(2 * dimension * 2 * tensors * face_nodes, 0.2));
        let mut lifted = zeroed(u.len());
        let traces = traces(&maps, [dimension, order, tensors], &u);
        maps.lift(tensors, &f, 2, &mut lifted);
        let (left, right) = (inner_product(&traces, &f), inner_product(&u, &lifted));
        for lane in 0..WIDTH {
            assert!((left[lane] - right[lane]).abs() < 1e-11 * left[lane].abs().max(1.0), "{dimension}-D");
        }
    }
}

/// The traces of `u`, `[face][kind][tensor][face node]`.
fn traces(maps: &FaceMaps, [dimension, order, tensors]: [usize; 3], u: &[Pack]) -> Vec<Pack> {
    let kind_len = tensors * order.pow(dimension as u32 - 1);
    let mut derivatives = zeroed(2 * dimension * kind_len);
    maps.derivatives(tensors, u, &mut derivatives);
    let of_face = |face: usize| {
        let nodes = mesh::face_nodes(dimension, order, face);
        let tensors = u.chunks_exact(order.pow(dimension as u32));
        let mut of_face: Vec<Pack> = tensors.flat_map(|tensor| nodes.iter().map(|&node| tensor[node])).collect();
        of_face.extend(&derivatives[face * kind_len..(face + 1) * kind_len]);
        of_face
    };
    (0..2 * dimension).flat_map(of_face).collect()
}

/// The functionals give the preconditioner the same traces.
#[test]
fn traces_are_the_functionals_of_the_nodes() {
    for dimension in [2, 3] {
        let order = 4;
        let maps = FaceMaps::new(&Shape1d::new(order, &[0.0]), dimension);
        let u = packs(order.pow(dimension as u32), 0.1);
        let traces = traces(&maps, [dimension, order, 1], &u);
        let functionals = (0..2 * dimension).flat_map(|face| maps.functionals(face, true));
        for (functional, trace) in functionals.zip(&traces) {
            let expected: f64 = functional.iter().map(|&(node, weight)| weight * u[node].0[3]).sum();
            assert!((expected - trace.0[3]).abs() < 1e-12, "{dimension}-D: {expected} {}", trace.0[3]);
        }
    }
}

/// Values and gradients of all planes at once, and of one block of planes after the other.
struct InBlocks<'a>(&'a Tables<3>);

impl WithSimd for InBlocks<'_> {
    type Output = [Vec<Pack>; 2];
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let InBlocks(tables) = self;
        let (nodes, points) = (tables.orders.flow.pow(3), tables.volume_points());
        let (u, mut whole, mut in_blocks) = (packs(nodes, 0.4), zeroed(4 * points), zeroed(4 * points));
        let mut room = Scratch::new(3, 1, tables.rule.points.len());
        let (values, gradients) = whole.split_at_mut(points);
        evaluate(simd, Lattice::whole(&tables.flow, 3, 1), &u, AtPoints::Both(values, gradients), &mut room);
        let mut first = 0;
        for planes in &tables.planes {
            let n = planes.weights.len();
            let lattice = Lattice { line: &tables.flow, last: &planes.flow, dimension: 3, components: 1 };
            let (mut values, mut gradients) = (zeroed(n), zeroed(3 * n));
            evaluate(simd, lattice, &u, AtPoints::Both(&mut values, &mut gradients), &mut room);
            for (part, packs) in values.chunks(n).chain(gradients.chunks(n)).enumerate() {
                in_blocks[part * points + first..][..n].copy_from_slice(packs);
            }
            first += n;
        }
        [whole, in_blocks]
    }
}

#[test]
fn blocks_of_planes_hold_every_point_once() {
    let tables = Tables::<3>::new(Orders { flow: 6, mesh: 6, time: 2 }, 5, Quadrature::Conserving);
    assert!(tables.planes.len() > 1, "the test needs several blocks");
    let weights: f64 = tables.planes.iter().flat_map(|planes| &planes.weights).sum();
    assert!((weights - 8.0).abs() < 1e-13, "{weights}");
    let [whole, in_blocks] = Arch::new().dispatch(InBlocks(&tables));
    assert_eq!(whole, in_blocks);
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
