//! The motion and the equilibrium of a structure whose law is not linear, or whose loads follow it, by Newton's method.
//!
//! Products are exact. They are preconditioned by the systems of K at one displacement: that at the bottom of a slab, or that of the
//! Newton step where there is no inertia.

use crate::corrections::{ROUNDINGS, rounding};
use crate::modal::ModalSolver;
use crate::nonlinear::{self, ElasticEquations};
use crate::shifted::Shifted;
use crate::structure_slab::StructureSlab;
use crate::{ElasticityError, Inversion, Structure};
use newton_krylov::newton::{Error, Settings, Stall};
use newton_krylov::problem::Inadmissible;
use newton_krylov::{forcing, line_search};

/// Relative tolerance of a preconditioner that is a solve.
const PRECONDITIONER_TOLERANCE: f64 = 1e-2;

/// The residual is this small against the forces in it, or rounding.
const TOLERANCE: f64 = 1e-12;

/// An attempt that fails has converged if its residual is below this part of the forces: only rounding is left.
const ROUNDING_LEFT: f64 = 1e-11;

/// If the forces at the solution are less than this part of those at the guess, the solution is not accurate enough for them.
const SMALLER: f64 = 0.1;

/// A full step may raise the residual by this factor: by any that leaves it finite.
const LARGEST_INCREASE: f64 = 1e100;

/// Full steps end if the residual has not fallen for so many of them.
const PATIENCE: Stall = Stall { steps: 30, factor: 0.9 };

/// What Newton's method has cost.
#[derive(Default)]
pub(crate) struct Work {
    pub(crate) steps: usize,
    pub(crate) iterations: usize,
}

/// The size of the forces in the residual at x.
type ForcesAt<'a> = &'a dyn Fn(&[f64]) -> Result<f64, Inversion>;

/// Finds `x` with a residual that is small against `forces_at(x)`, the size of the forces in it, in the slab from `time`. A guess that nearly
/// inverts cells has forces far beyond those of the solution, so its scale is only the first one. Where a load ends, no force is left to compare
/// with: then the solution has forces that are rounding of those at the guess.
pub(crate) fn solve(
    equations: &mut impl ElasticEquations,
    forces_at: ForcesAt<'_>,
    time: f64,
    x: &mut [f64],
) -> Result<Work, ElasticityError> {
    let (mut work, mut forces, least) = (Work::default(), forces_at(x)?, rounding_of(equations, x));
    loop {
        solve_from(equations, (forces_at, forces), x, &mut work)
            .map_err(|error| ElasticityError::LargeDisplacement { time, source: Box::new(error) })?;
        let before = std::mem::replace(&mut forces, forces_at(x)?);
        let is_scale = forces >= SMALLER * before || forces <= least;
        if is_scale || residual_norm(equations, x) <= TOLERANCE * forces {
            return Ok(work);
        }
    }
}

/// Full steps first, and from the same guess again with a line search if they fail. A step that bends a thin body stretches it at first, and
/// may raise the residual by the square of its slenderness. The next steps take that back, where a line search would creep.
fn solve_from(
    equations: &mut impl ElasticEquations,
    (forces_at, forces): (ForcesAt<'_>, f64),
    x: &mut [f64],
    work: &mut Work,
) -> Result<(), Error> {
    let guess = x.to_vec();
    let mut attempt = |settings: Settings, x: &mut [f64]| {
        let solved = nonlinear::solve(equations, x, forces, settings);
        let report = solved.as_ref().unwrap_or_else(Error::report);
        work.steps += report.steps.len();
        work.iterations += report.krylov_iterations;
        // No step lowers a residual of rounding.
        let rounding = || forces_at(x).map_or(0.0, |forces| ROUNDING_LEFT * forces).max(rounding_of(equations, x));
        match solved {
            Err(error) if residual_norm(equations, x) > rounding() => Err(error),
            _ => Ok(()),
        }
    };
    let searching = Settings {
        relative_tolerance: TOLERANCE,
        round_off: TOLERANCE,
        max_steps: 100,
        forcing: forcing::Settings { minimum: 1e-4, ..Default::default() },
        divergence: f64::INFINITY,
        ..Default::default()
    };
    let any_finite = line_search::Settings { sufficient_decrease: -LARGEST_INCREASE, ..searching.line_search };
    let full = Settings { line_search: any_finite, stall: Some(PATIENCE), ..searching };
    attempt(full, x).or_else(|_| {
        x.copy_from_slice(&guess);
        attempt(searching, x)
    })
}

/// |R(x)|, infinite where R is not defined.
fn residual_norm(equations: &impl ElasticEquations, x: &[f64]) -> f64 {
    let mut r = vec![0.0; x.len()];
    equations.residual(x, &mut r).map_or(f64::INFINITY, |()| equations.inner_product().norm(&r))
}

/// A residual below this is rounding at `x`.
fn rounding_of(equations: &impl ElasticEquations, x: &[f64]) -> f64 {
    equations.round_off(x).map_or(0.0, |rounding| ROUNDINGS * rounding)
}

/// (dynamics) as R(V) = 0; fixed entries stay as they are.
pub(crate) struct StructureMotion<'a, const D: usize> {
    /// The slab.
    pub(crate) slab: StructureSlab<'a, D>,
    /// The loads at rest.
    pub(crate) forces: &'a [f64],
    /// The preconditioner.
    pub(crate) modal: &'a ModalSolver<D>,
    /// The scales of forces per displacement.
    pub(crate) scales: &'a [f64],
}

