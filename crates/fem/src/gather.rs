//! From vectors to the lanes of packs, and back.

use crate::batches::{FacetBatch, Permutation};
use crate::operator::SlabOperator;
use crate::scratch::FacetScratch;
use crate::traces::Traces;
use tensor::{Pack, WIDTH};

/// Reads the coefficients of a batch, `source[lane]` each of the same length, into packs.
pub fn gather(sources: [&[f64]; WIDTH], packs: &mut [Pack]) {
    for (lane, source) in sources.iter().enumerate() {
        for (pack, value) in packs.iter_mut().zip(*source) {
            pack.0[lane] = *value;
        }
    }
}

/// Writes the packs of a batch to its cells.
pub(crate) fn scatter(packs: &[Pack], cell_len: usize, out: &mut [f64]) {
    for (lane, out) in out.chunks_exact_mut(cell_len).enumerate() {
        for (value, pack) in out.iter_mut().zip(packs) {
            *value = pack.0[lane];
        }
    }
}

/// Reads one kind of one side's traces into a lane, nodes reordered by `permutation`; one block per entry of `traces`.
fn gather_trace(
    traces: &[&Traces],
    side: mesh::Side,
    kind: usize,
    permutation: &[usize],
    lane: usize,
    packs: &mut [Pack],
) {
    let len = traces[0].layout.kind_len();
    for (traces, packs) in traces.iter().zip(packs.chunks_exact_mut(len)) {
        let nodes = traces.layout.face_nodes;
        let tensors = traces.of(side.cell, side.face, kind).chunks_exact(nodes);
        for (tensor, packs) in tensors.zip(packs.chunks_exact_mut(nodes)) {
            for (pack, &i) in packs.iter_mut().zip(permutation) {
                pack.0[lane] = tensor[i];
            }
        }
    }
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// Reads the traces on both sides of a batch of facets, in the lattice of minus: one block per entry of `state` and of `mesh`.
    pub(crate) fn gather_sides(
        &self,
        state: &[&Traces],
        mesh: &[&Traces],
        batch: &FacetBatch,
        scratch: &mut FacetScratch,
    ) {
        scratch.normal_sign = batch.normal_sign;
        let kinds = if self.problem.kernels.is_viscous() { 2 } else { 1 };
        let used = if batch.boundary.is_none() { 2 } else { 1 };
        for lane in 0..WIDTH {
            let ends = [(batch.minus[lane], 0), batch.plus[lane]];
            for ((end, permutation), side) in ends.into_iter().zip(&mut scratch.sides).take(used) {
                let Permutation { flow, mesh: geometry } = &self.facets.permutations[permutation];
                for kind in 0..kinds {
                    gather_trace(state, end, kind, flow, lane, &mut side.state[kind]);
                    gather_trace(mesh, end, kind, geometry, lane, &mut side.mesh[kind]);
                }
            }
        }
    }

    /// The terms of a batch of facets, `[facet][side][kind][a][m][face node]`, every side in its own lattice; not a number where a trace
    /// was inadmissible.
    pub(crate) fn scatter_terms(&self, batch: &FacetBatch, scratch: &FacetScratch, viscous: bool, terms: &mut [f64]) {
        let layout = self.state_traces.layout;
        let sides = if batch.boundary.is_none() { 2 } else { 1 };
        for (lane, terms) in terms.chunks_exact_mut(2 * layout.face_len()).take(batch.count).enumerate() {
            for (side, terms) in terms.chunks_exact_mut(layout.face_len()).take(sides).enumerate() {
                let permutation = if side == 0 { 0 } else { batch.plus[lane].1 };
                let Permutation { flow, .. } = &self.facets.permutations[permutation];
                for (kind, terms) in
                    terms.chunks_exact_mut(layout.kind_len()).take(if viscous { 2 } else { 1 }).enumerate()
                {
                    let packs = scratch.sides[side].terms[kind].chunks_exact(layout.face_nodes);
                    for (tensor, packs) in terms.chunks_exact_mut(layout.face_nodes).zip(packs) {
                        for (pack, &i) in packs.iter().zip(flow) {
                            tensor[i] = pack.0[lane];
                        }
                    }
                }
            }
        }
        if scratch.violated != Pack::ZERO {
            // A number that no admissible residual has: the cells that read it see the violation.
            terms.fill(f64::NAN);
        }
    }
}
