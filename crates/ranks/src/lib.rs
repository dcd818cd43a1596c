//! Ranks: the processes that solve one case together.
//!
//! 1. [`Communicator`]: how ranks talk. [`Alone`] is one rank; the ranks of [`Threads`] are threads of one process.
//! 2. [`Sums`]: which blocks of the mesh a rank owns, and sums over all blocks in a fixed order.
//!
//! Only numbers that are equal on all ranks may decide what a rank does next. A sum of [`Sums`] has the same bits on any number of ranks.

mod alone;
mod communicator;
mod sums;
mod threads;

pub use alone::Alone;
pub use communicator::Communicator;
pub use sums::Sums;
pub use threads::Threads;
