//! What a run tells its caller while it goes, and what it asks him.

use crate::clock::Clock;
use coupled::{MeshQuality, StructureReport};
use std::path::Path;

/// A slab of mesh and flow that is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlabDone {
    /// Its number in the run, from 1.
    pub number: usize,
    /// The time at its end.
    pub time: f64,
    /// Newton steps that it took.
    pub newton: usize,
    /// Krylov iterations that it took.
    pub krylov: usize,
    /// Its final residual, relative to the first one.
    pub residual: f64,
}

/// What a user may do with a run that is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NextStep {
    /// Go on from its checkpoint.
    Resume,
    /// Replace it.
    Replace,
    /// Keep it, and write into another directory.
    WriteElsewhere,
    /// Look at it.
    Report,
}

/// The caller of a run. All methods have defaults: `()` is an observer that shows nothing and never stops a run.
pub trait Observer: Sync {
    /// The output `directory` is open and locked. The spans of the numerics may drive `clock` from now on, and a log may start.
    ///
    /// # Errors
    /// What forbids the run.
    fn open(&self, _directory: &Path, _clock: &Clock) -> anyhow::Result<()> {
        Ok(())
    }
    /// The run goes from time `start`, which is that of the checkpoint if it is resumed, to `end`.
    fn begin(&self, _start: f64, _end: f64) {}
    /// The steady flow at the start is found: slabs begin.
    fn begin_slabs(&self) {}
    /// A slab of mesh and flow is done.
    fn slab(&self, _slab: &SlabDone) {}
    /// A slab of the mesh alone is done, the one with this `number`, at `time`.
    fn mesh_slab(&self, _number: usize, _time: f64, _quality: &MeshQuality) {}
    /// A slab of a structure is done.
    fn structure_slab(&self, _report: &StructureReport) {}
    /// A message for the user, of one line or more.
    fn say(&self, _message: &str) {}
    /// No slab follows.
    fn finish(&self) {}
    /// Whether the run is to stop after the slab in hand, with a checkpoint.
    fn is_stop_requested(&self) -> bool {
        false
    }
    /// How a user takes a `step` with the run in `directory`, for the end of a message.
    fn advice(&self, step: NextStep, directory: &Path) -> String {
        let directory = directory.display();
        match step {
            NextStep::Resume => format!("run the case again with `Existing::Resume` and the directory {directory}"),
            NextStep::Replace => format!("run the case again with `Existing::Replace` and the directory {directory}"),
            NextStep::WriteElsewhere => "choose another directory".to_owned(),
            NextStep::Report => format!("look at it: `report::write` makes a page of {directory}"),
        }
    }
}

impl Observer for () {}
