//! Failures of a command: message and exit code.

use crate::case::CaseError;
use std::error::Error;
use std::io::Write;
use std::process::ExitCode;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The input is wrong; nothing was done. Exit code 2.
    #[error(transparent)]
    BadInput(anyhow::Error),
    /// The solve failed; the last good state is written. Exit code 1.
    #[error(transparent)]
    Solve(anyhow::Error),
    /// A signal stopped the run before its end; a checkpoint is written, and the user has been told. Exit code 3.
    #[error("a signal stopped the run before its end")]
    Stopped,
}

impl Failure {
    /// Bad input.
    pub fn bad_input(error: impl Into<anyhow::Error>) -> Self {
        Failure::BadInput(error.into())
    }

    /// A failed solve.
    pub fn solve(error: impl Into<anyhow::Error>) -> Self {
        Failure::Solve(error.into())
    }

    /// Prints the chain of errors, once, and returns the exit code.
    pub fn report(&self) -> ExitCode {
        let (error, code) = match self {
            Failure::BadInput(error) => (error, 2),
            Failure::Solve(error) => (error, 1),
            Failure::Stopped => return ExitCode::from(3),
        };
        // If stderr is closed, the message cannot be shown.
        let _ = writeln!(std::io::stderr(), "error: {}", chain(error.as_ref()));
        ExitCode::from(code)
    }
}

/// The message of `error` and of its causes, without those that the message above them already contains.
fn chain(error: &(dyn Error + 'static)) -> String {
    let mut text = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        let message = cause.to_string();
        if !text.contains(&message) {
            text += &format!("\n  caused by: {message}");
        }
        next = cause.source();
    }
    text
}

impl From<Box<CaseError>> for Failure {
    fn from(error: Box<CaseError>) -> Self {
        Failure::bad_input(error)
    }
}

impl From<output::OutputError> for Failure {
    fn from(error: output::OutputError) -> Self {
        use output::OutputError::{Busy, Damaged, Directory, NoCheckpoint, OtherCase, Version};
        match error {
            Directory { .. }
            | Busy { .. }
            | NoCheckpoint { .. }
            | Damaged { .. }
            | OtherCase { .. }
            | Version { .. } => Failure::bad_input(error),
            // All other errors occur while results are written.
            _ => Failure::solve(error),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_chain_says_everything_once() {
        let cause = std::io::Error::other("no space left");
        let repeated = anyhow::Error::new(cause).context("cannot write: no space left").context("the slab is lost");
        assert_eq!(chain(repeated.as_ref()), "the slab is lost\n  caused by: cannot write: no space left");
    }
}
