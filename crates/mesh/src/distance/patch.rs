//! The nearest point of one curved facet.
//!
//! The facet is x(eta), eta in [-1, 1]^(D-1), a polynomial given at the Gauss-Lobatto nodes. Newton's method minimises
//!
//! ```text
//! phi(eta) = |x(eta) - p|^2 / 2,    phi_a = r . x_a,    phi_ab = x_a . x_b + r . x_ab,    r = x(eta) - p     (nearest)
//! ```
//!
//! in the box, from every sample of the facet that is nearer to p than its neighbours. If the facet is straight with equal
//! spacing, x is affine and one step is exact. (In two dimensions axis 1 is a dummy with a single node.)

use super::Frame;
use basis::{Lagrange, Matrix, gauss_lobatto};
use std::array::from_fn;
use tensor::{dot, norm};

/// The largest number of Newton steps; from samples this near a handful is enough.
const MAX_STEPS: usize = 50;

/// A step shorter than this changes nothing.
const SHORTEST_STEP: f64 = 1e-15;

/// Tables shared by all facets of one order.
#[derive(Clone, Debug)]
pub(super) struct Tables {
    lagrange: Lagrange,
    derivative: Matrix,
    /// Reference coordinates of the samples along an axis, and the values of the basis there.
    samples: Vec<f64>,
    at_samples: Matrix,
    /// A bound of the ratio of a polynomial to its largest value at a node.
    lebesgue: f64,
}

impl Tables {
    pub(super) fn new(order: usize) -> Self {
        let lagrange = Lagrange::gauss_lobatto(order);
        let count = 2 * order + 1;
        let samples: Vec<f64> = (0..count).map(|i| 2.0 * i as f64 / (count - 1) as f64 - 1.0).collect();
        Tables {
            derivative: lagrange.derivative_matrix(&gauss_lobatto(order).points),
            at_samples: lagrange.value_matrix(&samples),
            // The Lebesgue constant of N Gauss-Lobatto nodes is below 1 + (2 / pi) ln N.
            lebesgue: 1.0 + std::f64::consts::FRAC_2_PI * (order as f64).ln(),
            samples,
            lagrange,
        }
    }
}

/// Values at the nodes of a facet, axis 0 fastest.
type Nodal<const D: usize> = Vec<[f64; D]>;

/// A curved facet.
#[derive(Clone, Debug)]
pub(super) struct Patch<const D: usize> {
    /// The first node: all other positions are relative to it, except the box.
    origin: [f64; D],
    /// x at the nodes, and at the same nodes its derivatives: polynomials of the same degree.
    x: Nodal<D>,
    first: [Nodal<D>; 2],
    second: [[Nodal<D>; 2]; 2],
    /// x at the samples.
    samples: Nodal<D>,
    /// No point of the facet is further from the nearest sample.
    reach: f64,
    /// A box around the facet.
    pub(super) frame: Frame<D>,
}

impl<const D: usize> Patch<D> {
    /// The facet with the nodes `x`.
    pub(super) fn new(tables: &Tables, nodes: Nodal<D>) -> Self {
        let origin = nodes[0];
        let x: Nodal<D> = nodes.iter().map(|x| from_fn(|i| x[i] - origin[i])).collect();
        let derivative = |f: &Nodal<D>, axis: usize| along::<D>(&tables.derivative, f, axis);
        let first = from_fn(|a| derivative(&x, a));
        let second = from_fn(|a| from_fn(|b| derivative(&first[a], b)));
        let samples = (0..D - 1).fold(x.clone(), |x, axis| along(&tables.at_samples, &x, axis));
        // Half the distance of samples along each axis, at the largest speed along it.
        let speed = |a: usize| tables.lebesgue * first[a].iter().map(norm).fold(0.0, f64::max);
        let reach = (0..D - 1).map(|a| speed(a) / (tables.samples.len() - 1) as f64).sum();
        let frames = samples.iter().map(|x| Frame {
            lower: from_fn(|i| origin[i] + (x[i] - reach)),
            upper: from_fn(|i| origin[i] + (x[i] + reach)),
        });
        let frame = frames.reduce(Frame::around).expect("a facet has samples");
        Patch { origin, x, first, second, samples, reach, frame }
    }

    /// The smaller of `nearest` and the distance of `p` to the facet.
    pub(super) fn distance(&self, tables: &Tables, p: &[f64; D], nearest: f64) -> f64 {
        let p = &from_fn(|i| p[i] - self.origin[i]);
        let distances: Vec<f64> = self.samples.iter().map(|x| norm(&from_fn::<f64, D, _>(|i| x[i] - p[i]))).collect();
        let n = tables.samples.len();
        let mut nearest = nearest;
        for (k, &distance) in distances.iter().enumerate() {
            if distance - self.reach < nearest && is_smallest::<D>(&distances, n, k) {
                let start = [tables.samples[k % n], if D == 3 { tables.samples[k / n] } else { 0.0 }];
                nearest = nearest.min(self.refine(tables, p, start));
            }
        }
        nearest
    }

