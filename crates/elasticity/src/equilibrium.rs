//! The equilibrium of a slab: the solution of its mesh equations.
//!
//! With a linear law one solve is exact, from any guess. With another law Newton's method starts from the guess; the best guess is the
//! extrapolated motion of the slab before. It stops at
//!
//! ```text
//! sqrt( (1/n) sum (b_i R_i / (K_ii h_i))^2 ) <= accuracy,     h: node spacing                                   (accuracy)
//! ```
//!
//! At free entries b = 1, and this is an error of position relative to the node spacing. At constrained entries b is so large that the
//! boundary is at its prescribed position to [`BOUNDARY_ACCURACY`]. The increment of the boundary enters every Newton step through
//! K_fc. A step begins with one solve with the K of the slab's bottom. If that leaves much of the residual, the exact derivative
//! at the iterate is used, preconditioned by K. No iterate has J <= 0 where the energy is integrated, or fails the guard of the
//! caller.

use crate::nonlinear::{self, ElasticEquations};
use crate::{ElasticSlab, ElasticityError};
use newton_krylov::forcing;
use newton_krylov::inner_product::{InnerProduct, Weighted, largest};
use newton_krylov::newton::Settings;
use newton_krylov::problem::Inadmissible;

/// The accuracy of the boundary position, relative to the node spacing.
const BOUNDARY_ACCURACY: f64 = 1e-9;

/// The accuracy, relative to the node spacing, below which rounding ends the solve.
const ROUND_OFF: f64 = 1e-9;

/// The relative residual of the first guess. The forces at a boundary of thin stiff cells are many digits larger than those that move soft cells.
const GUESS_TOLERANCE: f64 = 1e-10;

/// A boundary that moves by less, in units of the rounding of a position, is at rest.
const AT_REST: f64 = 8.0;

/// The accuracy of the equilibrium of a slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// The relative residual of solves with K. For a nonlinear law they only precondition, and 1e-3 is enough.
    pub solve: f64,
    /// (accuracy), for a nonlinear law.
    pub position: f64,
}

/// The cost of the equilibrium of a slab.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Newton steps; 1 for a linear law, 0 at rest.
    pub steps: usize,
    /// Solves with K for all time nodes.
    pub solves: usize,
    /// CG iterations in them.
    pub iterations: usize,
}

/// Decides whether a motion V of the mesh is admissible.
pub type Guard<'a> = &'a (dyn Fn(&[f64]) -> Result<(), Inadmissible> + 'a);

impl<const D: usize> ElasticSlab<'_, D> {
    /// Replaces the guess `v` by the velocities for which the mesh equations with the data `bottom` and `g` of [`Self::residual`] hold.
    /// `guard` is called only for a nonlinear law; a guess that it refuses is replaced by rest. Where the boundary rests, so does the mesh.
    ///
    /// # Errors
    /// As [`crate::ElasticMesh::solve`]; [`ElasticityError::Newton`] if the equilibrium is not found.
    pub fn equilibrium(
        &self,
        bottom: &[f64],
        g: &[f64],
        v: &mut [f64],
        accuracy: Accuracy,
        guard: Guard<'_>,
    ) -> Result<Work, ElasticityError> {
        if self.boundary_rests(bottom, g) {
            v.fill(0.0);
            return Ok(Work::default());
        }
        if self.mesh.law().is_linear() {
            let (mut r, mut w) = (vec![0.0; v.len()], vec![0.0; v.len()]);
            self.residual(bottom, g, v, &mut r)?;
            let reports = self.solve(&r, &mut w, accuracy.solve)?;
            v.iter_mut().zip(&w).for_each(|(v, w)| *v -= w);
            return Ok(Work { steps: 1, solves: 1, iterations: reports.iter().map(|report| report.iterations).sum() });
        }
        let mut equations = MeshEquilibrium::new(self, bottom, g, accuracy, guard);
        if equations.residual(v, &mut vec![0.0; v.len()]).is_err() {
            v.fill(0.0);
        }
        let report = nonlinear::solve(&mut equations, v, 1.0, settings(accuracy.position))
            .map_err(|error| ElasticityError::Newton { tolerance: accuracy.position, source: Box::new(error) })?;
        Ok(Work { steps: report.steps.len(), ..equations.work })
    }

    /// Whether the boundary stays where `bottom` has it, up to rounding. Then so does the mesh: it is in equilibrium, with a residual that
    /// no solve could reduce by its tolerance.
    fn boundary_rests(&self, bottom: &[f64], g: &[f64]) -> bool {
        let size_of = |x: &[f64]| largest(x.iter().map(|x| x.abs()));
        let size = size_of(self.mesh.coordinates().as_flattened()) + size_of(bottom);
        let rests = |g: &[f64]| {
            let mut entries = self.mesh.constrained().iter().zip(bottom).zip(g);
            entries.all(|((constrained, d), g)| !constrained || (g - d).abs() <= AT_REST * f64::EPSILON * size)
        };
        g.chunks_exact(bottom.len()).all(rests)
    }
}

