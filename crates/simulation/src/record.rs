//! The output of every slab.

mod checkpoint_schedule;
mod draw;
mod layout;
mod mesh_view;
mod step_parts;
mod together;

pub use mesh_view::MeshView;

use super::averages::fields::{self as averages, AverageFields};
use super::averages::{AverageSums, FILES as FILES_OF_AVERAGES};
use super::bodies::beside_flow;
use super::cuts::Reached;
use super::history::columns;
use super::resume;
use super::statistics::RunStatistics;
use crate::crew::{OfCells, Together};
use crate::error::Failure;
use crate::observer::{Positions, RunState, SlabFlow};
use crate::session::Session;
use case::Case;
use checkpoint_schedule::CheckpointSchedule;
use coupled::block::BodyState;
pub use layout::result_bytes;
use layout::{fingerprint, flow_order, layout, metadata};
use output::{
    ArrayInParts, ArraySpec, Checkpoint, History, Kept, Metadata, OutputError, Parts, ResultFile, ResultReader,
    SolverState,
};
use report::{COMPARISON_FILE, REPORT_FILE};
use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
pub use step_parts::StepParts;
use together::Moment;
pub use together::write_state;

/// The state of a run at the end of a slab, and within it.
pub struct Snapshot<'a> {
    /// The time.
    pub time: f64,
    /// The displacement at that time, `[C0 node][component]`.
    pub displacement: &'a [f64],
    /// The velocities of the slab that ends at that time, `[time node][C0 node][component]`.
    pub velocities: &'a [f64],
    /// The flow of that slab in some cells; empty without one.
    pub flow: &'a dyn Fn(Range<usize>) -> Cow<'a, [f64]>,
    /// The structure beside it.
    pub structure: Option<StructureSnapshot>,
    /// Sums of the averages over time in some cells.
    pub averages: &'a dyn Fn(Range<usize>) -> AverageSums,
    /// The ranks that write cells together, if they do.
    pub together: Option<Together<'a>>,
}

/// A structure beside a flow at the end of a slab, and within it.
pub struct StructureSnapshot {
    /// The displacement, `[C0 node][component]`.
    pub displacement: Vec<f64>,
    /// The velocities of the slab, `[time node][C0 node][component]`.
    pub velocities: Vec<f64>,
}

impl StructureSnapshot {
    /// That of a case in the `state` of its march, if it has one.
    pub fn new<const D: usize>(case: &Case<D>, state: &coupled::State) -> Option<Self> {
        beside_flow(case)?;
        let stored = state.bodies.last()?;
        let length = BodyState::coordinates(stored);
        let velocities = match &state.past {
            Some(past) => past.bodies.last()?.clone(),
            None => stored[length..2 * length].repeat(case.time.order),
        };
        Some(StructureSnapshot { displacement: stored[..length].to_vec(), velocities })
    }
}

/// A state from which a run can go on.
pub struct Stored<'a> {
    /// The state.
    pub state: SolverState,
    /// The parts of it that are made while they are written.
    pub long: Vec<ArrayInParts<'a>>,
    /// The ranks that write those parts together, if they do.
    pub together: Option<Together<'a>>,
}

impl From<SolverState> for Stored<'_> {
    fn from(state: SolverState) -> Self {
        Stored { state, long: Vec::new(), together: None }
    }
}

/// The files of a run.
pub struct Recorder<'a, const D: usize, const M: usize> {
    parts: StepParts<'a, D, M>,
    result: ResultFile,
    /// `history.csv`.
    pub history: History,
    checkpoints: CheckpointSchedule,
    told: Told,
}

/// The parts of [`RunState`] that are the same for all slabs.
struct Told {
    columns: Vec<String>,
    arrays: Vec<ArraySpec>,
    positions: Arc<Positions>,
}

impl Told {
    fn new<const D: usize, const M: usize>(case: &Case<D>, mesh: &Arc<MeshView<D>>) -> Self {
        let mesh = mesh.clone();
        let positions = Arc::new(move |d: &[f64]| mesh.all_displaced(d));
        Told { columns: columns(case), arrays: layout::<D, M>(case).exact, positions }
    }
}

