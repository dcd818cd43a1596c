//! The motion of a structure in one slab, by discontinuous Galerkin in time.
//!
//! The velocity is a polynomial with the values V_b at the N_t right-Radau nodes s_b of the slab; it jumps at the bottom. The displacement
//! is its integral, (motion) of `slab`, and continuous. Tested with phi_a and integrated by the right-Radau rule,
//!
//! ```text
//! R_a = sum_b T_ab M V_b - phi_a(0) M v_n + dt w_a ( K d(s_a) - f(s_a) ) = 0      at free entries              (dynamics)
//! V_a = g'(s_a)                                                                  at fixed entries
//! ```
//!
//! T and w come from `basis::RadauTime`. As W^{-1} T = A^{-1}, this is the Radau IIA method: order 2 N_t - 1 at the top of a slab,
//! stable for any dt. At supports the velocity is prescribed. Prescribed positions would reduce the order of (dynamics), because the
//! reactions would follow from second differences. So the position of a support is the Radau integral of g', which has the same order.
//!
//! Only the jumps dissipate energy. With [v] = v(0+) - v_n and [d] the jump of the polynomial through the d(s_a),
//!
//! ```text
//! E_{n+1} - E_n = W - D,     E = v.Mv/2 + d.Kd/2,     D = [v].M[v]/2 + [d].K[d]/2                              (energy)
//! W = dt sum_a w_a f(s_a) . V_a  +  sum over a and fixed entries of  R_a V_a          of loads, and of supports
//! ```
//!
//! The eigenvectors of A^{-1} decouple (dynamics) into N_t systems in space. With its eigenvalues lambda and the transformed residual
//! c,
//!
//! ```text
//! ( K + (lambda/dt)^2 M ) y = (lambda/dt^2) c                                                                  (mode)
//! ```
//!
//! Each is factored once per length of slab, see `shifted`.

use crate::shifted::Shifted;
use crate::slab::combine_nodes;
use crate::{ElasticityError, Loads, SlabMotion, Structure};
use basis::{RadauTime, TemporalModes, is_real};
use newton_krylov::inner_product::{Euclidean, InnerProduct};
use rayon::prelude::*;

/// A slab is solved when its residual, relative to the forces in it, is this small ...
pub(crate) const TOLERANCE: f64 = 1e-12;
/// ... or when a correction leaves more than this fraction of it, so that only round-off is left.
pub(crate) const ROUND_OFF: f64 = 0.1;
/// It is an error if the residual stagnates by round-off above this.
pub(crate) const STALLED: f64 = 1e-5;
/// Relative tolerance of the systems of one correction, if the modes are well conditioned.
pub(crate) const CORRECTION_TOLERANCE: f64 = 1e-6;
/// Slabs whose lengths differ relatively by less than this share their factors.
const SAME_LENGTH: f64 = 1e-9;

/// A structure, its loads, and the factors of the systems of a slab.
pub struct Dynamics<const D: usize> {
    structure: Structure<D>,
    loads: Loads<D>,
    motion: SlabMotion,
    modes: TemporalModes,
    /// Relative tolerance of the systems of one correction.
    tolerance: f64,
    /// The length of most slabs.
    step: f64,
    /// The length of the slab that is factored, and for each mode the factor of K + |lambda/dt|^2 M.
    factored: (f64, Vec<Shifted<D>>),
}

/// The bottom of a slab.
#[derive(Clone, Copy, Debug)]
pub struct SlabBottom<'a> {
    /// t_n
    pub time: f64,
    /// d_n, `[C0 node][component]`.
    pub displacement: &'a [f64],
    /// v_n, `[C0 node][component]`.
    pub velocity: &'a [f64],
}

/// The report of a slab.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DynamicsReport {
    /// Corrections of the guess.
    pub corrections: usize,
    /// CG and FGMRES iterations of all modes.
    pub iterations: usize,
    /// The work of the loads.
    pub load_work: f64,
    /// The work of the supports.
    pub support_work: f64,
    /// D of (energy): the energy dissipated by the jumps.
    pub dissipation: f64,
}

/// The residual of a slab, and the size of the forces that cancel in it.
struct Residual {
    r: Vec<f64>,
    scale: f64,
}

impl<const D: usize> Dynamics<D> {
    /// The motion of `structure` under `loads` with `time_order` nodes per slab. The systems are factored for slabs of length `step`, the
    /// length of most slabs.
    ///
    /// # Errors
    /// An inverted sub-cell between Gauss-Lobatto nodes.
    pub fn new(
        structure: Structure<D>,
        loads: Loads<D>,
        time_order: usize,
        step: f64,
    ) -> Result<Self, ElasticityError> {
        let motion = SlabMotion::new(RadauTime::new(time_order));
        let modes = TemporalModes::new(motion.time());
        let tolerance = (1e-4 / modes.condition(motion.time())).clamp(1e-12, CORRECTION_TOLERANCE);
        let factored = (step, factors(&structure, &modes, step)?);
        Ok(Dynamics { structure, loads, motion, modes, tolerance, step, factored })
    }

