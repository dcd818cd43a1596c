//! The reports of a run to its caller, and the questions that it asks.

use crate::clock::CostClock;
use coupled::{MeshQuality, State, StructureReport};
use output::ArraySpec;
use std::path::Path;
use std::sync::Arc;

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

/// The positions of the nodes of a mesh, `[cell][component][node]`, as a function of its displacement, `[C0 node][component]`.
pub type Positions = dyn Fn(&[f64]) -> Vec<f64> + Send + Sync;

/// The flow in the last slab, `[cell][time node][component][node]`; none in a run without a flow. It is brought together where several ranks have
/// it, otherwise it is shared.
pub type SlabFlow<'a> = dyn Fn() -> Option<Arc<Vec<f64>>> + 'a;

/// A run at the end of a slab, with the numbers of the solver. The files of the slab are written.
#[derive(Clone, Copy)]
pub struct RunState<'a> {
    /// The columns of history.csv.
    pub columns: &'a [String],
    /// The row of the slab in history.csv.
    pub row: &'a [f64],
    /// Displacement and bodies at the end of the slab. Its `past` holds the mesh velocities within the slab, which may be kept without a copy.
    /// Of the flow it holds the cells of this rank.
    pub state: &'a State,
    /// The flow in the slab.
    pub flow: &'a SlabFlow<'a>,
    /// The arrays of a step in the result file, of which `flow` is one.
    pub arrays: &'a [ArraySpec],
    /// The mesh; `positions(&state.d)` are the positions at the end of the slab.
    pub positions: &'a Arc<Positions>,
}

impl RunState<'_> {
    /// The value of a column of history.csv, for instance the force `airfoil_force_x`.
    pub fn value(&self, column: &str) -> Option<f64> {
        let number = self.columns.iter().position(|name| name == column)?;
        self.row.get(number).copied()
    }

    /// The lengths of the axes of the array `name` of the result file.
    pub fn shape(&self, name: &str) -> Option<Vec<usize>> {
        let array = self.arrays.iter().find(|array| array.name == name)?;
        Some(array.axes.iter().map(|axis| axis.length).collect())
    }
}

/// Where warnings go.
pub type WarningSink = Box<dyn Fn(&str) + Send + Sync>;

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
    fn open(&self, _directory: &Path, _clock: &CostClock) -> anyhow::Result<()> {
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
    /// A slab of any run is done, and its files are written.
    fn state(&self, _state: &RunState<'_>) {}
    /// A message for the user, of one line or more.
    fn say(&self, _message: &str) {}
    /// Where the warnings of a run go if the program has no subscriber of `tracing`.
    fn warnings(&self) -> Option<WarningSink> {
        None
    }
    /// No slab follows.
    fn finish(&self) {}
    /// Whether the run is to stop after the slab in hand, or after the step in hand of a search for its start, with a checkpoint.
    fn is_stop_requested(&self) -> bool {
        false
    }
    /// The command with which a user takes a `step` with the run in `directory`, for the end of a message.
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
