//! The motion of a structure, slab by slab: (dynamics) of `structure_slab`. The temporal modes of `modal` solve linear equations,
//! `large_displacement` all others.

use crate::large_displacement::{self, StructureMotion};
use crate::modal::{ModalSolver, SlabSystems, nominal_length};
use crate::structure_slab::{SlabBottom, SlabWork, StructureSlab};
use crate::{ElasticityError, Loads, SlabMotion, Structure};
use basis::{RadauTime, TemporalModes};
use fem::Clock;
use newton_krylov::inner_product::{Euclidean, InnerProduct};

/// A slab is solved when its residual, relative to the forces in it, is this small ...
pub(crate) const TOLERANCE: f64 = 1e-12;
/// ... or when a correction leaves more than this fraction of it, so that only round-off is left.
pub(crate) const ROUND_OFF: f64 = 0.1;
/// It is an error if the residual stagnates by round-off above this.
pub(crate) const STALLED: f64 = 1e-5;
/// Forces below this many times their rounding are rounding: those in a body that moves as a rigid one.
pub(crate) const ROUNDINGS: f64 = 100.0;
/// Relative tolerance of the systems of one correction, if the modes are well conditioned.
pub(crate) const CORRECTION_TOLERANCE: f64 = 1e-6;

/// A structure, its loads, and the factors of the systems of a slab.
pub struct Dynamics<const D: usize> {
    structure: Structure<D>,
    loads: Loads<D>,
    motion: SlabMotion,
    /// Relative tolerance of the systems of one correction.
    tolerance: f64,
    /// The length of most slabs.
    step: f64,
    /// The systems of the slab last solved.
    modal: ModalSolver<D>,
}

/// The report of a slab.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DynamicsReport {
    /// Corrections of the guess.
    pub corrections: usize,
    /// CG and FGMRES iterations of all modes.
    pub iterations: usize,
    /// The terms of (energy).
    pub work: SlabWork,
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
        let condition = TemporalModes::new(motion.time()).condition(motion.time());
        let tolerance = (1e-4 / condition).clamp(1e-12, CORRECTION_TOLERANCE);
        let modal = ModalSolver::new(&structure, motion.time(), alone(step))?;
        Ok(Dynamics { structure, loads, motion, tolerance, step, modal })
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
    /// [`ElasticityError::Load`], [`ElasticityError::Stalled`], [`ElasticityError::LargeDisplacement`], or the error of a system that
    /// cannot be solved; `v` then holds the last iterate.
    pub fn solve(&mut self, bottom: SlabBottom<'_>, dt: f64, v: &mut [f64]) -> Result<DynamicsReport, ElasticityError> {
        self.factor_for(dt, bottom)?;
        let (structure, loads, motion) = (&self.structure, &self.loads, &self.motion);
        let slab = StructureSlab { structure, loads, motion, bottom, dt, clock: Clock::running(bottom.time, dt) };
        let forces = slab.forces()?;
        let mut report =
            if self.is_linear() { self.correct(&slab, &forces, v)? } else { self.find(&slab, &forces, v)? };
        let mut r = vec![0.0; v.len()];
        slab.residual(&forces, v, &mut r)?;
        report.work = slab.work(&forces, v, &r);
        Ok(report)
    }

    /// Whether the residual is affine.
    fn is_linear(&self) -> bool {
        self.structure.law().is_linear() && self.loads.pressures.is_empty()
    }

    /// Corrects `v` until the residual is round-off: one correction would be exact if the modes were solved exactly.
    fn correct(
        &self,
        slab: &StructureSlab<'_, D>,
        forces: &[f64],
        v: &mut [f64],
    ) -> Result<DynamicsReport, ElasticityError> {
        let (mut report, mut r) = (DynamicsReport::default(), vec![0.0; v.len()]);
        let mut scale = slab.residual(forces, v, &mut r)?;
        let mut norm = self.free_norm(&r);
        // Forces that vanish leave the rounding of those at the guess.
        let least = f64::EPSILON * scale;
        while norm > (TOLERANCE * scale).max(least) && scale > ROUNDINGS * slab.rounding(v) {
            report.iterations += self.correct_once(&r, slab.dt, v)?;
            report.corrections += 1;
            scale = slab.residual(forces, v, &mut r)?;
            let before = std::mem::replace(&mut norm, self.free_norm(&r));
            if norm > ROUND_OFF * before {
                break;
            }
        }
        if norm.is_nan() || norm > (STALLED * scale).max(least).max(ROUNDINGS * slab.rounding(v)) {
            return Err(ElasticityError::Stalled { time: slab.bottom.time, residual: norm / scale });
        }
        Ok(report)
    }

    /// Finds `v` by Newton's method.
    fn find(
        &self,
        slab: &StructureSlab<'_, D>,
        forces: &[f64],
        v: &mut [f64],
    ) -> Result<DynamicsReport, ElasticityError> {
        let forces_at = |v: &[f64]| slab.residual(forces, v, &mut vec![0.0; v.len()]);
        if forces_at(v).is_err() {
            // The velocities at the bottom would turn cells inside out before the top.
            let guess = v.to_vec();
            v.fill(0.0);
            slab.structure.at_fixed(v, |i| guess[i]);
        }
        let mut motion = StructureMotion { slab: *slab, forces, modal: &self.modal };
        let large_displacement::Work { steps, iterations } =
            large_displacement::solve(&mut motion, &forces_at, slab.bottom.time, v)?;
        Ok(DynamicsReport { corrections: steps, iterations, ..Default::default() })
    }

    /// Factors the systems for a slab of length `dt` above `bottom`, unless they are those of the last slab. They do not depend on earlier
    /// slabs.
    fn factor_for(&mut self, dt: f64, bottom: SlabBottom<'_>) -> Result<(), ElasticityError> {
        let dt = nominal_length(dt, self.step);
        if self.modal.dt() != dt || !self.structure.law().is_linear() {
            let of = SlabSystems { position: bottom.displacement, ..alone(dt) };
            self.modal = ModalSolver::new(&self.structure, self.motion.time(), of)?;
        }
        Ok(())
    }

    /// |R| at free entries.
    fn free_norm(&self, r: &[f64]) -> f64 {
        let mut free = r.to_vec();
        self.structure.at_fixed(&mut free, |_| 0.0);
        Euclidean.norm(&free)
    }

    /// v := v - (dR/dV)^{-1} r at free entries; returns the iterations.
    fn correct_once(&self, r: &[f64], dt: f64, v: &mut [f64]) -> Result<usize, ElasticityError> {
        let mut increment = r.to_vec();
        let solved = self.modal.solve(&self.structure, dt, self.tolerance, &mut increment);
        v.iter_mut().zip(&increment).for_each(|(v, w)| *v -= w);
        solved
    }
}

/// The systems of slabs of length `dt` without a fluid and without pseudo-time.
fn alone<'a, const D: usize>(dt: f64) -> SlabSystems<'a, D> {
    SlabSystems { dt, inverse_pseudo_time: 0.0, fluid: None, position: &[] }
}
