//! The motion of the mesh in one slab, by collocation at the right-Radau nodes.
//!
//! The mesh velocity is a polynomial in time with the values V_b at the N_t right-Radau nodes s_b of the slab, and
//!
//! ```text
//! d(s) = d_n + dt sum_b Phi_b(s) V_b,         Phi_b(s) = int_0^s phi_b                                  (motion at nodes)
//! d(s_a) = d_n + dt sum_b Phi_ab V_b,         Phi_ab = Phi_b(s_a)
//! V_b = (1/dt) sum_a (Phi^{-1})_ba (d(s_a) - d_n)                                                                (velocity)
//! ```
//!
//! A prescribed displacement g gives the velocities at the nodes. They are those of the polynomial p through d_n at the bottom and g at N_t + 2
//! right-Radau nodes. A constant takes the mesh to g at the top, also where g bends or jumps:
//!
//! ```text
//! V_b = p'(s_b) / dt + (1/dt) ( g(1) - d_n - sum_c omega_c p'(s_c) )                                            (prescribed)
//! ```
//!
//! The constant is of the order of the error in time. The jumps of V then have moments like those of g', so that the pressure on a wall follows its
//! acceleration with order N_t. The derivative of a polynomial through g(s_a) alone would leave order N_t - 1. Rates of g itself would do as well where
//! it is smooth, but may be infinite or very large at a node.
//!
//! The equilibrium holds at every node. The last node is the top of the slab, so the mesh there
//! is in equilibrium with the exact boundary for any history: errors of the solver do not accumulate. (With Galerkin in time they
//! would persist: they return at the next top with the factor (-1)^{N_t}.)
//!
//! Fields of a slab have the layout `[time node][C0 node][component]`.

use crate::{ElasticMesh, ElasticityError, Inversion};
use basis::{Matrix, RadauTime};
use newton_krylov::cg;
use tensor::Real;

/// The largest number of time nodes of a slab.
pub const MAX_TIME_ORDER: usize = 16;

/// How many more nodes than a slab the polynomial p of (prescribed) has. With one more its error would be seen.
const MORE_NODES: usize = 2;

/// The relation between velocities and displacements in a slab. It does not depend on space: vectors may have any
/// length.
#[derive(Clone, Debug)]
pub struct SlabMotion {
    time: RadauTime,
    /// The nodes of p of (prescribed).
    finer: RadauTime,
    /// The polynomials of `finer` at the nodes of `time`, one row each.
    to_nodes: Matrix,
}

impl SlabMotion {
    /// The motion with the given temporal basis, of order at most [`MAX_TIME_ORDER`].
    pub fn new(time: RadauTime) -> Self {
        let finer = RadauTime::new(time.order() + MORE_NODES);
        let rows = time.nodes().iter().flat_map(|s| finer.values(*s)).collect();
        let to_nodes = Matrix::new(time.order(), finer.order(), rows);
        SlabMotion { time, finer, to_nodes }
    }
    /// The temporal basis.
    pub fn time(&self) -> &RadauTime {
        &self.time
    }

    /// out = d(s) by (motion at nodes), for the displacement `bottom` = d_n, the velocities `v[b][..]`, and s in [0, 1].
    pub fn displacement<T: Real>(&self, dt: f64, bottom: &[T], v: &[T], s: f64, out: &mut [T]) {
        displace(dt, bottom, v, &self.time.integrals(s), out);
    }

    /// out = d(s_a) at time node `a`.
    pub fn displacement_at_node<T: Real>(&self, dt: f64, bottom: &[T], v: &[T], a: usize, out: &mut [T]) {
        displace(dt, bottom, v, self.time.collocation().row(a), out);
    }

    /// Replaces the displacements `d[a][..]` at the time nodes by the velocities by (velocity).
    pub fn velocities<T: Real>(&self, dt: f64, bottom: &[T], d: &mut [T]) {
        velocities(&self.time, dt, bottom, d);
    }

