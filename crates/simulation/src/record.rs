//! The output of every slab.

use super::averages::fields::{self as averages, AverageFields};
use super::averages::{AverageSums, Averaged};
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
use elasticity::{Solid, Stress};
use fem::{Layout, Sampler};
use mesh::{Mesh, NodeNumbering};
use output::{
    ArraySpec, Checksum, FieldSpec, FileLayout, Grid, History, Metadata, OutputError, RestMesh, ResultFile,
    SolverState, Step,
};
use report::REPORT_FILE;
use report::fields::{self, CellSample, Medium};
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

/// The mesh as the recorder needs it: C0 nodes per cell and reference positions `[cell][component][node]`.
pub struct MeshView<const D: usize> {
    cells: Vec<Vec<usize>>,
    positions: Vec<Vec<f64>>,
}

impl<const D: usize> MeshView<D> {
    /// The view of `mesh` and its nodes.
    pub fn new(mesh: &Mesh<D>, numbering: &NodeNumbering) -> Self {
        let cells = 0..mesh.n_cells();
        let transposed = |cell| {
            let nodes = mesh.cell_coordinates(cell);
            (0..D).flat_map(|d| nodes.iter().skip(d).step_by(D).copied()).collect()
        };
        MeshView {
            cells: cells.clone().map(|cell| numbering.cell(cell).to_vec()).collect(),
            positions: cells.map(transposed).collect(),
        }
    }

    /// A C0 field `[C0 node][component]` on `cell`, `[component][node]`.
    fn on_cell(&self, cell: usize, field: &[f64]) -> Vec<f64> {
        (0..D).flat_map(|d| self.cells[cell].iter().map(move |node| field[node * D + d])).collect()
    }

    /// Positions of the nodes of `cell`, displaced by `d`.
    fn displaced(&self, cell: usize, d: &[f64]) -> Vec<f64> {
        let displacement = self.on_cell(cell, d);
        self.positions[cell].iter().zip(displacement).map(|(x, d)| x + d).collect()
    }

    /// Positions of the nodes of all cells, displaced by `d`.
    fn all_displaced(&self, d: &[f64]) -> Vec<f64> {
        (0..self.cells.len()).flat_map(|cell| self.displaced(cell, d)).collect()
    }
}

