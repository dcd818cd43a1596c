//! The blocks of (node blocks).

use super::stencil::{Stencil, Step};
use crate::preconditioner::blocks::Link;
use crate::preconditioner::ordering::{Ordering, minimum_discarded_fill_of};
use faer::Mat;
use faer::linalg::solvers::Solve;
use fem::parallel::{self, Grain};
use fem::{Layout, LowOrderRows, NO_NEIGHBOUR, Neighbours, Share, SlabOperator};
use half::bf16;
use std::sync::Arc;

/// Blocks are read in groups of rows; the last one may reach beyond its end by so many numbers.
pub(super) const BEYOND: usize = 8;

/// dt A for a slab length dt, and who neighbours whom.
pub(super) struct NodeBlocks<const D: usize, const M: usize> {
    pub(super) layout: Layout,
    pub(super) share: Arc<Share>,
    /// Nodes of a line.
    pub(super) order: usize,
    /// dt of the blocks.
    dt: f64,
    /// The scales S.
    scales: [f64; M],
    /// M_i^(-1/2) of own cells and ghosts, `[cell][node]`.
    inverse_roots: Vec<f64>,
    /// dt A_ii, `[cell][node][column][row]`.
    pub(super) diagonal: Vec<f32>,
    /// dt A_ij of every face, `[cell][node][face][column][row]`.
    pub(super) couplings: Vec<bf16>,
    neighbours: Neighbours,
    pub(super) stencil: Stencil,
}

impl<const D: usize, const M: usize> NodeBlocks<D, M> {
    /// The blocks in the middle of the slab of `operator`. They are rounded for its length, whatever slabs they serve: so a resumed run makes the
    /// same ones.
    pub(super) fn new(operator: &SlabOperator<D, M>) -> Self {
        let (layout, order, (_, dt)) = (operator.layout, operator.tables.orders.flow, operator.interval());
        let nodes = layout.nodes;
        let blocks = layout.cells * nodes * M * M;
        let mut matrix = NodeBlocks {
            layout,
            share: operator.share.clone(),
            order,
            dt,
            scales: operator.problem.kernels.scales(),
            inverse_roots: vec![0.0; (layout.cells + operator.share.ghosts.len()) * nodes],
            diagonal: vec![0.0; blocks + BEYOND],
            couplings: vec![bf16::ZERO; 2 * D * blocks + BEYOND],
            neighbours: Neighbours::of(operator),
            stencil: Stencil::new::<D>(order),
        };
        let low_order = operator.low_order(0.5);
        parallel::for_each_chunk(&mut matrix.inverse_roots, nodes, Grain::Any, &|cell, roots| {
            for (root, mass) in roots.iter_mut().zip(low_order.masses(cell)) {
                *root = 1.0 / mass.abs().sqrt();
            }
        });
        let NodeBlocks { diagonal, couplings, inverse_roots, scales, neighbours, stencil, .. } = &mut matrix;
        let scaling = Scaling { dt, scales, inverse_roots, neighbours: &neighbours.nodes, stencil, nodes, order };
        let len = nodes * M * M;
        // Both have some numbers more at their ends.
        let own = layout.cells * len;
        let (diagonal, couplings) = (&mut diagonal[..own], &mut couplings[..2 * D * own]);
        parallel::for_each_pair((diagonal, len), (couplings, 2 * D * len), Grain::Any, &|cell, diagonal, couplings| {
            low_order.with_rows(cell, |rows| scaling.store::<D, M>(cell, rows, diagonal, couplings));
        });
        matrix
    }

    /// dt A_ij across `face` of node number `node` of `cell`.
    #[inline(always)]
    pub(super) fn coupling(&self, cell: usize, node: usize, face: usize) -> &[bf16] {
        let start = ((cell * self.layout.nodes + node) * 2 * D + face) * M * M;
        &self.couplings[start..start + M * M + BEYOND]
    }

    /// dt A_ii, and what follows it.
    #[inline(always)]
    pub(super) fn diagonal(&self, cell: usize, node: usize) -> &[f32] {
        let start = (cell * self.layout.nodes + node) * M * M;
        &self.diagonal[start..start + M * M + BEYOND]
    }

    /// The factor that turns blocks into those of a slab of length `dt`.
    pub(super) fn ratio(&self, dt: f64) -> f64 {
        dt / self.dt
    }

    /// M_i^(-1/2) / S_m.
    #[inline(always)]
    pub(super) fn scale(&self, cell: usize, node: usize, component: usize) -> f64 {
        self.inverse_roots[cell * self.layout.nodes + node] / self.scales[component]
    }

    /// M_i^(-1/2) S_m: turns scaled unknowns into those of the flow.
    #[inline(always)]
    pub(super) fn unknown(&self, cell: usize, node: usize, component: usize) -> f64 {
        self.inverse_roots[cell * self.layout.nodes + node] * self.scales[component]
    }

    /// The nodes across `face` of `cell`, in the lattice of the face: cell times nodes plus node, or [`NO_NEIGHBOUR`].
    #[inline(always)]
    pub(super) fn across(&self, cell: usize, face: usize) -> &[u32] {
        let face_nodes = self.layout.nodes / self.order;
        &self.neighbours.nodes[(cell * 2 * D + face) * face_nodes..][..face_nodes]
    }

    /// The face of the neighbour across `face` of `cell`.
    pub(super) fn face_across(&self, cell: usize, face: usize) -> usize {
        self.neighbours.faces[cell * 2 * D + face] as usize
    }

