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

use crate::{ElasticSlab, ElasticityError};
use newton_krylov::inner_product::{InnerProduct, Weighted};
use newton_krylov::newton::{self, Workspace};
use newton_krylov::problem::{Field, Inadmissible, NonlinearProblem};
use newton_krylov::{forcing, pseudo_time};

/// The accuracy of the boundary position, relative to the node spacing.
const BOUNDARY_ACCURACY: f64 = 1e-9;

/// The accuracy, relative to the node spacing, below which rounding ends the solve.
const ROUND_OFF: f64 = 1e-9;

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
        let mut problem = Equilibrium::new(self, bottom, g, accuracy, guard);
        if problem.residual(v, &mut vec![0.0; v.len()]).is_err() {
            v.fill(0.0);
        }
        let settings = settings(accuracy.position);
        let report = newton::solve(&mut problem, v, Some(&[1.0]), &settings, &mut Workspace::default())
            .map_err(|error| ElasticityError::Newton { tolerance: accuracy.position, source: Box::new(error) })?;
        Ok(Work { steps: report.steps.len(), ..problem.work })
    }

    /// Whether the boundary stays where `bottom` has it, up to rounding. Then so does the mesh: it is in equilibrium, with a residual that no
    /// solve could reduce by its tolerance.
    fn boundary_rests(&self, bottom: &[f64], g: &[f64]) -> bool {
        let largest = |x: &[f64]| x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let size = largest(self.mesh.coordinates().as_flattened()) + largest(bottom);
        let rests = |g: &[f64]| {
            let mut entries = self.mesh.constrained().iter().zip(bottom).zip(g);
            entries.all(|((constrained, d), g)| !constrained || (g - d).abs() <= AT_REST * f64::EPSILON * size)
        };
        g.chunks_exact(bottom.len()).all(rests)
    }
}

/// Newton's method without pseudo-time.
fn settings(accuracy: f64) -> newton::Settings {
    newton::Settings {
        relative_tolerance: 0.0,
        absolute_tolerance: accuracy,
        round_off: ROUND_OFF,
        forcing: forcing::Settings { minimum: 1e-2, ..Default::default() },
        pseudo_time: pseudo_time::Settings { restart_inverse: 0.0, max_rejections: 0, ..Default::default() },
        ..Default::default()
    }
}

/// The mesh equations of one slab as R(V) = 0.
struct Equilibrium<'a, const D: usize> {
    slab: &'a ElasticSlab<'a, D>,
    bottom: &'a [f64],
    prescribed: &'a [f64],
    guard: Guard<'a>,
    /// The tolerance of a solve with K.
    tolerance: f64,
    fields: [Field; 1],
    weights: Weighted,
    /// The V at which R is differentiated.
    point: Vec<f64>,
    work: Work,
}

impl<'a, const D: usize> Equilibrium<'a, D> {
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
        Equilibrium {
            slab,
            bottom,
            prescribed,
            guard,
            tolerance: accuracy.solve,
            fields: [Field { name: "mesh", range: 0..prescribed.len() }],
            weights: Weighted::new(weights),
            point: vec![0.0; prescribed.len()],
            work: Work::default(),
        }
    }

    /// w = K^{-1} r. An unconverged w is still a good direction.
    fn solve(&mut self, r: &[f64], w: &mut [f64]) {
        self.work.solves += 1;
        if let Ok(reports) = self.slab.solve(r, w, self.tolerance) {
            self.work.iterations += reports.iter().map(|report| report.iterations).sum::<usize>();
        }
    }
}

impl<const D: usize> NonlinearProblem for Equilibrium<'_, D> {
    fn len(&self) -> usize {
        self.prescribed.len()
    }
    fn fields(&self) -> &[Field] {
        &self.fields
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        &self.weights
    }

    fn residual(&mut self, v: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        self.slab.residual(self.bottom, self.prescribed, v, r)?;
        (self.guard)(v)
    }

    fn linearise(&mut self, v: &[f64], _inverse_pseudo_time: &[f64]) -> Result<(), Inadmissible> {
        self.point.copy_from_slice(v);
        Ok(())
    }

    /// Satisfies the boundary conditions; all directions that follow vanish at the boundary.
    fn guess_increment(&mut self, right_side: &[f64], increment: &mut [f64]) {
        self.solve(right_side, increment);
    }

    fn jacobian_product(&mut self, direction: &[f64], out: &mut [f64]) {
        self.slab.jacobian_product(self.bottom, &self.point, direction, out);
    }

    fn add_pseudo_time(&mut self, _direction: &[f64], _out: &mut [f64]) {}

    fn precondition(&mut self, r: &[f64], out: &mut [f64]) {
        self.solve(r, out);
    }

    fn largest_step(&mut self, _v: &[f64], _increment: &[f64]) -> f64 {
        1.0
    }
}

#[cfg(test)]
mod tests;
