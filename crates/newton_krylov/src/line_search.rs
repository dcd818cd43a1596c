//! How far to go along a Newton increment: backtracking guarded by admissibility.
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
    /// Every trial was admissible or the last one was, but the norm did not fall enough.
    #[error("the norm did not fall below {initial:e} along the increment: it is {norm:e} at step length {step_length:e}")]
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
        /// What is wrong with that state.
        source: Inadmissible,
    },
}

impl Error {
    /// The number of evaluations of G.
    pub fn trials(&self) -> usize {
        match self {
            Self::NoDecrease { trials, .. } | Self::Inadmissible { trials, .. } => *trials,
        }
    }
}

/// Finds a step a = `largest`, `largest` x shrink, ... that satisfies (decrease).
///
/// `norm_at(a)` is |G(a)|, `initial` is |G(0)|, `round_off` the level at which no decrease is asked for. A norm that is not a
/// number never satisfies (decrease).
///
/// # Errors
/// [`Error`] after `max_trials` trials, by what was wrong with the last one.
pub fn search(
    settings: &Settings,
    initial: f64,
    largest: f64,
    round_off: f64,
    mut norm_at: impl FnMut(f64) -> Result<f64, Inadmissible>,
) -> Result<Report, Error> {
    let mut step_length = largest;
    let mut trials = 1;
    loop {
        let trial = norm_at(step_length);
        if let Ok(norm) = trial {
            let decreased = norm <= (1.0 - settings.sufficient_decrease * step_length) * initial;
            if decreased || norm <= round_off {
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
