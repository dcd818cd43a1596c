//! One-dimensional matrices of a slab space, which the kernels contract with.

use crate::collocation::Collocation;
use crate::time_points::TimePoint;
use basis::{Lagrange, Matrix, RadauTime, Rule, gauss, gauss_lobatto};
use tensor::Pack;

/// The number of quadrature points of the flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quadrature {
    /// The fewest Gauss points that satisfy the geometric conservation law exactly.
    Conserving,
    /// Three points for two nodes, or as many as conserve where that is more; conserving in time.
    ThreeHalves,
    /// Twice the order, in space and time (the paper's choice).
    Double,
    /// A number of points per direction in space; conserving in time.
    Points(usize),
    /// As many points as nodes, in space and time. It conserves by its metric, see `collocation`.
    Collocated(PointFamily),
}

/// The points of a collocated rule in one direction of space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointFamily {
    /// Gauss points.
    Gauss,
    /// Gauss-Lobatto points, the nodes of the flow.
    Lobatto,
}

/// Orders of a slab space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Orders {
    /// Order of the flow in space, N_s.
    pub flow: usize,
    /// Order of the mesh in space, N_m: geometry and displacement.
    pub mesh: usize,
    /// Order in time, N_t, of the flow and of the mesh velocity.
    pub time: usize,
}

impl Quadrature {
    /// Gauss points per direction in space.
    ///
    /// A free stream is preserved on any motion if `int grad w . v cof` and `int w_t J` are exact. Their degree is (N_s - 1) + D
    /// (N_m - 1) - 1 per direction: 3p - 1 in 2-D and 4p - 1 in 3-D for equal degrees p. A rule of n points is exact to degree 2n -
    /// 1.
    pub fn space_points(self, dimension: usize, orders: Orders) -> usize {
        match self {
            Quadrature::Conserving => {
                let degree = (orders.flow - 1) + dimension * (orders.mesh - 1) - 1;
                (degree + 1).div_ceil(2).max(orders.flow)
            }
            Quadrature::ThreeHalves => {
                (3 * orders.flow).div_ceil(2).max(Quadrature::Conserving.space_points(dimension, orders))
            }
            Quadrature::Double => 2 * orders.flow.max(orders.mesh),
            Quadrature::Points(n) => n,
            Quadrature::Collocated(_) => orders.flow,
        }
    }

    /// Whether a free stream is preserved on any motion.
    pub fn conserves(self, dimension: usize, orders: Orders) -> bool {
        let needed = Quadrature::Conserving.space_points(dimension, orders);
        matches!(self, Quadrature::Collocated(_)) || self.space_points(dimension, orders) >= needed
    }

    /// Points in time. The cofactors of the map have degree (D - 1) N_t in time, the mesh velocity and the test
    /// function N_t - 1 each.
    pub fn time_points(self, dimension: usize, orders: Orders) -> usize {
        match self {
            Quadrature::Double => 2 * orders.time,
            Quadrature::Collocated(_) => orders.time,
            _ => {
                let degree = (dimension - 1) * orders.time + 2 * (orders.time - 1);
                (degree + 1).div_ceil(2).max(orders.time)
            }
        }
    }

    /// The rule in one direction of space.
    fn space_rule(self, dimension: usize, orders: Orders) -> Rule {
        match self {
            Quadrature::Collocated(PointFamily::Lobatto) => gauss_lobatto(orders.flow),
            _ => gauss(self.space_points(dimension, orders)),
        }
    }

    /// The rule in time, on [0, 1]: the nodes of the slab if it is collocated, else Gauss points.
    fn time_rule(self, dimension: usize, orders: Orders, time: &RadauTime) -> Rule {
        match self {
            Quadrature::Collocated(_) => Rule { points: time.nodes().to_vec(), weights: time.weights().to_vec() },
            _ => gauss(self.time_points(dimension, orders)).on(0.0, 1.0),
        }
    }
}

/// Nodal polynomials of one order at the quadrature points of one direction.
pub struct Shape1d {
    /// Nodes per direction.
    pub order: usize,
    /// Values at the points, `[point][node]`.
    pub values: Matrix,
    /// Derivatives at the points, `[point][node]`.
    pub derivatives: Matrix,
    /// Transpose of `values`: integrates against test functions.
    pub values_transposed: Matrix,
    /// Transpose of `derivatives`: integrates against derivatives of test functions.
    pub derivatives_transposed: Matrix,
    /// Derivatives of the nodal polynomials at the low and the high end, `[end][node]`.
    pub end_derivatives: [Vec<f64>; 2],
    /// Whether the points are the nodes, so that `values` is the identity.
    pub is_nodal: bool,
}

