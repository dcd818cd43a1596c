//! Traces of the mesh in the layout of the kernels of cells and facets, since a mesh serves many evaluations.

use crate::batches::{BATCHES_PER_TASK, FacetBatches};
use crate::gather::{gather_nodes, gather_traces};
use crate::per_thread::PerThread;
use crate::traces::{TraceLayout, Traced};
use rayon::prelude::*;
use std::array::from_fn;
use tensor::{Pack, WIDTH, zeroed};

/// The traces that a batch of facets reads: kinds 0 and 1 of the minus side, which give position and tangents, and kind 1 of the plus
/// side.
const PARTS: [(usize, usize); 3] = [(0, 0), (0, 1), (1, 1)];

/// Traces of the mesh by batches of facets.
pub(crate) struct MeshTraces {
    layout: TraceLayout,
    /// `[batch][part][slot][d][face node]`, see [`PARTS`], in the lattice of minus.
    on_facets: Vec<Pack>,
    /// One trace of every lane in another order of nodes.
    reordered: PerThread<Vec<f64>>,
}

impl MeshTraces {
    /// Memory for the traces on `batches` batches of facets.
    pub(crate) fn new(layout: TraceLayout, batches: usize) -> Self {
        let on_facets = zeroed(batches * PARTS.len() * layout.kind_len());
        let reordered = PerThread::new(|| vec![0.0; WIDTH * layout.kind_len()]);
        MeshTraces { layout, on_facets, reordered }
    }

    /// Reads the traces of `mesh`, `[cell][slot][d][node]`.
    pub(crate) fn take(&mut self, mesh: Traced, facets: &FacetBatches) {
        let (layout, len) = (self.layout, self.layout.kind_len());
        let batches = self.on_facets.par_chunks_mut(PARTS.len() * len).zip(&facets.batches);
        batches.with_max_len(BATCHES_PER_TASK).for_each(|(packs, batch)| {
            for ((side, kind), packs) in PARTS.into_iter().zip(packs.chunks_exact_mut(len)) {
                let ends = batch.ends(side);
                if kind == 0 {
                    let nodes = from_fn(|lane| &facets.lattice(batch, lane, side).mesh_of_cell[ends[lane].face][..]);
                    gather_nodes(ends.map(|end| mesh.cell(end.cell)), layout.nodes, nodes, packs);
                    continue;
                }
                let sources = ends.map(|end| mesh.traces.derivatives_on(end));
                let permutations = from_fn(|lane| facets.permutation(batch, lane, side).map(|p| &p.mesh[..]));
                self.reordered.with(|reordered| gather_traces(sources, permutations, packs, reordered));
            }
        });
    }

    /// A kind on a side of batch `number` of facets, `[slot][d][face node]`; none of kind 0 on the plus side.
    pub(crate) fn on_facets(&self, number: usize, side: usize, kind: usize) -> Option<&[Pack]> {
        let part = PARTS.iter().position(|part| *part == (side, kind))?;
        let len = self.layout.kind_len();
        Some(&self.on_facets[(PARTS.len() * number + part) * len..][..len])
    }

    /// Whether a trace on batch `number` of facets is not zero.
    pub(crate) fn change_on_facets(&self, number: usize) -> bool {
        let len = PARTS.len() * self.layout.kind_len();
        self.on_facets[number * len..][..len].iter().any(|pack| *pack != Pack::ZERO)
    }

    /// Length of one kind.
    pub(crate) fn kind_len(&self) -> usize {
        self.layout.kind_len()
    }
}
