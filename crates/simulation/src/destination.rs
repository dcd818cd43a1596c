//! Where a run writes.

use case::AnyCase;
use std::path::{Path, PathBuf};

/// The treatment of a run that the output directory holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// It is kept: the new run is refused.
    #[default]
    Keep,
    /// It goes on from its checkpoint.
    Resume,
    /// It is replaced.
    Replace,
}

/// The output directory of a run, and the treatment of a run that is there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Destination {
    /// The output directory.
    pub directory: PathBuf,
    /// What becomes of the run that it holds.
    pub existing: Existing,
}

impl Destination {
    /// The directory that `case` names, else `runs/<case name>`.
    pub fn of(case: &AnyCase) -> Self {
        let directory = case.output_directory().map(Path::to_owned);
        let directory = directory.unwrap_or_else(|| Path::new("runs").join(&case.about().name));
        Destination { directory, existing: Existing::default() }
    }

    /// Whether the run there goes on.
    pub fn is_resumed(&self) -> bool {
        self.existing == Existing::Resume
    }
}
