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
    /// The coefficients of component `m` at time node `a` of `cell`.
    pub fn component_at(&self, cell: usize, a: usize, m: usize) -> Range<usize> {
        let start = self.cell_at(cell, a).start + m * self.nodes;
        start..start + self.nodes
    }
    /// The coefficient of component `m` at space node `i` and time node `a` of `cell`.
    pub fn index(&self, cell: usize, a: usize, m: usize, i: usize) -> usize {
        self.component_at(cell, a, m).start + i
    }
    /// All pairs (cell, time node) in the order of the coefficients.
    pub fn cells_and_times(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (cells, time_order) = (self.cells, self.time_order);
        (0..cells).flat_map(move |cell| (0..time_order).map(move |a| (cell, a)))
    }
    /// The coefficients of component `m`, for every pair of [`Self::cells_and_times`].
    pub fn component(&self, m: usize) -> impl Iterator<Item = Range<usize>> + use<> {
        let layout = *self;
        self.cells_and_times().map(move |(cell, a)| layout.component_at(cell, a, m))
    }
    /// The cell of the coefficient `index`.
    pub fn cell_of(&self, index: usize) -> usize {
        index / self.cell_len()
    }
    /// The component of the coefficient `index`.
    pub fn component_of(&self, index: usize) -> usize {
        index / self.nodes % self.components
    }
}

#[cfg(test)]
mod tests {
    use super::Layout;

    const LAYOUT: Layout = Layout { cells: 3, time_order: 2, components: 4, nodes: 9 };

    #[test]
    fn the_cell_and_the_component_of_an_index_are_found() {
        let (mut next, Layout { cells, components, nodes, .. }) = (0, LAYOUT);
        for (cell, a) in LAYOUT.cells_and_times() {
            assert_eq!(LAYOUT.cell_at(cell, a).start, next);
            for (m, i) in (0..components).flat_map(|m| (0..nodes).map(move |i| (m, i))) {
                assert_eq!(
                    (LAYOUT.index(cell, a, m, i), LAYOUT.cell_of(next), LAYOUT.component_of(next)),
                    (next, cell, m)
                );
                next += 1;
            }
        }
        assert_eq!((next, LAYOUT.cell_of(next)), (LAYOUT.len(), cells));
    }

    #[test]
    fn components_cover_every_index_once() {
        let mut seen = vec![0; LAYOUT.len()];
        for m in 0..LAYOUT.components {
            for index in LAYOUT.component(m).flatten() {
                assert_eq!(LAYOUT.component_of(index), m);
                seen[index] += 1;
            }
        }
        assert!(seen.iter().all(|&times| times == 1));
    }
}