/// `history.csv` with the rows of the checkpoint `before`, if there is one.
fn history_after(
    before: Option<&SolverState>,
    session: &Session<'_>,
    columns: &[String],
) -> Result<History, OutputError> {
    let rows = before.and_then(|before| before.arrays.get(HISTORY)).map_or(&[][..], |rows| &rows[..]);
    History::create(&session.directory, columns, rows)
}

/// The array of a checkpoint with the rows of history.csv, and the text with the names of its columns.
pub const HISTORY: &str = "history";
/// See [`HISTORY`].
pub const COLUMNS: &str = "history_columns";

/// Name of the log in the output directory.
pub const LOG_FILE: &str = "log.jsonl";

/// Files that are made from the result of a run, beside lines, slices and surfaces: those of averages, the report, and a comparison with others.
pub fn made_from_results() -> Vec<&'static str> {
    FILES_OF_AVERAGES.into_iter().chain([REPORT_FILE, COMPARISON_FILE]).collect()
}

/// Files of an earlier run beside its result: also the log. Where records are logged, the first one replaces the log.
fn others_to_clear() -> Vec<&'static str> {
    let log = (!tracing::enabled!(tracing::Level::INFO)).then_some(LOG_FILE);
    made_from_results().into_iter().chain(log).collect()
}

impl<'a, const D: usize, const M: usize> Recorder<'a, D, M> {
    /// Starts the files of a new run, or continues those of its own checkpoint. A run that continues another one begins with the
    /// history of its `origin`.
    ///
    /// # Errors
    /// Files that cannot be written; for a resumed run a checkpoint that is missing, torn or of another case.
    pub fn start(
        session: &Session<'_>,
        case: &'a Case<D>,
        mesh: &Arc<MeshView<D>>,
        resume: bool,
        origin: Option<&SolverState>,
    ) -> Result<(Self, Option<Checkpoint>), Failure> {
        let metadata = metadata(case, mesh);
        let (result, stored) = if resume {
            let accept = |found: &Metadata, stored: &SolverState| {
                let reached = stored.arrays.get("time").and_then(|time| time.first());
                let reached = reached.copied().unwrap_or(f64::INFINITY);
                resume::accept(found, &metadata, reached, |lasting| fingerprint(case, lasting))
            };
            let (result, stored) = ResultFile::resume(&session.directory, &metadata, &OfCells::names(), accept)?;
            (result, Some(stored))
        } else {
            (ResultFile::create(&session.directory, layout::<D, M>(case), &metadata)?, None)
        };
        // From here on nothing can refuse the run any more.
        session.directory.clear(resume, &others_to_clear())?;
        tracing::info!(resume, "the run begins");
        let told = Told::new::<D, M>(case, mesh);
        let history = history_after(stored.as_ref().map(|stored| &stored.state).or(origin), session, &told.columns)?;
        let parts = StepParts::new(case, mesh.clone());
        let checkpoints = CheckpointSchedule::new(case.output.checkpoint_every);
        let recorder = Recorder { parts, result, history, checkpoints, told };
        Ok((recorder, stored))
    }

    /// Drops what was written after the last checkpoint, and returns that.
    ///
    /// # Errors
    /// Files that cannot be read or written.
    pub fn go_back(&mut self, session: &Session<'_>) -> Result<Checkpoint, Failure> {
        let metadata = metadata(self.case(), &self.parts.mesh);
        let (result, stored) = ResultFile::resume(&session.directory, &metadata, &OfCells::names(), |_, _| Ok(()))?;
        self.result = result;
        self.history = history_after(Some(&stored.state), session, &self.told.columns)?;
        self.checkpoints.go_back();
        Ok(stored)
    }

