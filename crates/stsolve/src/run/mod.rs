//! Runs: a checked case becomes a march, and its slabs become files.
//!
//! | module | holds |
//! |---|---|
//! | `build` | from a case to the problem of the numerics |
//! | `drive` | the loop over slabs |
//! | `record` | what every slab leaves on disk |
//! | `fields` | fields for drawing |
//! | `checkpoint` | the state of a run as named arrays, and back |
//! | `tally` | sums over the run |

mod build;
mod checkpoint;
mod drive;
mod fields;
mod record;
mod tally;

pub use drive::{motion, run};
