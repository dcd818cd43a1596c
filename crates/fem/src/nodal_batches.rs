//! C0 fields in packs: which node lies in which lane, and how the results of cells become one vector.

use crate::batches::cells_of;
use crate::parallel::{self, Grain};
use mesh::NodeNumbering;
use tensor::{Pack, WIDTH};

/// C0 nodes per task of [`NodalBatches::assemble`]. It sets the size of the tasks, not the result.
const NODES_PER_TASK: usize = 4096;

/// The cells of a mesh, [`WIDTH`] at a time.
///
/// A **cell field** has the layout `[batch][component][node]` in packs, component 0..D, one cell per lane. Lanes after the last cell
/// repeat it: they are computed, but not assembled.
pub struct NodalBatches<const D: usize> {
    cells: usize,
    nodes_per_cell: usize,
    /// C0 nodes, `[batch][node][lane]`.
    nodes: Vec<usize>,
    /// First entry of each C0 node in `places`, with the end.
    starts: Vec<usize>,
    /// The places of each C0 node in the cells, component 0: indices into cell fields, counted in f64, in the order of
    /// the cells.
    places: Vec<usize>,
}

impl<const D: usize> NodalBatches<D> {
    /// The cells of `numbering`.
    pub fn new(numbering: &NodeNumbering) -> Self {
        let (cells, nodes_per_cell) = (numbering.n_cells(), numbering.order().pow(D as u32));
        let mut batches =
            NodalBatches { cells, nodes_per_cell, nodes: Vec::new(), starts: Vec::new(), places: Vec::new() };
        let lanes = (0..batches.count())
            .flat_map(|batch| (0..nodes_per_cell * WIDTH).map(move |k| (batch, k / WIDTH, k % WIDTH)));
        batches.nodes = lanes.map(|(batch, k, lane)| numbering.cell(batches.cell(batch, lane))[k]).collect();
        batches.find_places(numbering);
        batches
    }

    /// Counting sort of all nodes of all cells by their C0 number.
    fn find_places(&mut self, numbering: &NodeNumbering) {
        let mut starts = vec![0; numbering.count + 1];
        let all_cells = 0..self.cells;
        all_cells.clone().for_each(|cell| numbering.cell(cell).iter().for_each(|&node| starts[node + 1] += 1));
        for node in 0..numbering.count {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        self.places = vec![0; starts[numbering.count]];
        for cell in all_cells {
            let pack = cell / WIDTH * self.cell_length();
            for (k, &node) in numbering.cell(cell).iter().enumerate() {
                self.places[next[node]] = (pack + k) * WIDTH + cell % WIDTH;
                next[node] += 1;
            }
        }
        self.starts = starts;
    }

    /// The number of cells.
    pub fn cells(&self) -> usize {
        self.cells
    }
    /// The C0 node in place `k` of a cell.
    pub fn cell_node(&self, cell: usize, k: usize) -> usize {
        self.batch_nodes(cell / WIDTH)[k * WIDTH + cell % WIDTH]
    }
    /// The C0 nodes of a batch, `[node][lane]`.
    fn batch_nodes(&self, batch: usize) -> &[usize] {
        &self.nodes[batch * self.nodes_per_cell * WIDTH..][..self.nodes_per_cell * WIDTH]
    }
    /// The number of batches.
    pub fn count(&self) -> usize {
        self.cells.div_ceil(WIDTH)
    }
    /// Packs of one batch in a cell field.
    pub fn cell_length(&self) -> usize {
        D * self.nodes_per_cell
    }
    /// Numbers of a nodal vector.
    pub fn nodal_length(&self) -> usize {
        D * (self.starts.len() - 1)
    }
    /// Packs of a cell field.
    pub fn field_length(&self) -> usize {
        self.count() * self.cell_length()
    }
    /// The cell in a lane of a batch; behind the last cell, the last cell again.
    pub fn cell(&self, batch: usize, lane: usize) -> usize {
        cells_of(batch, self.cells)[lane]
    }

    /// One batch of a cell field from the nodal vector `d`, `[C0 node][component]`.
    pub fn gather(&self, batch: usize, d: &[f64], cell: &mut [Pack]) {
        let nodes = self.batch_nodes(batch);
        for k in 0..self.nodes_per_cell {
            for lane in 0..WIDTH {
                let node = nodes[k * WIDTH + lane];
                for i in 0..D {
                    cell[i * self.nodes_per_cell + k].0[lane] = d[node * D + i];
                }
            }
        }
    }

    /// out = sum over cells of a cell field, `[C0 node][component]`. A node adds its cells in increasing order for any number of
    /// threads.
    pub fn assemble(&self, field: &[Pack], out: &mut [f64]) {
        let component = self.nodes_per_cell * WIDTH;
        parallel::for_each_chunk(out, NODES_PER_TASK * D, Grain::Any, &|task, out| {
            for (offset, sum) in out.chunks_exact_mut(D).enumerate() {
                let node = task * NODES_PER_TASK + offset;
                sum.fill(0.0);
                for &place in &self.places[self.starts[node]..self.starts[node + 1]] {
                    for i in 0..D {
                        let place = place + i * component;
                        sum[i] += field[place / WIDTH].0[place % WIDTH];
                    }
                }
            }
        });
    }
}
