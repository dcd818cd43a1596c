//! The step length along a Newton increment: backtracking guarded by admissibility.
//!
//! ```text
//! (decrease)   |G(a)| <= (1 - c a) |G(0)|     or     |G(a)| <= round-off
//! ```

use crate::problem::Inadmissible;

/// The settings of [`search`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// c of (decrease).
    pub sufficient_decrease: f64,
    /// The factor between one trial step and the next.
    pub shrink: f64,
    /// The number of trials after which the search fails.
    pub max_trials: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { sufficient_decrease: 1e-4, shrink: 0.5, max_trials: 12 }
    }
}

/// The accepted step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// a
    pub step_length: f64,
    /// |G(a)|
    pub norm: f64,
    /// The number of evaluations of G.
    pub trials: usize,
    /// False if |G(a)| was accepted only because it is at the level of round-off.
    pub decreased: bool,
}

/// No step was accepted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The last trial was admissible, but the norm did not fall enough.
    #[error(
        "the merit norm of the residual did not fall below {initial:e} along the increment: it is {norm:e} at step length {step_length:e}"
    )]
    NoDecrease {
        /// |G(0)|
        initial: f64,
        /// |G(a)| of the last trial.
        norm: f64,
        /// a of the last trial.
        step_length: f64,
        /// The number of evaluations of G.
        trials: usize,
    },
    /// The last, shortest trial was inadmissible.
    #[error("even at step length {step_length:e} the state is not admissible")]
    Inadmissible {
        /// a of the last trial.
        step_length: f64,
        /// The number of evaluations of G.
        trials: usize,
        /// Why that state is inadmissible.
        source: Inadmissible,
    },
}

/// Finds a step a = `largest`, `largest` x shrink, ... that satisfies (decrease).
///
/// `norm_at(a)` is |G(a)| and `initial` is |G(0)|. `round_off()` is the level below which no decrease is required; it is called only
/// after a trial without a decrease. A norm that is not a number never satisfies (decrease).
///
/// # Errors
/// [`Error`] after `max_trials` trials, according to the last one.
pub fn search(
    settings: &Settings,
    initial: f64,
    largest: f64,
    mut round_off: impl FnMut() -> f64,
    mut norm_at: impl FnMut(f64) -> Result<f64, Inadmissible>,
) -> Result<Report, Error> {
    let mut step_length = largest;
    let mut trials = 1;
    loop {
        let trial = norm_at(step_length);
        if let Ok(norm) = trial {
            let decreased = norm <= (1.0 - settings.sufficient_decrease * step_length) * initial;
            if decreased || norm.is_finite() && norm <= round_off() {
                return Ok(Report { step_length, norm, trials, decreased });
            }
        }
        if trials >= settings.max_trials {
            return Err(match trial {
                Ok(norm) => Error::NoDecrease { initial, norm, step_length, trials },
                Err(source) => Error::Inadmissible { step_length, trials, source },
            });
        }
        step_length *= settings.shrink;
        trials += 1;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const SETTINGS: Settings = Settings { sufficient_decrease: 1e-4, shrink: 0.5, max_trials: 4 };

    fn inadmissible() -> Inadmissible {
        Inadmissible { quantity: "density".into(), value: -1.0, location: "in cell 3".into() }
    }

    #[test]
    fn the_largest_step_is_tried_first_and_taken_if_it_is_good() {
        let report = search(&SETTINGS, 1.0, 0.7, || 0.0, |a| Ok(1.0 - a)).unwrap();
        assert_eq!(report, Report { step_length: 0.7, norm: 1.0 - 0.7, trials: 1, decreased: true });
    }

    #[test]
    fn steps_are_halved_until_the_norm_falls() {
        // 1 - a + 8 a^3 exceeds 1 for a > 0.354.
        let report = search(&SETTINGS, 1.0, 1.0, || 0.0, |a| Ok((1.0 - a).abs() + 8.0 * a * a * a)).unwrap();
        assert_eq!((report.step_length, report.trials), (0.25, 3));
    }

    #[test]
    fn a_decrease_that_is_not_sufficient_is_none() {
        let flat = |a: f64| Ok(1.0 - 0.5e-4 * a);
        assert!(matches!(search(&SETTINGS, 1.0, 1.0, || 0.0, flat), Err(Error::NoDecrease { trials: 4, .. })));
        let steep = |a: f64| Ok(1.0 - 2e-4 * a);
        assert_eq!(search(&SETTINGS, 1.0, 1.0, || 0.0, steep).unwrap().step_length, 1.0);
    }

    #[test]
    fn inadmissible_states_and_norms_that_are_not_numbers_shorten_the_step() {
        let guarded = |a: f64| match a {
            a if a > 0.6 => Err(inadmissible()),
            a if a > 0.3 => Ok(f64::NAN),
            a => Ok(1.0 - a),
        };
        assert_eq!(search(&SETTINGS, 1.0, 1.0, || 0.0, guarded).unwrap().step_length, 0.25);
    }

    #[test]
    fn at_round_off_no_decrease_is_asked_for() {
        let report = search(&SETTINGS, 1e-14, 1.0, || 1e-13, |_| Ok(3e-14)).unwrap();
        assert_eq!((report.step_length, report.decreased), (1.0, false));
    }

    #[test]
    fn failures_name_the_last_trial() {
        let error = search(&SETTINGS, 1.0, 1.0, || 0.0, |a| Ok(1.0 + a)).unwrap_err();
        assert_eq!(error, Error::NoDecrease { initial: 1.0, norm: 1.125, step_length: 0.125, trials: 4 });
        let error = search(&SETTINGS, 1.0, 1.0, || 0.0, |_| Err(inadmissible())).unwrap_err();
        assert_eq!(error, Error::Inadmissible { step_length: 0.125, trials: 4, source: inadmissible() });
    }
}