    /// The least distance of p that Newton's method finds from `eta`.
    fn refine(&self, tables: &Tables, p: &[f64; D], mut eta: [f64; 2]) -> f64 {
        let mut weights = Weights::new::<D>(tables, eta);
        let mut distance = self.distance_at(&weights, p);
        for _ in 0..MAX_STEPS {
            let step = self.newton_step(&weights, p, &eta);
            let mut length = 1.0;
            loop {
                let next: [f64; 2] = from_fn(|a| (eta[a] + length * step[a]).clamp(-1.0, 1.0));
                if (0..2).all(|a| (next[a] - eta[a]).abs() < SHORTEST_STEP) {
                    return distance;
                }
                let weights_there = Weights::new::<D>(tables, next);
                let distance_there = self.distance_at(&weights_there, p);
                if distance_there < distance {
                    (eta, weights, distance) = (next, weights_there, distance_there);
                    break;
                }
                length *= 0.5;
            }
        }
        distance
    }

    fn distance_at(&self, weights: &Weights, p: &[f64; D]) -> f64 {
        let x = weights.sum(&self.x);
        norm(&from_fn::<f64, D, _>(|i| x[i] - p[i]))
    }

    /// The step of Newton's method for (nearest), or of Gauss-Newton where phi is not convex. An axis is held if the
    /// facet ends there and phi falls outwards.
    fn newton_step(&self, weights: &Weights, p: &[f64; D], eta: &[f64; 2]) -> [f64; 2] {
        let x = weights.sum(&self.x);
        let r: [f64; D] = from_fn(|i| x[i] - p[i]);
        let tangents: [[f64; D]; 2] = from_fn(|a| weights.sum(&self.first[a]));
        let gradient: [f64; 2] = from_fn(|a| dot(&r, &tangents[a]));
        let held: [bool; 2] = from_fn(|a| a + 1 >= D || eta[a].abs() >= 1.0 && gradient[a] * eta[a] <= 0.0);
        let metric: [[f64; 2]; 2] = from_fn(|a| from_fn(|b| dot(&tangents[a], &tangents[b])));
        let hessian: [[f64; 2]; 2] = from_fn(|a| from_fn(|b| metric[a][b] + dot(&r, &weights.sum(&self.second[a][b]))));
        solve(&hessian, &gradient, held).or_else(|| solve(&metric, &gradient, held)).unwrap_or([0.0; 2])
    }
}

/// -matrix^{-1} gradient along the axes that are not held, 0 along the others; `None` if the matrix is not positive there.
fn solve(matrix: &[[f64; 2]; 2], gradient: &[f64; 2], held: [bool; 2]) -> Option<[f64; 2]> {
    let [[a, b], [_, c]] = *matrix;
    let determinant = a * c - b * b;
    match held {
        [true, true] => Some([0.0; 2]),
        [false, true] => (a > 0.0).then(|| [-gradient[0] / a, 0.0]),
        [true, false] => (c > 0.0).then(|| [0.0, -gradient[1] / c]),
        [false, false] => (a > 0.0 && determinant > 0.0).then(|| {
            [(b * gradient[1] - c * gradient[0]) / determinant, (b * gradient[0] - a * gradient[1]) / determinant]
        }),
    }
}

/// Whether no neighbour of sample `k` along an axis is nearer.
fn is_smallest<const D: usize>(distances: &[f64], n: usize, k: usize) -> bool {
    (0..D - 1).all(|axis| {
        let (stride, digit) = (n.pow(axis as u32), k / n.pow(axis as u32) % n);
        let low = digit > 0 && distances[k - stride] < distances[k];
        let high = digit + 1 < n && distances[k + stride] < distances[k];
        !low && !high
    })
}

/// The values of the basis at a point, along each axis.
struct Weights([Vec<f64>; 2]);

impl Weights {
    fn new<const D: usize>(tables: &Tables, eta: [f64; 2]) -> Self {
        Weights(from_fn(|a| if a + 1 < D { tables.lagrange.values(eta[a]) } else { vec![1.0] }))
    }

    /// The polynomial with these values at the nodes.
    fn sum<const D: usize>(&self, nodal: &Nodal<D>) -> [f64; D] {
        let [along, across] = &self.0;
        let mut sum = [0.0; D];
        for (row, weight) in nodal.chunks_exact(along.len()).zip(across) {
            for (x, l) in row.iter().zip(along) {
                (0..D).for_each(|i| sum[i] += weight * l * x[i]);
            }
        }
        sum
    }
}

/// `matrix` applied along one axis of a lattice of D - 1 axes. The lattice has as many nodes along the axis as the matrix has columns. The
/// dummy axis has derivative 0.
fn along<const D: usize>(matrix: &Matrix, nodal: &Nodal<D>, axis: usize) -> Nodal<D> {
    if axis + 1 >= D {
        return vec![[0.0; D]; nodal.len()];
    }
    let columns = matrix.cols();
    // Axis 0 comes first. When axis 1 is mapped, axis 0 has been mapped to its samples already.
    let stride = if axis == 0 { 1 } else { nodal.len() / columns };
    let outer = nodal.len() / (columns * stride);
    let mut out = Vec::with_capacity(outer * matrix.rows() * stride);
    for block in 0..outer {
        for row in 0..matrix.rows() {
            for inner in 0..stride {
                let at = |j: usize| &nodal[(block * columns + j) * stride + inner];
                out.push(from_fn(|i| (0..columns).map(|j| matrix.row(row)[j] * at(j)[i]).sum()));
            }
        }
    }
    out
}
