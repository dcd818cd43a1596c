//! The equations of a structure in one slab, by discontinuous Galerkin in time.
//!
//! The velocity is a polynomial with the values V_b at the N_t right-Radau nodes s_b of the slab and jumps at its bottom; the displacement
//! is its integral, (motion at nodes) of `slab`, and continuous. With phi_a tested and integrated by the right-Radau rule,
//!
//! ```text
//! R_a = sum_b T_ab M V_b - phi_a(0) M v_n + dt omega_a ( R(d(s_a)) + C V_a - f(s_a) ) - I_a = 0     at free entries  (dynamics)
//! V_a = g'(s_a) + c                                                                            at fixed entries
//! ```
//!
//! I_a is the impulse of follower pressures, see `pressure_impulse`.
//!
//! T and omega are the matrix and the weights of `basis::RadauTime`. As diag(omega)^{-1} T = Phi^{-1}, this is the Radau IIA method. It has
//! the order 2 N_t - 1 at the top of a slab and is stable for any dt. Supports prescribe the velocity. Prescribed positions would cost
//! (dynamics) its order, because the reactions would follow from second differences. The constant c takes the Radau quadrature of g', of the
//! same order, to the position g at the top of the slab. The caller computes V_a.
//!
//! Only dampers and jumps take energy. E_strain is the strain energy, [v] = v(0+) - v_n, and [d] is the jump at the bottom of the
//! polynomial through the d(s_a):
//!
//! ```text
//! E_tot(t_n+1) - E_tot(t_n) = E_load - E_damp - E_num,     E_tot = v . M v / 2 + E_strain(d)                         (energy)
//! E_load = sum_a ( dt omega_a f(s_a) + I_a ) . V_a + sum_(a, fixed) R_a V_a    of loads, and of supports
//! E_damp = dt sum_a omega_a V_a . C V_a
//! E_num = [v] . M [v] / 2 + dt sum_a omega_a R(d(s_a)) . V_a - ( E_strain(d_{n+1}) - E_strain(d_n) )
//! ```
//!
//! The last difference is [d].K[d]/2 for a linear law, and of the order 2 N_t - 1 for others.

mod pressure_impulse;

use crate::corrections::{ROUNDING, rounding};
use crate::slab::accumulate;
use crate::{ElasticityError, Inversion, Loads, SlabMotion, Structure};
use fem::Clock;
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
    /// E_damp: the energy that dampers take.
    pub damped: f64,
    /// E_num: the energy that jumps take.
    pub dissipation: f64,
}

/// A structure in the slab of length `dt` above `bottom`. Fields of the slab have the layout `[time node][C0 node][component]`.
#[derive(Clone, Copy)]
pub struct StructureSlab<'a, const D: usize> {
    /// M, R and the supports.
    pub structure: &'a Structure<D>,
    /// The loads on it.
    pub loads: &'a Loads<D>,
    /// The polynomials in time.
    pub motion: &'a SlabMotion,
    /// Where it begins.
    pub bottom: SlabBottom<'a>,
    /// Its length.
    pub dt: f64,
    /// The times of the loads.
    pub clock: Clock,
}

