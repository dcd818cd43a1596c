//! The space-time operator of a slab: residual and Jacobian products of all cells.

use crate::batches::{BATCHES_PER_TASK, FacetBatch, FacetBatches, cells_of};
use crate::cell::{CellCoefficients, CellContext};
use crate::facet::{Across, DataAt, FacetContext};
use crate::field::StateField;
use crate::gather::{gather, scatter};
use crate::instants::{Clock, InTime};
use crate::kernels::{Differentiate, Kernels, Times};
use crate::layout::Layout;
use crate::mesh_traces::MeshTraces;
use crate::moving_mesh::MovingMesh;
use crate::per_thread::PerThread;
use crate::prescribed::Prescribed;
use crate::scratch::{CellScratch, FacetScratch};
use crate::share::Share;
use crate::slab_geometry::{SlabEnd, SlabGeometry};
use crate::tables::{Orders, Quadrature, Tables};
use crate::traces::{FaceMaps, TraceLayout, Traces};
use crate::wall_loads::{WallLoads, scatter_loads};
use basis::Matrix;
use mesh::{Mesh, NodeNumbering};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use tensor::{Pack, WIDTH};

/// The data of a slab operator.
pub struct Problem<const D: usize, const M: usize> {
    /// The law with its boundary conditions.
    pub kernels: Box<dyn Kernels<D, M>>,
    /// For every boundary the states that its condition prescribes, if it takes any.
    pub data: Vec<Option<Arc<dyn StateField<D, M>>>>,
    /// The source s.
    pub source: Option<Arc<dyn StateField<D, M>>>,
}

/// What a slab stands on.
#[derive(Clone, Copy, Debug)]
pub struct Bottom<'a> {
    /// The state, laid out at one time.
    pub state: &'a [f64],
    /// The displacement of the C0 nodes, `[C0 node][component]`.
    pub displacement: &'a [f64],
    /// J of (carried) at the nodes, `[cell][node]`, see [`SlabOperator::determinants_at_top`]; empty at the start of a run.
    pub determinants: &'a [f64],
}

impl<'a> Bottom<'a> {
    /// At the start of a run.
    pub fn new(state: &'a [f64], displacement: &'a [f64]) -> Self {
        Bottom { state, displacement, determinants: &[] }
    }
}

/// An inadmissible state, or a cell turned inside out.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// The quantity: "det J", or one that the law names.
    pub quantity: String,
    /// Its value.
    pub value: f64,
    /// The cell, by its number in the whole mesh.
    pub cell: usize,
    /// The time.
    pub time: f64,
}

/// The residual of one slab,
///
/// ```text
/// R_a(U; V) = (volume) + (facet) - phi_a(0) int_K w u_n J |_{t_n}                                                   (slab)
/// ```
///
/// with `u` laid out by [`Layout`], and its exact derivatives along directions of state and mesh. A rank has those of its own cells; then
/// evaluations are collective.
pub struct SlabOperator<const D: usize, const M: usize> {
    /// The law, its boundary conditions and source.
    pub problem: Problem<D, M>,
    /// One-dimensional tables.
    pub tables: Tables<D>,
    /// The layout of `u`, own cells only.
    pub layout: Layout,
    /// The cells.
    pub share: Arc<Share>,
    /// The mesh in this slab.
    pub mesh: MovingMesh,
    pub(crate) facets: FacetBatches,
    pub(crate) flow_faces: FaceMaps,
    mesh_faces: FaceMaps,
    start: f64,
    dt: f64,
    clock: Clock,
    /// The fixed time at which all data are evaluated, if set.
    held_time: Option<f64>,
    pub(crate) position_rows: Vec<Matrix>,
    /// Positions at the Gauss points in time, `[instant][slot]`, and the same with the top as the last row.
    pub(crate) positions: Matrix,
    pub(crate) positions_and_top: Matrix,
    bottom_values: Vec<f64>,
    bottom_mass_product: Vec<f64>,
    pub(crate) state_traces: Traces,
    direction_traces: Traces,
    pub(crate) mesh_traces: MeshTraces,
    mesh_direction: MovingMesh,
    mesh_direction_traces: MeshTraces,
    terms: Vec<f64>,
    pub(crate) cells: PerThread<CellScratch>,
    pub(crate) facet_scratch: PerThread<FacetScratch>,
    pub(crate) wall_loads: WallLoads,
    /// For every boundary facet its number in the whole mesh.
    pub(crate) boundary_facets: Vec<usize>,
    /// Coefficients of own cells and ghosts.
    with_ghosts: Vec<f64>,
    /// The geometry on the mesh last set, where it is kept.
    pub(crate) geometry: SlabGeometry,
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// The operator on `mesh` (of order `orders.mesh`).
    ///
    /// # Panics
    /// If the orders disagree with the mesh, or a boundary has no condition.
    pub fn new(
        problem: Problem<D, M>,
        mesh: &Mesh<D>,
        numbering: NodeNumbering,
        orders: Orders,
        quadrature: Quadrature,
    ) -> Self {
        let boundary_facets = (0..mesh.boundary_facets().len()).collect();
        Self::of_cells(problem, mesh, (numbering, boundary_facets), orders, quadrature, Share::whole(mesh))
    }

