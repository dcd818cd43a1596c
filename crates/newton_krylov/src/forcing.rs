//! The accuracy of the linear solve of a Newton step: Eisenstat & Walker (SIAM J. Sci. Comput. 17, 1996), choice 2.
//!
//! ```text
//! (forcing)   eta = gamma_e (|R| / |R_old|)^2
//! ```

/// The settings of [`Settings::next`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// eta of the first step.
    pub initial: f64,
    /// gamma_e of (forcing), in (0, 1].
    pub gamma: f64,
    /// The smallest eta. 1e-6 gives quadratic convergence; 1e-3 costs less.
    pub minimum: f64,
    /// The smallest eta of a step that pseudo-time damps.
    pub damped_minimum: f64,
    /// The largest eta, below 1.
    pub maximum: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { initial: 0.1, gamma: 0.9, minimum: 1e-3, damped_minimum: 1e-3, maximum: 0.1 }
    }
}

/// The step before the one for which eta is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Previous {
    /// |R_old|, where that step started.
    pub norm: f64,
    /// Its eta.
    pub forcing: f64,
}

impl Settings {
    /// eta of the step that starts at |R| = `norm`, and that pseudo-time damps if it is `damped`; `tolerance` is the |R| at which Newton stops,
    /// 0 < tolerance < norm.
    ///
    /// A single good step must not tighten eta at once: eta >= gamma_e eta_old^2 while that exceeds 0.1. And no step is solved
    /// more accurately than Newton's tolerance requires: eta >= tolerance / (2 |R|).
    pub fn next(&self, norm: f64, previous: Option<Previous>, tolerance: f64, damped: bool) -> f64 {
        let eta = previous.map_or(self.initial, |old| {
            let eta = self.gamma * (norm / old.norm).powi(2);
            let memory = self.gamma * old.forcing.powi(2);
            if memory > 0.1 { eta.max(memory) } else { eta }
        });
        let minimum = if damped { self.damped_minimum } else { self.minimum };
        eta.min(self.maximum).max(minimum).max(0.5 * tolerance / norm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOOSE: Settings = Settings { initial: 0.5, gamma: 0.9, minimum: 1e-6, damped_minimum: 1e-6, maximum: 0.9 };

    fn next(settings: &Settings, norm: f64, old_norm: f64, old_forcing: f64, tolerance: f64) -> f64 {
        settings.next(norm, Some(Previous { norm: old_norm, forcing: old_forcing }), tolerance, false)
    }

    #[test]
    fn the_first_step_takes_the_initial_value() {
        assert_eq!(Settings::default().next(1.0, None, 1e-8, false), 0.1);
        assert_eq!(LOOSE.next(1.0, None, 1e-8, false), 0.5);
    }

    #[test]
    fn choice_2_is_gamma_times_the_squared_reduction() {
        approx::assert_relative_eq!(next(&LOOSE, 0.02, 1.0, 0.1, 0.0), 0.9 * 4e-4, max_relative = 1e-14);
    }

    #[test]
    fn a_single_good_step_does_not_tighten_at_once() {
        // 0.9 x 0.5^2 = 0.225 > 0.1 is remembered; 0.9 x 0.3^2 = 0.081 is not.
        approx::assert_relative_eq!(next(&LOOSE, 0.1, 1.0, 0.5, 0.0), 0.225, max_relative = 1e-14);
        approx::assert_relative_eq!(next(&LOOSE, 0.1, 1.0, 0.3, 0.0), 0.009, max_relative = 1e-14);
    }

    #[test]
    fn values_are_clamped() {
        assert_eq!(next(&Settings::default(), 0.9, 1.0, 0.1, 0.0), 0.1);
        assert_eq!(next(&Settings::default(), 1e-4, 1.0, 0.1, 0.0), 1e-3);
        assert_eq!(next(&LOOSE, 1e-4, 1.0, 0.1, 0.0), 1e-6);
    }

    #[test]
    fn damped_steps_have_a_minimum_of_their_own() {
        let previous = Some(Previous { norm: 1.0, forcing: 0.1 });
        let settings = Settings { damped_minimum: 0.02, ..Settings::default() };
        assert_eq!(settings.next(0.1, previous, 1e-8, true), 0.02);
        approx::assert_relative_eq!(settings.next(0.1, previous, 1e-8, false), 0.009, max_relative = 1e-14);
    }

    #[test]
    fn the_last_step_does_not_solve_more_exactly_than_needed() {
        assert_eq!(next(&Settings::default(), 1e-7, 1e-4, 0.1, 1e-8), 0.05);
        assert_eq!(next(&Settings::default(), 2e-8, 1e-4, 0.1, 1e-8), 0.25);
    }
}
