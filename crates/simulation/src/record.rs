//! The output of every slab.

mod draw;
mod layout;
mod mesh_view;

pub use mesh_view::MeshView;

use super::averages::fields::{self as averages, AverageFields};
use super::averages::{AverageSums, Averaged, FILES as FILES_OF_AVERAGES};
use super::bodies::beside_flow;
use super::build::solid;
use super::history::columns;
use super::resume;
use super::statistics::RunStatistics;
use crate::error::Failure;
use crate::observer::{Positions, RunState};
use crate::session::Session;
use case::{Case, SolidPart};
use coupled::block::BodyState;
use elasticity::Solid;
use fem::Sampler;
use layout::{drawn_specs, fingerprint, flow_order, layout, metadata};
use mesh::NodeNumbering;
use mesh_view::exact_mesh;
use output::{ArraySpec, History, Metadata, OutputError, ResultFile, SolverState, Step};
use report::REPORT_FILE;
use report::fields;
use std::sync::Arc;

/// The state of a run at the end of a slab, and within it.
pub struct Snapshot<'a> {
    /// The time.
    pub time: f64,
    /// The displacement at that time, `[C0 node][component]`.
    pub displacement: &'a [f64],
    /// The velocities of the slab that ends at that time, `[time node][C0 node][component]`.
    pub velocities: &'a [f64],
    /// The flow of that slab; empty without one.
    pub flow: &'a [f64],
    /// The structure beside it.
    pub structure: Option<StructureSnapshot>,
    /// Sums of the averages over time.
    pub averages: &'a AverageSums,
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

/// The files of a run.
pub struct Recorder<'a, const D: usize, const M: usize> {
    case: &'a Case<D>,
    mesh: Arc<MeshView<D>>,
    /// The mesh of a structure beside the flow.
    beside: Option<MeshView<D>>,
    /// The material of the structure, if there is one.
    solid: Option<Solid<D>>,
    result: ResultFile,
    /// `history.csv`.
    pub history: History,
    sampler: Sampler<D>,
    /// For fields of the order of the mesh.
    mesh_sampler: Sampler<D>,
    /// det J at rest in every cell of the mesh, and then of the structure beside the flow.
    reference_determinants: Vec<Vec<f64>>,
    slabs_since_checkpoint: usize,
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