    /// The structure.
    pub fn structure(&self) -> &Structure<D> {
        &self.structure
    }
    /// The polynomials of a slab.
    pub fn motion(&self) -> &SlabMotion {
        &self.motion
    }

    /// Solves (dynamics) for the slab of length `dt` above `bottom`. `v`, `[time node][C0 node][component]`, holds the prescribed
    /// velocities at fixed entries and a guess at the others.
    ///
    /// # Errors
    /// [`ElasticityError::Load`], [`ElasticityError::Stalled`], or the error of a system that cannot be solved; `v` then holds the last
    /// iterate.
    pub fn solve(&mut self, bottom: SlabBottom<'_>, dt: f64, v: &mut [f64]) -> Result<DynamicsReport, ElasticityError> {
        self.factor_for(dt)?;
        let forces = self.forces(bottom.time, dt)?;
        let mut report = DynamicsReport::default();
        let mut residual = self.residual(bottom, dt, &forces, v);
        let mut norm = self.free_norm(&residual.r);
        while norm > TOLERANCE * residual.scale {
            report.iterations += self.correct(&residual.r, dt, v)?;
            report.corrections += 1;
            residual = self.residual(bottom, dt, &forces, v);
            let before = std::mem::replace(&mut norm, self.free_norm(&residual.r));
            if norm > ROUND_OFF * before {
                break;
            }
        }
        if norm.is_nan() || norm > STALLED * residual.scale {
            return Err(ElasticityError::Stalled { time: bottom.time, residual: norm / residual.scale });
        }
        let at_bottom = self.motion.time().values(0.0);
        let mut velocity_jump: Vec<f64> = bottom.velocity.iter().map(|v| -v).collect();
        add_combination(&at_bottom, v, &mut velocity_jump);
        let slab = Slab { structure: &self.structure, motion: &self.motion, dt, bottom: bottom.displacement };
        slab.add_works(&forces, v, &residual.r, &mut report);
        report.dissipation += self.structure.kinetic_energy(&velocity_jump);
        Ok(report)
    }

    /// Makes the factors for slabs of length `dt` if there are none. They depend on `dt` alone, not on earlier solves.
    fn factor_for(&mut self, dt: f64) -> Result<(), ElasticityError> {
        let dt = if (dt - self.step).abs() <= SAME_LENGTH * self.step { self.step } else { dt };
        if self.factored.0 != dt {
            self.factored = (dt, factors(&self.structure, &self.modes, dt)?);
        }
        Ok(())
    }

    /// f(s_a), `[time node][C0 node][component]`.
    fn forces(&self, start: f64, dt: f64) -> Result<Vec<f64>, ElasticityError> {
        let (time, length) = (self.motion.time(), self.structure.length());
        let mut forces = vec![0.0; time.order() * length];
        for (s, f) in time.nodes().iter().zip(forces.chunks_exact_mut(length)) {
            self.structure.load(&self.loads, start + s * dt, f)?;
        }
        Ok(forces)
    }

    /// R_a by (dynamics), also at fixed entries, where it is dt w_a times the reaction of the support.
    fn residual(&self, bottom: SlabBottom<'_>, dt: f64, forces: &[f64], v: &[f64]) -> Residual {
        let (time, length) = (self.motion.time(), self.structure.length());
        let at_bottom = time.values(0.0);
        let (mut inertia, mut elastic, mut loads) = (vec![0.0; v.len()], vec![0.0; v.len()], forces.to_vec());
        let (mut change, mut d) = (vec![0.0; length], vec![0.0; length]);
        for a in 0..time.order() {
            let (node, weight) = (a * length..(a + 1) * length, dt * time.weights()[a]);
            // sum_b T_ab V_b - phi_a(0) v_n
            change.iter_mut().zip(bottom.velocity).for_each(|(change, v)| *change = -at_bottom[a] * v);
            add_combination(time.slab_matrix().row(a), v, &mut change);
            self.structure.apply_mass(&change, &mut inertia[node.clone()]);
            self.motion.displacement_at_node(dt, bottom.displacement, v, a, &mut d);
            self.structure.apply_stiffness(&d, &mut elastic[node.clone()]);
            elastic[node.clone()].iter_mut().for_each(|k| *k *= weight);
            loads[node].iter_mut().for_each(|f| *f *= weight);
        }
        let scale = [&inertia, &elastic, &loads].map(|part| Euclidean.norm(part)).into_iter().sum();
        let r = (0..v.len()).map(|i| inertia[i] + elastic[i] - loads[i]).collect();
        Residual { r, scale }
    }

    /// |R| at free entries.
    fn free_norm(&self, r: &[f64]) -> f64 {
        let mut free = r.to_vec();
        free.chunks_exact_mut(self.structure.length()).for_each(|r| self.structure.at_fixed(r, |_| 0.0));
        Euclidean.norm(&free)
    }

