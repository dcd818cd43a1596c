//! `stsolve run` and `stsolve motion`

use crate::cli::RunArguments;
use crate::observer::TerminalObserver;
use case::AnyCase;
use output::Summary;
use simulation::{Destination, Existing, Failure, Observer};

/// `stsolve run`
///
/// # Errors
/// As [`simulation::run`].
pub fn run(arguments: &RunArguments) -> Result<(), Failure> {
    call(arguments, "run", simulation::run)
}

/// `stsolve motion`
///
/// # Errors
/// As [`simulation::motion`].
pub fn motion(arguments: &RunArguments) -> Result<(), Failure> {
    call(arguments, "motion", simulation::motion)
}

type Simulate = fn(&AnyCase, &Destination, &dyn Observer) -> Result<Summary, Failure>;

fn call(arguments: &RunArguments, command: &'static str, simulate: Simulate) -> Result<(), Failure> {
    // The mesh of the case is made by the threads asked for, so they come first.
    set_threads(arguments)?;
    let case = AnyCase::read(&arguments.case.case, &arguments.case.set)?;
    simulate(&case, &destination(arguments, &case), &TerminalObserver::new(arguments, command)).map(drop)
}

/// Sets the number of threads for everything that follows.
fn set_threads(arguments: &RunArguments) -> Result<(), Failure> {
    let Some(threads) = arguments.threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global().map_err(Failure::bad_input)
}

/// The directory of the command line, else that of the case.
fn destination(arguments: &RunArguments, case: &AnyCase) -> Destination {
    let default = Destination::of(case);
    Destination {
        directory: arguments.output.clone().unwrap_or(default.directory),
        existing: match arguments {
            RunArguments { resume: true, .. } => Existing::Resume,
            RunArguments { force: true, .. } => Existing::Replace,
            _ => Existing::Keep,
        },
    }
}
