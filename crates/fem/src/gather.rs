//! From vectors to the lanes of packs, and back.

use crate::batches::{FacetBatch, Permutation};
use crate::kernels::Differentiate;
use crate::operator::SlabOperator;
use crate::scratch::FacetScratch;
use crate::traces::Traced;
use std::array::from_fn;
use tensor::{Pack, WIDTH};

/// Reads the coefficients of a batch, `source[lane]` each of the same length, into packs.
pub fn gather(sources: [&[f64]; WIDTH], packs: &mut [Pack]) {
    let sources = sources.map(|source| &source[..packs.len()]);
    for (i, pack) in packs.iter_mut().enumerate() {
        for lane in 0..WIDTH {
            pack.0[lane] = sources[lane][i];
        }
    }
}

/// Writes the packs of a batch to its cells.
pub(crate) fn scatter(packs: &[Pack], cell_len: usize, out: &mut [f64]) {
    for (lane, out) in out.chunks_exact_mut(cell_len).enumerate() {
        write_lane(packs, lane, out);
    }
}

fn write_lane(packs: &[Pack], lane: usize, out: &mut [f64]) {
    for (value, pack) in out.iter_mut().zip(packs) {
        *value = pack.0[lane];
    }
}

/// Reads the values at `nodes` of 8 cells, `[tensor][node]` with `of_cell` nodes in a cell, into `[tensor][number of the node]`.
pub(crate) fn gather_nodes(cells: [&[f64]; WIDTH], of_cell: usize, nodes: [&[usize]; WIDTH], packs: &mut [Pack]) {
    for (lane, (cell, nodes)) in cells.into_iter().zip(nodes).enumerate() {
        for (tensor, packs) in cell.chunks_exact(of_cell).zip(packs.chunks_exact_mut(nodes.len())) {
            packs.iter_mut().zip(nodes).for_each(|(pack, &node)| pack.0[lane] = tensor[node]);
        }
    }
}

/// Reads the traces of 8 sides; nodes are reordered by the permutation of each lane, if there is one.
pub(crate) fn gather_traces(
    sources: [&[f64]; WIDTH],
    permutations: [Option<&[usize]>; WIDTH],
    packs: &mut [Pack],
    reordered: &mut [f64],
) {
    let len = packs.len();
    for ((source, permutation), reordered) in sources.iter().zip(permutations).zip(reordered.chunks_exact_mut(len)) {
        let Some(permutation) = permutation else { continue };
        let nodes = permutation.len();
        for (tensor, reordered) in source.chunks_exact(nodes).zip(reordered.chunks_exact_mut(nodes)) {
            reordered.iter_mut().zip(permutation).for_each(|(value, &i)| *value = tensor[i]);
        }
    }
    let in_order = |lane: usize| if permutations[lane].is_some() { &reordered[lane * len..] } else { sources[lane] };
    gather(from_fn(in_order), packs);
}

/// Reads the numbers of each cell of a batch, `[cell][..]`, into blocks of packs, one for each of `sources`.
pub(crate) fn gather_cells(sources: &[&[f64]], cells: [usize; WIDTH], blocks: &mut [Pack]) {
    let len = blocks.len() / 2;
    for (source, block) in sources.iter().zip(blocks.chunks_exact_mut(len)) {
        gather(cells.map(|cell| &source[cell * len..(cell + 1) * len]), block);
    }
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// Reads the traces of the state on both sides of a batch of facets, in the lattice of minus, for a kernel that differentiates `along`.
    /// There is one block per entry of `state`.
    pub(crate) fn gather_states(
        &self,
        along: Differentiate,
        state: &[Traced],
        batch: &FacetBatch,
        scratch: &mut FacetScratch,
    ) {
        let FacetScratch { sides, normal_sign, reordered, .. } = scratch;
        *normal_sign = batch.normal_sign;
        let layout = state[0].traces.layout;
        let len = layout.kind_len();
        for (number, side) in sides.iter_mut().enumerate().take(batch.sides()) {
            let ends = batch.ends(number);
            let nodes = from_fn(|lane| &self.facets.lattice(batch, lane, number).flow_of_cell[ends[lane].face][..]);
            let permutations = from_fn(|lane| self.facets.permutation(batch, lane, number).map(|p| &p.flow[..]));
            let (values, derivatives) = side.state.split_at_mut(along.state_blocks() * len);
            for (traced, packs) in state.iter().zip(values.chunks_exact_mut(len)) {
                gather_nodes(ends.map(|end| traced.cell(end.cell)), layout.nodes, nodes, packs);
            }
            let differentiated = state.iter().filter(|_| layout.kinds > 1);
            for (traced, packs) in differentiated.zip(derivatives.chunks_exact_mut(len)) {
                gather_traces(ends.map(|end| traced.traces.derivatives_on(end)), permutations, packs, reordered);
            }
        }
    }

    /// Reads the traces of the mesh. There is a second block, for its direction, if `along` differentiates by the mesh. Position and
    /// tangents are read from the minus side only.
    pub(crate) fn gather_mesh(&self, along: Differentiate, batch: &FacetBatch, scratch: &mut FacetScratch) {
        let mesh = &self.mesh_and_direction()[..along.geometry_blocks()];
        scratch.normal_sign = batch.normal_sign;
        let (len, kinds) = (mesh[0].kind_len(), self.kinds());
        for (number, side) in scratch.sides.iter_mut().enumerate().take(batch.sides()) {
            let of_kinds = side.mesh.chunks_exact_mut(along.geometry_blocks() * len).take(kinds);
            for (kind, packs) in of_kinds.enumerate() {
                for (traces, packs) in mesh.iter().zip(packs.chunks_exact_mut(len)) {
                    let from = traces.on_facets(batch.number, number, kind);
                    from.into_iter().for_each(|from| packs.copy_from_slice(from));
                }
            }
        }
    }

    /// Kinds of traces that the law reads.
    fn kinds(&self) -> usize {
        if self.problem.kernels.is_viscous() { 2 } else { 1 }
    }

    /// The terms of a batch of facets, `[facet][side][kind][a][m][face node]`, every side in its own lattice. They are NaN if a trace
    /// was inadmissible.
    pub(crate) fn scatter_terms(&self, batch: &FacetBatch, scratch: &FacetScratch, terms: &mut [f64]) {
        if scratch.violated != Pack::ZERO {
            // No admissible residual is NaN, so the cells that read it see the violation.
            return terms.fill(f64::NAN);
        }
        let layout = self.traced_state().traces.layout;
        for (lane, terms) in terms.chunks_exact_mut(2 * layout.face_len()).take(batch.count).enumerate() {
            for (side, terms) in terms.chunks_exact_mut(layout.face_len()).take(batch.sides()).enumerate() {
                let packs = &scratch.sides[side].terms[..layout.face_len()];
                let Some(Permutation { flow, .. }) = self.facets.permutation(batch, lane, side) else {
                    write_lane(packs, lane, terms);
                    continue;
                };
                let nodes = layout.face_nodes;
                for (tensor, packs) in terms.chunks_exact_mut(nodes).zip(packs.chunks_exact(nodes)) {
                    packs.iter().zip(flow).for_each(|(pack, &i)| tensor[i] = pack.0[lane]);
                }
            }
        }
    }
}
