//! The state of a run in the polynomials of another run on the same mesh.
//!
//! ```text
//! int_K phi_i (u' - u) J = 0   for every polynomial phi_i of the new order,   J = det dx/dxi at the time reached        (transfer)
//! ```
//!
//! To a higher order u' = u: it contains the lower order. To a lower order u' is the projection of u, and with phi = 1 every cell keeps its
//! mass, momentum and energy. The slab before, which gives the next guess, is transferred too: in space like the state, in time by its
//! values at the new nodes.

use crate::mesh_mover::MeshMover;
use crate::reuse_policy::JacobianReusePolicy;
use crate::state::{Past, State};
use basis::{Matrix, RadauTime, gauss, gauss_lobatto};
use faer::Mat;
use faer::linalg::solvers::Solve;
use fem::parallel::{self, Grain};
use fem::{Layout, Orders, Sampler};
use std::sync::Arc;

/// The flow `u` of the `cells` of a mesh at one time, of order `from` in space, as one of order `to`. The mesh is that of `mover` displaced by
/// `d`.
///
/// # Panics
/// If the length of `u` does not fit.
pub fn transfer_flow<const D: usize>(
    (cells, u): (&[usize], &[f64]),
    (mover, d): (&MeshMover<D>, &[f64]),
    from: usize,
    to: usize,
) -> Vec<f64> {
    let orders = |flow| Orders { flow, mesh: mover.reference.order(), time: 1 };
    let space = Space::<D>::new(orders(from), orders(to));
    carried(&space, (mover, d), (cells, u))
}

/// The state `u` of `cells`, by `space`.
fn carried<const D: usize>(
    space: &Space<D>,
    (mover, d): (&MeshMover<D>, &[f64]),
    (cells, u): (&[usize], &[f64]),
) -> Vec<f64> {
    let len = u.len() / cells.len().max(1);
    let of_cell = |k: usize| space.carry(&u[k * len..][..len], || mover.cell_positions(cells[k], d));
    parallel::map(cells.len(), Grain::Any, &of_cell).concat()
}

impl State {
    /// This state of a flow of `components` on the mesh of `mover`, with the orders `from`, as one with the orders `to`.
    ///
    /// # Panics
    /// If the orders of the mesh differ, or the lengths of the state do not fit.
    pub fn transfer<const D: usize>(&self, mover: &MeshMover<D>, components: usize, from: Orders, to: Orders) -> State {
        assert_eq!(from.mesh, to.mesh, "the mesh is the same");
        let layout = |orders: Orders| {
            let (cells, nodes) = (mover.reference.n_cells(), orders.flow.pow(D as u32));
            Layout { cells, time_order: orders.time, components, nodes }
        };
        let (old, new, space) = (layout(from), layout(to), Space::<D>::new(from, to));
        let time = RadauTime::new(from.time).lagrange().value_matrix(RadauTime::new(to.time).nodes());
        let cells: Vec<usize> = (0..old.cells).collect();
        let carried = |u: &[f64]| carried(&space, (mover, &self.d), (&cells, u));
        let past = self.past.as_ref().map(|past| Past {
            u: Arc::new(by_time(&time, &carried(&past.u), new.time_len())),
            v: Arc::new(by_time(&time, &past.v, self.d.len())),
            bodies: past.bodies.iter().map(|z| by_time(&time, z, z.len() / time.cols())).collect(),
            ..past.clone()
        });
        let u = carried(&self.u);
        let determinants = if from.flow == to.flow { self.determinants.clone() } else { Vec::new() };
        State {
            u,
            past,
            determinants,
            pending: Vec::new(),
            failed: None,
            rejected: 0,
            reuse_policy: JacobianReusePolicy::default(),
            ..self.clone()
        }
    }
}

