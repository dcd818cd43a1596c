//! The entries of [`SpaceJacobian`] at one time of the slab, for flow preconditioners: derivatives by dual numbers along unit directions,
//! computed by the kernels of the residual.

use crate::batches::{FacetBatch, cells_of};
use crate::cell::{CellContext, SourceAt};
use crate::facet_geometry::GeometryOfFacets;
use crate::gather::gather;
use crate::kernels::{Differentiate, Times};
use crate::layout::Layout;
use crate::operator::SlabOperator;
use crate::parallel::{self, Grain};
use crate::scratch::{CellScratch, FacetScratch, SideScratch};
use crate::space_jacobian::{Coupling, SpaceJacobian, Stored, TraceSpace};
use crate::time_points::{InTime, TimePoint};
use crate::traces::{TraceLayout, Traced, Traces};
use basis::Matrix;
use tensor::{Arch, Pack, WIDTH};

/// Data that are fixed while blocks are computed.
pub(crate) struct FrozenPoint {
    time_point: TimePoint,
    row: Matrix,
    test: Matrix,
    /// Of own cells and ghosts.
    state: Vec<f64>,
    pub(crate) traces: Traces,
}

impl FrozenPoint {
    fn in_time(&self) -> InTime<'_> {
        InTime { values: &self.time_point.values, velocities: &self.time_point.velocities, positions: &self.row }
    }
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// The blocks at position `s` of the slab, in the state and on the mesh last set.
    pub fn space_jacobian<T: Stored>(&self, s: f64) -> SpaceJacobian<T> {
        let (block, Layout { cells, nodes, .. }) = (self.layout.time_len(), self.layout);
        let mut jacobian = SpaceJacobian {
            block,
            diagonal: vec![T::default(); cells * block * block],
            mass: vec![T::default(); cells * nodes * nodes],
            couplings: Vec::new(),
            traces: TraceSpace::new(&self.flow_faces, 2 * D, M, nodes, self.problem.kernels.is_viscous()),
        };
        self.update_space_jacobian(s, &mut jacobian);
        jacobian
    }

    /// [`Self::space_jacobian`] in the memory of an earlier one of this operator: new pages cost as much as computing their contents.
    pub fn update_space_jacobian<T: Stored>(&self, s: f64, jacobian: &mut SpaceJacobian<T>) {
        let frozen = self.freeze(s);
        let SpaceJacobian { block, diagonal, mass, couplings, traces } = jacobian;
        self.cell_blocks(&frozen, diagonal, mass);
        couplings.clear();
        let batches = &self.facets.batches;
        let facets = parallel::map(batches.len(), Grain::Any, &|k| self.facet_blocks(&batches[k], &frozen, traces));
        let facets: Vec<FacetBlocks<T>> = facets.into_iter().flatten().collect();
        let first = self.first_of_batches();
        parallel::for_each_chunk(diagonal, *block * *block, Grain::Any, &|cell, diagonal| {
            for face in 0..2 * D {
                let (slot, side) = self.facets.of_face[cell * 2 * D + face];
                let facet = first[slot as usize / WIDTH] + slot as usize % WIDTH;
                let blocks = &facets[facet];
                traces.add_lifted([face; 2], &blocks.own[side as usize], diagonal);
                if let Some(Coupling { faces: [minus, plus], minus_plus, plus_minus, .. }) =
                    blocks.of_a_cell_with_itself()
                    && side == 0
                {
                    traces.add_lifted([*minus, *plus], minus_plus, diagonal);
                    traces.add_lifted([*plus, *minus], plus_minus, diagonal);
                }
            }
        });
        let between_cells = facets.into_iter().filter(|blocks| blocks.of_a_cell_with_itself().is_none());
        couplings.extend(between_cells.filter_map(|blocks| blocks.coupling));
    }

    /// For every coupling of [`Self::space_jacobian`] how the lattices of its two faces meet: for every flow node in that of the minus side, the
    /// node in that of the plus side.
    pub fn lattices_of_couplings(&self) -> Vec<Vec<usize>> {
        let interior = self.facets.batches.iter().filter(|batch| batch.boundary.is_none());
        let facets = interior.flat_map(|batch| (0..batch.count).map(move |lane| (batch, lane)));
        let between_cells = facets.filter(|(batch, lane)| batch.minus[*lane].cell != batch.plus[*lane].0.cell);
        between_cells.map(|(batch, lane)| self.own_lattice(batch, lane, 1).to_vec()).collect()
    }

    /// For each batch of facets, the number of facets before it.
    pub(crate) fn first_of_batches(&self) -> Vec<usize> {
        let counts = self.facets.batches.iter().map(|batch| batch.count);
        counts.scan(0, |sum, count| Some(std::mem::replace(sum, *sum + count))).collect()
    }

    pub(crate) fn freeze(&self, s: f64) -> FrozenPoint {
        let time_point = TimePoint::of_space(&self.tables.time, s);
        let state = self.state_at(s);
        let layout = TraceLayout { slots: 1, ..self.traced_state().traces.layout };
        let mut traces = Traces::new(layout, self.all_cells());
        traces.take(&self.flow_faces, &state);
        FrozenPoint {
            row: time_point.position_row(self.interval().1),
            test: Matrix::identity(1),
            time_point,
            state,
            traces,
        }
    }

    /// Own cells and ghosts.
    pub(crate) fn all_cells(&self) -> usize {
        self.share.own.len() + self.share.ghosts.len()
    }

    /// The state of own cells and ghosts last set, at position `s`.
    pub(crate) fn state_at(&self, s: f64) -> Vec<f64> {
        let one = self.layout.at_one_time();
        let (cells, linearisation) = (self.all_cells(), self.traced_state().coefficients);
        let mut state = vec![0.0; cells * one.cell_len()];
        for (a, phi) in self.tables.time.values(s).into_iter().enumerate() {
            for cell in 0..cells {
                let nodal = &linearisation[self.layout.cell_at(cell, a)];
                state[one.cell(cell)].iter_mut().zip(nodal).for_each(|(u, value)| *u += phi * value);
            }
        }
        state
    }

    /// Volume part of A_ii, and the mass matrices.
    fn cell_blocks<T: Stored>(&self, frozen: &FrozenPoint, diagonal: &mut [T], mass: &mut [T]) {
        let (block, nodes) = (self.layout.time_len(), self.layout.nodes);
        let (diagonal, mass) = ((diagonal, WIDTH * block * block), (mass, WIDTH * nodes * nodes));
        parallel::for_each_pair(diagonal, mass, Grain::Any, &|batch, diagonal, mass| {
            self.cells.with(|scratch| self.cell_batch_blocks(batch, frozen, scratch, diagonal, mass));
        });
    }

    fn cell_batch_blocks<T: Stored>(
        &self,
        batch: usize,
        frozen: &FrozenPoint,
        scratch: &mut CellScratch,
        diagonal: &mut [T],
        mass: &mut [T],
    ) {
        let (block, nodes) = (self.layout.time_len(), self.layout.nodes);
        self.gather_frozen(batch, frozen, scratch);
        for column in 0..block {
            self.along_cells(frozen, scratch, |direction| direction[column] = Pack([1.0; WIDTH]));
            write_column(&scratch.flux_at, block, column, diagonal);
            if column < nodes {
                write_column(&scratch.mass_product_at, nodes, column, mass);
            }
        }
    }

    /// Reads state and mesh of a batch of cells.
    pub(crate) fn gather_frozen(&self, batch: usize, frozen: &FrozenPoint, scratch: &mut CellScratch) {
        let (block, cells) = (self.layout.time_len(), cells_of(batch, self.layout.cells));
        gather(cells.map(|c| &frozen.state[c * block..(c + 1) * block]), &mut scratch.state_at[..block]);
        let rows = [frozen.row.row(0), frozen.time_point.velocities.row(0)];
        self.geometry_of_space(batch, rows, &mut scratch.geometry);
    }

    /// Runs the cell kernel on a gathered batch, along the direction `[m][node]` that `set` writes over zeros.
    pub(crate) fn along_cells(&self, frozen: &FrozenPoint, scratch: &mut CellScratch, set: impl FnOnce(&mut [Pack])) {
        let (block, (_, dt)) = (self.layout.time_len(), self.interval());
        let direction = &mut scratch.state_at[block..2 * block];
        direction.fill(Pack::ZERO);
        set(direction);
        let context = CellContext {
            tables: &self.tables,
            dt,
            clock: self.clock(),
            positions: &frozen.row,
            source: self.problem.source.is_some().then_some(&no_source as SourceAt),
            geometry: None,
        };
        self.problem.kernels.space_cells(&context, &frozen.time_point, scratch);
    }

    /// The blocks of a batch of facets in traces.
    fn facet_blocks<T: Stored>(
        &self,
        batch: &FacetBatch,
        frozen: &FrozenPoint,
        traces: &TraceSpace,
    ) -> Vec<FacetBlocks<T>> {
        let sides = batch.sides();
        let mut blocks: Vec<_> = (0..batch.count).map(|lane| FacetBlocks::new(batch, lane, traces.len())).collect();
        self.facet_scratch.with(|scratch| {
            self.gather_frozen_facets(batch, frozen, scratch);
            for side in 0..sides {
                for column in 0..traces.len() {
                    self.facet_column(batch, frozen, [side, column], traces, scratch);
                    for (lane, blocks) in blocks.iter_mut().enumerate() {
                        let maps = [0, 1].map(|side| self.own_lattice(batch, lane, side));
                        blocks.write(lane, [side, column], traces, scratch, maps);
                    }
                }
            }
        });
        blocks
    }

    /// The permutation from the batch's common lattice to the lattice of one side.
    fn own_lattice(&self, batch: &FacetBatch, lane: usize, side: usize) -> &[usize] {
        &self.facets.lattice(batch, lane, side).flow
    }

    /// Runs the facet kernel along one unit direction: trace `column[1]` of side `column[0]`.
    fn facet_column(
        &self,
        batch: &FacetBatch,
        frozen: &FrozenPoint,
        column: [usize; 2],
        traces: &TraceSpace,
        scratch: &mut FacetScratch,
    ) {
        let len = frozen.traces.layout.kind_len();
        let (kind, number) = traces.split(column[1]);
        self.along_facets(batch, frozen, scratch, |sides| {
            sides[column[0]].state[(2 * kind + 1) * len + number] = Pack([1.0; WIDTH]);
        });
    }

    /// Reads the traces of state and mesh on a batch of facets, and computes its geometry.
    pub(crate) fn gather_frozen_facets(&self, batch: &FacetBatch, frozen: &FrozenPoint, scratch: &mut FacetScratch) {
        let state = Traced { coefficients: &frozen.state, ghosts: &[], traces: &frozen.traces };
        self.gather_states(Differentiate::State, &[state], batch, scratch);
        self.gather_mesh(Differentiate::Nothing, batch, scratch);
        let (viscous, used, in_time) = (self.problem.kernels.is_viscous(), batch.sides(), frozen.in_time());
        let mut out = std::mem::take(&mut scratch.geometry);
        Arch::new().dispatch(GeometryOfFacets { tables: &self.tables, viscous, used, in_time, scratch, out: &mut out });
        scratch.geometry = out;
    }

    /// Runs the facet kernel on a gathered batch, along the direction that `set` writes over zeros: `[kind][b][m][face node]` with b = 1
    /// in the state of each side.
    pub(crate) fn along_facets(
        &self,
        batch: &FacetBatch,
        frozen: &FrozenPoint,
        scratch: &mut FacetScratch,
        set: impl FnOnce(&mut [SideScratch; 2]),
    ) {
        let len = frozen.traces.layout.kind_len();
        // For each kind, the values and then the direction.
        for kind in scratch.sides.iter_mut().flat_map(|side| side.state.chunks_exact_mut(2 * len).take(2)) {
            kind[len..].fill(Pack::ZERO);
        }
        set(&mut scratch.sides);
        let time_points = std::slice::from_ref(&frozen.time_point);
        let times = Times { time_points, in_time: frozen.in_time(), test: &frozen.test, weight: 1.0 };
        let geometry = std::mem::take(&mut scratch.geometry);
        self.facet_kernel(Differentiate::State, batch, &times, Some(&geometry), scratch);
        scratch.geometry = geometry;
    }
}

