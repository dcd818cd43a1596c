//! Results on disk: VTKHDF, exact coefficients, checkpoint, history, summary.
//!
//! This crate and `cgns` are the only links to libhdf5. It stores arrays and computes nothing. `FORMAT.md` beside this crate's
//! manifest documents the contents of `result.vtkhdf`.
//!
//! * [`RunDirectory`] is the directory of one run, locked against a second one;
//! * [`ResultFile`] is `result.vtkhdf`: fields for ParaView, exact coefficients, the state for a restart;
//! * [`ResultReader`] reads its steps back, also while the run goes on;
//! * [`ViewerFile`] is a VTKHDF file for viewers only;
//! * [`History`] is `history.csv`, a row per slab; [`HistoryTable`] holds its contents for a reader;
//! * [`LineFile`] is `line_NAME.csv`, [`SliceSeries`] is `slice_NAME.pvd` with a file of [`PolyData`] per time;
//! * [`Summary`] is `summary.json`, for scripts after the run;
//! * [`EarlierRun`] describes an earlier run in the same directory;
//! * [`inspect`] lists the contents of a result file.
//!
//! # A run killed at any moment
//!
//! A reader never sees a file that is being written. Steps are appended to a private copy, `result.vtkhdf.partial`. A
//! checkpoint closes the copy, forces it to the disk and renames it to `result.vtkhdf`, which is atomic. A killed run
//! therefore leaves the complete result of its last checkpoint, and at most one unfinished copy, which the next run
//! removes. A program that already reads the old file keeps reading the old file.
//!
//! # Example
//!
//! A history and a summary, written and read back. The directory is locked meanwhile:
//!
//! ```
//! use output::{History, HistoryTable, RunDirectory, SUMMARY_FILE, Summary};
//!
//! let place = tempfile::tempdir()?;
//! let directory = RunDirectory::open(place.path())?;
//! assert!(RunDirectory::open(place.path()).is_err(), "another run holds it");
//!
//! let mut history = History::create(&directory, &["t".to_owned(), "lift".to_owned()], &[])?;
//! history.push(&[0.5, 1e-3])?;
//! history.push(&[1.0, -0.25])?;
//! let table = HistoryTable::read(place.path())?;
//! assert_eq!(table.column("lift"), Some(vec![1e-3, -0.25]));
//!
//! Summary { case: "foil".to_owned(), completed: true, slabs: 2, time: 1.0, ..Summary::default() }.write(&directory)?;
//! let text = std::fs::read_to_string(place.path().join(SUMMARY_FILE))?;
//! assert!(text.contains(r#""completed": true"#), "{text}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod checkpoint;
mod checksum;
mod cost;
mod directory;
mod earlier;
mod error;
mod files;
mod format;
mod hdf;
mod history;
mod inspect;
mod lagrange;
mod layout;
mod line_file;
mod poly_data;
mod reader;
mod rest_mesh;
mod result_file;
mod seal;
mod series;
mod shared_file;
mod slice_series;
mod state;
mod step;
mod summary;
mod viewer_file;
mod vtkhdf;

pub use checkpoint::Checkpoint;
pub use checksum::Checksum;
pub use cost::{Cost, Machine, Part};
pub use directory::{LockOwner, RunDirectory};
pub use earlier::EarlierRun;
pub use error::OutputError;
pub use files::write_atomically;
pub use format::{FORMAT_VERSION, Metadata};
pub use history::{HISTORY_FILE, History, HistoryTable, header, names};
pub use inspect::{CheckpointInfo, ResultInfo, inspect};
pub use lagrange::{vtk_node, vtk_order};
pub use layout::{ArraySpec, Axis, FieldSpec, FileLayout, Grid};
pub use line_file::LineFile;
pub use poly_data::PolyData;
pub use reader::ResultReader;
pub use rest_mesh::RestMesh;
pub use result_file::{Kept, RESULT_FILE, ResultFile, read_checkpoint};
pub use series::Series;
pub use shared_file::SharedFile;
pub use slice_series::SliceSeries;
pub use state::{ArrayInParts, Arrays, Parts, SolverState};
pub use step::{Step, StepInParts};
pub use summary::{
    Body, Conservation, ErrorNorms, Krylov, MeshQuality, MeshSize, Misused, Newton, Opening, Oscillation, SUMMARY_FILE,
    Steady, SteadyStability, SteadyWall, StructureSummary, Summary, Unknowns, Wall,
};
pub use viewer_file::{ViewerFile, read_viewer_file};
