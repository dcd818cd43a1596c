//! Ranks that are processes: which of them this process is, and how they talk.
//!
//! [`world`] tells from the way the process was started. The feature `mpi` links MPI and adds `Mpi`. Nothing but the program depends on this
//! crate, so the feature changes no other one.

#[cfg(feature = "mpi")]
mod processes;
mod world;

#[cfg(feature = "mpi")]
pub use processes::Mpi;
pub use world::{Error, world};
