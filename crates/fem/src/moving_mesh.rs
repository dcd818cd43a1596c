//! The mesh in a slab: the position of every cell at the bottom, and its motion.
//!
//! ```text
//! x(xi, s) = x_0(xi) + d_n(xi) + dt sum_b Phi_b(s) V_b(xi),   v(xi, s) = sum_b phi_b(s) V_b(xi)                     (motion)
//! ```
//!
//! The positions of a cell are stored relative to its **origin**, the position of its first node at the bottom of the slab.
//! Derivatives of absolute positions would lose the digits that all nodes of the cell have in common: with a cell of size h at x, an
//! error of eps |x| / h becomes one of eps. Neighbours share their nodes to the bit, and differences of close numbers are exact, so
//! both sides of a facet have the same tangents. Functions of the position in space (prescribed states, sources, moments) add the
//! origin.

use mesh::{Mesh, NodeNumbering};
use tensor::Pack;

/// Bottom position and velocities per cell, `[cell][slot][component][node]`, slot 0 the position x_0 + d_n relative to the origin of
/// the cell, slots 1.. the V_b.
#[derive(Clone, Debug)]
pub struct MovingMesh {
    dimension: usize,
    nodes: usize,
    time_order: usize,
    numbering: NodeNumbering,
    /// x_0 relative to the first node of the cell, `[cell][component][node]`, and x_0 of that node, `[cell][component]`.
    reference: Vec<f64>,
    first_nodes: Vec<f64>,
    /// The origins, `[cell][component]`.
    origins: Vec<f64>,
    /// The coefficients.
    pub data: Vec<f64>,
}

impl MovingMesh {
    /// A mesh at rest in its reference position.
    pub fn new<const D: usize>(mesh: &Mesh<D>, numbering: NodeNumbering, time_order: usize) -> Self {
        let nodes = mesh.nodes_per_cell();
        let mut reference = vec![0.0; mesh.coordinates().len()];
        let mut origins = Vec::with_capacity(mesh.n_cells() * D);
        for (cell, out) in reference.chunks_exact_mut(D * nodes).enumerate() {
            transpose_relative(mesh.cell_coordinates(cell), D, out);
            origins.extend_from_slice(&mesh.cell_coordinates(cell)[..D]);
        }
        let data = vec![0.0; mesh.n_cells() * (time_order + 1) * D * nodes];
        let first_nodes = origins.clone();
        let mut moving =
            MovingMesh { dimension: D, nodes, time_order, numbering, reference, first_nodes, origins, data };
        moving.set_bottom(None);
        moving
    }

    /// A direction of variation of the first `cells` cells, which has no position of its own.
    pub(crate) fn direction(&self, cells: usize) -> Self {
        let (reference, first_nodes, origins) = (Vec::new(), Vec::new(), Vec::new());
        let data = vec![0.0; cells * self.cell_len()];
        MovingMesh { reference, first_nodes, origins, data, numbering: self.numbering.clone(), ..*self }
    }

    /// Unknowns of one velocity field: C0 nodes times dimension.
    pub fn field_len(&self) -> usize {
        self.numbering.count * self.dimension
    }
    /// The numbering of C0 nodes.
    pub fn numbering(&self) -> &NodeNumbering {
        &self.numbering
    }
    /// Entries of one cell.
    pub fn cell_len(&self) -> usize {
        (self.time_order + 1) * self.slot_len()
    }
    /// Entries of one slot of a cell.
    pub fn slot_len(&self) -> usize {
        self.dimension * self.nodes
    }
    /// Slots: the bottom position and N_t velocities.
    pub fn slots(&self) -> usize {
        self.time_order + 1
    }

