//! The space-time operator of a slab: residual and Jacobian products of all cells.

mod build;
mod evaluation;

use crate::batches::{FacetBatches, cells_of};
use crate::field::StateField;
use crate::gather::{gather, scatter};
use crate::kernels::{Differentiate, Kernels};
use crate::layout::Layout;
use crate::mesh_traces::MeshTraces;
use crate::moving_mesh::MovingMesh;
use crate::parallel::{self, Grain};
use crate::per_thread::PerThread;
use crate::scratch::{CellScratch, FacetScratch};
use crate::share::Share;
use crate::slab_geometry::{SlabEnd, SlabGeometry};
use crate::tables::Tables;
use crate::time_points::Clock;
use crate::traces::{FaceMaps, Traced, Traces};
use crate::wall_loads::NodalLoads;
use basis::Matrix;
use mesh::{Side, face_nodes};
use std::array::from_fn;
use std::sync::Arc;
use tensor::{Pack, WIDTH, norm};

/// Faces of two cells that lie apart by more than this part of a cell are those of a periodic boundary.
const LEAST_PERIOD: f64 = 1e-3;

/// The data of a slab operator.
pub struct Problem<const D: usize, const M: usize> {
    /// The law with its boundary conditions.
    pub kernels: Box<dyn Kernels<D, M>>,
    /// For every boundary the states that its condition prescribes, if it takes any.
    pub data: Vec<Option<Arc<dyn StateField<D, M>>>>,
    /// The source b.
    pub source: Option<Arc<dyn StateField<D, M>>>,
}

