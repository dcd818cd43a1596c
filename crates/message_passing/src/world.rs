//! The ranks of this process, from the environment in which it was started.

use ranks::{Alone, Communicator};
use std::env;
use std::sync::Arc;

/// The reason why the ranks of this process cannot work together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// Several processes were started, and each would do the whole work.
    #[error(
        "this program was started as several ranks, but is built without MPI: cargo build --release --features mpi; \
         or start it without mpirun"
    )]
    WithoutMpi,
    /// MPI can be started once in a process.
    #[error("MPI has already been started in this process, and has ended or belongs to another library")]
    StartedBefore,
    /// The MPI library does not allow calls from several threads.
    #[error("this MPI library allows calls from the main thread only; one that offers MPI_THREAD_SERIALIZED is needed")]
    MainThreadOnly,
    /// The processes do not find each other.
    #[error(
        "{launched} ranks were started, but MPI finds {found}: the launcher belongs to another MPI than the library of this program; \
         use the mpirun of the MPI that it was built with"
    )]
    OtherMpi {
        /// As many processes the launcher has started.
        launched: usize,
        /// As many the MPI library knows.
        found: usize,
    },
}

/// The communicator of this process. It is that of MPI if a launcher of MPI has started several ranks, else [`Alone`]: a plain start
/// never initialises MPI.
///
/// MPI ends when the last copy of the communicator is dropped, which has to happen in the thread that made the first. Later calls return
/// [`Error::StartedBefore`].
///
/// # Errors
///
/// If there are several ranks and this program is built without the feature `mpi`, or MPI does not start.
pub fn world() -> Result<Arc<dyn Communicator>, Error> {
    match Launch::from(|variable| env::var(variable).ok()) {
        Launch::Ranks(1) => Ok(Arc::new(Alone)),
        launch => join(launch),
    }
}

/// How many ranks were started.
#[derive(Debug, PartialEq)]
enum Launch {
    Ranks(usize),
    /// The launcher does not say.
    Unknown,
}

impl Launch {
    /// From the environment: Open MPI, then MPICH and those that follow it, then PMIx, of which Slurm tells the number of ranks.
    fn from(variable: impl Fn(&str) -> Option<String>) -> Self {
        let number = |name| variable(name).and_then(|text| text.parse().ok());
        let known = number("OMPI_COMM_WORLD_SIZE").or_else(|| number("PMI_SIZE"));
        match (known, variable("PMIX_RANK")) {
            (Some(ranks), _) => Launch::Ranks(ranks),
            (None, None) => Launch::Ranks(1),
            (None, Some(_)) => number("SLURM_STEP_NUM_TASKS").map_or(Launch::Unknown, Launch::Ranks),
        }
    }
}

#[cfg(not(feature = "mpi"))]
fn join(_: Launch) -> Result<Arc<dyn Communicator>, Error> {
    Err(Error::WithoutMpi)
}

#[cfg(feature = "mpi")]
fn join(launch: Launch) -> Result<Arc<dyn Communicator>, Error> {
    use crate::Mpi;
    use std::sync::{Mutex, PoisonError, Weak};
    static STARTED: Mutex<Weak<Mpi>> = Mutex::new(Weak::new());

    let mut started = STARTED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(mpi) = started.upgrade() {
        return Ok(mpi);
    }
    let mpi = Mpi::start()?;
    match launch {
        Launch::Ranks(launched) if launched != mpi.size() => Err(Error::OtherMpi { launched, found: mpi.size() }),
        _ => {
            let mpi = Arc::new(mpi);
            *started = Arc::downgrade(&mpi);
            Ok(mpi)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn launch(environment: &[(&str, &str)]) -> Launch {
        Launch::from(|variable| {
            environment.iter().find(|(name, _)| *name == variable).map(|(_, value)| value.to_string())
        })
    }

    #[test]
    fn the_environment_tells_the_number_of_ranks() {
        assert_eq!(launch(&[]), Launch::Ranks(1));
        assert_eq!(launch(&[("OMPI_COMM_WORLD_SIZE", "4"), ("PMIX_RANK", "0")]), Launch::Ranks(4));
        assert_eq!(launch(&[("PMI_SIZE", "3"), ("PMI_RANK", "0")]), Launch::Ranks(3));
        assert_eq!(launch(&[("PMIX_RANK", "1"), ("SLURM_STEP_NUM_TASKS", "8")]), Launch::Ranks(8));
        assert_eq!(launch(&[("PMIX_RANK", "1")]), Launch::Unknown);
    }

    #[test]
    fn a_batch_job_of_slurm_without_mpi_is_one_rank() {
        assert_eq!(launch(&[("SLURM_PROCID", "0"), ("SLURM_NTASKS", "16")]), Launch::Ranks(1));
    }

    #[cfg(not(feature = "mpi"))]
    #[test]
    fn several_ranks_without_mpi_are_refused() {
        let error = join(Launch::Ranks(2)).err().expect("ranks that do not know each other");
        assert!(error.to_string().contains("built without MPI: cargo build --release --features mpi"));
    }
}
