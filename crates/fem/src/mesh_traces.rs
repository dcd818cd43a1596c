//! Traces of the mesh in the layout of the kernels of cells and facets, since a mesh serves many evaluations.

use crate::batches::{BATCHES_PER_TASK, FacetBatches};
use crate::gather::gather_traces;
use crate::per_thread::PerThread;
use crate::traces::{FaceMaps, TraceLayout, Traces};
use rayon::prelude::*;
use std::array::from_fn;
use tensor::{Pack, WIDTH, zeroed};

/// The traces that a batch of facets reads: kinds 0 and 1 of the minus side, which give position and tangents, and kind 1 of the plus
/// side.
const PARTS: [(usize, usize); 3] = [(0, 0), (0, 1), (1, 1)];

/// Coefficients of the mesh by batches of cells, and their traces by batches of facets.
pub(crate) struct MeshTraces {
    traces: Traces,
    /// `[batch][part][slot][d][face node]`, see [`PARTS`], in the lattice of minus.
    on_facets: Vec<Pack>,
    /// One trace of every lane in another order of nodes.
    reordered: PerThread<Vec<f64>>,
}

impl MeshTraces {
    /// Memory for the traces of `cells` cells on `batches` batches of facets.
    pub(crate) fn new(layout: TraceLayout, cells: usize, batches: usize) -> Self {
        let on_facets = zeroed(batches * PARTS.len() * layout.kind_len());
        let reordered = PerThread::new(|| vec![0.0; WIDTH * layout.kind_len()]);
        MeshTraces { traces: Traces::new(layout, cells), on_facets, reordered }
    }

    /// Computes the traces of `coefficients[cell][slot][d][node]`.
    pub(crate) fn take(&mut self, maps: &FaceMaps, coefficients: &[f64], facets: &FacetBatches) {
        self.traces.take(maps, coefficients, true);
        let (traces, len) = (&self.traces, self.traces.layout.kind_len());
        let batches = self.on_facets.par_chunks_mut(PARTS.len() * len).zip(&facets.batches);
        batches.with_max_len(BATCHES_PER_TASK).for_each(|(packs, batch)| {
            for ((side, kind), packs) in PARTS.into_iter().zip(packs.chunks_exact_mut(len)) {
                let sources = batch.ends(side).map(|end| traces.of(end.cell, end.face, kind));
                let permutations = from_fn(|lane| facets.permutation(batch, lane, side).map(|p| &p.mesh[..]));
                self.reordered.with(|reordered| gather_traces(sources, permutations, packs, reordered));
            }
        });
    }

    /// The coefficients of a batch of cells, `[slot][d][node]`.
    pub(crate) fn coefficients(&self, batch: usize) -> &[Pack] {
        self.traces.coefficients(batch)
    }

    /// A kind on a side of batch `number` of facets, `[slot][d][face node]`; none of kind 0 on the plus side.
    pub(crate) fn on_facets(&self, number: usize, side: usize, kind: usize) -> Option<&[Pack]> {
        let part = PARTS.iter().position(|part| *part == (side, kind))?;
        let len = self.traces.layout.kind_len();
        Some(&self.on_facets[(PARTS.len() * number + part) * len..][..len])
    }

    /// Whether a trace on batch `number` of facets is not zero.
    pub(crate) fn change_on_facets(&self, number: usize) -> bool {
        let len = PARTS.len() * self.traces.layout.kind_len();
        self.on_facets[number * len..][..len].iter().any(|pack| *pack != Pack::ZERO)
    }

    /// Length of one kind.
    pub(crate) fn kind_len(&self) -> usize {
        self.traces.layout.kind_len()
    }
}