    /// The operator on a share of `mesh`.
    ///
    /// # Panics
    /// As [`Self::new`].
    pub fn of_share(
        problem: Problem<D, M>,
        mesh: &Mesh<D>,
        numbering: &NodeNumbering,
        orders: Orders,
        quadrature: Quadrature,
        share: Share,
    ) -> Self {
        if share.is_whole() {
            return Self::new(problem, mesh, numbering.clone(), orders, quadrature);
        }
        let cells: Vec<usize> = share.cells().collect();
        let subset = mesh.subset(&cells, share.own.len());
        let numbering = (numbering.subset(&cells), subset.boundary_facets);
        Self::of_cells(problem, &subset.mesh, numbering, orders, quadrature, share)
    }

    /// The operator on the cells of `share`, which `mesh` consists of.
    fn of_cells(
        problem: Problem<D, M>,
        mesh: &Mesh<D>,
        (numbering, boundary_facets): (NodeNumbering, Vec<usize>),
        orders: Orders,
        quadrature: Quadrature,
        share: Share,
    ) -> Self {
        assert_eq!(mesh.order(), orders.mesh, "the mesh must have the order of the space");
        assert_eq!(mesh.boundary_names().len(), problem.kernels.boundaries(), "every boundary needs a condition");
        let tables = Tables::<D>::new(orders, M, quadrature);
        let (own, cells) = (share.own.len(), mesh.n_cells());
        let layout = Layout { cells: own, time_order: orders.time, components: M, nodes: orders.flow.pow(D as u32) };
        let facets = FacetBatches::new(mesh, orders.flow, orders.mesh);
        let moving = MovingMesh::new(mesh, numbering, orders.time);
        let flow_traces = trace_layout::<D>(orders.time, M, orders.flow);
        let mesh_traces = trace_layout::<D>(orders.time + 1, D, orders.mesh);
        let terms = facets.batches.len() * WIDTH * 2 * flow_traces.face_len();
        let mut operator = SlabOperator {
            flow_faces: FaceMaps::new(&tables.flow, D),
            mesh_faces: FaceMaps::new(&tables.mesh, D),
            start: 0.0,
            clock: Clock::stopped(0.0),
            held_time: None,
            dt: 0.0,
            position_rows: Vec::new(),
            positions: Matrix::identity(0),
            positions_and_top: Matrix::identity(0),
            bottom_values: tables.time.values(0.0),
            bottom_mass_product: vec![0.0; layout.at_one_time().len()],
            state_traces: Traces::new(flow_traces, cells),
            direction_traces: Traces::new(flow_traces, cells),
            mesh_traces: MeshTraces::new(mesh_traces, cells, facets.batches.len()),
            mesh_direction: moving.clone(),
            mesh_direction_traces: MeshTraces::new(mesh_traces, cells, facets.batches.len()),
            terms: vec![0.0; terms],
            geometry: SlabGeometry::new(&tables, problem.kernels.is_viscous(), own, facets.batches.len()),
            cells: PerThread::new(|| CellScratch::new::<D, M>(&tables)),
            facet_scratch: PerThread::new(|| FacetScratch::new::<D, M>(&tables)),
            wall_loads: WallLoads::unloaded(facets.batches.len()),
            share: Arc::new(share),
            boundary_facets,
            with_ghosts: Vec::new(),
            problem,
            mesh: moving,
            facets,
            layout,
            tables,
        };
        operator.set_bottom_determinants(&[]);
        operator
    }

