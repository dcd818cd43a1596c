//! Collocation that conserves: as many points as nodes, in space and time.
//!
//! A free stream is kept where the metric has no divergence and the determinant follows the velocity of the mesh, whatever the number of
//! points. The position x of the mesh is interpolated at the Gauss-Lobatto nodes of the flow; I is that interpolation.
//!
//! ```text
//! A_i = J grad xi_i;  in 2-D as it is, in 3-D in the form of a curl, whose divergence vanishes identically:
//! A_i,n = -1/2 ( d_j F_k,n - d_k F_j,n ),   F_k,n = I_h( x_l d_k x_m - x_m d_k x_l ),   (i, j, k) and (n, m, l) cyclic             (metric)
//! g_i = I_h( A_i . v ),   v the velocity of the mesh                                                                     (grid flux)
//! J(s) = J_n + dt int_0^s sum_i d_i g_i                                                                                  (carried)
//! ```
//!
//! The time points are the nodes of the slab in time, so g is a polynomial through its values there. J at the top is the J_n of the next slab;
//! the first one is I(det dx/dxi). J differs from det dx/dxi by the error of interpolating g.
//!
//! Kernels read A, J and a velocity. With Gauss-Lobatto points these are values at nodes. With Gauss points they are interpolated, and
//! the velocity is the one with A_i . v = g_i there.

use crate::tables::{Orders, PointFamily, Shape1d};
use basis::{Lagrange, Matrix, Rule, gauss_lobatto};
use tensor::Real;

/// One-dimensional tables of (metric), (grid flux) and (carried).
pub struct Collocation {
    /// Mesh polynomials at the nodes of the flow, with the derivatives of their interpolant.
    pub mesh: Shape1d,
    /// Derivatives of the flow polynomials at the nodes.
    pub derivative: Matrix,
    /// The same times -1/2 and +1/2, for the curl.
    pub half_derivatives: [Matrix; 2],
    /// Whether the points are the nodes.
    pub at_nodes: bool,
    /// Q - Q^T of (split), see [`crate::split_form`]; used where the points are the nodes.
    pub skew: Matrix,
}

/// F_k of (metric) at a node, from its position and d_k x; three dimensions only.
#[inline(always)]
pub(crate) fn curled<G: Real, const D: usize>(x: &[G; D], slope: &[G; D]) -> [G; D] {
    let mut f = *x;
    for n in 0..D {
        let (m, l) = ((n + 1) % D, (n + 2) % D);
        f[n] = x[l] * slope[m] - x[m] * slope[l];
    }
    f
}

impl Collocation {
    /// The tables for `orders` with points of a `family`.
    pub(crate) fn new(orders: Orders, family: PointFamily) -> Self {
        let Rule { points: nodes, weights } = gauss_lobatto(orders.flow);
        let derivative = Lagrange::gauss_lobatto(orders.flow).derivative_matrix(&nodes);
        let times = |factor: f64| Matrix::from_fn(nodes.len(), nodes.len(), |i, j| factor * derivative[(i, j)]);
        Collocation {
            mesh: Shape1d::interpolated(orders.mesh, orders.flow, &nodes),
            half_derivatives: [times(-0.5), times(0.5)],
            at_nodes: family == PointFamily::Lobatto,
            skew: Matrix::from_fn(nodes.len(), nodes.len(), |i, j| {
                weights[i] * derivative[(i, j)] - weights[j] * derivative[(j, i)]
            }),
            derivative,
        }
    }
}
