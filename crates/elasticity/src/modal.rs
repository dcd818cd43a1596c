//! The systems of a slab of a structure, separated into temporal modes.
//!
//! The eigenvectors of A^{-1} separate the derivative of (dynamics) into N_t systems in space. lambda is an eigenvalue, c the transformed
//! residual, and 1/dtau the rate of a pseudo-time:
//!
//! ```text
//! ( K + s^2 M ) y = (lambda / b dt^2) c,      s^2 = lambda (lambda + dt/dtau + alpha dt) / (b dt^2),   b = 1 + beta lambda / dt   (mode)
//! ```
//!
//! with alpha and beta of a [`crate::Damping`].
//!
//! Each has its own factor, see `shifted`. If the law is not linear, K is taken at one displacement, and these systems precondition. A
//! fluid beside the structure moves with it. A preconditioner adds its mass to M,
//!
//! ```text
//! M + m_L int_G (N_i n).(N_j n) ds,     m_L = rho L / sqrt(1 + (|lambda| L / (dt c))^2)                    (layer of fluid)
//! ```
//!
//! for a layer of depth L, density rho and speed of sound c on the wet boundary G. The integral is lumped at the nodes.

use crate::shifted::Shifted;
use crate::slab::combine_nodes;
use crate::structure::Damping;
use crate::{ElasticityError, Structure};
use basis::{RadauTime, TemporalModes, is_real};
use fem::parallel::{self, Grain};
use rayon::prelude::*;

/// A layer of fluid on the boundary of a structure, with the mass of (layer of fluid).
#[derive(Clone, Debug, PartialEq)]
pub struct FluidLayer<const D: usize> {
    /// rho
    pub density: f64,
    /// c
    pub speed_of_sound: f64,
    /// L
    pub depth: f64,
    /// The lumped integral of n n^T over the wet boundary, by C0 node; see [`Structure::wet_areas`].
    pub areas: Vec<[[f64; D]; D]>,
}

impl<const D: usize> FluidLayer<D> {
    /// m_L of (layer of fluid) for motions of the rate |lambda| / dt.
    pub fn surface_density(&self, rate: f64) -> f64 {
        self.density * self.depth / (1.0 + (rate * self.depth / self.speed_of_sound).powi(2)).sqrt()
    }

    /// The mass of the layer by node.
    pub(crate) fn masses(&self, rate: f64) -> Vec<[[f64; D]; D]> {
        let density = self.surface_density(rate);
        self.areas.iter().map(|area| area.map(|row| row.map(|a| density * a))).collect()
    }
}

/// Slabs whose lengths differ by less than this, relatively, share their factors.
const SAME_LENGTH: f64 = 1e-9;

/// The length for which the systems of a slab of length `dt` are factored: `step`, the length of most slabs, if both differ by rounding
/// only.
pub fn nominal_length(dt: f64, step: f64) -> f64 {
    if (dt - step).abs() <= SAME_LENGTH * step { step } else { dt }
}

/// The data of the systems of a slab, in addition to the structure.
#[derive(Clone, Copy, Debug)]
pub struct SlabSystems<'a, const D: usize> {
    /// The length of the slab.
    pub dt: f64,
    /// 1/dtau
    pub inverse_pseudo_time: f64,
    /// The fluid beside it.
    pub fluid: Option<&'a FluidLayer<D>>,
    /// The displacement where K is taken, at rest if it is empty. A linear law does not look at it.
    pub position: &'a [f64],
}

/// The factored systems of (mode).
pub struct ModalSolver<const D: usize> {
    modes: TemporalModes,
    dt: f64,
    systems: Vec<System<D>>,
}

/// The system of one mode.
struct System<const D: usize> {
    lambda: faer::c64,
    /// b
    stiffening: faer::c64,
    /// The argument of s^2.
    theta: f64,
    /// K + |s^2| M
    shifted: Shifted<D>,
}

