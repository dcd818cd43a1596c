//! The inviscid volume terms in split form, for Gauss-Lobatto points that are the nodes.
//!
//! ```text
//! R_i += omega_perp sum_j (Q_ij - Q_ji) f#(u_i, u_j; {A}, {A . v}),   Q_ij = omega_i phi_j'(xi_i)                    (split)
//! ```
//!
//! along every line of nodes in every direction. The phi_j are the polynomials of the line, omega its weights, omega_perp those across it, { } the
//! mean of both nodes. f# is the law's two-point flux, consistent and symmetric. With its mean value in place of f#
//! these are the volume terms of (volume) themselves, since Q + Q^T holds the boundary alone. Other choices keep balances that the
//! product rule gives to the equations and not to collocation: of kinetic energy, or of entropy.
//!
//! After Gassner, Winters & Kopriva, J. Comput. Phys. 327 (2016).

use crate::cell_geometry::geometry_len;
use crate::conservation_law::ConservationLaw;
use crate::fields::Fields;
use crate::point::{Kernel, KernelTypes, PointIndex};
use crate::tables::Planes;
use tensor::{LaneNumber, Lanes, Pack, dot};

/// A pair of nodes on a line, and their entry of (split).
#[derive(Clone, Copy)]
struct Pair {
    axis: usize,
    nodes: [usize; 2],
    /// omega_perp (Q_ij - Q_ji) times the weight in time.
    weight: f64,
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> Kernel<'_, D, M, T> {
    /// Adds (split) times `weight` to `tested[m][node]`, with the state `u[b][m][node]` and `geometry[b][number][node]`.
    #[inline(always)]
    pub(crate) fn split_terms(self, [u, geometry]: [&[Pack]; 2], planes: &Planes, weight: f64, tested: &mut [Pack]) {
        let Some(collocation) = &self.tables.collocation else { return };
        let (n, weights) = (self.tables.orders.flow, &self.tables.rule.weights);
        for axis in 0..D {
            let stride = n.pow(axis as u32);
            for i in 0..planes.weights.len() {
                let on_line = i / stride % n;
                let across = weight * planes.weights[i] / weights[on_line];
                for j in on_line + 1..n {
                    let nodes = [i, i + (j - on_line) * stride];
                    let pair = Pair { axis, nodes, weight: across * collocation.skew[(on_line, j)] };
                    for part in 0..Lanes::<T::Simd>::PARTS {
                        self.add_pair([u, geometry], pair, part, tested);
                    }
                }
            }
        }
    }

    /// The flux of a pair: The matrix is skew, so the second node loses what the first one receives.
    #[inline(always)]
    fn add_pair(self, [u, geometry]: [&[Pack]; 2], pair: Pair, part: usize, tested: &mut [Pack]) {
        let points = self.tables.volume_points();
        let (fields, [i, j]) = (Fields::new(geometry_len(D), points), pair.nodes);
        let (areas, velocities) = (fields.from(pair.axis * D), fields.from(D * D));
        let mut area: [T::Geometry; D] = areas.vector(self.simd, geometry, i, part);
        let other: [T::Geometry; D] = areas.vector(self.simd, geometry, j, part);
        let of_i = dot(&area, &velocities.vector(self.simd, geometry, i, part));
        let of_j = dot(&other, &velocities.vector(self.simd, geometry, j, part));
        let grid_flux = (of_i + of_j) * 0.5;
        for d in 0..D {
            area[d] = (area[d] + other[d]) * 0.5;
        }
        let a = self.state(u, PointIndex { points, p: i, part });
        let b = self.state(u, PointIndex { points, p: j, part });
        let flux = self.law.two_point_flux(&a, &b, &area, grid_flux);
        for m in 0..M {
            let term = (flux[m] * pair.weight).result();
            let [first, second] = [m * points + i, m * points + j];
            self.add_to(term, &mut tested[first], part);
            self.add_to(-term, &mut tested[second], part);
        }
    }
}