    /// Time at the bottom of the slab, and its length.
    pub fn interval(&self) -> (f64, f64) {
        (self.start, self.dt)
    }

    /// The times at which the slab evaluates time-dependent data.
    pub(crate) fn clock(&self) -> Clock {
        self.clock
    }

    /// Evaluates all data of this and of later slabs at `time`: a steady flow depends on one time, although its slab is
    /// long.
    pub fn hold_time(&mut self, time: f64) {
        self.held_time = Some(time);
        self.clock = Clock::stopped(time);
    }

    /// The row of positions at the top of the slab.
    pub fn top_row(&self) -> Matrix {
        self.tables.top.position_row(self.dt)
    }

    /// Moves to the slab [`start`, `start + dt`] on top of `bottom`.
    pub fn begin_slab(&mut self, start: f64, dt: f64, bottom: Bottom) {
        let Bottom { state, displacement, determinants } = bottom;
        (self.start, self.dt) = (start, dt);
        self.clock = self.held_time.map_or(Clock::running(start, dt), Clock::stopped);
        let instants = self.tables.instants.iter().chain([&self.tables.top]);
        self.position_rows = instants.map(|instant| instant.position_row(dt)).collect();
        let (rows, slots, count) = (&self.position_rows, self.mesh.slots(), self.tables.instants.len());
        self.positions = Matrix::from_fn(count, slots, |q, slot| rows[q][(0, slot)]);
        self.positions_and_top = Matrix::from_fn(self.tables.times(), slots, |q, slot| rows[q][(0, slot)]);
        self.mesh.set_bottom(Some(displacement));
        self.set_bottom_determinants(determinants);
        let mut mass_product = std::mem::take(&mut self.bottom_mass_product);
        self.mass_product(state, SlabEnd::Bottom, &mut mass_product);
        self.bottom_mass_product = mass_product;
    }

    /// Sets the mesh velocities of the slab, `[time node][C0 node][component]`.
    pub fn set_mesh(&mut self, velocities: &[f64]) {
        self.mesh.set_velocities(velocities);
        self.mesh_traces.take(&self.mesh_faces, &self.mesh.data, &self.facets);
        self.take_geometry();
    }

    /// Sets the state at which Jacobian products are taken.
    pub fn linearise(&mut self, state: &[f64]) {
        let SlabOperator { share, layout, with_ghosts, state_traces, flow_faces, problem, .. } = self;
        let all = share.with_ghosts(state, layout.cell_len(), with_ghosts);
        state_traces.take(flow_faces, all, problem.kernels.is_viscous());
    }

    /// Takes the traces of a direction of the state.
    fn take_direction(&mut self, direction: &[f64]) {
        let SlabOperator { share, layout, with_ghosts, direction_traces, flow_faces, problem, .. } = self;
        let all = share.with_ghosts(direction, layout.cell_len(), with_ghosts);
        direction_traces.take(flow_faces, all, problem.kernels.is_viscous());
    }

    /// The state at which Jacobian products are taken.
    pub fn linearisation(&self) -> Vec<f64> {
        (0..self.layout.cells).flat_map(|cell| self.state_traces.coefficients_of(cell)).collect()
    }

