//! Runs: a checked case becomes a march, and its slabs become files.
//!
//! This crate has no command line, prints nothing and handles no signals: a run reports to its [`Observer`].
//!
//! | module | holds |
//! |---|---|
//! | `averages` | averages over time and over phases |
//! | `bench` | kernels of a run, to be measured |
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
//! | `openings` | the flow through inflows and outflows, and whether their conditions are suited to it |
//! | `boundary_values`, `frame_checks` | values of formulas in a slab that failed; checks of rotating frames |
//! | `bodies`, `elastic_body` | bodies that the flow moves; the structure as one of them |
//! | `body_checks`, `body_record` | what is doubtful about rigid bodies; what bodies have done so far |
//! | `controls` | numbers in formulas that the run changes |
//! | `steady_search`, `fallback` | the search for the steady flow; how a run goes on in a more robust way |
//! | `steady_warnings` | what that search cannot determine |
//! | `preflight` | what is known of a run before it starts, for callers of any dimension |
//! | `probe` | the cost of a run and the validity of its mesh, estimated beforehand |
//! | `memory_estimate` | the memory of a run, estimated beforehand |
//! | `resume` | the decision whether a run may continue from a checkpoint |
//! | `restart` | a run that starts from the result of another one |
//! | `statistics` | sums over the run |
//! | `surfaces` | distributions along walls |
//! | `probes`, `lines`, `slices` | the flow at points, along lines and in planes |
//! | `cuts` | the files of lines and slices |
//! | `walls`, `integrals`, `opening_states` | loads of walls, integrals over the flow, mean states of openings |
//! | `cells` | numbers of the flow in some cells, wherever they are |
//! | `errors` | errors of the flow where the exact flow is known |
//! | `stored_field`, `cell_finder` | fields of a result file at points |
//! | `nodal` | values at the nodes of one cell |
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
//!
//! An observer of one's own, which keeps a column of history.csv and the flow, and stops the run:
//!
//! ```
//! use simulation::{Destination, Existing, Failure, Observer, RunState};
//! use std::sync::{Arc, Mutex};
//!
//! /// The mass and the flow at the end of every slab, up to the third.
//! #[derive(Default)]
//! struct Keep(Mutex<Vec<(f64, Arc<Vec<f64>>)>>);
//!
//! impl Observer for Keep {
//!     fn state(&self, now: &RunState<'_>) {
//!         let (Some(mass), Some(past)) = (now.value("mass"), &now.state.past) else { return };
//!         self.0.lock().expect("no other thread fails").push((mass, past.u.clone()));
//!     }
//!     fn is_stop_requested(&self) -> bool {
//!         self.0.lock().is_ok_and(|kept| kept.len() == 3)
//!     }
//! }
//!
//! # let text = r#"
//! #     mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], periodic = ["x", "y"] } }
//! #     flow = { order = 2, initial.uniform = { velocity = [0.5, 0], pressure = 1 } }
//! #     time = { order = 1, end = 1, slabs = 10 }
//! # "#;
//! # let case = case::AnyCase::check(&case::Document::parse("stream.toml".as_ref(), text.to_owned(), &[])?)?;
//! # let folder = tempfile::tempdir()?;
//! # let directory = folder.path().join("run");
//! let keep = Keep::default();
//! let stopped = simulation::run(&case, &Destination { directory, existing: Existing::Keep }, &keep);
//! assert!(matches!(stopped, Err(Failure::Stopped)));
//! let kept = keep.0.into_inner()?;
//! assert!(kept.len() == 3 && kept.iter().all(|(mass, _)| (mass - 1.0).abs() < 1e-12));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A motion of the mesh of one's own, in place of that of the case:
//!
//! ```
//! use coupled::{BoundaryField, MeshMotion};
//! use std::sync::Arc;
//!
//! /// The inside of the unit square turns back and forth.
//! struct Swing;
//!
//! impl BoundaryField<2> for Swing {
//!     fn displacement(&self, _node: usize, [x, y]: &[f64; 2], t: f64) -> [f64; 2] {
//!         let size = 0.5 * x * (1.0 - x) * y * (1.0 - y) * t.sin();
//!         [size * (0.5 - y), size * (x - 0.5)]
//!     }
//!     fn velocity(&self, node: usize, x: &[f64; 2], t: f64) -> [f64; 2] {
//!         // The factor sin t becomes cos t = sin(t + pi / 2).
//!         self.displacement(node, x, t + std::f64::consts::FRAC_PI_2)
//!     }
//! }
//!
//! # let text = r#"
//! #     mesh = { order = 4, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2] } }
//! #     flow = { order = 2, initial.uniform = { velocity = [0, 0], pressure = 1 }, boundary.others = "slip_wall",
//! #         reference = { density = 1, speed = 1, pressure = 1 } }
//! #     time = { order = 2, end = 0.2, slabs = 2 }
//! # "#;
//! # let case = case::AnyCase::check(&case::Document::parse("box.toml".as_ref(), text.to_owned(), &[])?)?;
//! # let case::AnyCase::Plane(case) = case else { return Err("not in the plane".into()) };
//! # let Some(flow) = &case.flow else { return Err("without a flow".into()) };
//! let mut march = simulation::march_with_motion::<2, 4>(&case, flow, MeshMotion::Prescribed(Arc::new(Swing)))?;
//! while !march.is_done() {
//!     march.advance()?;
//! }
//! assert!((march.totals()[0] - 1.0).abs() < 1e-12, "mass is conserved on the moving mesh");
//! assert!(march.state.d.iter().any(|d| d.abs() > 1e-4), "the mesh has moved");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod averages;
pub mod bench;
mod bodies;
mod body_checks;
mod body_record;
mod boundary_values;
mod build;
mod cell_finder;
mod cells;
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
mod errors;
mod failure;
mod fallback;
mod flow_run;
mod frame_checks;
mod history;
mod integrals;
mod lines;
mod memory_estimate;
mod mesh_run;
mod motion_jump;
mod nodal;
mod observer;
mod occupied;
mod opening_states;
mod openings;
mod preflight;
mod probe;
mod probes;
mod record;
mod restart;
mod resume;
mod session;
mod slices;
mod statistics;
mod steady_search;
mod steady_warnings;
mod stored_field;
mod structure_run;
mod summary;
mod surfaces;
mod walls;

/// More threads than any machine has cores. Thousands take minutes to start.
pub const MOST_THREADS: u16 = 1024;

pub use body_checks::{
    check_structure, point_far_from_body, speed_of_bodies_at_start, unheld_in_equilibrium, wall_that_follows,
};
pub use build::{PrescribedNode, march, march_with_motion, mover, structure_march};
pub use cell_finder::CellFinder;
pub use controls::check as check_controls;
pub use crew::{agree, serve};
pub use destination::{Destination, Existing};
pub use drive::{motion, run, run_on};
pub use error::Failure;
pub use failure::Mismatch;
pub use frame_checks::jump_of_centrifugal_force;
pub use history::require_distinct_columns;
pub use memory_estimate::{MemoryEstimate, PROGRAM_BYTES, require_memory, typical_iterations};
pub use observer::{NextStep, Observer, Positions, RunState, SlabDone, SlabFlow, WarningSink};
pub use openings::{Misuse, Record as OpeningRecord, Seen as OpeningSeen};
pub use preflight::Preflight;
pub use probe::{MeshOverRun, ProbeError, Timing};
pub use record::LOG_FILE;
pub use steady_warnings::undetermined;
pub use stored_field::StoredField;
pub use surfaces::{Column as SurfaceColumn, columns as surface_columns, surface_name};