impl Shape1d {
    /// Gauss-Lobatto nodal polynomials of `order` at `points`.
    pub fn new(order: usize, points: &[f64]) -> Self {
        let is_nodal = points == gauss_lobatto(order).points;
        Shape1d { is_nodal, ..Self::interpolated(order, order, points) }
    }

    /// Gauss-Lobatto nodal polynomials of `order`, interpolated at the Gauss-Lobatto nodes of order `to`, at `points`.
    pub fn interpolated(order: usize, to: usize, points: &[f64]) -> Self {
        let (lagrange, interpolant) = (Lagrange::gauss_lobatto(order), Lagrange::gauss_lobatto(to));
        let at_nodes = match order == to {
            true => Matrix::identity(order),
            false => lagrange.value_matrix(&gauss_lobatto(to).points),
        };
        let of_nodes = |matrix: Matrix| if order == to { matrix } else { matrix.product(&at_nodes) };
        let values = of_nodes(interpolant.value_matrix(points));
        let derivatives = of_nodes(interpolant.derivative_matrix(points));
        let ends = of_nodes(interpolant.derivative_matrix(&[-1.0, 1.0]));
        Shape1d {
            order,
            is_nodal: order == to && points == gauss_lobatto(to).points,
            values_transposed: values.transpose(),
            derivatives_transposed: derivatives.transpose(),
            values,
            derivatives,
            end_derivatives: [ends.row(0).to_vec(), ends.row(1).to_vec()],
        }
    }
}

/// Planes of volume points, normal to the last axis. A cell kernel treats as many at a time as its arrays fit into the
/// second-level cache.
pub struct Planes {
    /// Flow polynomials at these points of the last axis.
    pub flow: Shape1d,
    /// Mesh polynomials there.
    pub mesh: Shape1d,
    /// Weights of the points, lexicographic.
    pub weights: Vec<f64>,
}

/// The largest size in bytes of the arrays at the points of a block, unless a single plane takes more. They share a second-level
/// cache of 1 MB or less with the nodal arrays.
const BLOCK_BYTES: usize = 1 << 18;

impl Planes {
    /// The blocks of a rule in `dimension` directions, for `packs` packs at every point. Each has at least one plane,
    /// and their sizes are as equal as possible.
    fn blocks(rule: &Rule, dimension: usize, orders: Orders, packs: usize) -> Vec<Planes> {
        let plane_bytes = rule.points.len().pow(dimension as u32 - 1) * packs * size_of::<Pack>();
        let count = rule.points.len().div_ceil((BLOCK_BYTES / plane_bytes).max(1));
        Self::divided(rule, dimension, orders, count)
    }

    /// The number of blocks of planes.
    fn divided(rule: &Rule, dimension: usize, orders: Orders, count: usize) -> Vec<Planes> {
        let (q, in_plane) = (rule.points.len(), rule.tensor_weights(dimension - 1));
        let block = |number: usize| {
            let planes = number * q / count..(number + 1) * q / count;
            let points = &rule.points[planes.clone()];
            let weights = rule.weights[planes].iter().flat_map(|w| in_plane.iter().map(move |v| v * w)).collect();
            Planes { flow: Shape1d::new(orders.flow, points), mesh: Shape1d::new(orders.mesh, points), weights }
        };
        (0..count).map(block).collect()
    }
}

/// All one-dimensional tables of a slab space in `D` dimensions.
pub struct Tables<const D: usize> {
    /// The orders.
    pub orders: Orders,
    /// Quadrature in one direction of space.
    pub rule: Rule,
    /// Flow polynomials at the space points.
    pub flow: Shape1d,
    /// Mesh polynomials at the space points.
    pub mesh: Shape1d,
    /// The time basis.
    pub time: RadauTime,
    /// The Gauss points of the slab in time.
    pub time_points: Vec<TimePoint>,
    /// The top of the slab, s = 1, weight 1.
    pub top: TimePoint,
    /// phi_a(s) at the time points, `[time point][a]`.
    pub values: Matrix,
    /// The same with the top as the last row, unless the last time point is the top.
    pub values_and_top: Matrix,
    /// Velocities at the Gauss points, `[time point][slot]`.
    pub velocities: Matrix,
    /// phi_a(s) at the Gauss points, `[a][time point]`: sends terms there to the test functions.
    pub test: Matrix,
    /// -phi_a'(s) at the time points, with the sign from integration by parts, and last phi_a(1), `[a][time or top]`: the test of the
    /// conserved quantity. Where the last time point is the top, its column holds both.
    pub test_rate: Matrix,
    /// The volume points, plane by plane.
    pub planes: Vec<Planes>,
    /// Weights of the facet points, lexicographic.
    pub facet_weights: Vec<f64>,
    /// The tables of the metric of collocated rules.
    pub collocation: Option<Collocation>,
}

