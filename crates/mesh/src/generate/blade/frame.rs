//! The blocks around the O-block.

use super::around::Around;
use super::shear::Shear;
use super::{BladeCells, BladeMesh, Point};
use crate::generate::assembly::{Assembly, Names};
use std::array::from_fn;

/// The blocks around the O-block, in (x, Y). Columns 0, 1, 2 lie before, beside and behind the blade, rows 0, 1, 2
/// below, beside and above it.
pub(super) struct Frame<'a> {
    mesh: &'a BladeMesh,
    around: &'a Around<'a>,
    shear: &'a Shear,
    /// x of the four lines between the columns, at the periodic lines.
    columns: [f64; 4],
}

/// Corners of the O-block as [`Around`] counts them: by column (front, rear) and row (lower, upper).
const CORNERS: [[usize; 2]; 2] = [[0, 1], [3, 2]];

impl<'a> Frame<'a> {
    pub(super) fn new(mesh: &'a BladeMesh, around: &'a Around, shear: &'a Shear) -> Self {
        let x = |corner: usize| around.edge(corner, corner, 0.0)[0];
        let [front, rear] = CORNERS.map(|[lower, upper]| 0.5 * (x(lower) + x(upper)));
        let columns = [front - mesh.distances[0], front, rear, rear + mesh.distances[1]];
        Frame { mesh, around, shear, columns }
    }

    /// A point of the edge of the O-block, see [`Around::edge`].
    fn edge(&self, from: usize, to: usize, share: f64) -> Point {
        self.shear.straightened(self.around.edge(from, to, share))
    }

    /// Cells of the columns and of the rows.
    fn cells(&self) -> [[usize; 3]; 2] {
        let BladeCells { side, end, gap, before, after, .. } = self.mesh.cells;
        [[before, side, after], [gap, end, gap]]
    }

    pub(super) fn add_block(&self, assembly: &mut Assembly, column: usize, row: usize) {
        let cells = [self.cells()[0][column], self.cells()[1][row]];
        let name = |here: bool, name: &'static str| here.then_some(name);
        let names: Names = [
            name(column == 0, "inflow"),
            name(column == 2, "outflow"),
            name(row == 0, "lower"),
            name(row == 2, "upper"),
        ];
        assembly.add(cells, names, |[s, t]| {
            let (s, t) = (s / cells[0] as f64, t / cells[1] as f64);
            let sides = [self.along(column, row, s), self.along(column, row + 1, s)];
            let ends = [self.across(column, row, t), self.across(column + 1, row, t)];
            let corners = [column, column + 1].map(|column| [row, row + 1].map(|row| self.vertex(column, row)));
            transfinite([s, t], sides, ends, corners)
        });
    }

    /// Line `row` (0..=3, from the lower to the upper periodic one) in `column`, s from 0 to 1.
    fn along(&self, column: usize, row: usize, s: f64) -> Point {
        match (column, row) {
            // The lower side is reached from its end, corner FL after a full turn.
            (1, 1) => self.edge(4, 3, s),
            (1, 2) => self.edge(1, 2, s),
            _ => blend(self.vertex(column, row), self.vertex(column + 1, row), s),
        }
    }

    /// Line `column` (0..=3, from the inflow to the outflow) in `row`, t from 0 to 1.
    fn across(&self, column: usize, row: usize, t: f64) -> Point {
        match (column, row) {
            (1, 1) => self.edge(0, 1, t),
            (2, 1) => self.edge(3, 2, t),
            _ => blend(self.vertex(column, row), self.vertex(column, row + 1), t),
        }
    }

    /// The intersection of line `column` and line `row`.
    fn vertex(&self, column: usize, row: usize) -> Point {
        if let (1 | 2, 1 | 2) = (column, row) {
            let corner = CORNERS[column - 1][row - 1];
            return self.edge(corner, corner, 0.0);
        }
        // Inflow and outflow are divided in proportion to the cells.
        let BladeCells { gap, end, .. } = self.mesh.cells;
        let cells_below = [0, gap, gap + end, 2 * gap + end][row];
        let share = cells_below as f64 / (2 * gap + end) as f64;
        [self.columns[column], self.mesh.pitch * (share - 0.5)]
    }
}

fn blend(a: Point, b: Point, s: f64) -> Point {
    from_fn(|i| (1.0 - s) * a[i] + s * b[i])
}

/// The point (s, t) of a block with given points on its sides (Gordon & Hall 1973): the sum of the two linear
/// interpolations between opposite sides minus the bilinear interpolation between the corners.
///
/// * `sides`: at s on the lower and the upper side; `ends`: at t on the left and the right one
/// * `corners`: `[left, right][lower, upper]`
fn transfinite([s, t]: [f64; 2], sides: [Point; 2], ends: [Point; 2], corners: [[Point; 2]; 2]) -> Point {
    let (rows, columns) = (blend(sides[0], sides[1], t), blend(ends[0], ends[1], s));
    let [left, right] = corners.map(|[lower, upper]| blend(lower, upper, t));
    let bilinear = blend(left, right, s);
    from_fn(|i| rows[i] + columns[i] - bilinear[i])
}
