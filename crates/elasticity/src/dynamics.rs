//! The motion of a structure, slab by slab: (dynamics) of `structure_slab`. The temporal modes of `modal` solve linear equations,
//! `large_displacement` all others.

use crate::corrections::{self, Corrections, LinearEquations};
use crate::large_displacement::{self, StructureMotion};
use crate::modal::{ModalSolver, SlabSystems, nominal_length};
use crate::structure_slab::{SlabBottom, SlabWork, StructureSlab};
use crate::{ElasticityError, Loads, SlabMotion, Structure};
use basis::{RadauTime, TemporalModes};
use fem::Clock;
use newton_krylov::inner_product::{Euclidean, InnerProduct};

/// Relative tolerance of the systems of one correction, if the modes are well conditioned.
pub(crate) const CORRECTION_TOLERANCE: f64 = 1e-6;

/// A structure, its loads, and the factors of the systems of a slab.
pub struct Dynamics<const D: usize> {
    structure: Structure<D>,
    loads: Loads<D>,
    motion: SlabMotion,
    /// Relative tolerance of the systems of one correction.
    tolerance: f64,
    /// The scales of forces per displacement.
    scales: Vec<f64>,
    /// The length of most slabs.
    step: f64,
    /// The systems of the slab last solved.
    modal: ModalSolver<D>,
}

/// The report of a slab.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DynamicsReport {
    /// Corrections of the guess.
    pub corrections: usize,
    /// CG and FGMRES iterations of all modes.
    pub iterations: usize,
    /// The terms of (energy).
    pub work: SlabWork,
    /// The force of the supports on the structure, `[C0 node][component]`, zero at free entries: its mean over the slab, or without
    /// inertia its value at the top.
    pub reaction: Vec<f64>,
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
        let scales = structure.force_scales(0.0);
        Ok(Dynamics { structure, loads, motion, tolerance, scales, step, modal })
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
        report.reaction = slab.reaction(&r);
        Ok(report)
    }

    /// Whether the residual is affine.
    fn is_linear(&self) -> bool {
        self.structure.law().is_linear() && self.loads.pressures.is_empty()
    }

    /// Corrects `v` until the residual is round-off.
    fn correct(
        &self,
        slab: &StructureSlab<'_, D>,
        forces: &[f64],
        v: &mut [f64],
    ) -> Result<DynamicsReport, ElasticityError> {
        let equations = LinearMotion { dynamics: self, slab, forces };
        let Corrections { count, iterations } = corrections::correct(&equations, slab.bottom.time, v)?;
        Ok(DynamicsReport { corrections: count, iterations, ..Default::default() })
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
        let mut motion = StructureMotion { slab: *slab, forces, modal: &self.modal, scales: &self.scales };
        let large_displacement::Work { steps, iterations } =
            large_displacement::solve(&mut motion, &forces_at, slab.bottom.time, v)?;
        Ok(DynamicsReport { corrections: steps, iterations, ..Default::default() })
    }

    /// Factors the systems for a slab of length `dt` above `bottom`, unless they are those of the last slab. They do not depend on earlier
    /// slabs.
    fn factor_for(&mut self, dt: f64, bottom: SlabBottom<'_>) -> Result<(), ElasticityError> {
        let dt = nominal_length(dt, self.step);
        if self.modal.dt() != dt || !self.structure.law().is_linear() {
            let _timed = tracing::trace_span!(target: "cost", "preconditioner_setup").entered();
            let of = SlabSystems { position: bottom.displacement, ..alone(dt) };
            self.modal = ModalSolver::new(&self.structure, self.motion.time(), of)?;
        }
        Ok(())
    }
}

/// (dynamics) of a linear law in one slab.
struct LinearMotion<'a, const D: usize> {
    dynamics: &'a Dynamics<D>,
    slab: &'a StructureSlab<'a, D>,
    forces: &'a [f64],
}

impl<const D: usize> LinearEquations for LinearMotion<'_, D> {
    fn residual(&self, v: &[f64], r: &mut [f64]) -> Result<[f64; 2], ElasticityError> {
        let size = self.slab.residual(self.forces, v, r)?;
        let mut free = r.to_vec();
        self.slab.structure.at_fixed(&mut free, |_| 0.0);
        Ok([Euclidean.norm(&free), size])
    }
    /// v := v - (dR/dV)^{-1} r at free entries
    fn correct(&self, r: &[f64], v: &mut [f64]) -> Result<usize, ElasticityError> {
        let Dynamics { structure, modal, tolerance, .. } = self.dynamics;
        let mut increment = r.to_vec();
        let solved = modal.solve(structure, self.slab.dt, *tolerance, &mut increment);
        v.iter_mut().zip(&increment).for_each(|(v, w)| *v -= w);
        solved
    }
    fn rounding(&self, v: &[f64]) -> f64 {
        self.slab.rounding(&self.dynamics.scales, v)
    }
}

/// The systems of slabs of length `dt` without a fluid and without pseudo-time.
fn alone<'a, const D: usize>(dt: f64) -> SlabSystems<'a, D> {
    SlabSystems { dt, inverse_pseudo_time: 0.0, fluid: None, position: &[] }
}
