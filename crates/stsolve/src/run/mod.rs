//! Runs: a checked case becomes a march, and its slabs become files.
//!
//! | module | holds |
//! |---|---|
//! | `build` | from a case to the problem of the numerics |
//! | `drive` | a run, slab by slab, for any equations |
//! | `flow_run`, `mesh_run`, `structure_run` | mesh and flow; the mesh alone; a structure |
//! | `context` | data of a run besides its march, and its end |
//! | `record` | the output of every slab |
//! | `motion_jump` | differences between a motion and the motion of the run that it continues |
//! | `occupied` | whether a run may write into its output directory |
//! | `history` | columns and rows of history.csv |
//! | `failure` | the report of a failed run |
//! | `summary` | summary.json |
//! | `fields` | fields for display |
//! | `checkpoint` | the state of a run as named arrays, and back |
//! | `openings` | the flow through inflows and outflows, and whether their conditions are made for it |
//! | `probe` | the cost of a run and the validity of its mesh, estimated beforehand |
//! | `resume` | the decision whether a run may continue from a checkpoint |
//! | `restart` | a run that starts from the result of another one |
//! | `statistics` | sums over the run |
//! | `walls` | loads of walls |

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
