//! The set-up of a command that computes, before the first slab.

use crate::case::About;
use crate::cli::RunArguments;
use crate::clock::Clock;
use crate::failure::Failure;
use crate::logging;
use crate::signals::StopFlag;
use crate::terminal::Terminal;
use output::RunDirectory;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The output directory, locked; the log and the signal handlers of this process.
#[derive(Debug)]
pub struct Session {
    /// The output directory.
    pub directory: RunDirectory,
    /// stderr.
    pub terminal: Terminal,
    /// Whether the run has been asked to stop.
    pub stop: StopFlag,
    /// The clock of its parts.
    pub clock: Clock,
}

impl Session {
    /// Sets up a run that has `begun`. `directory` is the one given in the case, if any.
    ///
    /// # Errors
    /// An output directory that cannot be written or is in use, or handlers that the system refuses.
    pub fn start(
        arguments: &RunArguments,
        about: &About,
        directory: Option<&Path>,
        begun: Instant,
    ) -> Result<Self, Failure> {
        let (terminal, stop, clock) = (Terminal::default(), StopFlag::default(), Clock::new(begun));
        let directory = RunDirectory::open(&output_directory(arguments, about, directory))?;
        logging::start(directory.path(), !arguments.force, arguments.verbosity, &terminal, &clock)
            .map_err(Failure::bad_input)?;
        stop.install(&terminal).map_err(Failure::bad_input)?;
        Ok(Session { directory, terminal, stop, clock })
    }
}

/// Sets the number of threads for everything that follows.
///
/// # Errors
/// If the system refuses to start them.
pub fn set_threads(arguments: &RunArguments) -> Result<(), Failure> {
    let Some(threads) = arguments.threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global().map_err(Failure::bad_input)
}

/// From the command line, or else from the case, or else `runs/<case name>`.
pub fn output_directory(arguments: &RunArguments, about: &About, directory: Option<&Path>) -> PathBuf {
    let chosen = arguments.output.clone().or_else(|| directory.map(Path::to_owned));
    chosen.unwrap_or_else(|| Path::new("runs").join(&about.name))
}
