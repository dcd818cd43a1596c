//! Ranks: the processes that solve one case together.
//!
//! 1. [`Communicator`]: how ranks communicate. [`Alone`] is one rank; the ranks of [`Threads`] are threads of one process. Those that are
//!    processes are in the crate `message_passing`. [`Counting`] wraps any of them and counts what is sent.
//! 2. [`agree`]: an error of one rank becomes an error of all.
//! 3. [`Sums`]: which blocks of the mesh a rank owns, and sums over all blocks in a fixed order.
//!
//! Only numbers that are equal on all ranks may decide what a rank does next. A sum of [`Sums`] has the same bits on any number of ranks.
//!
//! A sum over six blocks has the same bits on one rank and on four:
//!
//! ```
//! use ranks::{Alone, Communicator, Sums, Threads};
//! use std::sync::Arc;
//!
//! let total = |ranks: Arc<dyn Communicator>| {
//!     let sums = Sums::new(ranks, 6);
//!     let parts: Vec<f64> = sums.own().map(|block| 0.1 * block as f64).collect();
//!     sums.total(&parts, 1)[0]
//! };
//! let alone = total(Arc::new(Alone));
//! assert!((alone - 1.5).abs() < 1e-14);
//! assert_eq!(Threads::run(4, total), [alone; 4]);
//! ```

mod agreement;
mod alone;
mod communicator;
mod counting;
mod sums;
mod threads;

pub use agreement::agree;
pub use alone::Alone;
pub use communicator::{Communicator, FileSharing};
pub use counting::{Counting, Traffic};
pub use sums::Sums;
pub use threads::Threads;
