//! The loads of the flow on boundaries that respond to it, in the scheme's own fluxes and quadrature.
//!
//! ```text
//! L_q,i = dt omega_q int_F N_i Fhat_m dS  at s_q,    Fhat_m the flux of momentum out of the flow                        (load)
//! ```
//!
//! s_q and w_q are the quadrature points of the flow in time, N_i the shape functions of the mesh. Whoever has test functions phi_a in time
//! takes sum_q phi_a(s_q) L_q,i. The velocity of the wall is sum_i N_i v_i(s_q). Therefore the sum of L_q,i . v_i(s_q) is the work of the
//! wall to round-off: the structure gains the energy that the flow loses.

use crate::batches::FacetBatch;
use crate::operator::SlabOperator;
use crate::share::Share;
use tensor::{Pack, WIDTH};

/// The loads of the last evaluation, and the tables that sum them.
#[derive(Default)]
pub(crate) struct NodalLoads {
    /// C0 nodes of the loaded boundaries, in increasing order.
    nodes: Vec<usize>,
    /// For every loaded facet of the whole mesh the positions of its nodes in `nodes`, `[facet][face node]`.
    positions: Vec<usize>,
    /// For every loaded facet of this rank its number in the whole mesh.
    facets: Vec<usize>,
    /// Terms of the facets of every batch, `[facet][time point][component][face node]`.
    pub(crate) terms: Vec<Vec<f64>>,
    /// `[time point][position in nodes][component]`
    values: Vec<f64>,
}

impl NodalLoads {
    /// No loads, on a mesh with `batches` batches of facets.
    pub(crate) fn unloaded(batches: usize) -> Self {
        NodalLoads { terms: vec![Vec::new(); batches], ..NodalLoads::default() }
    }

    /// Sums the terms of all facets of the whole mesh, in their order; on all ranks.
    fn sum(&mut self, share: &Share, dimension: usize, points: usize, face_nodes: usize) {
        let NodalLoads { nodes, positions, facets, terms, values } = self;
        values.fill(0.0);
        if nodes.is_empty() {
            return;
        }
        let of_facet = face_nodes * dimension * points;
        let all = share.all_in_order(facets, terms.concat(), of_facet);
        for (positions, terms) in positions.chunks_exact(face_nodes).zip(all.chunks_exact(of_facet)) {
            for (row, terms) in terms.chunks_exact(face_nodes).enumerate() {
                let (q, d) = (row / dimension, row % dimension);
                for (position, term) in positions.iter().zip(terms) {
                    values[(q * nodes.len() + position) * dimension + d] += term;
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
    /// From now on every evaluation computes the loads on the boundaries for which `loaded` holds, see [`Self::loads`]. A collective call.
    pub fn load_boundaries(&mut self, loaded: &[bool]) {
        let is_loaded = |batch: &&FacetBatch| batch.boundary.is_some_and(|boundary| loaded[boundary]);
        let (points, face_nodes) = (self.tables.time_points.len(), self.face_nodes_of_mesh());
        let (mut facets, mut own, mut numbers) = (Vec::new(), Vec::new(), self.boundary_facets.iter());
        let mut terms = vec![Vec::new(); self.facets.batches.len()];
        for batch in self.facets.batches.iter().filter(|batch| batch.boundary.is_some()) {
            let of_batch = numbers.by_ref().take(batch.count);
            if is_loaded(&batch) {
                facets.extend(of_batch);
                let faces = batch.minus[..batch.count].iter().flat_map(|side| self.mesh.numbering().face::<D>(*side));
                own.extend(faces.map(|node| node as f64));
                terms[batch.number] = vec![0.0; batch.count * face_nodes * D * points];
            } else {
                of_batch.for_each(drop);
            }
        }
        let all: Vec<usize> =
            self.share.all_in_order(&facets, own, face_nodes).into_iter().map(|node| node as usize).collect();
        let mut nodes = all.clone();
        nodes.sort_unstable();
        nodes.dedup();
        let positions = all.iter().map(|&node| nodes.partition_point(|&other| other < node)).collect();
        let values = vec![0.0; nodes.len() * D * points];
        self.wall_loads = NodalLoads { nodes, positions, facets, terms, values };
    }

    /// C0 nodes of a face.
    fn face_nodes_of_mesh(&self) -> usize {
        self.tables.orders.mesh.pow(D as u32 - 1)
    }

    /// The C0 nodes of the loaded boundaries, in increasing order.
    pub fn loaded_nodes(&self) -> &[usize] {
        &self.wall_loads.nodes
    }

    /// L of (load) at the loaded nodes, `[time point][loaded node][component]`, with the weights of the time points. They belong to the
    /// last evaluation: the residual, or a product, which leaves the derivative of L along its direction.
    pub fn loads(&self) -> &[f64] {
        &self.wall_loads.values
    }

    /// Sums the loads that the facets have left.
    pub(crate) fn sum_loads(&mut self) {
        let (points, face_nodes) = (self.tables.time_points.len(), self.face_nodes_of_mesh());
        self.wall_loads.sum(&self.share, D, points, face_nodes);
    }
}
