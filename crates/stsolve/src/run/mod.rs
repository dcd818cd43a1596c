//! Runs: a checked case becomes a march, and its slabs become files.
//!
//! | module | holds |
//! |---|---|
//! | `build` | from a case to the problem of the numerics |
//! | `drive` | a run, slab by slab, whatever it solves |
//! | `flow_run`, `mesh_run`, `structure_run` | mesh and flow; the mesh alone; a structure |
//! | `books` | what a run keeps beside its march, and how it ends |
//! | `record` | what every slab leaves on disk |
//! | `history` | columns and rows of history.csv |
//! | `failure` | what a run that has failed leaves behind |
//! | `summary` | summary.json |
//! | `fields` | fields for drawing |
//! | `checkpoint` | the state of a run as named arrays, and back |
//! | `tally` | sums over the run |
//! | `walls` | what walls feel |

mod books;
mod build;
mod checkpoint;
mod drive;
mod failure;
pub(crate) mod fields;
mod flow_run;
mod history;
mod mesh_run;
mod record;
mod structure_run;
mod summary;
mod tally;
mod walls;

pub use build::{elasticity_plan, mover};
pub use drive::{motion, run};
