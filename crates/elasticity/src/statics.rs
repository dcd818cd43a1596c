//! The equilibrium of a structure under given loads and supports, without inertia.
//!
//! Loads and supports may change with time, which then numbers the load steps:
//!
//! ```text
//! R(d(t)) = f(d, t)   at free entries,      d(t) = g(t)   at fixed entries                                     (statics)
//! ```
//!
//! It holds at the time nodes of a slab. In between d is the polynomial through them and the bottom, (motion at nodes) of `slab`. Works and
//! energies are defined as in `structure_slab`, without the kinetic terms.

use crate::corrections::{self, LinearEquations, rounding};
use crate::dynamics::{CORRECTION_TOLERANCE, DynamicsReport};
use crate::large_displacement::{self, StructureEquilibrium};
use crate::shifted::Shifted;
use crate::structure_slab::{SlabBottom, StructureSlab};
use crate::{ElasticityError, Inversion, Loads, SlabMotion, Structure};
use basis::RadauTime;
use fem::Clock;
use newton_krylov::inner_product::{Euclidean, InnerProduct};

mod buckling;

pub use buckling::Stability;

/// A structure, its loads, and the preconditioner of K.
pub struct Statics<const D: usize> {
    structure: Structure<D>,
    loads: Loads<D>,
    motion: SlabMotion,
    stiffness: Shifted<D>,
    /// The scales of forces per displacement.
    scales: Vec<f64>,
}

impl<const D: usize> Statics<D> {
    /// The equilibria of `structure` under `loads` at `time_order` nodes per slab.
    ///
    /// # Errors
    /// [`ElasticityError::RigidMotion`] if too few entries are fixed; an error if a sub-cell between Gauss-Lobatto nodes
    /// is inverted.
    pub fn new(structure: Structure<D>, loads: Loads<D>, time_order: usize) -> Result<Self, ElasticityError> {
        let stiffness = structure.stiffness_at_rest()?;
        let (scales, motion) = (structure.force_scales(0.0), SlabMotion::new(RadauTime::new(time_order)));
        Ok(Statics { structure, loads, motion, stiffness, scales })
    }

    /// The structure.
    pub fn structure(&self) -> &Structure<D> {
        &self.structure
    }
    /// The polynomials of a slab.
    pub fn motion(&self) -> &SlabMotion {
        &self.motion
    }

    /// Solves (statics) at time `t`: `d` holds the prescribed displacement at fixed entries and a guess at the others. Returns the
    /// iterations.
    ///
    /// # Errors
    /// [`ElasticityError::Load`], [`ElasticityError::Stalled`], [`ElasticityError::LargeDisplacement`], or the error of a system that
    /// cannot be solved.
    pub fn equilibrium(&self, t: f64, d: &mut [f64]) -> Result<usize, ElasticityError> {
        let mut f = vec![0.0; d.len()];
        self.structure.load(&self.loads, t, &mut f)?;
        self.balance(t, &f, d)
    }

    /// The same for the loads `f` at rest.
    fn balance(&self, t: f64, f: &[f64], d: &mut [f64]) -> Result<usize, ElasticityError> {
        if self.structure.law().is_linear() && self.loads.pressures.is_empty() {
            return self.structure.balance((&self.stiffness, &self.scales), t, f, d);
        }
        let (structure, loads) = (&self.structure, &self.loads);
        let imbalance = |d: &[f64], r: &mut [f64]| self.imbalance(t, f, d, r);
        let stiffness = |d: &[f64], w: &[f64], out: &mut [f64]| {
            structure.apply_stiffness_at(d, w, out);
            structure.add_pressure_stiffness(loads, t, (d, w), -1.0, out);
        };
        // Forces at supports, too: those at free entries may all vanish at rest.
        let forces_at = |d: &[f64]| -> Result<f64, Inversion> {
            let mut r = vec![0.0; d.len()];
            imbalance(d, &mut r)?;
            Ok(Euclidean.norm(f) + Euclidean.norm(&r))
        };
        self.improve_guess(t, f, &forces_at, d);
        let mut equations = StructureEquilibrium::new((structure, &self.scales), &imbalance, &stiffness);
        Ok(large_displacement::solve(&mut equations, &forces_at, t, d)?.iterations)
    }

    /// Replaces the guess `d` by the equilibrium of the linear law if that has smaller forces. A guess that moves supports alone turns the
    /// cells there inside out.
    fn improve_guess(&self, t: f64, f: &[f64], forces_at: &dyn Fn(&[f64]) -> Result<f64, Inversion>, d: &mut [f64]) {
        let mut linear = vec![0.0; d.len()];
        self.structure.at_fixed(&mut linear, |i| d[i]);
        if linear.iter().all(|&x| x == 0.0)
            || self.structure.balance((&self.stiffness, &self.scales), t, f, &mut linear).is_err()
        {
            return;
        }
        let size = |d: &[f64]| forces_at(d).unwrap_or(f64::INFINITY);
        if size(&linear) < size(d) {
            d.copy_from_slice(&linear);
        }
    }