    /// The cell across `face`.
    pub(super) fn cell_across(&self, cell: usize, face: usize) -> Option<usize> {
        let node = self.across(cell, face)[0];
        (node != NO_NEIGHBOUR).then(|| node as usize / self.layout.nodes)
    }

    /// The cell across `face` if it is in the same block: elimination and sweeps stay inside of blocks.
    pub(super) fn cell_in_block(&self, cell: usize, face: usize) -> Option<usize> {
        let blocks = &self.share.blocks.of_cell;
        self.cell_across(cell, face).filter(|&other| blocks[other] == blocks[cell])
    }

    /// The order of elimination for lambda + dt A with one real lambda: minimum discarded fill of the cells.
    pub(super) fn ordering(&self, lambda: f64) -> Ordering {
        let links: Vec<Vec<Link>> = (0..self.layout.cells).map(|cell| self.links(cell)).collect();
        let strengths: Vec<Vec<f64>> =
            parallel::map(links.len(), Grain::Any, &|cell| self.strengths(cell, &links[cell], lambda));
        minimum_discarded_fill_of(&links, &strengths)
    }

    fn links(&self, cell: usize) -> Vec<Link> {
        let link = |face: usize| {
            let other = self.cell_in_block(cell, face)?;
            let other_face = self.face_across(cell, face);
            // Both cells number the facet alike.
            let coupling = (cell * 2 * D + face).min(other * 2 * D + other_face);
            Some(Link { cell: other, coupling, side: usize::from(cell > other), face, other_face })
        };
        (0..2 * D).filter_map(link).collect()
    }

    /// |D_i^(-1) dt A_ij| in the Frobenius norm over the nodes of every link, with D_i = lambda + dt A_ii.
    fn strengths(&self, cell: usize, links: &[Link], lambda: f64) -> Vec<f64> {
        let square = |face: usize, node: usize| -> f64 {
            let d = Mat::from_fn(M, M, |i, j| {
                f64::from(self.diagonal(cell, node)[j * M + i]) + if i == j { lambda } else { 0.0 }
            });
            let a = Mat::from_fn(M, M, |i, j| f64::from(self.coupling(cell, node, face)[j * M + i].to_f32()));
            squared_norm_of_solution(&d, &a)
        };
        let nodes = |face: usize| mesh::face_nodes(D, self.order, face);
        let strength =
            |link: &Link| nodes(link.face).into_iter().map(|node| square(link.face, node)).sum::<f64>().sqrt();
        links.iter().map(strength).collect()
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.inverse_roots[..])
            + size_of_val(&self.diagonal[..])
            + size_of_val(&self.couplings[..])
            + size_of_val(&self.neighbours.nodes[..])
    }
}

/// What turns rows into blocks.
struct Scaling<'a> {
    dt: f64,
    scales: &'a [f64],
    inverse_roots: &'a [f64],
    neighbours: &'a [u32],
    stencil: &'a Stencil,
    nodes: usize,
    order: usize,
}

impl Scaling<'_> {
    fn store<const D: usize, const M: usize>(
        &self,
        cell: usize,
        rows: &LowOrderRows,
        diagonal: &mut [f32],
        couplings: &mut [bf16],
    ) {
        for node in 0..self.nodes {
            let own = self.inverse_roots[cell * self.nodes + node];
            let range = node * M * M..(node + 1) * M * M;
            self.scaled::<M>(own * own, &rows.diagonal[range.clone()], |number, value| {
                diagonal[range.start + number] = value as f32;
            });
            for face in 0..2 * D {
                let start = (node * 2 * D + face) * M * M;
                let other = self.root_across::<D>(cell, node, face);
                if other == 0.0 {
                    continue;
                }
                self.scaled::<M>(own * other, &rows.couplings[start..start + M * M], |number, value| {
                    let rounded = bf16::from_f64(value);
                    couplings[start + number] = rounded;
                    // What rounding takes acts on a state that is the same at both nodes: thin cells are soft along it.
                    diagonal[range.start + number] += ((value - f64::from(rounded.to_f32())) * own / other) as f32;
                });
            }
        }
    }

    fn scaled<const M: usize>(&self, roots: f64, block: &[f64], mut put: impl FnMut(usize, f64)) {
        for (number, entry) in block.iter().enumerate() {
            let (column, row) = (number / M, number % M);
            put(number, entry * self.dt * roots * self.scales[column] / self.scales[row]);
        }
    }

    /// M_j^(-1/2) of the neighbour across `face`. Without a neighbour it is 0.
    fn root_across<const D: usize>(&self, cell: usize, node: usize, face: usize) -> f64 {
        let face_nodes = self.nodes / self.order;
        match self.stencil.of(node)[face] {
            Step::Inside(next) => self.inverse_roots[cell * self.nodes + next as usize],
            Step::Across(i) => {
                let other = self.neighbours[(cell * 2 * D + face) * face_nodes + i as usize];
                if other == NO_NEIGHBOUR { 0.0 } else { self.inverse_roots[other as usize] }
            }
        }
    }
}

/// |D^(-1) A|^2 in the Frobenius norm. Compiled here once, and not for every dimension.
fn squared_norm_of_solution(d: &Mat<f64>, a: &Mat<f64>) -> f64 {
    d.partial_piv_lu().solve(a).squared_norm_l2()
}
