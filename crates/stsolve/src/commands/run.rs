//! `stsolve run` and `stsolve motion`

use crate::cli::RunArguments;
use crate::observer::TerminalObserver;
use crate::processes::{end_all_on_panic, threads_of_rank};
use crate::signals::StopFlag;
use crate::terminal::Terminal;
use case::AnyCase;
use simulation::{Destination, Existing, Failure};

/// `stsolve run`, also as one of the processes that `mpirun` starts. The first one runs the case and tells of it.
///
/// # Errors
/// As [`simulation::run_on`].
pub fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let communicator = message_passing::world().map_err(Failure::bad_input)?;
    end_all_on_panic(&communicator);
    // The mesh of the case is made by the threads asked for, so they come first.
    set_threads(arguments.threads.map(usize::from).or_else(|| threads_of_rank(&*communicator)))?;
    let case = AnyCase::read(&arguments.case.case, &arguments.case.set);
    if communicator.rank() > 0 {
        // What is wrong with a case is told by the first process. It also stops the run after a signal.
        StopFlag::default().install(&Terminal::default()).map_err(Failure::bad_input)?;
        case.iter().for_each(|case| simulation::serve(case, &communicator));
        return Ok(());
    }
    let case = case?;
    let observer = TerminalObserver::new(arguments, "run");
    simulation::run_on(communicator, &case, &destination(arguments, &case), &observer).map(drop)
}

/// `stsolve motion`
///
/// # Errors
/// As [`simulation::motion`].
pub fn motion(arguments: &RunArguments) -> Result<(), Failure> {
    set_threads(arguments.threads.map(usize::from))?;
    let case = AnyCase::read(&arguments.case.case, &arguments.case.set)?;
    let observer = TerminalObserver::new(arguments, "motion");
    simulation::motion(&case, &destination(arguments, &case), &observer).map(drop)
}

/// Sets the number of threads for everything that follows.
fn set_threads(threads: Option<usize>) -> Result<(), Failure> {
    let Some(threads) = threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().map_err(Failure::bad_input)
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