/// Blocks leave the source out. It does not depend on the state, or weakly: a body force or a sponge changes the gas little while a wave
/// crosses a cell.
fn no_source(_: f64, _: usize, _: &[Pack], data: &mut [Pack]) {
    data.fill(Pack::ZERO);
}

/// Blocks of one facet in traces, by columns.
struct FacetBlocks<T> {
    /// Row and column of the same side.
    own: [Vec<f64>; 2],
    coupling: Option<Coupling<T>>,
}

impl<T: Stored> FacetBlocks<T> {
    fn new(batch: &FacetBatch, lane: usize, traces: usize) -> Self {
        let (own, square) = (|| vec![0.0; traces * traces], || vec![T::default(); traces * traces]);
        let (minus, plus) = (batch.minus[lane], batch.plus[lane].0);
        let coupling = batch.boundary.is_none().then(|| Coupling {
            cells: [minus.cell, plus.cell],
            faces: [minus.face, plus.face],
            minus_plus: square(),
            plus_minus: square(),
        });
        FacetBlocks { own: [own(), if coupling.is_some() { own() } else { Vec::new() }], coupling }
    }

    /// The coupling of a cell that is its own neighbour across a periodic boundary.
    fn of_a_cell_with_itself(&self) -> Option<&Coupling<T>> {
        self.coupling.as_ref().filter(|coupling| coupling.cells[0] == coupling.cells[1])
    }

