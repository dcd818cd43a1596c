//! What a run sets up before its first slab.

use crate::clock::CostClock;
use crate::destination::Destination;
use crate::error::Failure;
use crate::observer::Observer;
use output::RunDirectory;
use std::time::Instant;

/// The output directory, locked, and the caller of the run.
pub(crate) struct Session<'a> {
    /// The output directory.
    pub(crate) directory: RunDirectory,
    /// Who called.
    pub(crate) observer: &'a dyn Observer,
    /// Where the time of the run goes.
    pub(crate) clock: CostClock,
}

impl<'a> Session<'a> {
    /// Sets up a run that has `begun`.
    ///
    /// # Errors
    /// An output directory that cannot be written or is in use, and errors of the observer.
    pub(crate) fn start(
        destination: &Destination,
        observer: &'a dyn Observer,
        begun: Instant,
    ) -> Result<Self, Failure> {
        let clock = CostClock::new(begun);
        let directory = RunDirectory::open(&destination.directory)?;
        observer.open(directory.path(), &clock).map_err(Failure::BadInput)?;
        Ok(Session { directory, observer, clock })
    }
}
