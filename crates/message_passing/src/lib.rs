//! Ranks that are processes: the rank of this process, and the communication.
//!
//! [`world`] decides by the way the process was started. The feature `mpi` links MPI and adds `Mpi`. Nothing but the program depends on
//! this crate, so the feature changes no other one. With the feature `parallel-hdf5` the crate `output` does, too: it opens files on all ranks.
//!
//! ```
//! // Alone, unless mpirun has started several ranks.
//! let ranks = message_passing::world()?;
//! assert!(ranks.rank() < ranks.size());
//! # Ok::<(), message_passing::Error>(())
//! ```

#[cfg(feature = "mpi")]
mod processes;
mod world;

#[cfg(feature = "mpi")]
pub use processes::Mpi;
#[cfg(feature = "parallel-hdf5")]
pub use processes::handle_of_world;
pub use world::{Error, world};
