//! The solution of the equilibrium, for several right-hand sides.

use super::ElasticMesh;
use crate::ElasticityError;
use crate::solver::Inverse;
use newton_krylov::cg;
use newton_krylov::inner_product::{Euclidean, InnerProduct, axpy, largest};
use newton_krylov::operator::LinearSystem;
use rayon::prelude::*;

/// CG iterations after which a solve gives up: ten times the worst case.
const MAX_ITERATIONS: usize = 500;

/// The largest number of passes of a direct solve: the first one and its refinements.
const MAX_PASSES: i32 = 4;

/// The relative residual that a direct solve must reach: a larger one is an error.
const DIRECT_TOLERANCE: f64 = 1e-8;

/// The rounding error of a sum of forces at a node, in units of the rounding of its largest term.
const ROUNDING: f64 = 4.0;

/// Work space of one solve with CG.
pub(super) struct SolveWork {
    right_hand_side: Vec<f64>,
    solution: Vec<f64>,
    cg: cg::Workspace,
}

impl SolveWork {
    fn new(length: usize) -> Self {
        SolveWork { right_hand_side: vec![0.0; length], solution: vec![0.0; length], cg: cg::Workspace::default() }
    }
}

impl<const D: usize> ElasticMesh<D> {
    /// Solves (equilibrium) for the forces `f`, whose constrained entries are ignored. An iterative solver
    /// reaches |residual| <= `tolerance` |f_f - K_fc d_c|. A direct solver reaches that error in `d`, or as near to it
    /// as round-off allows. `d` holds the prescribed displacement at constrained entries and, for iterative solvers, a
    /// guess at the others.
    ///
    /// # Errors
    /// [`ElasticityError::Solver`]; `d` then holds the last iterate.
    pub fn solve(&self, f: &[f64], d: &mut [f64], tolerance: f64) -> Result<cg::Report, ElasticityError> {
        debug_assert_eq!((f.len(), d.len()), (self.length(), self.length()));
        self.solve_one(Some(f), d, tolerance)
    }

