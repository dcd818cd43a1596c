//! Pseudo-transient continuation of several fields by one rule, switched evolution relaxation.
//!
//! ```text
//! (ser)   dtau_k = dtau_0 (|R_k0| / |R_k|)^power        for each field k
//! ```
//!
//! |R_k0| and dtau_0 belong to the last start of the rule: the start of the solve, or the last rejected step. The code stores 1/dtau_k, which
//! is zero for an undamped field.
//!
//! A residual may grow on the way to a solution: a flow that starts suddenly passes through waves. After a rejection (ser) would then keep
//! dtau as short as that one step needed. Where diffusion takes long, the residual hardly falls, and dtau would hardly grow. With a recovery
//! factor above 1, dtau grows by at least this factor in such steps:
//!
//! ```text
//! (recovery)   dtau_k >= recovery dtau_k of the step before,   where the step length was 1, after a rejection,
//!                                                              or if 0.9 |R_k| of the step before <= |R_k| <= |R_k| of the step before
//! ```

/// The factor by which a residual falls that hardly falls.
const HARDLY: f64 = 0.9;

/// The settings of [`PseudoTime`], the same for every field: a problem scales its M_k to make them comparable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// 1/dtau_0 of the first step; zero starts with plain Newton.
    pub initial_inverse: f64,
    /// 1/dtau_0 of an undamped field after a rejected step; zero never switches damping on.
    pub restart_inverse: f64,
    /// The power of (ser).
    pub power: f64,
    /// dtau_k grows or falls by at most this factor per accepted step.
    pub growth: f64,
    /// dtau_k is divided by this factor after a rejected step.
    pub shrink: f64,
    /// Damping of a field ends once |R_k| <= switch_off |R_k0|.
    pub switch_off: f64,
    /// So many rejected steps in a row are repeated with more damping; at the next one the driver gives up.
    pub max_rejections: usize,
    /// The factor of (recovery); 1 disables it.
    pub recovery: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            initial_inverse: 0.0,
            restart_inverse: 1.0,
            power: 1.0,
            growth: 10.0,
            shrink: 10.0,
            switch_off: 1e-3,
            max_rejections: 6,
            recovery: 1.0,
        }
    }
}

/// The state of (ser) during one solve.
#[derive(Clone, Debug, PartialEq)]
pub struct PseudoTime {
    settings: Settings,
    fields: Vec<FieldState>,
    inverse: Vec<f64>,
    /// |R_k| after the last step.
    norms: Vec<f64>,
    /// Whether a step was rejected.
    rejected: bool,
}

/// The start of (ser) for one field.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FieldState {
    norm: f64,
    inverse: f64,
}

impl PseudoTime {
    /// Starts the rule at the norms |R_k| of the fields. A field within its tolerance is not damped: any other norm would be many times that
    /// one, and the damping would grow.
    pub fn new(settings: Settings, field_norms: &[f64], tolerances: &[f64]) -> Self {
        let start = |(&norm, &tolerance): (&f64, &f64)| {
            let inverse = if norm > tolerance { settings.initial_inverse } else { 0.0 };
            FieldState { norm, inverse }
        };
        let fields: Vec<FieldState> = field_norms.iter().zip(tolerances).map(start).collect();
        let inverse = fields.iter().map(|field| field.inverse).collect();
        Self { settings, fields, inverse, norms: field_norms.to_vec(), rejected: false }
    }

    /// 1/dtau_k of each field.
    pub fn inverse(&self) -> &[f64] {
        &self.inverse
    }

    /// Whether any field is damped.
    pub fn is_active(&self) -> bool {
        self.inverse.iter().any(|&inverse| inverse > 0.0)
    }

    /// Applies (ser) and (recovery) after an accepted step of the given length that ended at `field_norms`.
    pub fn accept(&mut self, field_norms: &[f64], step_length: f64) {
        let Settings { power, growth, switch_off, recovery, .. } = self.settings;
        let may_recover = recovery > 1.0 && step_length == 1.0;
        for (((inverse, start), &norm), before) in
            self.inverse.iter_mut().zip(&self.fields).zip(field_norms).zip(&mut self.norms)
        {
            let hardly_falls = (HARDLY * *before..=*before).contains(&norm);
            let recovers = may_recover && (self.rejected || hardly_falls);
            *before = norm;
            let wanted = start.inverse * (norm / start.norm).powf(power);
            *inverse = if *inverse == 0.0 || norm <= switch_off * start.norm {
                0.0
            } else {
                let most = if recovers { *inverse / recovery } else { *inverse * growth };
                wanted.max(*inverse / growth).min(most)
            };
        }
    }

