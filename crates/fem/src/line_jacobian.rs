//! The Jacobian of the operator of space along the lines of each cell, for preconditioners by directions.
//!
//! Consider functions of one reference coordinate, constant along the others. The volume terms of a cell and the terms of the two
//! faces at the ends of its lines form a one-dimensional operator:
//!
//! ```text
//! L_k = P_k^T (A_cell + A_2k + A_2k+1) P_k,    m_k = P_k^T M P_k,    (P_k c)(xi) = sum_i c_i phi_i(xi_k)             (lines)
//! ```
//!
//! with the derivatives of a face with respect to the cell's own trace alone.

use crate::batches::FacetBatch;
use crate::linearisation::FrozenPoint;
use crate::operator::SlabOperator;
use crate::parallel::{self, Grain};
use crate::scratch::{CellScratch, FacetScratch};
use crate::space_jacobian::TraceSpace;
use crate::traces::FaceMaps;
use tensor::{Pack, WIDTH};

/// (lines) of all cells at one time.
pub struct LineJacobian {
    /// Axes of a cell.
    pub dimension: usize,
    /// Nodes of a line.
    pub nodes: usize,
    /// Unknowns of a line: components times nodes.
    pub block: usize,
    /// L_k, `[cell][axis][column][row]` over `[component][node]`.
    pub operators: Vec<f32>,
    /// m_k, the same for every component, `[cell][axis][column][row]` over nodes.
    pub masses: Vec<f32>,
}

impl LineJacobian {
    /// L_k of a cell.
    pub fn operator(&self, cell: usize, axis: usize) -> &[f32] {
        part(&self.operators, cell * self.dimension + axis, self.block)
    }
    /// m_k of a cell.
    pub fn mass(&self, cell: usize, axis: usize) -> &[f32] {
        part(&self.masses, cell * self.dimension + axis, self.nodes)
    }
}

/// Square matrix number `number` of order `n`.
fn part(matrices: &[f32], number: usize, n: usize) -> &[f32] {
    &matrices[number * n * n..(number + 1) * n * n]
}

