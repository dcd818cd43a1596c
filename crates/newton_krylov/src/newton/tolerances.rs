//! The convergence criterion.
//!
//! ```text
//! (converged)   |R| <= max(absolute, relative |R|_ref)     and, for each field k,
//!               |R_k| <= max(absolute, relative |R_k|_ref, round-off |R|_ref)
//! ```
//!
//! Each field must converge by itself, but no field needs a residual below the round-off of the whole system. Once steps make no
//! more progress, the rounding that the problem estimates counts as well.

use super::Settings;

/// The right-hand sides of (converged).
pub(super) struct Tolerances {
    /// |R|_ref
    pub(super) reference: f64,
    /// The bound of the total norm.
    pub(super) total: f64,
    /// The bound of each field.
    pub(super) fields: Vec<f64>,
    /// The norm below which no decrease is required.
    pub(super) round_off: f64,
    /// The rounding of each field at the iterate as the problem estimates it, once it was asked; zero if it does not know.
    pub(super) rounding: Option<Vec<f64>>,
}

impl Tolerances {
    /// Tolerances for the reference norms of the fields.
    pub(super) fn new(settings: &Settings, references: &[f64]) -> Self {
        let reference = total(references);
        let round_off = settings.round_off * reference;
        let tolerance = |reference| settings.absolute_tolerance.max(settings.relative_tolerance * reference);
        Self {
            reference,
            total: tolerance(reference),
            fields: references.iter().map(|&norm| tolerance(norm).max(round_off)).collect(),
            round_off,
            rounding: None,
        }
    }

    /// The next iterate has another rounding: a displacement that grows from zero, for example.
    pub(super) fn forget_rounding(&mut self) {
        self.rounding = None;
    }

    /// The norm below which no decrease is required, from the rounding of each field that `ask` returns. `ask` is called once for an
    /// iterate.
    pub(super) fn floor(&mut self, ask: impl FnOnce() -> Option<Vec<f64>>) -> f64 {
        let fields = self.fields.len();
        let rounding = self.rounding.get_or_insert_with(|| ask().unwrap_or_else(|| vec![0.0; fields]));
        self.round_off.max(total(rounding))
    }

    /// The norm of the rounding of all fields, if the problem was asked and has an estimate.
    pub(super) fn rounding_norm(&self) -> Option<f64> {
        self.rounding.as_ref().map(|fields| total(fields)).filter(|&norm| norm > 0.0)
    }

    /// (converged), or not converged by rounding alone. The rounding must be known.
    pub(super) fn met_but_for_rounding(&self, norm: f64, field_norms: &[f64]) -> bool {
        let Some(rounding) = &self.rounding else { return false };
        let mut fields = field_norms.iter().zip(&self.fields).zip(rounding);
        norm <= self.total.max(total(rounding))
            && fields.all(|((norm, tolerance), rounding)| *norm <= tolerance.max(*rounding))
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

/// The norm of all fields together.
fn total(field_norms: &[f64]) -> f64 {
    field_norms.iter().fold(0.0, |sum: f64, norm| sum.hypot(*norm))
}
