//! Runs: a checked case becomes a march, and its slabs become files.
//!
//! | module | holds |
//! |---|---|
//! | `build` | from a case to the problem of the numerics |
//! | `drive` | a run, slab by slab, whatever it solves |
//! | `flow_run`, `mesh_run`, `structure_run` | mesh and flow; the mesh alone; a structure |
//! | `context` | what a run keeps beside its march, and how it ends |
//! | `record` | what every slab leaves on disk |
//! | `motion_jump` | how a motion differs from that of the run that it continues |
//! | `occupied` | whether a run may write into its output directory |
//! | `history` | columns and rows of history.csv |
//! | `failure` | what a run that has failed leaves behind |
//! | `summary` | summary.json |
//! | `fields` | fields for drawing |
//! | `checkpoint` | the state of a run as named arrays, and back |
//! | `openings` | what passes inflows and outflows, and whether their conditions are made for it |
//! | `probe` | what a run will cost, and whether its mesh will hold, found out beforehand |
//! | `resume` | whether a run may continue the one that left a checkpoint |
//! | `restart` | a run that starts where another one stands |
//! | `statistics` | sums over the run |
//! | `walls` | what walls feel |

mod build;
mod checkpoint;
mod context;
mod drive;
mod failure;
pub(crate) mod fields;
mod flow_run;
mod history;
mod mesh_run;
mod motion_jump;
mod occupied;
pub(crate) mod openings;
mod probe;
mod record;
mod restart;
mod resume;
mod statistics;
mod structure_run;
mod summary;
mod walls;

pub use build::{PrescribedNode, elasticity_plan, mover, prescribed_nodes};
pub use drive::{motion, run};
pub use probe::{MeshOverRun, ProbeError, Timing, move_over_run, time_flow};
pub use restart::check as check_restart;
