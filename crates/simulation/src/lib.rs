//! Runs: a checked case becomes a march, and its slabs become files.
//!
//! This crate has no command line, prints nothing and handles no signals: a run reports to its [`Observer`].
//!
//! | module | holds |
//! |---|---|
//! | `averages` | averages over time and over phases |
//! | `build` | from a case to the problem of the numerics |
//! | `crew` | a flow on several ranks |
//! | `drive` | a run, slab by slab, for any equations |
//! | `flow_run`, `mesh_run`, `structure_run` | mesh and flow; the mesh alone; a structure |
//! | `observer` | reports of a run to its caller, and requests of the caller |
//! | `destination`, `occupied` | the output directory of a run, and whether it may write there |
//! | `session` | the set-up of a run before its first slab |
//! | `context` | data of a run besides its march, and its end |
//! | `clock` | the wall time of the parts of a run |
//! | `record` | the output of every slab |
//! | `motion_jump` | differences between a motion and the motion of the run that it continues |
//! | `history` | columns and rows of history.csv |
//! | `failure` | the report of a failed run |
//! | `error` | failures of a run |
//! | `summary` | summary.json |
//! | `checkpoint` | the state of a run as named arrays, and back |
//! | `openings` | the flow through inflows and outflows, and whether their conditions are made for it |
//! | `probe` | the cost of a run and the validity of its mesh, estimated beforehand |
//! | `memory_estimate` | the memory of a run, estimated beforehand |
//! | `resume` | the decision whether a run may continue from a checkpoint |
//! | `restart` | a run that starts from the result of another one |
//! | `statistics` | sums over the run |
//! | `surfaces` | distributions along walls |
//! | `time` | times without round-off, for messages |
//! | `probes`, `lines`, `slices` | the flow at points, along lines and in planes |
//! | `cuts` | the files of lines and slices |
//! | `walls` | loads of walls |
//!
//! A case in memory, run slab by slab:
//!
//! ```
//! use case::{AnyCase, Document};
//!
//! let text = r#"
//!     mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], periodic = ["x", "y"] } }
//!     flow = { order = 2, initial.uniform = { velocity = [0.5, 0], pressure = 1 } }
//!     time = { order = 1, end = 0.2, slabs = 2 }
//! "#;
//! let document = Document::parse("stream.toml".as_ref(), text.to_owned(), &[])?;
//! let AnyCase::Plane(case) = AnyCase::check(&document)? else { return Err("not in the plane".into()) };
//! let Some(flow) = &case.flow else { return Err("without a flow".into()) };
//! let mut march = simulation::march::<2, 4>(&case, flow)?;
//! while !march.is_done() {
//!     march.advance()?;
//! }
//! assert!((march.totals()[0] - 1.0).abs() < 1e-12, "mass is conserved");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod averages;
mod bodies;
mod body_record;
mod build;
mod checkpoint;
pub mod clock;
mod context;
mod controls;
mod crew;
mod cuts;
mod destination;
mod drive;
mod elastic_body;
mod error;
mod failure;
mod flow_run;
mod history;
mod integrals;
mod lines;
mod memory_estimate;
mod mesh_run;
mod motion_jump;
mod observer;
mod occupied;
mod opening_states;
mod openings;
mod probe;
mod probes;
mod record;
mod restart;
mod resume;
mod session;
mod slices;
mod statistics;
mod structure_run;
mod summary;
mod surfaces;
#[cfg(test)]
mod tests;
mod time;
mod walls;

pub use build::{PrescribedNode, elasticity_plan, march, mover, prescribed_nodes, structure_march};
pub use controls::check as check_controls;
pub use crew::serve;
pub use destination::{Destination, Existing};
pub use drive::{motion, run, run_on};
pub use error::Failure;
pub use memory_estimate::{MemoryEstimate, require_memory, typical_iterations};
pub use observer::{NextStep, Observer, SlabDone};
pub use opening_states::by_node;
pub use openings::{Misuse, Record as OpeningRecord, Seen as OpeningSeen, at_start as openings_at_start};
pub use probe::{MeshOverRun, ProbeError, Timing, move_over_run, time_flow};
pub use probes::{locate, values_at};
pub use restart::check as check_restart;
pub use surfaces::{Column as SurfaceColumn, columns as surface_columns, surface_name};
pub use time::rounded;