/// `history.csv` with the rows of the checkpoint `before`, if there is one.
fn history_after(
    before: Option<&SolverState>,
    session: &Session<'_>,
    columns: &[String],
) -> Result<History, OutputError> {
    let rows = before.and_then(|before| before.arrays.get("history")).map_or(&[][..], |rows| &rows[..]);
    History::create(&session.directory, columns, rows)
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
        session.directory.clear(resume, &[REPORT_FILE])?;
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
        state.arrays.insert("history".into(), self.history.rows().to_vec().into());
        self.slabs_since_checkpoint = 0;
        Ok(self.result.checkpoint(&state)?)
    }

    fn fields(&self) -> impl Iterator<Item = case::Field> + use<'a, D, M> {
        drawn_fields(self.case)
    }

    /// Points `[cell][point][3]`, and for every field `[cell][point][component]`: cells of the flow, then those of a structure beside it.
    fn draw(&self, snapshot: &Snapshot) -> (Vec<f64>, Vec<Vec<f64>>) {
        let mut drawn = Drawn { points: Vec::new(), fields: vec![Vec::new(); drawn_specs(self.case).count()] };
        let Snapshot { displacement, velocities, flow, .. } = *snapshot;
        let solid = self.solid.as_ref().filter(|_| self.case.flow.is_none());
        let (determinants, of_structure) = self.reference_determinants.split_at(self.mesh.cells.len());
        let velocity = top(velocities, displacement);
        let time = snapshot.time;
        let moving = Moving { mesh: &self.mesh, determinants, displacement, velocity, solid, time };
        (0..self.mesh.cells.len())
            .for_each(|cell| self.draw_cell(&moving, cell, self.top_state(cell, flow), &mut drawn));
        if let Some((mesh, structure)) = self.beside.as_ref().zip(snapshot.structure.as_ref()) {
            let (displacement, solid) = (&structure.displacement[..], self.solid.as_ref());
            let velocity = top(&structure.velocities, displacement);
            let moving = Moving { mesh, determinants: of_structure, displacement, velocity, solid, time };
            (0..mesh.cells.len()).for_each(|cell| self.draw_cell(&moving, cell, &[], &mut drawn));
        }
        (drawn.points, drawn.fields)
    }

    /// Adds a cell. A cell without a flow has no `coefficients`.
    fn draw_cell(&self, moving: &Moving<'_, D>, cell: usize, coefficients: &[f64], drawn: &mut Drawn) {
        let Moving { mesh, determinants, displacement, velocity, solid, time } = *moving;
        let (rest, nodal, n) = (&mesh.positions[cell], mesh.displaced(cell, displacement), self.sampler.points());
        let x = self.sampler.positions(&nodal);
        drawn
            .points
            .extend((0..n).flat_map(|p| std::array::from_fn::<f64, 3, _>(|d| if d < D { x[d * n + p] } else { 0.0 })));
        let jacobian = self.sampler.determinants(&nodal).into_iter().zip(&determinants[cell]);
        let jacobian: Vec<f64> = jacobian.map(|(j, j0)| j / j0).collect();
        let gradients = match coefficients.is_empty() {
            true => Vec::new(),
            false => self.sampler.gradients(coefficients, &nodal).to_vec(),
        };
        let moved = mesh.on_cell(cell, displacement);
        let sample = CellSample {
            points: n,
            state: &self.sampler.state(coefficients),
            mesh_velocity: &self.sampler.positions(&mesh.on_cell(cell, velocity)),
            jacobian: &jacobian,
            gradients: &gradients,
            displacement: &self.sampler.positions(&moved),
            stress: &solid.map_or(Vec::new(), |solid| self.stress(solid, rest, &moved)),
        };
        let medium = self.case.flow.as_ref().filter(|_| solid.is_none()).map(Medium::of);
        let mut columns = drawn.fields.iter_mut();
        for (field, out) in self.fields().zip(&mut columns) {
            fields::values::<D, M>(field, medium.as_ref(), &sample, out);
        }
        let formulas = &self.case.observed.formulas;
        let of_formulas = fields::of_formulas::<D, M>(formulas, medium.as_ref(), &sample, &x, time);
        of_formulas.into_iter().zip(columns).for_each(|(values, out)| out.extend(values));
    }

    /// The stress at the points of a cell at `rest` that is displaced by `moved`, both `[component][node]`.
    fn stress(&self, solid: &Solid<D>, rest: &[f64], moved: &[f64]) -> Vec<Stress> {
        let (x, n) = (self.mesh_sampler.positions(rest), self.mesh_sampler.points());
        let gradients = self.mesh_sampler.gradients(moved, rest);
        let at = |p: usize| {
            let gradient = std::array::from_fn(|i| std::array::from_fn(|j| gradients[j][i * n + p]));
            // The case has been checked at the nodes; a point between them may have no material.
            solid.stress(&std::array::from_fn(|d| x[d * n + p]), &gradient).unwrap_or([[f64::NAN; 3]; 3])
        };
        (0..n).map(at).collect()
    }

    /// The flow of a cell at the last time node.
    fn top_state<'b>(&self, cell: usize, flow: &'b [f64]) -> &'b [f64] {
        if flow.is_empty() {
            return flow;
        }
        let layout = flow_layout::<D, M>(self.case);
        &flow[layout.cell_at(cell, layout.time_order - 1)]
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

/// The averages that the case asks for, if any.
fn average_fields<'b, const D: usize>(case: &Case<D>, sums: &'b AverageSums) -> Option<AverageFields<'b>> {
    let nodes = flow_order(case).pow(D as u32);
    case.averages.as_ref().map(|wanted| AverageFields::new::<D>(wanted, sums, case.mesh.n_cells(), nodes))
}

/// A mesh that moves.
#[derive(Clone, Copy)]
struct Moving<'a, const D: usize> {
    mesh: &'a MeshView<D>,
    /// det J at rest, cell by cell.
    determinants: &'a [Vec<f64>],
    displacement: &'a [f64],
    velocity: &'a [f64],
    /// What fills it, if that is no gas.
    solid: Option<&'a Solid<D>>,
    time: f64,
}

/// What a viewer shows.
struct Drawn {
    /// `[cell][point][3]`
    points: Vec<f64>,
    /// For every field `[cell][point][component]`.
    fields: Vec<Vec<f64>>,
}

/// The velocities at the last time node.
pub fn top<'a>(velocities: &'a [f64], displacement: &[f64]) -> &'a [f64] {
    &velocities[velocities.len() - displacement.len()..]
}

/// Positions `[cell][component][node]` and velocities `[cell][time node][component][node]`.
fn exact_mesh<const D: usize>(mesh: &MeshView<D>, displacement: &[f64], velocities: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let cells = 0..mesh.cells.len();
    let fields = || velocities.chunks_exact(displacement.len());
    let positions = mesh.all_displaced(displacement);
    let velocities = cells.flat_map(|cell| fields().flat_map(move |field| mesh.on_cell(cell, field))).collect();
    (positions, velocities)
}

/// The fields that the case lists and that exist in it, and those of mesh and structure that every such run shows.
fn drawn_fields<const D: usize>(case: &Case<D>) -> impl Iterator<Item = case::Field> + use<'_, D> {
    let (flows, has_structure) = (case.flow.is_some(), case.structure.is_some());
    let exists = move |field: &case::Field| match fields::of_structure(*field) {
        true => has_structure,
        false => flows || fields::of_mesh(*field),
    };
    let of_mesh = [case::Field::Jacobian, case::Field::MeshVelocity].into_iter().filter(move |_| !flows);
    let of_structure = [case::Field::Displacement, case::Field::VonMises].into_iter().filter(move |_| has_structure);
    let listed = case.output.fields.iter().copied().filter(exists);
    listed.chain(of_mesh.chain(of_structure).filter(|field| !case.output.fields.contains(field)))
}