    /// Sets the displacement d_n at the bottom, `[C0 node][component]`; `None` is the reference position.
    pub fn set_bottom(&mut self, displacement: Option<&[f64]>) {
        let (cell_len, slot_len, dimension) = (self.cell_len(), self.slot_len(), self.dimension);
        self.origins.copy_from_slice(&self.first_nodes);
        for (cell, data) in self.data.chunks_exact_mut(cell_len).enumerate() {
            let (position, velocities) = data.split_at_mut(slot_len);
            // Sums over slots multiply them by zero, so values left by a failed slab must not be NaN.
            velocities.fill(0.0);
            position.copy_from_slice(&self.reference[cell * slot_len..(cell + 1) * slot_len]);
            if let Some(displacement) = displacement {
                let (nodes, origin) = (self.numbering.cell(cell), &mut self.origins[cell * dimension..][..dimension]);
                let first = &displacement[nodes[0] * dimension..][..dimension];
                add_nodes(displacement, nodes, first, position);
                origin.iter_mut().zip(first).for_each(|(origin, first)| *origin += first);
            }
        }
    }

    /// The origin of `cell` in this slab, `[component]`.
    pub fn origin(&self, cell: usize) -> &[f64] {
        &self.origins[cell * self.dimension..(cell + 1) * self.dimension]
    }

    /// Sets the velocities `v[time node][C0 node][component]`.
    pub fn set_velocities(&mut self, v: &[f64]) {
        let (cell_len, slot_len, field_len) = (self.cell_len(), self.slot_len(), self.field_len());
        let zero = &[0.0; 3][..self.dimension];
        for (cell, data) in self.data.chunks_exact_mut(cell_len).enumerate() {
            let slots = data[slot_len..].chunks_exact_mut(slot_len);
            for (slot, field) in slots.zip(v.chunks_exact(field_len)) {
                slot.fill(0.0);
                add_nodes(field, self.numbering.cell(cell), zero, slot);
            }
        }
    }

    /// A direction of variation of the motion: velocities only, the bottom is fixed.
    pub fn set_direction(&mut self, v: &[f64]) {
        let (cell_len, slot_len) = (self.cell_len(), self.slot_len());
        for data in self.data.chunks_exact_mut(cell_len) {
            data[..slot_len].fill(0.0);
        }
        self.set_velocities(v);
    }

    /// The nodal positions of `cell` at a time with position row `row` (1, dt Phi_b(s)), `[component][node]`.
    pub fn positions(&self, cell: usize, row: &[f64], out: &mut [f64]) {
        self.relative_positions(cell, row, out);
        for (out, origin) in out.chunks_exact_mut(self.nodes).zip(self.origin(cell)) {
            out.iter_mut().for_each(|x| *x += origin);
        }
    }

    /// The same relative to the origin of `cell`.
    pub fn relative_positions(&self, cell: usize, row: &[f64], out: &mut [f64]) {
        let cell = &self.data[cell * self.cell_len()..(cell + 1) * self.cell_len()];
        out.fill(0.0);
        for (weight, slot) in row.iter().zip(cell.chunks_exact(self.slot_len())) {
            for (x, value) in out.iter_mut().zip(slot) {
                *x += weight * value;
            }
        }
    }

    /// One lane of the sum over slots of `weights[slot]` times the coefficients of `cell`, `[component][node]`.
    pub(crate) fn gather_sum(&self, cell: usize, weights: &[f64], lane: usize, packs: &mut [Pack]) {
        let (slot, data) = (self.slot_len(), &self.data[cell * self.cell_len()..(cell + 1) * self.cell_len()]);
        for (i, pack) in packs.iter_mut().enumerate() {
            pack.0[lane] = weights.iter().enumerate().map(|(b, weight)| weight * data[b * slot + i]).sum();
        }
    }
}

/// `[node][component]` to `[component][node]`, relative to the first node.
fn transpose_relative(nodal: &[f64], dimension: usize, out: &mut [f64]) {
    let nodes = nodal.len() / dimension;
    for (i, point) in nodal.chunks_exact(dimension).enumerate() {
        for (d, x) in point.iter().enumerate() {
            out[d * nodes + i] = x - nodal[d];
        }
    }
}

/// Adds a C0 field, `[C0 node][component]`, less the constant `origin`, to the nodes of a cell, `[component][node]`.
fn add_nodes(field: &[f64], numbers: &[usize], origin: &[f64], out: &mut [f64]) {
    let (nodes, dimension) = (numbers.len(), origin.len());
    for (i, &node) in numbers.iter().enumerate() {
        for d in 0..dimension {
            out[d * nodes + i] += field[node * dimension + d] - origin[d];
        }
    }
}