/// Newton's method to this (accuracy).
fn settings(accuracy: f64) -> Settings {
    Settings {
        relative_tolerance: 0.0,
        absolute_tolerance: accuracy,
        round_off: ROUND_OFF,
        forcing: forcing::Settings { minimum: 1e-2, ..Default::default() },
        ..Default::default()
    }
}

/// The mesh equations of one slab as R(V) = 0.
struct MeshEquilibrium<'a, const D: usize> {
    slab: &'a ElasticSlab<'a, D>,
    bottom: &'a [f64],
    prescribed: &'a [f64],
    guard: Guard<'a>,
    /// The tolerance of a solve with K.
    tolerance: f64,
    weights: Weighted,
    work: Work,
}

impl<'a, const D: usize> MeshEquilibrium<'a, D> {
    fn new(
        slab: &'a ElasticSlab<'a, D>,
        bottom: &'a [f64],
        prescribed: &'a [f64],
        accuracy: Accuracy,
        guard: Guard<'a>,
    ) -> Self {
        let boundary = (accuracy.position / BOUNDARY_ACCURACY).max(1.0).powi(2);
        let mut weights = slab.mesh.position_weights(slab.motion.time().order());
        for weights in weights.chunks_exact_mut(bottom.len()) {
            weights
                .iter_mut()
                .enumerate()
                .filter(|(i, _)| slab.mesh.constrained()[*i])
                .for_each(|(_, w)| *w *= boundary);
        }
        MeshEquilibrium {
            slab,
            bottom,
            prescribed,
            guard,
            tolerance: accuracy.solve,
            weights: Weighted::new(weights),
            work: Work::default(),
        }
    }
}

impl<const D: usize> MeshEquilibrium<'_, D> {
    fn solve(&mut self, r: &[f64], w: &mut [f64], tolerance: f64) {
        self.work.solves += 1;
        if let Ok(reports) = self.slab.solve(r, w, tolerance) {
            self.work.iterations += reports.iter().map(|report| report.iterations).sum::<usize>();
        }
    }
}

impl<const D: usize> ElasticEquations for MeshEquilibrium<'_, D> {
    const FIELD: &'static str = "mesh";

    fn residual(&self, v: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        self.slab.residual(self.bottom, self.prescribed, v, r)?;
        (self.guard)(v)
    }
    fn product(&self, v: &[f64], w: &[f64], out: &mut [f64]) {
        self.slab.jacobian_product(self.bottom, v, w, out);
    }
    /// w := K^{-1} r
    fn precondition(&mut self, r: &[f64], w: &mut [f64]) {
        self.solve(r, w, self.tolerance);
    }
    /// Satisfies the boundary conditions; all directions that follow vanish at the boundary.
    fn guess(&mut self, r: &[f64], w: &mut [f64]) {
        self.solve(r, w, self.tolerance.min(GUESS_TOLERANCE));
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        &self.weights
    }
    fn merit(&mut self, r: &[f64]) -> f64 {
        self.weights.norm(r)
    }
}

#[cfg(test)]
mod tests;