/// The storage of these fields, and then of those by formulas.
fn drawn_specs<const D: usize>(case: &Case<D>) -> impl Iterator<Item = FieldSpec> + use<'_, D> {
    let formulas = case.observed.formulas.iter().map(|formula| FieldSpec::scalar(&formula.name));
    drawn_fields(case).map(|field| fields::spec(field, D)).chain(formulas)
}

/// The order of the flow, or of the mesh without a flow.
fn flow_order<const D: usize>(case: &Case<D>) -> usize {
    case.flow.as_ref().map_or(case.mesh.order(), |flow| flow.order)
}

/// The layout of the flow in a slab.
fn flow_layout<const D: usize, const M: usize>(case: &Case<D>) -> Layout {
    let nodes = flow_order(case).pow(D as u32);
    Layout { cells: case.mesh.n_cells(), time_order: case.time.order, components: M, nodes }
}

fn layout<const D: usize, const M: usize>(case: &Case<D>) -> FileLayout {
    let (cells, mesh_nodes, time) = (case.mesh.n_cells(), case.mesh.nodes_per_cell(), case.time.order);
    let points_per_direction = flow_order(case).max(case.mesh.order());
    let position = ArraySpec::new("position", &[("cell", cells), ("component", D), ("mesh node", mesh_nodes)]);
    let velocity = [("cell", cells), ("time node", time), ("component", D), ("mesh node", mesh_nodes)];
    let mut exact = vec![position, ArraySpec::new("mesh_velocity", &velocity)];
    if case.flow.is_some() {
        let nodes = flow_order(case).pow(D as u32);
        let axes = [("cell", cells), ("time node", time), ("component", M), ("flow node", nodes)];
        exact.push(ArraySpec::new("flow", &axes));
    }
    let beside = beside_flow(case).map_or(0, |(_, part)| part.mesh.n_cells());
    if beside > 0 {
        let position = [("structure cell", beside), ("component", D), ("mesh node", mesh_nodes)];
        let velocity = [("structure cell", beside), ("time node", time), ("component", D), ("mesh node", mesh_nodes)];
        exact.push(ArraySpec::new("structure_position", &position));
        exact.push(ArraySpec::new("structure_velocity", &velocity));
    }
    let mut fields: Vec<_> = drawn_specs(case).collect();
    if let Some(of_mesh) = average_fields(case, &AverageSums::default()) {
        exact.extend(of_mesh.averages().iter().map(|average| of_mesh.array(average)));
        fields.extend(of_mesh.averages().iter().map(averages::spec));
    }
    FileLayout { grid: Grid { dimension: D, points_per_direction, cells: cells + beside }, fields, exact }
}

/// A checksum of the parts that a run must share with the run that it continues: the `lasting` part of the case, and the
/// equations solved.
fn fingerprint<const D: usize>(case: &Case<D>, lasting: &str) -> String {
    let solved = match (&case.flow, &case.structure) {
        (Some(_), _) => "mesh and flow",
        (None, Some(_)) => "structure",
        (None, None) => "mesh",
    };
    // The mesh is included, because it may come from a file that has changed.
    let solid = beside_flow(case).map_or(&[][..], |(_, part)| part.mesh.coordinates());
    let checksum = Checksum::default().text(lasting).text(solved);
    checksum.numbers(case.mesh.coordinates()).numbers(solid).to_string()
}

fn metadata<const D: usize>(case: &Case<D>, mesh: &MeshView<D>) -> Metadata {
    Metadata {
        creator: format!("stsolve {}", env!("CARGO_PKG_VERSION")),
        case_name: case.about.name.clone(),
        case_text: case.about.resolved.clone(),
        case_fingerprint: fingerprint(case, &case.about.lasting),
        mesh_id: Checksum::default().numbers(case.mesh.coordinates()).to_string(),
        space_nodes: basis::gauss_lobatto(flow_order(case)).points,
        time_nodes: basis::RadauTime::new(case.time.order).nodes().to_vec(),
        mesh: rest_mesh(case, mesh),
    }
}

fn rest_mesh<const D: usize>(case: &Case<D>, mesh: &MeshView<D>) -> RestMesh {
    let facet = |facet: &mesh::BoundaryFacet| [facet.side.cell, facet.side.face, facet.boundary].map(|i| i as i64);
    RestMesh {
        position: mesh.positions.concat(),
        boundary_names: case.mesh.boundary_names().to_vec(),
        boundary_facets: case.mesh.boundary_facets().iter().map(facet).collect(),
    }
}
