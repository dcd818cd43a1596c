//! `stsolve run` and `stsolve motion`

use crate::cli::RunArguments;
use crate::logging;
use crate::observer::TerminalObserver;
use crate::processes::{end_all_on_panic, threads_of_rank};
use crate::signals::leave_to_first_process;
use case::AnyCase;
use simulation::{Destination, Existing, Failure};

/// `stsolve run`, also as one of the processes that `mpirun` starts. The first one runs the case and prints all messages.
///
/// # Errors
/// As [`simulation::run_on`].
pub fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let communicator = message_passing::world().map_err(Failure::bad_input)?;
    end_all_on_panic(&communicator);
    // The mesh of the case is made by the threads asked for, so they come first.
    let threads = arguments.threads.set(threads_of_rank(&*communicator));
    let begun = threads.and_then(|()| begin(arguments, communicator.rank()));
    let case = simulation::agree(&*communicator, begun);
    if communicator.rank() > 0 {
        // What is wrong is told by the first process.
        case.iter().for_each(|case| simulation::serve(case, &communicator));
        return Ok(());
    }
    let case = case?;
    let observer = TerminalObserver::new(arguments, "run");
    simulation::run_on(communicator, &case, &destination(arguments, &case), &observer).map(drop)
}

/// Reads the case. A process other than the first one leaves signals to that one.
fn begin(arguments: &RunArguments, rank: usize) -> Result<AnyCase, Failure> {
    let case = AnyCase::read(&arguments.case.case, &arguments.case.set)?;
    if rank > 0 {
        leave_to_first_process().map_err(Failure::bad_input)?;
    }
    if rank > 0 && arguments.log_ranks {
        let directory = destination(arguments, &case).directory;
        logging::start_of_rank(&directory, rank, !arguments.force).map_err(Failure::bad_input)?;
    }
    Ok(case)
}

/// `stsolve motion`
///
/// # Errors
/// As [`simulation::motion`]; several processes.
pub fn motion(arguments: &RunArguments) -> Result<(), Failure> {
    let communicator = message_passing::world().map_err(Failure::bad_input)?;
    match (communicator.rank(), communicator.size()) {
        (_, 1) => {}
        (0, size) => {
            return Err(Failure::bad_input(anyhow::anyhow!("the mesh alone moves in one process, not in {size}")));
        }
        // What is wrong is told by the first process.
        _ => return Ok(()),
    }
    arguments.threads.set(None)?;
    let case = AnyCase::read(&arguments.case.case, &arguments.case.set)?;
    let observer = TerminalObserver::new(arguments, "motion");
    simulation::motion(&case, &destination(arguments, &case), &observer).map(drop)
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