    /// Whether the only step of the result is at `time`: the run begins there.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn begins_at(&self, time: f64) -> Result<bool, Failure> {
        Ok(ResultReader::open(self.result.path())?.times == [time])
    }

    /// The times of all steps of the result.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn step_times(&mut self) -> Result<Vec<f64>, Failure> {
        Ok(self.result.step_times()?)
    }

    /// Drops the fields and the distributions of a former end, where a run without interruption has none.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn drop_former_end(&mut self, reached: Reached) -> Result<(), Failure> {
        let output = &self.case().output;
        let keeps_series = output.surfaces_every.is_some_and(|every| reached.keeps_last(every));
        let kept = Kept { step: reached.keeps_last(output.every), series: reached.is_end || keeps_series };
        Ok(self.result.drop_former_end(reached.time, kept)?)
    }

    /// The case of the run.
    pub fn case(&self) -> &'a Case<D> {
        self.parts.case
    }

    /// A run in `state` at the end of a slab with the `row` of history.csv, for observers.
    pub fn tell<'b>(&'b self, row: &'b [f64], state: &'b coupled::State, flow: &'b SlabFlow<'b>) -> RunState<'b> {
        let Told { columns, arrays, positions } = &self.told;
        RunState { columns, row, state, flow, arrays, positions }
    }

    /// Appends a step to the result, one part of the mesh after the other.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn step(&mut self, snapshot: &Snapshot) -> Result<(), Failure> {
        let _timed = tracing::trace_span!(target: "cost", "output").entered();
        let together = self.together(&snapshot.together)?;
        let mut step = self.result.append_in_parts(snapshot.time)?;
        if let Some(together) = together {
            let write = |path: &Path| self.parts.write(&Moment::of(snapshot), together, path);
            step = step.share(self.parts.mesh.cells.len(), write)?;
        } else {
            for cells in self.parts.ranges() {
                self.parts.of_cells(snapshot, cells).add_to(&mut step)?;
            }
        }
        if let Some(part) = self.parts.of_structure(snapshot) {
            part.add_to(&mut step)?;
        }
        Ok(step.finish()?)
    }

    /// The ranks that write the result `together`, if they can. The others receive its path as a text.
    fn together<'b, 'c>(&mut self, together: &'c Option<Together<'b>>) -> Result<Option<&'c Together<'b>>, Failure> {
        match together {
            Some(together) if self.result.path().to_str().is_some() && self.result.can_be_shared()? => {
                Ok(Some(together))
            }
            _ => Ok(None),
        }
    }

    /// Appends the `values` at a `time` to a series of the result.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn append_to_series(&mut self, array: &ArraySpec, time: f64, values: &[f64]) -> Result<(), Failure> {
        let _timed = tracing::trace_span!(target: "cost", "output").entered();
        Ok(self.result.append_to_series(array, time, values)?)
    }

    /// Counts a slab; returns whether a checkpoint is due.
    pub fn is_checkpoint_due(&mut self) -> bool {
        self.checkpoints.count(Instant::now())
    }

    /// Writes a checkpoint: what is `stored` with the history and the sums of the run.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn checkpoint(&mut self, stored: Stored<'_>, statistics: &RunStatistics) -> Result<(), Failure> {
        let _timed = tracing::trace_span!(target: "cost", "output").entered();
        let begin = Instant::now();
        self.write_checkpoint(stored, statistics)?;
        self.checkpoints.written(begin, Instant::now());
        Ok(())
    }

    fn write_checkpoint(&mut self, stored: Stored<'_>, statistics: &RunStatistics) -> Result<(), Failure> {
        let Stored { mut state, mut long, together } = stored;
        state.arrays.extend(statistics.to_arrays());
        state.arrays.insert(HISTORY.into(), self.history.rows().to_vec().into());
        state.texts.insert(COLUMNS.into(), output::header(&self.told.columns));
        let case = self.case();
        let Some(together) = self.together(&together)? else { return Ok(self.result.checkpoint_with(&state, long)?) };
        long.iter_mut().for_each(|array| array.parts = Parts::OfAllRanks);
        self.result.checkpoint_together(&state, long, |path| write_state::<D, M>(case, together, path))
    }
}

/// The velocities at the last time node.
pub fn top<'a>(velocities: &'a [f64], displacement: &[f64]) -> &'a [f64] {
    &velocities[velocities.len() - displacement.len()..]
}

/// The averages that the case asks for, if any.
fn average_fields<'b, const D: usize>(case: &Case<D>, sums: &'b AverageSums) -> Option<AverageFields<'b>> {
    let nodes = flow_order(case).pow(D as u32);
    case.averages.as_ref().map(|wanted| AverageFields::new::<D>(wanted, sums, case.mesh.n_cells(), nodes))
}
