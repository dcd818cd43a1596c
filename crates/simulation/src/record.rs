//! The output of every slab.

use super::history::columns;
use super::resume;
use super::statistics::RunStatistics;
use crate::error::Failure;
use crate::session::Session;
use case::Case;
use fem::{Layout as FlowLayout, Sampler};
use mesh::{Mesh, NodeNumbering};
use navier_stokes::Gas;
use output::{ArraySpec, Checksum, Grid, History, Layout, Metadata, RestMesh, ResultFile, SolverState, Step};
use report::REPORT_FILE;
use report::fields::{self, CellSample};

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
}

/// The files of a run.
pub struct Recorder<'a, const D: usize, const M: usize> {
    case: &'a Case<D>,
    mesh: &'a MeshView<D>,
    result: ResultFile,
    /// `history.csv`.
    pub history: History,
    sampler: Sampler<D>,
    reference_determinants: Vec<Vec<f64>>,
    slabs_since_checkpoint: usize,
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
        mesh: &'a MeshView<D>,
        resume: bool,
        origin: Option<&SolverState>,
    ) -> Result<(Self, Option<SolverState>), Failure> {
        let metadata = metadata(case, mesh);
        let (result, stored) = if resume {
            let accept = |found: &Metadata| resume::accept(found, &metadata);
            let (result, stored) = ResultFile::resume(&session.directory, &metadata.case_text, accept)?;
            (result, Some(stored))
        } else {
            (ResultFile::create(&session.directory, layout::<D, M>(case), &metadata)?, None)
        };
        // From here on nothing can refuse the run any more.
        session.directory.clear(resume, &[REPORT_FILE])?;
        let before = stored.as_ref().or(origin);
        let rows = before.and_then(|before| before.arrays.get("history")).map_or(&[][..], Vec::as_slice);
        let history = History::create(&session.directory, &columns(case), rows)?;
        let (sampler, _) = fields::equidistant::<D>(flow_order(case), case.mesh.order());
        let reference_determinants = mesh.positions.iter().map(|nodes| sampler.determinants(nodes)).collect();
        let recorder =
            Recorder { case, mesh, result, history, sampler, reference_determinants, slabs_since_checkpoint: 0 };
        Ok((recorder, stored))
    }

    /// Appends a step to the result.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn step(&mut self, snapshot: &Snapshot) -> Result<(), Failure> {
        let _timed = tracing::trace_span!(target: "cost", "output").entered();
        let (points, drawn) = self.draw(snapshot);
        let names: Vec<_> = self.fields().map(|field| fields::spec(field, D).name).collect();
        let fields: Vec<(&str, &[f64])> =
            names.iter().map(String::as_str).zip(drawn.iter().map(Vec::as_slice)).collect();
        let (positions, velocities) = self.exact_mesh(snapshot);
        let mut exact = vec![("position", &positions[..]), ("mesh_velocity", &velocities[..])];
        if self.case.flow.is_some() {
            exact.push(("flow", snapshot.flow));
        }
        Ok(self.result.append(&Step { time: snapshot.time, points: &points, fields: &fields, exact: &exact })?)
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
        state.arrays.insert("history".into(), self.history.rows().to_vec());
        self.slabs_since_checkpoint = 0;
        Ok(self.result.checkpoint(&state)?)
    }

    fn fields(&self) -> impl Iterator<Item = case::Field> + use<'a, D, M> {
        drawn_fields(self.case)
    }

    /// Points `[cell][point][3]`, and for every field `[cell][point][component]`.
    fn draw(&self, snapshot: &Snapshot) -> (Vec<f64>, Vec<Vec<f64>>) {
        let gas: Option<&Gas> = self.case.flow.as_ref().map(|flow| &flow.law.gas);
        let wanted: Vec<_> = self.fields().collect();
        let (mut points, mut drawn) = (Vec::new(), vec![Vec::new(); wanted.len()]);
        let n = self.sampler.points();
        let last = &snapshot.velocities[snapshot.velocities.len() - snapshot.displacement.len()..];
        for cell in 0..self.mesh.cells.len() {
            let nodal = self.mesh.displaced(cell, snapshot.displacement);
            let x = self.sampler.positions(&nodal);
            points.extend(
                (0..n).flat_map(|p| (0..3).map(|d| if d < D { x[d * n + p] } else { 0.0 }).collect::<Vec<_>>()),
            );
            let determinants = self.sampler.determinants(&nodal);
            let jacobian: Vec<f64> =
                determinants.iter().zip(&self.reference_determinants[cell]).map(|(j, j0)| j / j0).collect();
            let coefficients = self.top_state(cell, snapshot.flow);
            let gradients = if coefficients.is_empty() {
                Vec::new()
            } else {
                self.sampler.gradients(coefficients, &nodal).to_vec()
            };
            let sample = CellSample {
                points: n,
                state: &self.sampler.state(coefficients),
                mesh_velocity: &self.sampler.positions(&self.mesh.on_cell(cell, last)),
                jacobian: &jacobian,
                gradients: &gradients,
            };
            for (field, out) in wanted.iter().zip(&mut drawn) {
                fields::values::<D, M>(*field, gas, &sample, out);
            }
        }
        (points, drawn)
    }

    /// The flow of a cell at the last time node.
    fn top_state<'b>(&self, cell: usize, flow: &'b [f64]) -> &'b [f64] {
        if flow.is_empty() {
            return flow;
        }
        let layout = flow_layout::<D, M>(self.case);
        &flow[layout.cell_at(cell, layout.time_order - 1)]
    }

    /// Positions `[cell][component][node]` and velocities `[cell][time node][component][node]`.
    fn exact_mesh(&self, snapshot: &Snapshot) -> (Vec<f64>, Vec<f64>) {
        let cells = 0..self.mesh.cells.len();
        let fields = || snapshot.velocities.chunks_exact(snapshot.displacement.len());
        let positions = cells.clone().flat_map(|cell| self.mesh.displaced(cell, snapshot.displacement)).collect();
        let velocities =
            cells.flat_map(|cell| fields().flat_map(move |field| self.mesh.on_cell(cell, field))).collect();
        (positions, velocities)
    }
}