impl<const D: usize> Tables<D> {
    /// The shares of the time points in what the equations of the top node see, see [`SlabOperator::boundary_fluxes`](crate::SlabOperator::boundary_fluxes):
    ///
    /// ```text
    /// p = sum_q e_q p_q,   e_q = w_q phi_N(s_q) / sum_q w_q phi_N(s_q)                                       (penalty at top)
    /// ```
    pub fn shares_at_top(&self) -> Vec<f64> {
        let tested = |point: &TimePoint| point.weight * point.values.row(0).last().copied().unwrap_or(1.0);
        let sum: f64 = self.time_points.iter().map(tested).sum();
        self.time_points.iter().map(|point| tested(point) / sum).collect()
    }

    /// Tables for `orders`, each in 1..=16 (2..=16 in space), and a state of `components`.
    pub fn new(orders: Orders, components: usize, quadrature: Quadrature) -> Self {
        let rule = quadrature.space_rule(D, orders);
        let time = RadauTime::new(orders.time);
        let time_rule = quadrature.time_rule(D, orders, &time);
        let time_points: Vec<_> =
            (time_rule.points.iter().zip(&time_rule.weights)).map(|(&s, &w)| TimePoint::new(&time, s, w)).collect();
        let (n_t, count) = (orders.time, time_points.len());
        let collocation = match quadrature {
            Quadrature::Collocated(family) => Some(Collocation::new(orders, family)),
            _ => None,
        };
        let test_rate = test_rate(&time, &time_points, collocation.is_some());
        // Of the state: values and gradients, mass product and fluxes; of the mesh: velocity and Jacobian matrix.
        let packs = (2 * components + D) * (1 + D);
        Tables {
            orders,
            planes: match collocation {
                Some(_) => Planes::divided(&rule, D, orders, 1),
                None => Planes::blocks(&rule, D, orders, packs),
            },
            flow: Shape1d::new(orders.flow, &rule.points),
            mesh: match collocation {
                Some(_) => Shape1d::interpolated(orders.mesh, orders.flow, &rule.points),
                None => Shape1d::new(orders.mesh, &rule.points),
            },
            top: TimePoint::new(&time, 1.0, 1.0),
            values: Matrix::from_fn(count, n_t, |q, a| time_points[q].values[(0, a)]),
            values_and_top: Matrix::from_fn(test_rate.cols(), n_t, |q, a| {
                time_points.get(q).map_or(time.values(1.0)[a], |time_point| time_point.values[(0, a)])
            }),
            velocities: Matrix::from_fn(count, n_t + 1, |q, slot| time_points[q].velocities[(0, slot)]),
            test: Matrix::from_fn(n_t, count, |a, q| time_points[q].values[(0, a)]),
            test_rate,
            collocation,
            time_points,
            time,
            facet_weights: rule.tensor_weights(D - 1),
            rule,
        }
    }

    /// The times at which cells evaluate the conserved quantity: the time points and the top.
    pub(crate) fn times(&self) -> usize {
        self.values_and_top.rows()
    }

    /// The row of positions of a slab at its bottom, which also holds for a mesh at rest.
    pub fn bottom_row(&self) -> Matrix {
        Matrix::from_fn(1, self.orders.time + 1, |_, b| if b == 0 { 1.0 } else { 0.0 })
    }
    /// Quadrature points of a cell.
    pub fn volume_points(&self) -> usize {
        self.rule.points.len().pow(D as u32)
    }
    /// The largest number of quadrature points of a block.
    pub fn block_points(&self) -> usize {
        self.planes.iter().map(|planes| planes.weights.len()).max().unwrap_or(0)
    }
    /// Quadrature points of a facet.
    pub fn facet_points(&self) -> usize {
        self.facet_weights.len()
    }
}

/// See [`Tables::test_rate`]. Mass products at a time point have its weight already.
fn test_rate(time: &RadauTime, time_points: &[TimePoint], last_is_top: bool) -> Matrix {
    let (n_t, count) = (time.order(), time_points.len());
    let rates: Vec<_> = time_points.iter().map(|time_point| time.derivatives(time_point.s)).collect();
    let top = time.values(1.0);
    if !last_is_top {
        return Matrix::from_fn(n_t, count + 1, |a, q| rates.get(q).map_or(top[a], |rates| -rates[a]));
    }
    let at_top = |a: usize, q: usize| if q + 1 == count { top[a] / time_points[q].weight } else { 0.0 };
    Matrix::from_fn(n_t, count, |a, q| at_top(a, q) - rates[q][a])
}
