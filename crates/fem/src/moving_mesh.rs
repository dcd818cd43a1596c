//! The mesh in a slab: where every cell is at the bottom and how it moves.
//!
//! ```text
//! x(xi, s) = x0(xi) + d_n(xi) + dt sum_b Phi_b(s) V_b(xi),   v(xi, s) = sum_b phi_b(s) V_b(xi)                     (motion)
//! ```

use mesh::{Mesh, NodeNumbering};
use tensor::Pack;

/// Bottom position and velocities per cell, `[cell][slot][component][node]`, slot 0 the position x0 + d_n, slots 1.. the V_b.
#[derive(Clone, Debug)]
pub struct MovingMesh {
    dimension: usize,
    nodes: usize,
    time_order: usize,
    numbering: NodeNumbering,
    reference: Vec<f64>,
    /// The coefficients.
    pub data: Vec<f64>,
}

impl MovingMesh {
    /// A mesh at rest in its reference position.
    pub fn new<const D: usize>(mesh: &Mesh<D>, numbering: NodeNumbering, time_order: usize) -> Self {
        let nodes = mesh.nodes_per_cell();
        let mut reference = vec![0.0; mesh.coordinates().len()];
        for (cell, out) in reference.chunks_exact_mut(D * nodes).enumerate() {
            transpose(mesh.cell_coordinates(cell), D, out);
        }
        let data = vec![0.0; mesh.n_cells() * (time_order + 1) * D * nodes];
        let mut moving = MovingMesh { dimension: D, nodes, time_order, numbering, reference, data };
        moving.set_bottom(None);
        moving
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
        for (cell, data) in self.data.chunks_exact_mut(cell_len).enumerate() {
            let position = &mut data[..slot_len];
            position.copy_from_slice(&self.reference[cell * slot_len..(cell + 1) * slot_len]);
            if let Some(displacement) = displacement {
                add_nodes(displacement, self.numbering.cell(cell), dimension, position);
            }
        }
    }

    /// Sets the velocities `v[time node][C0 node][component]`.
    pub fn set_velocities(&mut self, v: &[f64]) {
        let (cell_len, slot_len, field_len, dimension) =
            (self.cell_len(), self.slot_len(), self.field_len(), self.dimension);
        for (cell, data) in self.data.chunks_exact_mut(cell_len).enumerate() {
            let slots = data[slot_len..].chunks_exact_mut(slot_len);
            for (slot, field) in slots.zip(v.chunks_exact(field_len)) {
                slot.fill(0.0);
                add_nodes(field, self.numbering.cell(cell), dimension, slot);
            }
        }
    }

    /// A direction in which the motion may vary: velocities only, the bottom is fixed.
    pub fn set_direction(&mut self, v: &[f64]) {
        let (cell_len, slot_len) = (self.cell_len(), self.slot_len());
        for data in self.data.chunks_exact_mut(cell_len) {
            data[..slot_len].fill(0.0);
        }
        self.set_velocities(v);
    }

    /// The nodal positions of `cell` at a time with position row `row` (1, dt Phi_b(s)), `[component][node]`.
    pub fn positions(&self, cell: usize, row: &[f64], out: &mut [f64]) {
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

/// `[node][component]` to `[component][node]`.
fn transpose(nodal: &[f64], dimension: usize, out: &mut [f64]) {
    let nodes = nodal.len() / dimension;
    for (i, point) in nodal.chunks_exact(dimension).enumerate() {
        for (d, x) in point.iter().enumerate() {
            out[d * nodes + i] = *x;
        }
    }
}

/// Adds a C0 field, `[C0 node][component]`, to the nodes of a cell, `[component][node]`.
fn add_nodes(field: &[f64], numbers: &[usize], dimension: usize, out: &mut [f64]) {
    let nodes = numbers.len();
    for (i, &node) in numbers.iter().enumerate() {
        for d in 0..dimension {
            out[d * nodes + i] += field[node * dimension + d];
        }
    }
}