/// Polynomials in time `[..][old time node][len]` at the new time nodes.
fn by_time(time: &Matrix, values: &[f64], len: usize) -> Vec<f64> {
    let mut out = vec![0.0; values.len() / time.cols() * time.rows()];
    for (old, new) in values.chunks_exact(time.cols() * len).zip(out.chunks_exact_mut(time.rows() * len)) {
        for (a, new) in new.chunks_exact_mut(len).enumerate() {
            for (weight, old) in time.row(a).iter().zip(old.chunks_exact(len)) {
                new.iter_mut().zip(old).for_each(|(new, old)| *new += weight * old);
            }
        }
    }
    out
}

/// From one order in space to another.
enum Space<const D: usize> {
    Same,
    /// The new order is higher: values at its nodes.
    Embedding(Sampler<D>),
    /// The new order is lower.
    Projection(Projection<D>),
}

impl<const D: usize> Space<D> {
    fn new(from: Orders, to: Orders) -> Self {
        match to.flow.cmp(&from.flow) {
            std::cmp::Ordering::Equal => Space::Same,
            std::cmp::Ordering::Greater => {
                Space::Embedding(Sampler::new(from.flow, from.mesh, &gauss_lobatto(to.flow).points))
            }
            std::cmp::Ordering::Less => Space::Projection(Projection::new(from, to)),
        }
    }

    /// Coefficients `[column][node]` of the new order from those of the old one, in a cell with the given positions,
    /// `[component][mesh node]`.
    fn carry(&self, u: &[f64], positions: impl FnOnce() -> Vec<f64>) -> Vec<f64> {
        match self {
            Space::Same => u.to_vec(),
            Space::Embedding(sampler) => sampler.state(u),
            Space::Projection(projection) => projection.apply(u, &positions()),
        }
    }
}

/// (transfer) by quadrature.
struct Projection<const D: usize> {
    /// The old polynomials and the mesh at the points.
    old: Sampler<D>,
    /// The new polynomials at the points, `[node][point]`.
    test: Mat<f64>,
    weights: Vec<f64>,
}

impl<const D: usize> Projection<D> {
    fn new(from: Orders, to: Orders) -> Self {
        // phi_i u J has this degree in every direction, and n points are exact to degree 2 n - 1.
        let degree = (to.flow - 1) + (from.flow - 1) + D * (from.mesh - 1);
        let rule = gauss((degree + 1).div_ceil(2));
        let (q, n) = (rule.points.len(), to.flow.pow(D as u32));
        let mut nodal = vec![0.0; n * n];
        (0..n).for_each(|i| nodal[i * n + i] = 1.0);
        let values = Sampler::<D>::new(to.flow, from.mesh, &rule.points).state(&nodal);
        let points = q.pow(D as u32);
        let weight = |p: usize| (0..D as u32).map(|d| rule.weights[p / q.pow(d) % q]).product();
        Projection {
            old: Sampler::new(from.flow, from.mesh, &rule.points),
            test: Mat::from_fn(n, points, |i, p| values[i * points + p]),
            weights: (0..points).map(weight).collect(),
        }
    }

    /// Solves M u' = b with M_ij = int phi_i phi_j J and b_i = int phi_i u J, for every column of u.
    fn apply(&self, u: &[f64], positions: &[f64]) -> Vec<f64> {
        let (n, points) = (self.test.nrows(), self.weights.len());
        let (values, jacobians) = (self.old.state(u), self.old.determinants(positions));
        let columns = values.len() / points;
        let weighted = Mat::from_fn(points, n, |p, i| self.weights[p] * jacobians[p] * self.test[(i, p)]);
        let right_side = Mat::from_fn(n, columns, |i, c| {
            (0..points).map(|p| weighted[(p, i)] * values[c * points + p]).sum::<f64>()
        });
        let solution = projected(&self.test, &weighted, &right_side);
        (0..columns * n).map(|k| solution[(k % n, k / n)]).collect()
    }
}

/// M^{-1} b with the mass matrix M of test functions and the same, weighted. Compiled here once, and not for every dimension.
fn projected(test: &Mat<f64>, weighted: &Mat<f64>, right_side: &Mat<f64>) -> Mat<f64> {
    (test * weighted).partial_piv_lu().solve(right_side)
}

#[cfg(test)]
mod tests;