    /// Increases the damping after a rejected step that started at `field_norms`. A field within its tolerance is not
    /// changed.
    ///
    /// Returns whether anything changed: if not, the same step would be rejected again.
    pub fn reject(&mut self, field_norms: &[f64], tolerances: &[f64]) -> bool {
        let Settings { restart_inverse, shrink, .. } = self.settings;
        let before = self.inverse.clone();
        self.rejected = true;
        for k in 0..self.inverse.len() {
            if field_norms[k] > tolerances[k] {
                let inverse = if self.inverse[k] > 0.0 { self.inverse[k] * shrink } else { restart_inverse };
                self.inverse[k] = inverse;
                self.fields[k] = FieldState { norm: field_norms[k], inverse };
            }
        }
        self.inverse != before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DAMPED: Settings = Settings {
        initial_inverse: 8.0,
        restart_inverse: 1.0,
        power: 1.0,
        growth: 10.0,
        shrink: 4.0,
        switch_off: 1e-3,
        max_rejections: 6,
        recovery: 1.0,
    };

    /// The mesh of a slab begins in equilibrium. Its damping grew with every step that moved its boundary.
    #[test]
    fn a_field_that_is_solved_at_the_start_is_not_damped() {
        let mut rule = PseudoTime::new(DAMPED, &[1.0, 1e-12], &[1e-8, 1e-8]);
        assert_eq!(rule.inverse(), [DAMPED.initial_inverse, 0.0]);
        rule.accept(&[0.5, 1e-2], 1.0);
        assert_eq!(rule.inverse()[1], 0.0);
    }

    #[test]
    fn each_field_follows_its_own_residual() {
        let mut rule = PseudoTime::new(DAMPED, &[1.0, 1e-6], &[0.0; 2]);
        rule.accept(&[0.25, 0.5e-6], 1.0);
        assert_eq!(rule.inverse(), [2.0, 4.0]);
        rule.accept(&[0.5, 0.5e-6], 1.0);
        assert_eq!(rule.inverse(), [4.0, 4.0], "damped more where the residual grows");
    }

    #[test]
    fn the_power_sharpens_the_rule() {
        let mut rule = PseudoTime::new(Settings { power: 2.0, ..DAMPED }, &[1.0], &[0.0]);
        rule.accept(&[0.5], 1.0);
        assert_eq!(rule.inverse(), [2.0]);
    }

    #[test]
    fn a_step_grows_or_falls_by_a_limited_factor() {
        let mut rule = PseudoTime::new(DAMPED, &[1.0, 1.0], &[0.0; 2]);
        rule.accept(&[0.01, 1e4], 1.0);
        assert_eq!(rule.inverse(), [0.8, 80.0]);
    }

    #[test]
    fn a_field_is_switched_off_for_good_once_it_has_converged_far_enough() {
        let mut rule = PseudoTime::new(DAMPED, &[1.0, 1.0], &[0.0; 2]);
        rule.accept(&[1e-3, 0.5], 1.0);
        assert_eq!(rule.inverse(), [0.0, 4.0]);
        rule.accept(&[2.0, 0.5], 1.0);
        assert_eq!(rule.inverse(), [0.0, 4.0]);
        rule.accept(&[2.0, 1e-4], 1.0);
        assert!(!rule.is_active());
    }

    #[test]
    fn a_rejected_step_switches_on_or_damps_more_but_not_a_field_that_has_converged() {
        let mut rule = PseudoTime::new(Settings { initial_inverse: 0.0, ..DAMPED }, &[1.0, 1e-12], &[0.0; 2]);
        assert!(!rule.is_active());
        assert!(rule.reject(&[1.0, 1e-12], &[1e-8, 1e-8]));
        assert_eq!(rule.inverse(), [1.0, 0.0]);
        assert!(rule.reject(&[1.0, 1e-12], &[1e-8, 1e-8]));
        assert_eq!(rule.inverse(), [4.0, 0.0]);
        rule.accept(&[0.5, 1e-12], 1.0);
        assert_eq!(rule.inverse(), [2.0, 0.0], "the rule starts anew at the rejected step");
    }

    #[test]
    fn after_a_rejection_full_steps_lengthen_pseudo_time_though_the_residual_grows() {
        let mut rule = PseudoTime::new(Settings { recovery: 2.0, ..DAMPED }, &[1.0], &[0.0]);
        rule.accept(&[1.5], 1.0);
        assert_eq!(rule.inverse(), [12.0], "nothing was rejected yet");
        assert!(rule.reject(&[1.5], &[1e-8]));
        assert_eq!(rule.inverse(), [48.0]);
        rule.accept(&[3.0], 1.0);
        assert_eq!(rule.inverse(), [24.0]);
        rule.accept(&[3.0], 0.5);
        assert_eq!(rule.inverse(), [96.0], "a short step does not count");
        rule.accept(&[0.15], 1.0);
        assert_eq!(rule.inverse(), [9.6], "the residual falls faster than that");
    }

    #[test]
    fn a_rejection_that_changes_nothing_says_so() {
        let never = Settings { initial_inverse: 0.0, restart_inverse: 0.0, ..DAMPED };
        assert!(!PseudoTime::new(never, &[1.0], &[0.0]).reject(&[1.0], &[1e-8]));
        assert!(!PseudoTime::new(DAMPED, &[1e-9], &[0.0]).reject(&[1e-9], &[1e-8]));
    }
}
