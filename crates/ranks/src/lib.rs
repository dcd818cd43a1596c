//! Ranks: the processes that solve one case together.
//!
//! 1. [`Communicator`]: how ranks talk. [`Alone`] is one rank; the ranks of [`Threads`] are threads of one process, those of `Mpi` are
//!    processes. [`world`] chooses. [`Counting`] wraps any of them and counts what is sent.
//! 2. [`agree`]: an error of one rank becomes an error of all.
//! 3. [`Sums`]: which blocks of the mesh a rank owns, and sums over all blocks in a fixed order.
//!
//! Only numbers that are equal on all ranks may decide what a rank does next. A sum of [`Sums`] has the same bits on any number of ranks.
//!
//! The feature `mpi` links MPI and adds `Mpi`.

mod agreement;
mod alone;
mod communicator;
mod counting;
#[cfg(feature = "mpi")]
mod message_passing;
mod sums;
mod threads;
mod world;

pub use agreement::agree;
pub use alone::Alone;
pub use communicator::Communicator;
pub use counting::{Counting, Traffic};
#[cfg(feature = "mpi")]
pub use message_passing::Mpi;
pub use sums::Sums;
pub use threads::Threads;
pub use world::{Error, world};