    /// Stores the derivatives along trace `column[1]` of side `column[0]`; `lattices` map to each side's own lattice.
    fn write(
        &mut self,
        lane: usize,
        column: [usize; 2],
        traces: &TraceSpace,
        scratch: &FacetScratch,
        lattices: [&[usize]; 2],
    ) {
        let [side, number] = column;
        let column = traces.permuted(number, lattices[side]) * traces.len();
        for row_side in 0..(if self.coupling.is_some() { 2 } else { 1 }) {
            let terms = scratch.sides[row_side].terms[..traces.len()].iter().map(|term| term.0[lane]).enumerate();
            let at = terms.map(|(row, term)| (column + traces.permuted(row, lattices[row_side]), term));
            match (row_side == side, row_side, &mut self.coupling) {
                (true, ..) => at.for_each(|(entry, term)| self.own[side][entry] = term),
                (false, 0, Some(coupling)) => at.for_each(|(entry, term)| coupling.minus_plus[entry] = T::of(term)),
                (false, _, Some(coupling)) => at.for_each(|(entry, term)| coupling.plus_minus[entry] = T::of(term)),
                (false, _, None) => return,
            }
        }
    }
}

fn write_column<T: Stored>(packs: &[Pack], n: usize, column: usize, out: &mut [T]) {
    for (lane, out) in out.chunks_exact_mut(n * n).enumerate() {
        let out = &mut out[column * n..][..n];
        out.iter_mut().zip(packs).for_each(|(out, pack)| *out = T::of(pack.0[lane]));
    }
}
