//! Runs: a checked case becomes a march, and its slabs become files.
//!
//! | module | holds |
//! |---|---|
//! | `build` | from a case to the problem of the numerics |
//! | `drive` | mesh and flow, slab by slab |
//! | `mesh_run` | the mesh alone, slab by slab |
//! | `books` | what a run keeps beside its march, and how it ends |
//! | `record` | what every slab leaves on disk |
//! | `history` | columns and rows of history.csv |
//! | `summary` | summary.json |
//! | `fields` | fields for drawing |
//! | `checkpoint` | the state of a run as named arrays, and back |
//! | `tally` | sums over the run |

mod books;
mod build;
mod checkpoint;
mod drive;
mod fields;
mod history;
mod mesh_run;
mod record;
mod summary;
mod tally;

pub use build::mover;
pub use drive::{motion, run};