/// The derivatives of a facet with respect to the mean of each trace of one side, tested with the mean of that side: `[column][row]`
/// over kinds and components; for the minus and the plus side.
type OwnBlocks = [Vec<f64>; 2];

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// (lines) at position `s` of the slab, in the state and on the mesh last set.
    pub fn line_jacobian(&self, s: f64) -> LineJacobian {
        let (cells, nodes) = (self.layout.cells, self.tables.orders.flow);
        let block = M * nodes;
        let mut operators = vec![0.0; cells * D * block * block];
        let mut masses = vec![0.0; cells * D * nodes * nodes];
        let frozen = self.freeze(s);
        let of_batch = [block, nodes].map(|size| WIDTH * D * size * size);
        let (operators_of, masses_of) = ((&mut operators[..], of_batch[0]), (&mut masses[..], of_batch[1]));
        parallel::for_each_pair(operators_of, masses_of, Grain::Any, &|batch, operators, masses| {
            self.cells.with(|scratch| self.lines_of_cells(batch, &frozen, scratch, operators, masses));
        });
        let line =
            TraceSpace::new(&FaceMaps::new(&self.tables.flow, 1), 2, M, nodes, self.problem.kernels.is_viscous());
        let batches = &self.facets.batches;
        let facets = parallel::map(batches.len(), Grain::Any, &|k| self.ends_of_lines(&batches[k], &frozen, &line));
        let facets: Vec<OwnBlocks> = facets.into_iter().flatten().collect();
        let first = self.first_of_batches();
        parallel::for_each_chunk(&mut operators, block * block, Grain::Any, &|number, operator| {
            for end in 0..2 {
                let (slot, side) = self.facets.of_face[2 * number + end];
                let facet = first[slot as usize / WIDTH] + slot as usize % WIDTH;
                line.add_lifted([end; 2], &facets[facet][side as usize], operator);
            }
        });
        LineJacobian { dimension: D, nodes, block, operators, masses }
    }

    /// The position on its line along `axis` of node `node` of a cell.
    fn on_line(&self, axis: usize, node: usize) -> usize {
        node / self.tables.orders.flow.pow(axis as u32) % self.tables.orders.flow
    }

    /// Volume part of L_k, and m_k.
    fn lines_of_cells(
        &self,
        batch: usize,
        frozen: &FrozenPoint,
        scratch: &mut CellScratch,
        operators: &mut [f32],
        masses: &mut [f32],
    ) {
        let (n, nodes) = (self.tables.orders.flow, self.layout.nodes);
        self.gather_frozen(batch, frozen, scratch);
        for (axis, column) in (0..D).flat_map(|axis| (0..M * n).map(move |column| (axis, column))) {
            let (component, i) = (column / n, column % n);
            self.along_cells(frozen, scratch, |direction| {
                let direction = &mut direction[component * nodes..(component + 1) * nodes];
                let on_line = direction.iter_mut().enumerate().filter(|(node, _)| self.on_line(axis, *node) == i);
                on_line.for_each(|(_, value)| *value = Pack([1.0; WIDTH]));
            });
            let number = axis * M * n + column;
            self.add_sums(axis, &scratch.flux_at[..M * nodes], number, operators);
            if component == 0 {
                self.add_sums(axis, &scratch.mass_product_at[..nodes], axis * n + i, masses);
            }
        }
    }

    /// Tests with functions of one coordinate: sums over the nodes with the same position, as column `column` of every
    /// cell.
    fn add_sums(&self, axis: usize, tested: &[Pack], column: usize, matrices: &mut [f32]) {
        let (n, nodes) = (self.tables.orders.flow, self.layout.nodes);
        let rows = tested.len() / nodes * n;
        for (lane, matrices) in matrices.chunks_exact_mut(D * rows * rows).enumerate() {
            let sums = &mut matrices[column * rows..(column + 1) * rows];
            for (i, tested) in tested.iter().enumerate() {
                sums[i / nodes * n + self.on_line(axis, i % nodes)] += tested.0[lane] as f32;
            }
        }
    }

    /// The own blocks of the facets of a batch.
    fn ends_of_lines(&self, batch: &FacetBatch, frozen: &FrozenPoint, line: &TraceSpace) -> Vec<OwnBlocks> {
        let traces = line.len();
        let mut blocks: Vec<OwnBlocks> = vec![[vec![0.0; traces * traces], vec![0.0; traces * traces]]; batch.count];
        let sides = batch.sides();
        self.facet_scratch.with(|scratch| {
            self.gather_frozen_facets(batch, frozen, scratch);
            for (side, column) in (0..sides).flat_map(|side| (0..traces).map(move |column| (side, column))) {
                self.along_mean_trace(batch, frozen, [side, column], scratch);
                let terms = scratch.sides[side].terms.chunks_exact(frozen.traces.layout.face_nodes);
                for (row, terms) in terms.take(traces).enumerate() {
                    for (lane, blocks) in blocks.iter_mut().enumerate() {
                        blocks[side][column * traces + row] = terms.iter().map(|term| term.0[lane]).sum();
                    }
                }
            }
        });
        blocks
    }

    /// Runs the facet kernel along trace `column[1]` of side `column[0]`, with the same value at all nodes of the face.
    fn along_mean_trace(
        &self,
        batch: &FacetBatch,
        frozen: &FrozenPoint,
        column: [usize; 2],
        scratch: &mut FacetScratch,
    ) {
        let [side, number] = column;
        let (len, nodes) = (frozen.traces.layout.kind_len(), frozen.traces.layout.face_nodes);
        let (kind, component) = (number / M, number % M);
        self.along_facets(batch, frozen, scratch, |sides| {
            let start = (2 * kind + 1) * len + component * nodes;
            sides[side].state[start..start + nodes].fill(Pack([1.0; WIDTH]));
        });
    }
}
