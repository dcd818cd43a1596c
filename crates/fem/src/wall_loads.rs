//! The loads of the flow on boundaries that respond to it, in the scheme's own fluxes and quadrature.
//!
//! ```text
//! L_q,i = dt w_q int_f N_i Fhat_m ds  at s_q,    Fhat_m the flux of momentum out of the flow                        (load)
//! ```
//!
//! s_q and w_q are the quadrature points of the flow in time, N_i the shape functions of the mesh. Whoever has test functions phi_a in time
//! takes sum_q phi_a(s_q) L_q,i. The velocity of the wall is sum_i N_i v_i(s_q). Therefore the sum of L_q,i . v_i(s_q) is the work of the
//! wall to round-off: the structure gains the energy that the flow loses.

use crate::batches::{FacetBatch, FacetBatches};
use crate::operator::SlabOperator;
use mesh::NodeNumbering;
use tensor::{Pack, WIDTH};

/// The loads of the last evaluation, and the tables that sum them.
#[derive(Default)]
pub(crate) struct WallLoads {
    /// C0 nodes of the loaded boundaries, in increasing order.
    nodes: Vec<usize>,
    /// For every batch of facets on a loaded boundary the positions of its nodes in `nodes`, `[facet][face node]`; else empty.
    of_batch: Vec<Vec<usize>>,
    /// Terms of the facets of every batch, `[facet][time point][component][face node]`.
    pub(crate) terms: Vec<Vec<f64>>,
    /// `[time point][position in nodes][component]`
    values: Vec<f64>,
}

impl WallLoads {
    /// The loads on the boundaries for which `loaded` holds, at so many time `points`, in `D` dimensions.
    fn new<const D: usize>(facets: &FacetBatches, numbering: &NodeNumbering, loaded: &[bool], points: usize) -> Self {
        let is_loaded = |batch: &&FacetBatch| batch.boundary.is_some_and(|boundary| loaded[boundary]);
        let faces = |batch: &FacetBatch| -> Vec<usize> {
            batch.minus[..batch.count].iter().flat_map(|side| numbering.face::<D>(*side)).collect()
        };
        let mut nodes: Vec<usize> = facets.batches.iter().filter(is_loaded).flat_map(faces).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let position = |node: usize| nodes.partition_point(|&other| other < node);
        let of_batch: Vec<Vec<usize>> = facets
            .batches
            .iter()
            .map(|batch| if is_loaded(&batch) { faces(batch).into_iter().map(position).collect() } else { Vec::new() })
            .collect();
        let terms = of_batch.iter().map(|nodes| vec![0.0; nodes.len() * D * points]).collect();
        let values = vec![0.0; nodes.len() * D * points];
        WallLoads { nodes, of_batch, terms, values }
    }

    /// No loads, on a mesh with so many batches of facets.
    pub(crate) fn unloaded(batches: usize) -> Self {
        WallLoads { of_batch: vec![Vec::new(); batches], terms: vec![Vec::new(); batches], ..WallLoads::default() }
    }

    /// Sums the terms of all facets, in their order.
    fn sum(&mut self, dimension: usize, points: usize, face_nodes: usize) {
        let WallLoads { nodes, of_batch, terms, values } = self;
        values.fill(0.0);
        let of_facet = |nodes: usize| nodes * dimension * points;
        for (positions, terms) in of_batch.iter().zip(terms) {
            let facets = positions.chunks_exact(face_nodes).zip(terms.chunks_exact(of_facet(face_nodes)));
            for (positions, terms) in facets {
                for (row, terms) in terms.chunks_exact(face_nodes).enumerate() {
                    let (q, d) = (row / dimension, row % dimension);
                    for (position, term) in positions.iter().zip(terms) {
                        values[(q * nodes.len() + position) * dimension + d] += term;
                    }
                }
            }
        }
    }
}

/// Writes the loads of a batch, `[time point][d][face node]` in packs, to its facets.
pub(crate) fn scatter_loads(packs: &[Pack], terms: &mut [f64]) {
    for (lane, terms) in terms.chunks_exact_mut(packs.len()).enumerate().take(WIDTH) {
        terms.iter_mut().zip(packs).for_each(|(term, pack)| *term = pack.0[lane]);
    }
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// Has every evaluation leave the loads on the boundaries for which `loaded` holds, see [`Self::loads`].
    pub fn load_boundaries(&mut self, loaded: &[bool]) {
        let points = self.tables.instants.len();
        self.wall_loads = WallLoads::new::<D>(&self.facets, self.mesh.numbering(), loaded, points);
    }

    /// The C0 nodes of the loaded boundaries, in increasing order.
    pub fn loaded_nodes(&self) -> &[usize] {
        &self.wall_loads.nodes
    }

    /// L of (load) at the loaded nodes, `[time point][loaded node][component]`, with the weights of the time points: that of the residual last evaluated, or its derivative along
    /// the direction of the product last taken.
    pub fn loads(&self) -> &[f64] {
        &self.wall_loads.values
    }

    /// Sums the loads that the facets have left.
    pub(crate) fn sum_loads(&mut self) {
        let (points, face_nodes) = (self.tables.instants.len(), self.tables.orders.mesh.pow(D as u32 - 1));
        self.wall_loads.sum(D, points, face_nodes);
    }
}