    /// r = R(d) - f at all entries, with follower pressures.
    fn imbalance(&self, t: f64, f: &[f64], d: &[f64], r: &mut [f64]) -> Result<(), Inversion> {
        self.structure.internal_forces(d, r)?;
        let mut loads = f.to_vec();
        self.structure.add_pressures(&self.loads, t, d, &mut loads);
        r.iter_mut().zip(&loads).for_each(|(r, f)| *r -= f);
        Ok(())
    }

    /// The equilibria at the time nodes of the slab of length `dt` above the displacement `bottom` at time `start`. `v`, `[time node][C0
    /// node][component]`, holds the prescribed displacements at fixed entries and a guess at the others; it is replaced by the
    /// velocities.
    ///
    /// # Errors
    /// As [`Self::equilibrium`].
    pub fn solve(&self, start: f64, dt: f64, bottom: &[f64], v: &mut [f64]) -> Result<DynamicsReport, ElasticityError> {
        let (time, length) = (self.motion.time(), self.structure.length());
        let (mut forces, mut residual) = (vec![0.0; v.len()], vec![0.0; v.len()]);
        let mut report = DynamicsReport { corrections: 1, ..Default::default() };
        for (a, d) in v.chunks_exact_mut(length).enumerate() {
            let (node, t) = (a * length..(a + 1) * length, start + time.nodes()[a] * dt);
            let (f, r) = (&mut forces[node.clone()], &mut residual[node]);
            self.structure.load(&self.loads, t, f)?;
            report.iterations += self.balance(t, f, d)?;
            self.imbalance(t, f, d, r)?;
            // That of the last node, the top, stays.
            report.reaction = vec![0.0; length];
            self.structure.at_fixed(&mut report.reaction, |i| r[i]);
            // Equilibrium holds at the time nodes, so follower pressures work there too.
            self.structure.add_pressures(&self.loads, t, d, f);
            r.iter_mut().for_each(|r| *r *= dt * time.weights()[a]);
        }
        self.motion.velocities(dt, bottom, v);
        // Without inertia the velocity at the bottom is not asked for.
        let bottom = SlabBottom { time: start, displacement: bottom, velocity: &[] };
        let (structure, loads, motion) = (&self.structure, &self.loads, &self.motion);
        let slab = StructureSlab { structure, loads, motion, bottom, dt, clock: Clock::running(start, dt) };
        report.work = slab.work_without_inertia(&forces, v, &residual);
        Ok(report)
    }
}

impl<const D: usize> Structure<D> {
    /// The equilibrium K d = f of a linear law at free entries; `d` holds the prescribed displacement at fixed entries and a guess at the
    /// others. Returns the CG iterations.
    ///
    /// # Errors
    /// [`ElasticityError::RigidMotion`] or [`ElasticityError::Solver`] if too few entries are fixed.
    pub fn equilibrium(&self, f: &[f64], d: &mut [f64]) -> Result<usize, ElasticityError> {
        self.balance((&self.stiffness_at_rest()?, &self.force_scales(0.0)), 0.0, f, d)
    }

    /// The preconditioner of K at rest. Without stress only a rigid motion takes no energy.
    fn stiffness_at_rest(&self) -> Result<Shifted<D>, ElasticityError> {
        self.require_held()?;
        self.shifted(0.0, Vec::new(), &[])
    }

    /// The same as `equilibrium` with the preconditioner of K and the `scales` of forces, at time `t`.
    fn balance(
        &self,
        (stiffness, scales): (&Shifted<D>, &[f64]),
        t: f64,
        f: &[f64],
        d: &mut [f64],
    ) -> Result<usize, ElasticityError> {
        let equations = LinearEquilibrium { structure: self, stiffness, scales, f };
        Ok(corrections::correct(&equations, t, d)?.iterations)
    }
}

/// f - K d = 0 at free entries.
struct LinearEquilibrium<'a, const D: usize> {
    structure: &'a Structure<D>,
    stiffness: &'a Shifted<D>,
    scales: &'a [f64],
    f: &'a [f64],
}

impl<const D: usize> LinearEquations for LinearEquilibrium<'_, D> {
    fn residual(&self, d: &[f64], r: &mut [f64]) -> Result<[f64; 2], ElasticityError> {
        self.structure.apply_stiffness(d, r);
        let forces = Euclidean.norm(r) + Euclidean.norm(self.f);
        r.iter_mut().zip(self.f).for_each(|(r, f)| *r = f - *r);
        self.structure.at_fixed(r, |_| 0.0);
        Ok([Euclidean.norm(r), forces])
    }
    /// d := d + K^{-1} r
    fn correct(&self, r: &[f64], d: &mut [f64]) -> Result<usize, ElasticityError> {
        let mut increment = vec![0.0; d.len()];
        let iterations = self.stiffness.solve(self.structure, r, &mut increment, CORRECTION_TOLERANCE)?;
        d.iter_mut().zip(&increment).for_each(|(d, increment)| *d += increment);
        Ok(iterations)
    }
    fn rounding(&self, d: &[f64]) -> f64 {
        rounding(self.scales, d)
    }
}