    /// v := v - (dR/dV)^{-1} r at free entries, mode by mode; returns the iterations.
    fn correct(&self, r: &[f64], dt: f64, v: &mut [f64]) -> Result<usize, ElasticityError> {
        let length = self.structure.length();
        let mut modes = r.to_vec();
        modes.chunks_exact_mut(length).for_each(|r| self.structure.at_fixed(r, |_| 0.0));
        combine_nodes(&self.modes.forward, &mut modes);
        let mut rest = &mut modes[..];
        let mut systems = Vec::new();
        for (&lambda, shifted) in self.modes.eigenvalues.iter().zip(&self.factored.1) {
            let columns = if is_real(lambda) { 1 } else { 2 };
            let (column, others) = std::mem::take(&mut rest).split_at_mut(columns * length);
            systems.push((lambda, shifted, column));
            rest = others;
        }
        let solve = |(lambda, shifted, column): (_, &Shifted<D>, &mut [f64])| {
            solve_mode(&self.structure, shifted, lambda, dt, self.tolerance, column)
        };
        let solved: Vec<Result<usize, _>> = systems.into_par_iter().map(solve).collect();
        combine_nodes(&self.modes.backward, &mut modes);
        v.iter_mut().zip(&modes).for_each(|(v, w)| *v -= w);
        solved.into_iter().sum()
    }
}

/// A solved slab, with or without inertia.
pub(crate) struct Slab<'a, const D: usize> {
    pub(crate) structure: &'a Structure<D>,
    pub(crate) motion: &'a SlabMotion,
    /// Its length.
    pub(crate) dt: f64,
    /// d_n
    pub(crate) bottom: &'a [f64],
}

impl<const D: usize> Slab<'_, D> {
    /// The terms of (energy) except the kinetic one, for the solution `v` with the residual `r` of (dynamics).
    pub(crate) fn add_works(&self, forces: &[f64], v: &[f64], r: &[f64], report: &mut DynamicsReport) {
        let (time, length) = (self.motion.time(), self.structure.length());
        let at_bottom = time.values(0.0);
        let mut displacement_jump: Vec<f64> = self.bottom.iter().map(|d| -d).collect();
        let mut d = vec![0.0; length];
        for a in 0..time.order() {
            let node = a * length..(a + 1) * length;
            report.load_work += self.dt * time.weights()[a] * Euclidean.dot(&forces[node.clone()], &v[node.clone()]);
            let mut reaction = vec![0.0; length];
            self.structure.at_fixed(&mut reaction, |i| r[a * length + i]);
            report.support_work += Euclidean.dot(&reaction, &v[node]);
            self.motion.displacement_at_node(self.dt, self.bottom, v, a, &mut d);
            add_combination(&at_bottom[a..=a], &d, &mut displacement_jump);
        }
        report.dissipation += self.structure.strain_energy(&displacement_jump);
    }
}

/// The factors of K + |lambda/dt|^2 M for all modes.
fn factors<const D: usize>(
    structure: &Structure<D>,
    modes: &TemporalModes,
    dt: f64,
) -> Result<Vec<Shifted<D>>, ElasticityError> {
    let factors: Vec<Result<_, _>> =
        modes.eigenvalues.par_iter().map(|lambda| structure.shifted((lambda.norm() / dt).powi(2))).collect();
    factors.into_iter().collect()
}

/// Replaces c by y of (mode); a complex mode has two columns, real and imaginary part. Returns the iterations.
fn solve_mode<const D: usize>(
    structure: &Structure<D>,
    shifted: &Shifted<D>,
    lambda: faer::c64,
    dt: f64,
    tolerance: f64,
    column: &mut [f64],
) -> Result<usize, ElasticityError> {
    let factor = lambda / (dt * dt);
    let mut right_hand_side = column.to_vec();
    if is_real(lambda) {
        right_hand_side.iter_mut().for_each(|c| *c *= factor.re);
        return shifted.solve(structure, &right_hand_side, column, tolerance);
    }
    let (re, im) = right_hand_side.split_at_mut(column.len() / 2);
    for (re, im) in re.iter_mut().zip(im) {
        (*re, *im) = (factor.re * *re - factor.im * *im, factor.re * *im + factor.im * *re);
    }
    let theta = 2.0 * lambda.im.atan2(lambda.re);
    shifted.solve_complex(structure, theta, &right_hand_side, column, tolerance)
}

/// out = out + sum_b coefficients[b] fields[b].
fn add_combination(coefficients: &[f64], fields: &[f64], out: &mut [f64]) {
    for (c, field) in coefficients.iter().zip(fields.chunks_exact(out.len())) {
        out.iter_mut().zip(field).for_each(|(out, field)| *out += c * field);
    }
}

#[cfg(test)]
mod tests;