    /// The residual R(U; V) at the mesh last set. An error is the first violation in the order of cells; `out` is then undefined.
    pub fn residual(&mut self, state: &[f64], out: &mut [f64]) -> Result<(), Violation> {
        self.linearise(state);
        let own = self.run(Differentiate::Nothing, out).map(|cell| self.describe_violation(cell));
        self.share.first_violation(own).map_or(Ok(()), Err)
    }

    /// The derivative of the residual along a direction of the state.
    pub fn product(&mut self, direction: &[f64], out: &mut [f64]) {
        self.take_direction(direction);
        self.run(Differentiate::State, out);
    }

    /// The derivative of the residual along directions of the state and of the mesh velocities.
    pub fn product_with_mesh(&mut self, direction: &[f64], velocities: &[f64], out: &mut [f64]) {
        self.take_direction(direction);
        self.mesh_direction.set_direction(velocities);
        self.mesh_direction_traces.take(&self.mesh_faces, &self.mesh_direction.data, &self.facets);
        self.run(Differentiate::StateAndMesh, out);
    }

    /// Moments int w u J of a state at an end of the slab.
    pub fn mass_product(&self, state: &[f64], end: SlabEnd, out: &mut [f64]) {
        let layout = self.layout.at_one_time();
        let row = if end == SlabEnd::Bottom { self.tables.bottom_row() } else { self.top_row() };
        out.par_chunks_mut(WIDTH * layout.cell_len()).enumerate().for_each(|(batch, out)| {
            self.cells.with(|scratch| {
                let cells = cells_of(batch, layout.cells);
                gather(cells.map(|c| &state[layout.cell(c)]), &mut scratch.state_at[..layout.cell_len()]);
                self.gather_end(batch, end, row.row(0), scratch);
                self.problem.kernels.mass_product(&self.tables, scratch);
                scatter(&scratch.mass_product_at[..layout.cell_len()], layout.cell_len(), out);
            });
        });
    }

    /// out += factor (W (x) M) x, with M the mass matrix at the bottom of the slab: the term of pseudo-time.
    pub fn add_mass(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        let (layout, one) = (self.layout, self.layout.at_one_time());
        let (mut state, mut mass_product) = (vec![0.0; one.len()], vec![0.0; one.len()]);
        for (a, weight) in self.tables.time.weights().iter().enumerate() {
            for cell in 0..layout.cells {
                state[one.cell(cell)].copy_from_slice(&x[layout.cell_at(cell, a)]);
            }
            self.mass_product(&state, SlabEnd::Bottom, &mut mass_product);
            for cell in 0..layout.cells {
                let out = &mut out[layout.cell_at(cell, a)];
                out.iter_mut().zip(&mass_product[one.cell(cell)]).for_each(|(out, m)| *out += factor * weight * m);
            }
        }
    }

    /// Facets, then cells: the terms of every facet are computed once and read by both its cells. Returns the first cell, in the order of the whole mesh, with a NaN in
    /// its result: violations are passed on as NaN, and arithmetic may produce it.
    fn run(&mut self, along: Differentiate, out: &mut [f64]) -> Option<usize> {
        let (mut terms, mut loads) = (std::mem::take(&mut self.terms), std::mem::take(&mut self.wall_loads.terms));
        let facet_len = 2 * self.state_traces.layout.face_len();
        let facets = terms.par_chunks_mut(WIDTH * facet_len).zip(&mut loads).zip(&self.facets.batches);
        facets.with_max_len(BATCHES_PER_TASK).for_each(|((terms, loads), batch)| {
            self.facet_scratch.with(|scratch| self.facet_batch(along, batch, scratch, terms, loads));
        });
        self.wall_loads.terms = loads;
        self.sum_loads();
        let (cell_len, first) = (self.layout.cell_len(), AtomicUsize::new(usize::MAX));
        let cells = out.par_chunks_mut(WIDTH * cell_len).enumerate();
        cells.with_max_len(BATCHES_PER_TASK).for_each(|(batch, out)| {
            self.cells.with(|scratch| self.cell_batch(along, batch, scratch, &terms, out));
            for (lane, out) in out.chunks_exact(cell_len).enumerate() {
                if !sums_to_a_number(out) {
                    first.fetch_min(self.share.own[batch * WIDTH + lane], Ordering::Relaxed);
                }
            }
        });
        self.terms = terms;
        let first = first.into_inner();
        if first == usize::MAX {
            return None;
        }
        self.share.own.iter().position(|&cell| cell == first)
    }

