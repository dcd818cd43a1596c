//! Corrections of a solution of linear equations of a structure, until only round-off is left.
//!
//! One correction would be exact if its systems were solved exactly. The residual is compared with the forces that cancel in it. Where a body has
//! moved far, these may be no larger than the rounding of stiffness times displacement. One correction is always made: a load that is small
//! beside the rounding at each node can still move the whole body, because rounding inside of the body cancels.

use crate::ElasticityError;
use newton_krylov::inner_product::{Euclidean, InnerProduct};

/// A slab is solved when its residual, relative to the forces in it, is this small ...
const TOLERANCE: f64 = 1e-12;

/// ... or when a correction leaves more than this fraction of it, so that only round-off is left.
const LEFT_BY_ROUNDING: f64 = 0.1;

/// It is an error if the residual stagnates by round-off above this.
const STALLED: f64 = 1e-5;

/// A residual below this many times its rounding, as estimated, is rounding.
pub(crate) const ROUNDINGS: f64 = 100.0;

/// Rounding of a force is about this part of stiffness times displacement.
pub(crate) const ROUNDING: f64 = 10.0 * f64::EPSILON;

/// The rounding of R(d), with the `scales` of forces per displacement.
pub(crate) fn rounding(scales: &[f64], d: &[f64]) -> f64 {
    let forces: Vec<f64> = scales.iter().zip(d).map(|(k, d)| k * d).collect();
    ROUNDING * Euclidean.norm(&forces)
}

/// Linear equations R(x) = 0 of a structure.
pub(crate) trait LinearEquations {
    /// r := R(x); returns |r| at free entries, and the size of the forces that cancel in it.
    ///
    /// # Errors
    /// Those of the forces.
    fn residual(&self, x: &[f64], r: &mut [f64]) -> Result<[f64; 2], ElasticityError>;

    /// Corrects `x` by a solve for its residual `r`; returns the iterations.
    ///
    /// # Errors
    /// Those of the solve.
    fn correct(&self, r: &[f64], x: &mut [f64]) -> Result<usize, ElasticityError>;

    /// The rounding of |R(x)|.
    fn rounding(&self, x: &[f64]) -> f64;
}

/// What corrections have cost.
#[derive(Default)]
pub(crate) struct Corrections {
    pub(crate) count: usize,
    pub(crate) iterations: usize,
}

/// Corrects the guess `x` until its residual is round-off, at `time`.
///
/// # Errors
/// [`ElasticityError::Stalled`]; those of `equations`.
pub(crate) fn correct(
    equations: &impl LinearEquations,
    time: f64,
    x: &mut [f64],
) -> Result<Corrections, ElasticityError> {
    let (mut done, mut r) = (Corrections::default(), vec![0.0; x.len()]);
    let [mut norm, mut forces] = equations.residual(x, &mut r)?;
    // Forces that vanish leave the rounding of those at the guess.
    let least = f64::EPSILON * forces;
    while norm > (TOLERANCE * forces).max(least) {
        done.iterations += equations.correct(&r, x)?;
        done.count += 1;
        let before = norm;
        [norm, forces] = equations.residual(x, &mut r)?;
        if norm > LEFT_BY_ROUNDING * before {
            break;
        }
    }
    let is_stalled = norm > (STALLED * forces).max(least) && norm > ROUNDINGS * equations.rounding(x);
    if norm.is_nan() || is_stalled {
        return Err(ElasticityError::Stalled { time, residual: norm / forces });
    }
    Ok(done)
}
