//! The equations of a structure in one slab, by discontinuous Galerkin in time.
//!
//! The velocity is a polynomial with the values V_b at the N_t right-Radau nodes s_b of the slab and jumps at its bottom; the displacement
//! is its integral, (motion) of `slab`, and continuous. With phi_a tested and integrated by the right-Radau rule,
//!
//! ```text
//! R_a = sum_b T_ab M V_b - phi_a(0) M v_n + dt w_a ( K d(s_a) - f(s_a) ) = 0      at free entries              (dynamics)
//! V_a = g'(s_a)                                                                  at fixed entries
//! ```
//!
//! T and w are those of `basis::RadauTime`; as W^{-1} T = A^{-1}, this is the Radau IIA method: order 2 N_t - 1 at the top of a slab,
//! stable for any dt. At supports it is the velocity that is prescribed: prescribed positions would cost (dynamics) its order, for the
//! reactions then follow from second differences. A support so stands where the Radau rule puts the integral of g', of the same order.
//!
//! Nothing is lost but what the jumps take: with [v] = v(0+) - v_n and [d] that of the polynomial through the d(s_a),
//!
//! ```text
//! E_{n+1} - E_n = W - D,     E = v.Mv/2 + d.Kd/2,     D = [v].M[v]/2 + [d].K[d]/2                              (energy)
//! W = dt sum_a w_a f(s_a) . V_a  +  sum over a and fixed entries of  R_a V_a          of loads, and of supports
//! ```

use crate::slab::accumulate;
use crate::{ElasticityError, Loads, SlabMotion, Structure};
use newton_krylov::inner_product::{Euclidean, InnerProduct};

/// Where a slab begins.
#[derive(Clone, Copy, Debug)]
pub struct SlabBottom<'a> {
    /// t_n
    pub time: f64,
    /// d_n, `[C0 node][component]`.
    pub displacement: &'a [f64],
    /// v_n, `[C0 node][component]`.
    pub velocity: &'a [f64],
}

/// The terms of (energy) in one slab.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlabWork {
    /// The work of the loads.
    pub load: f64,
    /// The work of the supports.
    pub support: f64,
    /// D: what the jumps take.
    pub dissipation: f64,
}

/// A structure in the slab of length `dt` above `bottom`. Fields of the slab have the layout `[time node][C0 node][component]`.
#[derive(Clone, Copy)]
pub struct StructureSlab<'a, const D: usize> {
    /// M, K and the supports.
    pub structure: &'a Structure<D>,
    /// The polynomials in time.
    pub motion: &'a SlabMotion,
    /// Where it begins.
    pub bottom: SlabBottom<'a>,
    /// Its length.
    pub dt: f64,
}

impl<const D: usize> StructureSlab<'_, D> {
    /// f(s_a) of `loads`.
    ///
    /// # Errors
    /// [`ElasticityError::Load`] if a load is not a finite number.
    pub fn forces(&self, loads: &Loads<D>) -> Result<Vec<f64>, ElasticityError> {
        let (time, length) = (self.motion.time(), self.structure.length());
        let mut forces = vec![0.0; time.order() * length];
        for (s, f) in time.nodes().iter().zip(forces.chunks_exact_mut(length)) {
            self.structure.load(loads, self.bottom.time + s * self.dt, f)?;
        }
        Ok(forces)
    }

    /// r := R(V) by (dynamics) for the loads `forces`, at fixed entries too: there it is dt w_a times the reaction of the support. Returns
    /// the size of the forces that cancel in it.
    pub fn residual(&self, forces: &[f64], v: &[f64], r: &mut [f64]) -> f64 {
        let (time, length) = (self.motion.time(), self.structure.length());
        let at_bottom = time.values(0.0);
        let (mut inertia, mut elastic, mut loads) = (vec![0.0; v.len()], vec![0.0; v.len()], forces.to_vec());
        let (mut change, mut d) = (vec![0.0; length], vec![0.0; length]);
        for a in 0..time.order() {
            let (node, weight) = (a * length..(a + 1) * length, self.dt * time.weights()[a]);
            // sum_b T_ab V_b - phi_a(0) v_n
            change.iter_mut().zip(self.bottom.velocity).for_each(|(change, v)| *change = -at_bottom[a] * v);
            accumulate(1.0, v, time.slab_matrix().row(a), &mut change);
            self.structure.apply_mass(&change, &mut inertia[node.clone()]);
            self.motion.displacement_at_node(self.dt, self.bottom.displacement, v, a, &mut d);
            self.structure.apply_stiffness(&d, &mut elastic[node.clone()]);
            elastic[node.clone()].iter_mut().for_each(|k| *k *= weight);
            loads[node].iter_mut().for_each(|f| *f *= weight);
        }
        (0..v.len()).for_each(|i| r[i] = inertia[i] + elastic[i] - loads[i]);
        [&inertia, &elastic, &loads].map(|part| Euclidean.norm(part)).into_iter().sum()
    }

    /// out := (dR/dV) w, at fixed entries too.
    pub fn product(&self, w: &[f64], out: &mut [f64]) {
        let (time, length) = (self.motion.time(), self.structure.length());
        let mut elastic = vec![0.0; length];
        for (a, out) in out.chunks_exact_mut(length).enumerate() {
            let mut direction = vec![0.0; length];
            accumulate(1.0, w, time.slab_matrix().row(a), &mut direction);
            self.structure.apply_mass(&direction, out);
            direction.fill(0.0);
            accumulate(self.dt, w, time.collocation().row(a), &mut direction);
            self.structure.apply_stiffness(&direction, &mut elastic);
            let weight = self.dt * time.weights()[a];
            out.iter_mut().zip(&elastic).for_each(|(out, k)| *out += weight * k);
        }
    }

    /// The terms of (energy) for the solution `v` with the residual `r` of (dynamics).
    pub fn work(&self, forces: &[f64], v: &[f64], r: &[f64]) -> SlabWork {
        let mut work = self.work_without_inertia(forces, v, r);
        let mut jump: Vec<f64> = self.bottom.velocity.iter().map(|v| -v).collect();
        accumulate(1.0, v, &self.motion.time().values(0.0), &mut jump);
        work.dissipation += self.structure.kinetic_energy(&jump);
        work
    }

    /// The same but for the kinetic term.
    pub(crate) fn work_without_inertia(&self, forces: &[f64], v: &[f64], r: &[f64]) -> SlabWork {
        let (time, length) = (self.motion.time(), self.structure.length());
        let at_bottom = time.values(0.0);
        let mut jump: Vec<f64> = self.bottom.displacement.iter().map(|d| -d).collect();
        let (mut work, mut d) = (SlabWork::default(), vec![0.0; length]);
        for a in 0..time.order() {
            let node = a * length..(a + 1) * length;
            work.load += self.dt * time.weights()[a] * Euclidean.dot(&forces[node.clone()], &v[node.clone()]);
            let mut reaction = vec![0.0; length];
            self.structure.at_fixed(&mut reaction, |i| r[a * length + i]);
            work.support += Euclidean.dot(&reaction, &v[node]);
            self.motion.displacement_at_node(self.dt, self.bottom.displacement, v, a, &mut d);
            accumulate(1.0, &d, &at_bottom[a..=a], &mut jump);
        }
        work.dissipation = self.structure.strain_energy(&jump);
        work
    }
}

#[cfg(test)]
mod tests;
