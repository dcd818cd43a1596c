//! The layout of unknowns: all code that turns (cell, time node, component, space node) into an index.

use std::ops::Range;

/// Coefficients of the flow in one slab, `u[cell][time node][component][space node]`; with one time node also a state at
/// one time, `u[cell][component][space node]`.
///
/// Every cell has the same orders. All indices go through this type, so that cells can have their own orders later.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Cells of the mesh.
    pub cells: usize,
    /// Nodes in time N_t.
    pub time_order: usize,
    /// Components of the state M.
    pub components: usize,
    /// Nodes in space per cell, N_s^D.
    pub nodes: usize,
}

impl Layout {
    /// The layout of a state at one time of the same cells.
    pub fn at_one_time(&self) -> Layout {
        Layout { time_order: 1, ..*self }
    }
    /// Number of coefficients.
    pub fn len(&self) -> usize {
        self.cells * self.cell_len()
    }
    /// Whether there are no coefficients.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Coefficients of one cell.
    pub fn cell_len(&self) -> usize {
        self.time_order * self.time_len()
    }
    /// Coefficients of one cell at one time node.
    pub fn time_len(&self) -> usize {
        self.components * self.nodes
    }
    /// The coefficients of `cell`.
    pub fn cell(&self, cell: usize) -> Range<usize> {
        cell * self.cell_len()..(cell + 1) * self.cell_len()
    }
    /// The coefficients of `cell` at time node `a`.
    pub fn cell_at(&self, cell: usize, a: usize) -> Range<usize> {
        let start = cell * self.cell_len() + a * self.time_len();
        start..start + self.time_len()
    }
    /// The coefficient of component `m` at space node `i` and time node `a` of `cell`.
    pub fn index(&self, cell: usize, a: usize, m: usize, i: usize) -> usize {
        self.cell_at(cell, a).start + m * self.nodes + i
    }
}
