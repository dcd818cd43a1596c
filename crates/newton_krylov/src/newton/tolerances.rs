//! When a residual is small enough.
//!
//! ```text
//! (converged)   |R| <= max(absolute, relative |R|_ref)     and, for each field k,
//!               |R_k| <= max(absolute, relative |R_k|_ref, round-off |R|_ref)
//! ```
//!
//! No field can hide behind another; but none is asked for less than the round-off of the whole.

use super::Settings;

/// The right-hand sides of (converged).
pub(super) struct Tolerances {
    /// |R|_ref
    pub(super) reference: f64,
    /// That of the total norm.
    pub(super) total: f64,
    /// That of each field.
    pub(super) fields: Vec<f64>,
    /// The norm at which no decrease is asked for any more.
    pub(super) round_off: f64,
}

impl Tolerances {
    /// From the reference norm of each field.
    pub(super) fn new(settings: &Settings, references: &[f64]) -> Self {
        let reference = references.iter().fold(0.0, |sum: f64, norm| sum.hypot(*norm));
        let round_off = settings.round_off * reference;
        let tolerance = |reference| settings.absolute_tolerance.max(settings.relative_tolerance * reference);
        Self {
            reference,
            total: tolerance(reference),
            fields: references.iter().map(|&norm| tolerance(norm).max(round_off)).collect(),
            round_off,
        }
    }

    /// (converged)
    pub(super) fn met(&self, norm: f64, field_norms: &[f64]) -> bool {
        norm <= self.total && field_norms.iter().zip(&self.fields).all(|(norm, tolerance)| norm <= tolerance)
    }

    /// The norm that a linear residual must reach for (converged): the smallest tolerance that is not met yet.
    pub(super) fn aim(&self, norm: f64, field_norms: &[f64]) -> f64 {
        let unmet = field_norms.iter().zip(&self.fields).filter(|(norm, tolerance)| norm > tolerance);
        let total = if norm > self.total { self.total } else { norm };
        unmet.fold(total, |aim, (_, &tolerance)| aim.min(tolerance))
    }
}