impl<const D: usize> StructureSlab<'_, D> {
    /// The loads f(s_a) that do not follow the displacement: all except follower pressures.
    ///
    /// # Errors
    /// [`ElasticityError::Load`] if a load is not a finite number.
    pub fn forces(&self) -> Result<Vec<f64>, ElasticityError> {
        let length = self.structure.length();
        let mut forces = vec![0.0; self.motion.time().order() * length];
        for (a, f) in forces.chunks_exact_mut(length).enumerate() {
            self.structure.load(self.loads, self.time_of(a), f)?;
        }
        Ok(forces)
    }

    fn time_of(&self, a: usize) -> f64 {
        self.clock.time(self.motion.time().nodes()[a])
    }

    /// r := R(V) by (dynamics) for the loads `forces` of [`Self::forces`], at fixed entries too: there it is dt omega_a times the reaction
    /// of the support. Returns the size of the forces that cancel in it.
    ///
    /// # Errors
    /// [`Inversion`] where the law has no stress; `r` then has no meaning.
    pub fn residual(&self, forces: &[f64], v: &[f64], r: &mut [f64]) -> Result<f64, Inversion> {
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
            self.structure.internal_forces(&d, &mut elastic[node.clone()])?;
            self.structure.add_damping(&d, &v[node.clone()], &mut elastic[node.clone()]);
            elastic[node.clone()].iter_mut().for_each(|k| *k *= weight);
            loads[node].iter_mut().for_each(|f| *f *= weight);
        }
        self.add_pressure_impulses(v, &mut loads);
        (0..v.len()).for_each(|i| r[i] = inertia[i] + elastic[i] - loads[i]);
        Ok([&inertia, &elastic, &loads].map(|part| Euclidean.norm(part)).into_iter().sum())
    }

    /// The rounding of R(V), with the `scales` of forces per displacement: that of stiffness times displacement, and that of mass times velocity.
    pub(crate) fn rounding(&self, scales: &[f64], v: &[f64]) -> f64 {
        let (time, length) = (self.motion.time(), self.structure.length());
        let (mut d, mut momentum) = (vec![0.0; length], vec![0.0; length]);
        let of_node = |a: usize| {
            let at_node = &v[a * length..(a + 1) * length];
            let speeds: Vec<f64> =
                self.bottom.velocity.iter().zip(at_node).map(|(below, v)| below.abs() + v.abs()).collect();
            self.structure.apply_mass(&speeds, &mut momentum);
            self.motion.displacement_at_node(self.dt, self.bottom.displacement, v, a, &mut d);
            let elastic = self.dt * time.weights()[a] * rounding(scales, &d);
            elastic.powi(2) + (ROUNDING * Euclidean.norm(&momentum)).powi(2)
        };
        (0..time.order()).map(of_node).sum::<f64>().sqrt()
    }

    /// out := (dR/dV)(V) w, at fixed entries too.
    pub fn product(&self, v: &[f64], w: &[f64], out: &mut [f64]) {
        let (time, length) = (self.motion.time(), self.structure.length());
        let (mut elastic, mut d, mut along) = (vec![0.0; length], vec![0.0; length], vec![0.0; length]);
        for (a, out) in out.chunks_exact_mut(length).enumerate() {
            let (node, weight) = (a * length..(a + 1) * length, self.dt * time.weights()[a]);
            along.fill(0.0);
            accumulate(1.0, w, time.slab_matrix().row(a), &mut along);
            self.structure.apply_mass(&along, out);
            self.motion.displacement_at_node(self.dt, self.bottom.displacement, v, a, &mut d);
            along.fill(0.0);
            accumulate(self.dt, w, time.collocation().row(a), &mut along);
            self.structure.apply_stiffness_at(&d, &along, &mut elastic);
            self.structure.add_damping_product((&d, &v[node.clone()]), (&along, &w[node]), &mut elastic);
            out.iter_mut().zip(&elastic).for_each(|(out, k)| *out += weight * k);
        }
        self.subtract_impulse_product(v, w, out);
    }

    /// The terms of (energy) for the solution `v` with the residual `r` of (dynamics).
    pub fn work(&self, forces: &[f64], v: &[f64], r: &[f64]) -> SlabWork {
        let mut work = self.work_without_inertia(forces, v, r);
        let mut jump: Vec<f64> = self.bottom.velocity.iter().map(|v| -v).collect();
        accumulate(1.0, v, &self.motion.time().values(0.0), &mut jump);
        work.dissipation += self.structure.kinetic_energy(&jump);
        let mut impulses = vec![0.0; v.len()];
        self.add_pressure_impulses(v, &mut impulses);
        work.load += Euclidean.dot(&impulses, v);
        work
    }

    /// The same without inertia and impulses of follower pressures.
    pub(crate) fn work_without_inertia(&self, forces: &[f64], v: &[f64], r: &[f64]) -> SlabWork {
        let (time, length) = (self.motion.time(), self.structure.length());
        let (mut work, mut d) = (SlabWork::default(), vec![0.0; length]);
        for a in 0..time.order() {
            let (node, weight) = (a * length..(a + 1) * length, self.dt * time.weights()[a]);
            let velocity = &v[node.clone()];
            self.motion.displacement_at_node(self.dt, self.bottom.displacement, v, a, &mut d);
            work.load += weight * Euclidean.dot(&forces[node], velocity);
            let mut reaction = vec![0.0; length];
            self.structure.at_fixed(&mut reaction, |i| r[a * length + i]);
            work.support += Euclidean.dot(&reaction, velocity);
            let mut damping = vec![0.0; length];
            self.structure.add_damping(&d, velocity, &mut damping);
            work.damped += weight * Euclidean.dot(&damping, velocity);
        }
        work.dissipation = if self.structure.law().is_linear() { self.energy_of_jump(v) } else { self.excess_work(v) };
        work
    }

    /// The mean force of the supports on the structure over the slab, sum_a R_a / dt at fixed entries and zero elsewhere, for the residual
    /// `r` of (dynamics). The phi_a add up to 1, so this force closes the balance of momentum of the slab.
    pub fn reaction(&self, r: &[f64]) -> Vec<f64> {
        let (mut sum, mut reaction) = (vec![0.0; self.structure.length()], vec![0.0; self.structure.length()]);
        accumulate(1.0 / self.dt, r, &vec![1.0; self.motion.time().order()], &mut sum);
        self.structure.at_fixed(&mut reaction, |i| sum[i]);
        reaction
    }

    /// [d].K[d]/2
    fn energy_of_jump(&self, v: &[f64]) -> f64 {
        let at_bottom = self.motion.time().values(0.0);
        let mut jump: Vec<f64> = self.bottom.displacement.iter().map(|d| -d).collect();
        let mut d = vec![0.0; jump.len()];
        for a in 0..at_bottom.len() {
            self.motion.displacement_at_node(self.dt, self.bottom.displacement, v, a, &mut d);
            accumulate(1.0, &d, &at_bottom[a..=a], &mut jump);
        }
        self.structure.strain_energy(&jump)
    }

    /// dt sum_a omega_a R(d(s_a)) . V_a - ( E_strain(d_{n+1}) - E_strain(d_n) )
    fn excess_work(&self, v: &[f64]) -> f64 {
        let (time, bottom) = (self.motion.time(), self.bottom.displacement);
        let (mut work, mut d, mut forces) = (0.0, vec![0.0; bottom.len()], vec![0.0; bottom.len()]);
        for (a, v_a) in v.chunks_exact(bottom.len()).enumerate() {
            self.motion.displacement_at_node(self.dt, bottom, v, a, &mut d);
            if self.structure.internal_forces(&d, &mut forces).is_err() {
                return f64::NAN;
            }
            work += self.dt * time.weights()[a] * Euclidean.dot(&forces, v_a);
        }
        // The last node is the top.
        work - (self.structure.strain_energy(&d) - self.structure.strain_energy(bottom))
    }
}

#[cfg(test)]
mod tests;
