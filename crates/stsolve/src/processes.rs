//! This process as one of several that run a case.

use ranks::Communicator;
use std::sync::Arc;

/// Variables in which launchers of MPI pass the number of processes on this machine.
const PROCESSES_HERE: [&str; 2] = ["OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS"];

/// The exit code of a panic.
const PANIC: i32 = 101;

/// Threads of this process where it shares the machine with other ranks; None where it is alone.
pub fn threads_of_rank(communicator: &dyn Communicator) -> Option<usize> {
    if communicator.size() == 1 {
        return None;
    }
    let told = PROCESSES_HERE.iter().find_map(|name| std::env::var(name).ok()?.parse().ok());
    let processes: usize = told.unwrap_or(communicator.size());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    Some((cores / processes.max(1)).max(1))
}

/// A panic of one rank ends all of them: the others would wait for it for ever.
pub fn end_all_on_panic(communicator: &Arc<dyn Communicator>) {
    if communicator.size() == 1 {
        return;
    }
    // The hook stays until the process ends; MPI has to end before.
    let (tell, communicator) = (std::panic::take_hook(), Arc::downgrade(communicator));
    std::panic::set_hook(Box::new(move |panic| {
        tell(panic);
        if let Some(communicator) = communicator.upgrade() {
            communicator.abort(PANIC);
        }
    }));
}