fn drawn_fields<const D: usize>(case: &Case<D>) -> impl Iterator<Item = case::Field> + use<'_, D> {
    let moves = case.flow.is_none();
    let mesh_alone = [case::Field::Jacobian, case::Field::MeshVelocity];
    let listed = case.output.fields.iter().copied().filter(move |field| !moves || fields::of_mesh(*field));
    let added = mesh_alone.into_iter().filter(move |field| moves && !case.output.fields.contains(field));
    listed.chain(added)
}

/// The order of the flow, or of the mesh without a flow.
fn flow_order<const D: usize>(case: &Case<D>) -> usize {
    case.flow.as_ref().map_or(case.mesh.order(), |flow| flow.order)
}

/// The layout of the flow in a slab.
fn flow_layout<const D: usize, const M: usize>(case: &Case<D>) -> FlowLayout {
    let nodes = flow_order(case).pow(D as u32);
    FlowLayout { cells: case.mesh.n_cells(), time_order: case.time.order, components: M, nodes }
}

fn layout<const D: usize, const M: usize>(case: &Case<D>) -> Layout {
    let (cells, nodes, time) = (case.mesh.n_cells(), case.mesh.nodes_per_cell(), case.time.order);
    let points_per_direction = flow_order(case).max(case.mesh.order());
    let position = ArraySpec::new("position", &[("cell", cells), ("component", D), ("mesh node", nodes)]);
    let velocity = [("cell", cells), ("time node", time), ("component", D), ("mesh node", nodes)];
    let mut exact = vec![position, ArraySpec::new("mesh_velocity", &velocity)];
    if case.flow.is_some() {
        let nodes = flow_order(case).pow(D as u32);
        let axes = [("cell", cells), ("time node", time), ("component", M), ("flow node", nodes)];
        exact.push(ArraySpec::new("flow", &axes));
    }
    let fields = drawn_fields(case).map(|field| fields::spec(field, D)).collect();
    Layout { grid: Grid { dimension: D, points_per_direction, cells }, fields, exact }
}

/// A checksum of the parts that a run must share with the run that it continues: the lasting part of the case, and the
/// equations solved.
fn fingerprint<const D: usize>(case: &Case<D>) -> String {
    let solved = match (&case.flow, &case.structure) {
        (Some(_), _) => "mesh and flow",
        (None, Some(_)) => "structure",
        (None, None) => "mesh",
    };
    // The mesh is included, because it may come from a file that has changed.
    Checksum::default().text(&case.about.lasting).text(solved).numbers(case.mesh.coordinates()).to_string()
}

fn metadata<const D: usize>(case: &Case<D>, mesh: &MeshView<D>) -> Metadata {
    Metadata {
        creator: format!("stsolve {}", env!("CARGO_PKG_VERSION")),
        case_name: case.about.name.clone(),
        case_text: case.about.resolved.clone(),
        case_fingerprint: fingerprint(case),
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