/// Files of an earlier run beside its result: those of averages, the report and the log. Where records are logged, the first one replaces the log.
fn others_to_clear() -> Vec<&'static str> {
    let log = (!tracing::enabled!(tracing::Level::INFO)).then_some(LOG_FILE);
    FILES_OF_AVERAGES.into_iter().chain([REPORT_FILE]).chain(log).collect()
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
    ) -> Result<(Self, Option<SolverState>), Failure> {
        let metadata = metadata(case, mesh);
        let (result, stored) = if resume {
            let accept = |found: &Metadata, stored: &SolverState| {
                let reached = stored.arrays.get("time").and_then(|time| time.first());
                let reached = reached.copied().unwrap_or(f64::INFINITY);
                resume::accept(found, &metadata, reached, |lasting| fingerprint(case, lasting))
            };
            let (result, stored) = ResultFile::resume(&session.directory, &metadata, accept)?;
            (result, Some(stored))
        } else {
            (ResultFile::create(&session.directory, layout::<D, M>(case), &metadata)?, None)
        };
        // From here on nothing can refuse the run any more.
        session.directory.clear(resume, &others_to_clear())?;
        tracing::info!(resume, "the run begins");
        let told = Told::new::<D, M>(case, mesh);
        let history = history_after(stored.as_ref().or(origin), session, &told.columns)?;
        let (sampler, n) = fields::equidistant::<D>(flow_order(case), case.mesh.order());
        let mesh_sampler = Sampler::new(case.mesh.order(), case.mesh.order(), &basis::equidistant_points(n));
        let beside =
            |part: &SolidPart<D>| MeshView::new(&part.mesh, &NodeNumbering::new(&part.mesh, part.mesh.order()));
        let beside = beside_flow(case).map(|(_, part)| beside(part));
        let rest = mesh.positions.iter().chain(beside.iter().flat_map(|beside| &beside.positions));
        let recorder = Recorder {
            case,
            mesh: mesh.clone(),
            reference_determinants: rest.map(|nodes| sampler.determinants(nodes)).collect(),
            beside,
            solid: case.structure.as_ref().map(solid),
            result,
            history,
            sampler,
            mesh_sampler,
            slabs_since_checkpoint: 0,
            told,
        };
        Ok((recorder, stored))
    }

    /// Drops what was written after the last checkpoint, and returns that.
    ///
    /// # Errors
    /// Files that cannot be read or written.
    pub fn go_back(&mut self, session: &Session<'_>) -> Result<SolverState, Failure> {
        let (result, stored) = ResultFile::resume(&session.directory, &metadata(self.case, &self.mesh), |_, _| Ok(()))?;
        self.result = result;
        self.history = history_after(Some(&stored), session, &self.told.columns)?;
        self.slabs_since_checkpoint = 0;
        Ok(stored)
    }

    /// The case of the run.
    pub fn case(&self) -> &'a Case<D> {
        self.case
    }

    /// A run in `state` at the end of a slab with the `row` of history.csv, for observers.
    pub fn tell<'b>(&'b self, row: &'b [f64], state: &'b coupled::State) -> RunState<'b> {
        let Told { columns, arrays, positions } = &self.told;
        RunState { columns, row, state, arrays, positions }
    }

    /// Appends a step to the result.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn step(&mut self, snapshot: &Snapshot) -> Result<(), Failure> {
        let _timed = tracing::trace_span!(target: "cost", "output").entered();
        let (points, drawn) = self.draw(snapshot);
        let names: Vec<_> = drawn_specs(self.case).map(|spec| spec.name).collect();
        let averages = self.averages(snapshot.averages);
        let mut fields: Vec<(&str, &[f64])> =
            names.iter().map(String::as_str).zip(drawn.iter().map(Vec::as_slice)).collect();
        fields.extend(averages.iter().map(|average| (&average.name[..], &average.drawn[..])));
        let (positions, velocities) = exact_mesh(&self.mesh, snapshot.displacement, snapshot.velocities);
        let beside = self.beside.as_ref().zip(snapshot.structure.as_ref());
        let of_structure =
            beside.map(|(mesh, structure)| exact_mesh(mesh, &structure.displacement, &structure.velocities));
        let mut exact = vec![("position", &positions[..]), ("mesh_velocity", &velocities[..])];
        if self.case.flow.is_some() {
            exact.push(("flow", snapshot.flow));
        }
        if let Some((positions, velocities)) = &of_structure {
            exact.extend([("structure_position", &positions[..]), ("structure_velocity", velocities)]);
        }
        exact.extend(averages.iter().map(|average| (&average.name[..], &average.coefficients[..])));
        Ok(self.result.append(&Step { time: snapshot.time, points: &points, fields: &fields, exact: &exact })?)
    }

    /// Appends the `values` at a `time` to a series of the result.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn append_to_series(&mut self, array: &ArraySpec, time: f64, values: &[f64]) -> Result<(), Failure> {
        let _timed = tracing::trace_span!(target: "cost", "output").entered();
        Ok(self.result.append_to_series(array, time, values)?)
    }

    /// The averages up to now; a structure beside the flow has none.
    fn averages(&self, sums: &AverageSums) -> Vec<AverageAtStep> {
        let Some(fields) = average_fields(self.case, sums) else { return Vec::new() };
        let nodes = flow_order(self.case).pow(D as u32);
        let beside = self.beside.as_ref().map_or(0, |mesh| mesh.cells.len()) * self.sampler.points();
        let at_step = |average: &Averaged| {
            let coefficients = fields.coefficients(average, None);
            let mut drawn = averages::drawn::<D>(average, &coefficients, nodes, &self.sampler);
            drawn.extend(std::iter::repeat_n(f64::NAN, beside * averages::spec(average).components));
            AverageAtStep { name: average.name.clone(), coefficients, drawn }
        };
        fields.averages().iter().map(at_step).collect()
    }

    /// Counts a slab; returns whether a checkpoint is due.
    pub fn is_checkpoint_due(&mut self) -> bool {
        self.slabs_since_checkpoint += 1;
        self.slabs_since_checkpoint >= self.case.output.checkpoint_every
    }

    /// Writes a checkpoint: `state` with the history and the sums of the run.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn checkpoint(&mut self, mut state: SolverState, statistics: &RunStatistics) -> Result<(), Failure> {
        let _timed = tracing::trace_span!(target: "cost", "output").entered();
        state.arrays.extend(statistics.to_arrays());
        state.arrays.insert(HISTORY.into(), self.history.rows().to_vec().into());
        state.texts.insert(COLUMNS.into(), output::header(&self.told.columns));
        self.slabs_since_checkpoint = 0;
        Ok(self.result.checkpoint(&state)?)
    }
}

/// An average up to a step.
struct AverageAtStep {
    name: String,
    /// `[cell][component][node]`
    coefficients: Vec<f64>,
    /// `[cell][point][component]`, those of a structure included.
    drawn: Vec<f64>,
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