/// The state and the mesh at the bottom of a slab.
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
/// R_a(U; V) = (volume) + (facet) - phi_a(0) int_K psi u_n J |_{t_n}                                                 (slab)
/// ```
///
/// with `u` laid out by [`Layout`], and its exact derivatives along directions of state and mesh. On a rank it holds the rows of the own
/// cells, and evaluations are collective.
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
    /// Positions at the Gauss points in time, `[time point][slot]`, and the same with the top as the last row.
    pub(crate) positions: Matrix,
    pub(crate) positions_and_top: Matrix,
    bottom_values: Vec<f64>,
    bottom_mass_product: Vec<f64>,
    /// The state of own cells and ghosts at which products are taken.
    state: Vec<f64>,
    state_traces: Traces,
    /// The direction of products in ghosts, at the nodes of faces at the cuts.
    direction_of_ghosts: Vec<f64>,
    direction_traces: Traces,
    mesh_traces: MeshTraces,
    mesh_direction: MovingMesh,
    mesh_direction_traces: MeshTraces,
    /// The derivatives of mesh or direction, while their traces are taken.
    mesh_derivatives: Traces,
    terms: Vec<f64>,
    pub(crate) cells: PerThread<CellScratch>,
    pub(crate) facet_scratch: PerThread<FacetScratch>,
    pub(crate) wall_loads: NodalLoads,
    /// For every boundary facet its number in the whole mesh.
    pub(crate) boundary_facets: Vec<usize>,
    /// The geometry on the mesh last set, where it is kept.
    pub(crate) geometry: SlabGeometry,
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
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

    /// The time at which all data are evaluated, if they do not follow the slabs.
    pub fn held_time(&self) -> Option<f64> {
        self.held_time
    }

    /// Whether another cell lies behind `face` of an own cell.
    pub fn has_neighbour(&self, cell: usize, face: usize) -> bool {
        self.facets.is_interior(cell * 2 * D + face)
    }

    /// The other side of a face; on a boundary the face itself.
    pub(crate) fn across_face(&self, cell: usize, face: usize) -> Side {
        let (slot, side) = self.facets.of_face[cell * 2 * D + face];
        let (batch, lane) = (&self.facets.batches[slot as usize / WIDTH], slot as usize % WIDTH);
        if side == 0 { batch.plus[lane].0 } else { batch.minus[lane] }
    }

    /// How far the other side of `face` of an own cell lies from it at the bottom of the slab: by the period across a periodic boundary, else
    /// not at all.
    pub fn period_across(&self, cell: usize, face: usize) -> [f64; D] {
        let across = self.across_face(cell, face);
        let [here, there] =
            [(cell, face), (across.cell, across.face)].map(|(cell, face)| self.centre_of_face(cell, face));
        let difference = |a: [f64; D], b: [f64; D]| -> [f64; D] { from_fn(|d| a[d] - b[d]) };
        let size = norm(&difference(here, self.centre_of_face(cell, face ^ 1)));
        let apart = difference(there, here);
        if norm(&apart) > LEAST_PERIOD * size { apart } else { [0.0; D] }
    }

    /// The mean of the nodes of a face at the bottom of the slab.
    fn centre_of_face(&self, cell: usize, face: usize) -> [f64; D] {
        let mut position = vec![0.0; self.mesh.slot_len()];
        self.mesh.positions(cell, self.tables.bottom_row().row(0), &mut position);
        let on_face = face_nodes(D, self.tables.orders.mesh, face);
        let nodes = position.len() / D;
        from_fn(|d| on_face.iter().map(|&i| position[d * nodes + i]).sum::<f64>() / on_face.len() as f64)
    }

    /// The row of positions at the top of the slab.
    pub fn top_row(&self) -> Matrix {
        self.tables.top.position_row(self.dt)
    }

    /// Puts the mesh on a `displacement`, `[C0 node][component]`, where no slab has begun.
    pub fn set_displacement(&mut self, displacement: &[f64]) {
        self.mesh.set_bottom(Some(displacement));
        self.set_bottom_determinants(&[]);
    }

    /// Moves to the slab [`start`, `start + dt`] on top of `bottom`.
    pub fn begin_slab(&mut self, start: f64, dt: f64, bottom: Bottom) {
        let Bottom { state, displacement, determinants } = bottom;
        (self.start, self.dt) = (start, dt);
        self.clock = Clock::of_slab(start, dt, self.held_time);
        let time_points = self.tables.time_points.iter().chain([&self.tables.top]);
        self.position_rows = time_points.map(|time_point| time_point.position_row(dt)).collect();
        let (rows, slots, count) = (&self.position_rows, self.mesh.slots(), self.tables.time_points.len());
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
        let SlabOperator { mesh, mesh_faces, mesh_traces, mesh_derivatives, facets, .. } = self;
        take_mesh(mesh, mesh_faces, mesh_derivatives, facets, mesh_traces);
        self.take_geometry();
    }

    /// Sets the state at which Jacobian products are taken.
    pub fn linearise(&mut self, state: &[f64]) {
        self.share.with_ghosts(state, self.layout.cell_len(), &mut self.state);
        self.state_traces.take(&self.flow_faces, &self.state);
    }

    /// The state of own cells and ghosts, with its traces.
    pub(crate) fn traced_state(&self) -> Traced<'_> {
        Traced { coefficients: &self.state, ghosts: &[], traces: &self.state_traces }
    }

    /// The state at which Jacobian products are taken.
    pub fn linearisation(&self) -> Vec<f64> {
        self.state[..self.layout.len()].to_vec()
    }

    /// The residual R(U; V) at the mesh last set. An error is the first violation in the order of cells; `out` is then undefined.
    pub fn residual(&mut self, state: &[f64], out: &mut [f64]) -> Result<(), Violation> {
        self.linearise(state);
        let own = self.run(Differentiate::Nothing, &[], out).map(|cell| self.describe_violation(cell));
        self.share.first_violation(own).map_or(Ok(()), Err)
    }

    /// The derivative of the residual along a direction of the state.
    pub fn product(&mut self, direction: &[f64], out: &mut [f64]) {
        self.direction_traces.take(&self.flow_faces, direction);
        self.run(Differentiate::State, direction, out);
    }

    /// The derivative of the residual along directions of the state and of the mesh velocities.
    pub fn product_with_mesh(&mut self, direction: &[f64], velocities: &[f64], out: &mut [f64]) {
        self.direction_traces.take(&self.flow_faces, direction);
        self.mesh_direction.set_direction(velocities);
        let SlabOperator { mesh_direction, mesh_faces, mesh_direction_traces, mesh_derivatives, facets, .. } = self;
        take_mesh(mesh_direction, mesh_faces, mesh_derivatives, facets, mesh_direction_traces);
        self.run(Differentiate::StateAndMesh, direction, out);
    }

    /// Mass product int psi u J of a state at an end of the slab.
    pub fn mass_product(&self, state: &[f64], end: SlabEnd, out: &mut [f64]) {
        let cell_len = self.layout.time_len();
        self.mass_products(state, end, cell_len, out, |product, out| scatter(product, cell_len, out));
    }

    /// The integral of every component over every own cell at an end of the slab, `[cell][component]`.
    pub fn integrals(&self, state: &[f64], end: SlabEnd) -> Vec<f64> {
        let mut integrals = vec![0.0; self.layout.cells * M];
        self.mass_products(state, end, M, &mut integrals, |product, out| {
            for (lane, out) in out.chunks_exact_mut(M).enumerate() {
                let components = product.chunks_exact(self.layout.nodes);
                let integrals = components.map(|component| component.iter().map(|pack| pack.0[lane]).sum());
                out.iter_mut().zip(integrals).for_each(|(out, integral)| *out = integral);
            }
        });
        integrals
    }

    /// Passes the mass products of every batch of cells, `[component][node]`, to `put` with the part of `out` of these cells: `len` numbers
    /// for each.
    fn mass_products(
        &self,
        state: &[f64],
        end: SlabEnd,
        len: usize,
        out: &mut [f64],
        put: impl Fn(&[Pack], &mut [f64]) + Sync,
    ) {
        let layout = self.layout.at_one_time();
        let row = if end == SlabEnd::Bottom { self.tables.bottom_row() } else { self.top_row() };
        parallel::for_each_chunk(out, WIDTH * len, Grain::Any, &|batch, out| {
            self.cells.with(|scratch| {
                let cells = cells_of(batch, layout.cells);
                gather(cells.map(|c| &state[layout.cell(c)]), &mut scratch.state_at[..layout.cell_len()]);
                self.gather_end(batch, end, row.row(0), scratch);
                self.problem.kernels.mass_product(&self.tables, scratch);
                put(&scratch.mass_product_at[..layout.cell_len()], out);
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
}

/// Takes the traces of `mesh` on facets; `derivatives` is room.
fn take_mesh(
    mesh: &MovingMesh,
    faces: &FaceMaps,
    derivatives: &mut Traces,
    facets: &FacetBatches,
    to: &mut MeshTraces,
) {
    derivatives.take(faces, &mesh.data);
    to.take(Traced { coefficients: &mesh.data, ghosts: &[], traces: derivatives }, facets);
}