impl<const D: usize> ElasticEquations for StructureMotion<'_, D> {
    const FIELD: &'static str = "structure";

    fn residual(&self, v: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        self.slab.residual(self.forces, v, r)?;
        self.slab.structure.at_fixed(r, |_| 0.0);
        Ok(())
    }
    fn product(&self, v: &[f64], w: &[f64], out: &mut [f64]) {
        let _timed = tracing::trace_span!(target: "cost", "product").entered();
        self.slab.product(v, w, out);
        self.slab.structure.at_fixed(out, |i| w[i]);
    }
    fn precondition(&mut self, r: &[f64], w: &mut [f64]) {
        let _timed = tracing::trace_span!(target: "cost", "preconditioner").entered();
        w.copy_from_slice(r);
        let _ = self.modal.solve(self.slab.structure, self.slab.dt, PRECONDITIONER_TOLERANCE, w);
    }
    fn round_off(&self, v: &[f64]) -> Option<f64> {
        Some(self.slab.rounding(self.scales, v))
    }
}

/// R(d) - f = 0 at free entries; fixed ones stay as they are.
pub(crate) struct StructureEquilibrium<'a, const D: usize> {
    structure: &'a Structure<D>,
    /// The scales of forces per displacement.
    scales: &'a [f64],
    /// r := R(d) - f at `d`, on all entries.
    imbalance: Imbalance<'a>,
    /// out := the derivative of that at the first, along the second argument.
    stiffness: Product<'a>,
    /// K at the d of the Newton step.
    shifted: Option<Shifted<D>>,
}

type Imbalance<'a> = &'a dyn Fn(&[f64], &mut [f64]) -> Result<(), Inversion>;
type Product<'a> = &'a dyn Fn(&[f64], &[f64], &mut [f64]);

impl<'a, const D: usize> StructureEquilibrium<'a, D> {
    /// The equilibrium of `structure`, with the `scales` of its forces per displacement, where `imbalance`, with the derivative `stiffness`,
    /// vanishes.
    pub(crate) fn new(
        (structure, scales): (&'a Structure<D>, &'a [f64]),
        imbalance: Imbalance<'a>,
        stiffness: Product<'a>,
    ) -> Self {
        StructureEquilibrium { structure, scales, imbalance, stiffness, shifted: None }
    }
}

impl<const D: usize> ElasticEquations for StructureEquilibrium<'_, D> {
    const FIELD: &'static str = "structure";

    fn residual(&self, d: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        (self.imbalance)(d, r)?;
        self.structure.at_fixed(r, |_| 0.0);
        Ok(())
    }
    fn linearise(&mut self, d: &[f64]) {
        let _timed = tracing::trace_span!(target: "cost", "preconditioner_setup").entered();
        self.shifted = self.structure.shifted(0.0, Vec::new(), d).ok();
    }
    fn product(&self, d: &[f64], w: &[f64], out: &mut [f64]) {
        let _timed = tracing::trace_span!(target: "cost", "product").entered();
        (self.stiffness)(d, w, out);
        self.structure.at_fixed(out, |i| w[i]);
    }
    fn precondition(&mut self, r: &[f64], w: &mut [f64]) {
        let _timed = tracing::trace_span!(target: "cost", "preconditioner").entered();
        w.copy_from_slice(r);
        if let Some(shifted) = &self.shifted {
            shifted.low_order.apply(r, w);
        }
    }
    fn round_off(&self, d: &[f64]) -> Option<f64> {
        Some(rounding(self.scales, d))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// r(x) = |x - 1| + `noise`, which no step lowers below twice the noise.
    struct Noisy {
        noise: f64,
    }

    impl ElasticEquations for Noisy {
        const FIELD: &'static str = "structure";

        fn residual(&self, x: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
            r[0] = (x[0] - 1.0).abs() + self.noise;
            Ok(())
        }
        fn product(&self, _: &[f64], w: &[f64], out: &mut [f64]) {
            out.copy_from_slice(w);
        }
        fn precondition(&mut self, r: &[f64], w: &mut [f64]) {
            w.copy_from_slice(r);
        }
    }

    /// A line search that met rounding just above the tolerance was an error, although the solution was found.
    #[test]
    fn a_line_search_that_fails_at_rounding_has_converged() {
        let solve = |noise: f64| {
            let mut x = [2.0];
            solve(&mut Noisy { noise }, &|_| Ok(1.0), 0.0, &mut x).map(|_| x[0])
        };
        assert!(solve(2e-12).is_ok_and(|x| (x - 1.0).abs() < 1e-11));
        assert!(matches!(solve(1e-9), Err(ElasticityError::LargeDisplacement { .. })));
    }
}
