//! The order in which VTK numbers the nodes of its Lagrange curves (type 68), quadrilaterals (type 70) and hexahedra (type 72).
//!
//! Corners come first, then the edges, the faces and the inside; within each the lowest axis is fastest. The numbering
//! of VTK 9.1 and later is used, in which the edges along axis 2 follow the corners counter-clockwise
//! (`vtkHigherOrderQuadrilateral::PointIndexFromIJK`, `vtkHigherOrderHexahedron::PointIndexFromIJK`).

use crate::layout::Grid;

/// The VTK number of each lattice point of a cell: entry q belongs to the point with lexicographic number q (axis 0
/// fastest).
pub fn vtk_order(grid: &Grid) -> Vec<usize> {
    let n = grid.points_per_direction;
    let lattice = |q: usize| [q % n, q / n % n, q / (n * n)];
    (0..grid.points_per_cell()).map(|q| vtk_node(grid.dimension, n, lattice(q))).collect()
}

/// Values in VTK's `order` of the points of each cell: from and to `[cell][point][component]`.
pub(crate) fn in_vtk_order(order: &[usize], lexicographic: &[f64], components: usize) -> Vec<f64> {
    let mut values = vec![0.0; lexicographic.len()];
    let cell = order.len() * components;
    for (from, to) in lexicographic.chunks_exact(cell).zip(values.chunks_exact_mut(cell)) {
        for (point, &vtk) in from.chunks_exact(components).zip(order) {
            to[vtk * components..][..components].copy_from_slice(point);
        }
    }
    values
}

/// VTK's number of the lattice point (i, j, k), each in 0..`points_per_direction`; k is 0 in two dimensions, j on a curve too.
pub fn vtk_node(dimension: usize, points_per_direction: usize, [i, j, k]: [usize; 3]) -> usize {
    let lattice = Lattice { last: points_per_direction - 1 };
    match dimension {
        1 => lattice.curve(i),
        2 => lattice.quadrilateral(i, j),
        _ => lattice.hexahedron(i, j, k),
    }
}

/// A lattice with indices 0..=last in each direction.
struct Lattice {
    last: usize,
}

impl Lattice {
    /// Points strictly between two corners.
    fn inner(&self) -> usize {
        self.last - 1
    }

    fn is_end(&self, i: usize) -> bool {
        i == 0 || i == self.last
    }

    fn curve(&self, i: usize) -> usize {
        match i {
            0 => 0,
            _ if i == self.last => 1,
            _ => i + 1,
        }
    }

    fn quadrilateral(&self, i: usize, j: usize) -> usize {
        let n = self.inner();
        match (self.is_end(i), self.is_end(j)) {
            (true, true) => corner(i, j),
            (false, false) => 4 + 4 * n + (i - 1) + n * (j - 1),
            _ => 4 + self.edge(i, j),
        }
    }

    /// Number among the 4 n edge points of a quadrilateral, edges counter-clockwise from the low side of axis 1.
    /// Opposite edges run the same way: along their axis.
    fn edge(&self, i: usize, j: usize) -> usize {
        let n = self.inner();
        match (self.is_end(i), i > 0, j > 0) {
            (false, _, false) => i - 1,
            (true, true, _) => n + (j - 1),
            (false, _, true) => 2 * n + (i - 1),
            (true, false, _) => 3 * n + (j - 1),
        }
    }

    fn hexahedron(&self, i: usize, j: usize, k: usize) -> usize {
        let n = self.inner();
        let (edges, faces, inside) = (8, 8 + 12 * n, 8 + 12 * n + 6 * n * n);
        let face = |axis: usize, side: usize, first: usize, second: usize| {
            // Face 2 axis + side (0 low, 1 high); its lowest axis is fastest.
            faces + (2 * axis + usize::from(side > 0)) * n * n + (first - 1) + n * (second - 1)
        };
        match (self.is_end(i), self.is_end(j), self.is_end(k)) {
            (true, true, true) => corner(i, j) + if k > 0 { 4 } else { 0 },
            (true, true, false) => edges + 8 * n + n * corner(i, j) + (k - 1),
            (_, _, true) if self.is_end(i) || self.is_end(j) => edges + self.edge(i, j) + if k > 0 { 4 * n } else { 0 },
            (true, false, false) => face(0, i, j, k),
            (false, true, false) => face(1, j, i, k),
            (false, false, true) => face(2, k, i, j),
            _ => inside + (i - 1) + n * ((j - 1) + n * (k - 1)),
        }
    }
}

/// Counter-clockwise number of a corner in the plane of axes 0 and 1.
fn corner(i: usize, j: usize) -> usize {
    match (i > 0, j > 0) {
        (false, false) => 0,
        (true, false) => 1,
        (true, true) => 2,
        (false, true) => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_node_is_numbered_once() {
        for dimension in [1, 2, 3] {
            for points_per_direction in 2..=17 {
                let grid = Grid { dimension, points_per_direction, cells: 1 };
                let mut order = vtk_order(&grid);
                order.sort_unstable();
                assert!(order.into_iter().eq(0..grid.points_per_cell()), "{grid:?}");
            }
        }
    }

    #[test]
    fn a_curve_begins_with_its_ends() {
        let grid = Grid { dimension: 1, points_per_direction: 4, cells: 1 };
        assert_eq!(vtk_order(&grid), [0, 2, 3, 1]);
    }

    #[test]
    fn a_biquadratic_quadrilateral_is_numbered_like_the_nine_node_element() {
        let grid = Grid { dimension: 2, points_per_direction: 3, cells: 1 };
        assert_eq!(vtk_order(&grid), [0, 4, 1, 7, 8, 5, 3, 6, 2]);
    }

    #[test]
    fn a_triquadratic_hexahedron_has_its_bottom_top_and_middle_layer() {
        let grid = Grid { dimension: 3, points_per_direction: 3, cells: 1 };
        let bottom = [0, 8, 1, 11, 24, 9, 3, 10, 2];
        let middle = [16, 22, 17, 20, 26, 21, 19, 23, 18];
        let top = [4, 12, 5, 15, 25, 13, 7, 14, 6];
        assert_eq!(vtk_order(&grid), [bottom, middle, top].concat());
    }
}
