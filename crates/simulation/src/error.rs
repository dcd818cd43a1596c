//! How a run fails.

use case::CaseError;

/// The reason why a run, or a measurement of it, did not complete.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The input is wrong; nothing was done.
    #[error(transparent)]
    BadInput(anyhow::Error),
    /// The solve failed; the last good state is written.
    #[error(transparent)]
    Solve(anyhow::Error),
    /// The run was stopped before its end; a checkpoint is written, and the observer has the message.
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
}

impl From<Box<CaseError>> for Failure {
    fn from(error: Box<CaseError>) -> Self {
        Failure::bad_input(error)
    }
}

impl From<output::OutputError> for Failure {
    fn from(error: output::OutputError) -> Self {
        use output::OutputError::{
            Busy, Damaged, Directory, NoCheckpoint, NoDirectory, NoResult, NotHdf5, NotSealed, OtherCase, Version,
        };
        match error {
            Directory { .. }
            | Busy { .. }
            | NoCheckpoint { .. }
            | NoResult { .. }
            | NoDirectory { .. }
            | NotHdf5 { .. }
            | Damaged { .. }
            | NotSealed { .. }
            | OtherCase { .. }
            | Version { .. } => Failure::bad_input(error),
            // All other errors occur while results are written.
            _ => Failure::solve(error),
        }
    }
}