    /// The times of a slab, in [0, 1], at which [`Self::prescribed`] takes a displacement. The last one is the top.
    pub fn times_of_prescribed(&self) -> &[f64] {
        self.finer.nodes()
    }

    /// The velocities at the time nodes by (prescribed), `[b][..]`, for the displacements `g[k][..]` at [`Self::times_of_prescribed`].
    pub fn prescribed(&self, dt: f64, bottom: &[f64], mut g: Vec<f64>) -> Vec<f64> {
        let (length, top) = (bottom.len(), g[g.len() - bottom.len()..].to_vec());
        velocities(&self.finer, dt, bottom, &mut g);
        let mut v = vec![0.0; self.time.order() * length];
        for (b, v) in v.chunks_exact_mut(length).enumerate() {
            for (phi, of_finer) in self.to_nodes.row(b).iter().zip(g.chunks_exact(length)) {
                v.iter_mut().zip(of_finer).for_each(|(v, of_finer)| *v += phi * of_finer);
            }
        }
        self.lead_to(dt, bottom, &top, &mut v);
        v
    }

    /// Shifts the velocities `v[b][..]` by constants, such that the displacement `bottom` becomes `top`.
    pub fn lead_to<T: Real>(&self, dt: f64, bottom: &[T], top: &[T], v: &mut [T]) {
        let mut missing = bottom.to_vec();
        self.displacement(dt, bottom, v, 1.0, &mut missing);
        missing.iter_mut().zip(top).for_each(|(missing, top)| *missing = (*top - *missing) / top.constant(dt));
        for node in v.chunks_exact_mut(bottom.len()) {
            node.iter_mut().zip(&missing).for_each(|(v, missing)| *v += *missing);
        }
    }
}

/// Replaces the displacements `d[a][..]` at the nodes of `time` by the velocities by (velocity).
fn velocities<T: Real>(time: &RadauTime, dt: f64, bottom: &[T], d: &mut [T]) {
    for node in d.chunks_exact_mut(bottom.len()) {
        node.iter_mut().zip(bottom).for_each(|(d, bottom)| *d = (*d - *bottom) / d.constant(dt));
    }
    combine_nodes(time.inverse_collocation(), d);
}

/// out = bottom + dt sum_b integrals[b] v[b].
fn displace<T: Real>(dt: f64, bottom: &[T], v: &[T], integrals: &[f64], out: &mut [T]) {
    out.copy_from_slice(bottom);
    accumulate(dt, v, integrals, out);
}

/// out = out + dt sum_b integrals[b] v[b].
pub(crate) fn accumulate<T: Real>(dt: f64, v: &[T], integrals: &[f64], out: &mut [T]) {
    for (v, integral) in v.chunks_exact(out.len()).zip(integrals) {
        out.iter_mut().zip(v).for_each(|(out, v)| *out += *v * (dt * integral));
    }
}

/// How many entries of a field are combined at a time, so that they vectorise.
const BLOCK: usize = 16;

/// field[a] = sum_b matrix[a][b] field[b], in place.
pub(crate) fn combine_nodes<T: Real>(matrix: &Matrix, field: &mut [T]) {
    let (nodes, length) = (matrix.rows(), field.len() / matrix.rows());
    let Some(zero) = field.first().map(|number| number.zero()) else { return };
    let mut old = [[zero; BLOCK]; MAX_TIME_ORDER + MORE_NODES];
    for start in (0..length).step_by(BLOCK) {
        let entries = |a: usize| a * length + start..a * length + (start + BLOCK).min(length);
        (0..nodes).for_each(|b| old[b][..entries(b).len()].copy_from_slice(&field[entries(b)]));
        for a in 0..nodes {
            let new = &mut field[entries(a)];
            new.fill(zero);
            for (entry, old) in matrix.row(a).iter().zip(&old) {
                new.iter_mut().zip(old).for_each(|(new, old)| *new += *old * *entry);
            }
        }
    }
}