impl<const D: usize> ModalSolver<D> {
    /// Factors the systems of `structure` for slabs with the nodes of `time`.
    ///
    /// # Errors
    /// A sub-cell between Gauss-Lobatto nodes that is inverted.
    pub fn new(structure: &Structure<D>, time: &RadauTime, of: SlabSystems<'_, D>) -> Result<Self, ElasticityError> {
        let modes = TemporalModes::new(time);
        let system = |lambda: &faer::c64| -> Result<_, ElasticityError> {
            let Damping { mass, stiffness } = structure.damping();
            let damped = lambda + of.dt * (of.inverse_pseudo_time + mass);
            let stiffening = 1.0 + lambda * (stiffness / of.dt);
            let m = (lambda.norm() / of.dt) * (damped.norm() / of.dt) / stiffening.norm();
            let layer = of.fluid.map(|fluid| fluid.masses(lambda.norm() / of.dt)).unwrap_or_default();
            let theta = argument(*lambda) + argument(damped) - argument(stiffening);
            Ok(System { lambda: *lambda, stiffening, theta, shifted: structure.shifted(m, layer, of.position)? })
        };
        let systems = parallel::map(modes.eigenvalues.len(), Grain::Any, &|mode| system(&modes.eigenvalues[mode]));
        Ok(ModalSolver { dt: of.dt, systems: systems.into_iter().collect::<Result<_, _>>()?, modes })
    }

    /// The length of the slab that the systems are factored for.
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Replaces the residual `r` of a slab of length `dt`, `[time node][C0 node][component]`, by the solution of these systems, each to the
    /// relative `tolerance`. It is zero at fixed entries. Returns the iterations.
    ///
    /// # Errors
    /// The error of a system that cannot be solved; `r` then holds its best iterate.
    pub fn solve(
        &self,
        structure: &Structure<D>,
        dt: f64,
        tolerance: f64,
        r: &mut [f64],
    ) -> Result<usize, ElasticityError> {
        let length = structure.length();
        structure.at_fixed(r, |_| 0.0);
        combine_nodes(&self.modes.forward, r);
        let mut rest = &mut r[..];
        let mut columns = Vec::new();
        for system in &self.systems {
            let count = if is_real(system.lambda) { 1 } else { 2 };
            let (column, others) = std::mem::take(&mut rest).split_at_mut(count * length);
            columns.push((system, column));
            rest = others;
        }
        let solve = |(system, column): (&System<D>, &mut [f64])| system.solve(structure, dt, tolerance, column);
        let solved: Vec<Result<usize, _>> = columns.into_par_iter().map(solve).collect();
        combine_nodes(&self.modes.backward, r);
        solved.into_iter().sum()
    }
}

impl<const D: usize> System<D> {
    /// Replaces c by y of (mode); a complex mode has two columns, real and imaginary part. Returns the iterations.
    fn solve(
        &self,
        structure: &Structure<D>,
        dt: f64,
        tolerance: f64,
        column: &mut [f64],
    ) -> Result<usize, ElasticityError> {
        let mut factor = self.lambda / (dt * dt);
        if structure.damping().stiffness != 0.0 {
            factor /= self.stiffening;
        }
        let mut right_hand_side = column.to_vec();
        if is_real(self.lambda) {
            right_hand_side.iter_mut().for_each(|c| *c *= factor.re);
            return self.shifted.solve(structure, &right_hand_side, column, tolerance);
        }
        let (re, im) = right_hand_side.split_at_mut(column.len() / 2);
        for (re, im) in re.iter_mut().zip(im) {
            (*re, *im) = (factor.re * *re - factor.im * *im, factor.re * *im + factor.im * *re);
        }
        self.shifted.solve_complex(structure, self.theta, &right_hand_side, column, tolerance)
    }
}

fn argument(z: faer::c64) -> f64 {
    z.im.atan2(z.re)
}