    /// Extends the displacement at constrained entries to the others: K_ff d_f = -K_fc d_c. `d` holds a guess at free entries.
    ///
    /// An increment of the boundary position reaches the mesh only in this way. A boundary that moves alone would invert the cells
    /// next to it.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn extend(&self, d: &mut [f64], tolerance: f64) -> Result<cg::Report, ElasticityError> {
        self.solve_one(None, d, tolerance)
    }

    /// [`Self::solve`] for vectors one after the other, `[right-hand side][C0 node][component]`, with a report for each. A direct solver
    /// treats all of them in one pass, CG side by side.
    ///
    /// # Errors
    /// The error of the first right-hand side with an error.
    pub fn solve_all(&self, f: &[f64], d: &mut [f64], tolerance: f64) -> Result<Vec<cg::Report>, ElasticityError> {
        debug_assert_eq!((f.len(), d.len() % self.length()), (d.len(), 0));
        self.solve_equilibrium(Some(f), d, tolerance)
    }

    /// z_f = P^{-1} r_f, z_c = 0, with the prepared inverse, which is exact for a direct solver.
    pub fn precondition(&self, r: &[f64], z: &mut [f64]) {
        if let Inverse::LowOrder(low_order) = &self.inverse {
            return low_order.apply(r, z);
        }
        z.copy_from_slice(r);
        self.at_constrained(z, |_| 0.0);
        self.inverse.solve(self.operator.batches(), z);
    }

    fn solve_one(&self, f: Option<&[f64]>, d: &mut [f64], tolerance: f64) -> Result<cg::Report, ElasticityError> {
        Ok(self.solve_equilibrium(f, d, tolerance)?[0])
    }

    fn solve_equilibrium(
        &self,
        f: Option<&[f64]>,
        d: &mut [f64],
        tolerance: f64,
    ) -> Result<Vec<cg::Report>, ElasticityError> {
        if self.inverse.is_exact() {
            return self.solve_directly(f, d, tolerance);
        }
        let solve = |(side, d)| self.solve_iteratively(f.map(|f| self.side(f, side)), d, tolerance);
        let reports: Vec<_> = match &self.inverse {
            // Messages go one after the other.
            Inverse::Substructures(_) => d.chunks_exact_mut(self.length()).enumerate().map(solve).collect(),
            _ => d.par_chunks_exact_mut(self.length()).enumerate().map(solve).collect(),
        };
        reports.into_iter().collect()
    }

    /// Right-hand side number `side` of several.
    fn side<'a>(&self, f: &'a [f64], side: usize) -> &'a [f64] {
        &f[side * self.length()..][..self.length()]
    }

    /// Repeats d := d + K_ff^{-1} r, r = f - K d, from d_f = 0, until the tolerance is met. Every pass gains the same number of digits.
    fn solve_directly(
        &self,
        f: Option<&[f64]>,
        d: &mut [f64],
        tolerance: f64,
    ) -> Result<Vec<cg::Report>, ElasticityError> {
        d.chunks_exact_mut(self.length()).for_each(|d| self.at_free(d, |_| 0.0));
        let mut r = vec![0.0; d.len()];
        let start = self.residuals(f, d, &mut r);
        let mut norms = start.clone();
        for _ in 0..passes(self.pass_error, tolerance) {
            self.inverse.solve(self.operator.batches(), &mut r);
            axpy(1.0, &r, d);
            norms = self.residuals(f, d, &mut r);
        }
        let reports = start.iter().zip(&norms);
        let reports =
            reports.map(|(&initial_norm, &final_norm)| cg::Report { iterations: 0, initial_norm, final_norm });
        let sides = d.chunks_exact(self.length());
        reports.zip(sides).map(|(report, d)| accepted(report, tolerance, self.rounding(d))).collect()
    }

    /// The rounding error of K d. If boundary displacements cancel in K d, only rounding is left.
    fn rounding(&self, d: &[f64]) -> f64 {
        let forces: Vec<f64> = self.diagonal().iter().zip(d).map(|(k, d)| k * d).collect();
        ROUNDING * f64::EPSILON * Euclidean.norm(&forces)
    }

    /// The relative error of one pass of the factor, measured by a solve with the known solution d = x. It is near round-off in well-shaped
    /// meshes. It is larger where neighbouring cells differ in stiffness by ten orders of magnitude, although their residual is small.
    pub(super) fn measure_pass_error(&self) -> f64 {
        let mut expected = self.coordinates.as_flattened().to_vec();
        self.at_constrained(&mut expected, |_| 0.0);
        let mut found = vec![0.0; self.length()];
        self.apply_free(&expected, &mut found);
        self.inverse.solve(self.operator.batches(), &mut found);
        let size_of = |vector: &[f64]| largest(vector.iter().map(|x| x.abs()));
        let size = size_of(&expected);
        axpy(-1.0, &expected, &mut found);
        if size > 0.0 { size_of(&found) / size } else { 0.0 }
    }

    /// r = (f - K d)_f for every right-hand side; returns the norms.
    fn residuals(&self, f: Option<&[f64]>, d: &[f64], r: &mut [f64]) -> Vec<f64> {
        let sides = d.chunks_exact(self.length()).zip(r.chunks_exact_mut(self.length())).enumerate();
        let residual = |(side, (d, r)): (usize, (&[f64], &mut [f64]))| {
            self.apply(d, r);
            self.subtract_from(f.map(|f| self.side(f, side)), r);
            Euclidean.norm(r)
        };
        sides.map(residual).collect()
    }

    fn solve_iteratively(
        &self,
        f: Option<&[f64]>,
        d: &mut [f64],
        tolerance: f64,
    ) -> Result<cg::Report, ElasticityError> {
        let mut work = self.solves.take(|| SolveWork::new(self.length()));
        let SolveWork { right_hand_side, solution, cg } = &mut work;
        self.right_hand_side(f, d, solution, right_hand_side);
        solution.copy_from_slice(d);
        self.at_constrained(solution, |_| 0.0);
        if right_hand_side.iter().all(|&b| b == 0.0) {
            // A tolerance relative to zero cannot be met from a nonzero guess.
            solution.fill(0.0);
        }
        let settings =
            cg::Settings { relative_tolerance: tolerance, max_iterations: MAX_ITERATIONS, ..Default::default() };
        let result = cg::solve(&mut FreeNodes(self), right_hand_side, solution, &settings, cg);
        self.at_free(d, |i| solution[i]);
        self.solves.give(work);
        Ok(result?)
    }

    /// b = f_f - K_fc d_c at free entries, 0 at the others.
    fn right_hand_side(&self, f: Option<&[f64]>, d: &[f64], boundary: &mut [f64], b: &mut [f64]) {
        boundary.copy_from_slice(d);
        self.at_free(boundary, |_| 0.0);
        self.apply(boundary, b);
        self.subtract_from(f, b);
    }

    /// b = f - b at free entries, 0 at the others; without forces, f = 0.
    fn subtract_from(&self, f: Option<&[f64]>, b: &mut [f64]) {
        for (i, b) in b.iter_mut().enumerate() {
            *b = f.map_or(0.0, |f| f[i]) - *b;
        }
        self.at_constrained(b, |_| 0.0);
    }
}

/// The least number of passes that reach `tolerance`, if each leaves the fraction `pass_error` of the error before it.
fn passes(pass_error: f64, tolerance: f64) -> i32 {
    (1..MAX_PASSES).find(|&passes| pass_error.powi(passes) <= tolerance).unwrap_or(MAX_PASSES)
}

/// The report of a direct solve that has reached its tolerance, or the `rounding` of its terms.
fn accepted(report: cg::Report, tolerance: f64, rounding: f64) -> Result<cg::Report, ElasticityError> {
    if report.final_norm <= (tolerance.max(DIRECT_TOLERANCE) * report.initial_norm).max(rounding) {
        Ok(report)
    } else {
        Err(cg::Error::MaxIterations(report).into())
    }
}

/// K_ff and its preconditioner, on vectors that vanish at constrained entries.
struct FreeNodes<'a, const D: usize>(&'a ElasticMesh<D>);

impl<const D: usize> LinearSystem for FreeNodes<'_, D> {
    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        self.0.apply_free(x, y);
    }
    fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        self.0.precondition(r, z);
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        &Euclidean
    }
}