    /// The facet terms of one batch, `[facet][side][kind][a][m][face node]`, every side in its own lattice.
    fn facet_batch(
        &self,
        along: Differentiate,
        batch: &FacetBatch,
        scratch: &mut FacetScratch,
        terms: &mut [f64],
        loads: &mut [f64],
    ) {
        let viscous = self.problem.kernels.is_viscous();
        let state = &self.state_and_direction()[..along.state_blocks()];
        self.gather_states(along, state, batch, scratch);
        let geometry = self.facet_geometry(along, batch);
        if geometry.is_none() || batch.boundary.is_some() {
            self.gather_mesh(along, batch, scratch);
        }
        let (instants, test) = (&self.tables.instants[..], &self.tables.test);
        let times = Times { instants, in_time: self.in_time(), test, weight: self.dt };
        scratch.with_loads = !loads.is_empty();
        self.facet_kernel(along, batch, (&times, geometry), scratch);
        scatter_loads(&scratch.loads, loads);
        scratch.with_loads = false;
        self.scatter_terms(batch, scratch, viscous, terms);
    }

    /// The map from time nodes and slots to the Gauss points in time.
    pub(crate) fn in_time(&self) -> InTime<'_> {
        InTime { values: &self.tables.values, velocities: &self.tables.velocities, positions: &self.positions }
    }

    /// Runs the facet kernel on a batch that has been gathered, with its geometry at these times if that is known.
    pub(crate) fn facet_kernel(
        &self,
        along: Differentiate,
        batch: &FacetBatch,
        (times, geometry): (&Times, Option<&[Pack]>),
        scratch: &mut FacetScratch,
    ) {
        self.across(along, batch, |context, across| {
            self.problem.kernels.facets(along, &FacetContext { geometry, ..*context }, times, across, scratch);
        });
    }

    /// Passes the data on the other side of the facets of a batch to `kernel`.
    pub(crate) fn across(
        &self,
        along: Differentiate,
        batch: &FacetBatch,
        kernel: impl FnOnce(&FacetContext<D>, &Across),
    ) {
        let field = batch.boundary.and_then(|boundary| self.problem.data[boundary].as_deref());
        let fill = |time: f64, x: &[Pack], data: &mut [Pack]| {
            if let Some(field) = field {
                let (blocks, origins) = (along.geometry_blocks(), self.facet_origins(batch));
                Prescribed { field, blocks, origins }.fill(time, self.tables.facet_points(), x, data);
            }
        };
        let data = field.is_some().then_some(&fill as DataAt);
        let across = batch.boundary.map_or(Across::Cells, |boundary| Across::Boundary(boundary, data));
        kernel(&FacetContext { tables: &self.tables, dt: self.dt, clock: self.clock, geometry: None }, &across);
    }

    /// The origins of the positions of a batch of facets, those of the minus cells.
    pub(crate) fn facet_origins(&self, batch: &FacetBatch) -> [&[f64]; WIDTH] {
        batch.minus.map(|side| self.mesh.origin(side.cell))
    }

    /// Volume terms and facet terms of one batch of cells.
    fn cell_batch(
        &self,
        along: Differentiate,
        batch: usize,
        scratch: &mut CellScratch,
        terms: &[f64],
        out: &mut [f64],
    ) {
        let cell_len = self.layout.cell_len();
        let state = self.state_and_direction().map(|traces| traces.coefficients(batch));
        let mesh = self.mesh_and_direction().map(|traces| traces.coefficients(batch));
        let (state, mesh) = (&state[..along.state_blocks()], &mesh[..along.geometry_blocks()]);
        let fill = |time: f64, points: usize, x: &[Pack], data: &mut [Pack]| {
            if let Some(field) = self.problem.source.as_deref() {
                let origins = cells_of(batch, self.layout.cells).map(|cell| self.mesh.origin(cell));
                Prescribed { field, blocks: along.geometry_blocks(), origins }.fill(time, points, x, data);
            }
        };
        let context = CellContext {
            tables: &self.tables,
            dt: self.dt,
            clock: self.clock,
            positions: &self.positions_and_top,
            source: self.problem.source.is_some().then_some(&fill),
            geometry: self.geometry.of_cells(batch).filter(|_| mesh.len() == 1),
        };
        if mesh.len() == 2 {
            self.differentiate_geometry(batch, scratch);
        }
        self.problem.kernels.slab_cells(along, &context, CellCoefficients { state, mesh }, scratch);
        self.lift(cells_of(batch, self.layout.cells), terms, scratch);
        scatter(&scratch.residual, cell_len, out);
        for (lane, out) in out.chunks_exact_mut(cell_len).enumerate() {
            if along == Differentiate::Nothing {
                self.subtract_bottom(batch * WIDTH + lane, out);
            }
            if scratch.violated.0[lane] != 0.0 {
                out[0] = f64::NAN;
            }
        }
    }

    fn state_and_direction(&self) -> [&Traces; 2] {
        [&self.state_traces, &self.direction_traces]
    }
    pub(crate) fn mesh_and_direction(&self) -> [&MeshTraces; 2] {
        [&self.mesh_traces, &self.mesh_direction_traces]
    }

    /// Adds the terms of the facets of a batch of cells to its residual.
    fn lift(&self, cells: [usize; WIDTH], terms: &[f64], scratch: &mut CellScratch) {
        let (layout, viscous) = (self.state_traces.layout, self.problem.kernels.is_viscous());
        let len = if viscous { layout.face_len() } else { layout.kind_len() };
        for (face, packs) in scratch.face_terms.chunks_exact_mut(layout.face_len()).enumerate() {
            let of_cell = |cell: usize| {
                let (slot, side) = self.facets.of_face[cell * 2 * D + face];
                let start = (2 * slot as usize + side as usize) * layout.face_len();
                &terms[start..start + len]
            };
            gather(cells.map(of_cell), &mut packs[..len]);
        }
        let tensors = layout.slots * layout.components;
        self.flow_faces.lift(tensors, &scratch.face_terms, viscous, &mut scratch.residual);
    }

    /// - phi_a(0) int_K w u_n J at t_n.
    fn subtract_bottom(&self, cell: usize, out: &mut [f64]) {
        let mass_product = &self.bottom_mass_product[self.layout.at_one_time().cell(cell)];
        for (out, phi) in out.chunks_exact_mut(mass_product.len()).zip(&self.bottom_values) {
            for (r, m) in out.iter_mut().zip(mass_product) {
                *r -= phi * m;
            }
        }
    }
}

/// Whether all of `r` is finite: sums of it are then finite too, except for overflow. Several independent sums, so that none waits
/// for another.
fn sums_to_a_number(r: &[f64]) -> bool {
    let mut sums = [0.0; WIDTH];
    let (chunks, rest) = r.as_chunks::<WIDTH>();
    for chunk in chunks {
        sums.iter_mut().zip(chunk).for_each(|(sum, r)| *sum += r);
    }
    sums.iter().chain(rest).sum::<f64>().is_finite()
}

fn trace_layout<const D: usize>(slots: usize, components: usize, order: usize) -> TraceLayout {
    TraceLayout { faces: 2 * D, slots, components, nodes: order.pow(D as u32), face_nodes: order.pow(D as u32 - 1) }
}