/// The mesh equations of a slab of length `dt`, in the unknown velocities V.
///
/// ```text
/// R_a = R(d(s_a))_f                     at free entries                                                          (slab)
/// R_a = diag(K) (d(s_a) - g(s_a))_c     at constrained entries: a force, like the other rows
/// ```
///
/// The slab begins at the displacement that [`ElasticMesh::begin_slab`] was called with.
#[derive(Clone, Copy)]
pub struct ElasticSlab<'a, const D: usize> {
    /// The law and the constrained entries.
    pub mesh: &'a ElasticMesh<D>,
    /// The temporal basis.
    pub motion: &'a SlabMotion,
    /// The length of the slab.
    pub dt: f64,
}

impl<const D: usize> ElasticSlab<'_, D> {
    /// r = R(V) by (slab), for the displacement `bottom` at t_n and the prescribed displacements `g[a][..]` at the time nodes. Only the
    /// constrained entries of `g` are read.
    ///
    /// # Errors
    /// [`Inversion`] where the law has no stress; `r` is then meaningless.
    pub fn residual(&self, bottom: &[f64], g: &[f64], v: &[f64], r: &mut [f64]) -> Result<(), Inversion> {
        let length = self.mesh.length();
        self.mesh.with_vector(|d| {
            for (a, (r, g)) in r.chunks_exact_mut(length).zip(g.chunks_exact(length)).enumerate() {
                self.motion.displacement_at_node(self.dt, bottom, v, a, d);
                self.mesh.forces(d, r)?;
                self.mesh.at_constrained(r, |i| self.mesh.diagonal()[i] * (d[i] - g[i]));
            }
            Ok(())
        })
    }

    /// out += factor diag(K) g at constrained entries, for the displacements `g[a][..]`. Their rows of (slab) contain this term with the
    /// factor -1.
    pub fn add_prescribed(&self, factor: f64, g: &[f64], out: &mut [f64]) {
        let length = self.mesh.length();
        for (g, out) in g.chunks_exact(length).zip(out.chunks_exact_mut(length)) {
            self.mesh.add_at_constrained(out, |i| factor * self.mesh.diagonal()[i] * g[i]);
        }
    }

    /// out = (dR/dV)(V) w.
    pub fn jacobian_product(&self, bottom: &[f64], v: &[f64], w: &[f64], out: &mut [f64]) {
        let length = self.mesh.length();
        self.mesh.with_vector(|d| {
            self.mesh.with_vector(|direction| {
                for (a, out) in out.chunks_exact_mut(length).enumerate() {
                    if !self.mesh.law().is_linear() {
                        self.motion.displacement_at_node(self.dt, bottom, v, a, d);
                    }
                    direction.fill(0.0);
                    accumulate(self.dt, w, self.motion.time.collocation().row(a), direction);
                    self.mesh.product_at(d, direction, out);
                    self.mesh.at_constrained(out, |i| self.mesh.diagonal()[i] * direction[i]);
                }
            });
        });
    }

    /// Solves (dR/dV) w = r. K stands for the derivative of the forces at all time nodes, which is exact for a linear law. The temporal
    /// modes decouple into N_t right-hand sides of K for displacement increments. Their constrained entries enter through K_fc, and w
    /// follows by (velocity).
    ///
    /// # Errors
    /// As [`ElasticMesh::solve`].
    pub fn solve(&self, r: &[f64], w: &mut [f64], tolerance: f64) -> Result<Vec<cg::Report>, ElasticityError> {
        let length = self.mesh.length();
        w.fill(0.0);
        for (d, r) in w.chunks_exact_mut(length).zip(r.chunks_exact(length)) {
            self.mesh.at_constrained(d, |i| r[i] / self.mesh.diagonal()[i]);
        }
        let reports = self.mesh.solve_all(r, w, tolerance);
        w.iter_mut().for_each(|d| *d /= self.dt);
        combine_nodes(self.motion.time.inverse_collocation(), w);
        reports
    }
}

#[cfg(test)]
mod tests;
