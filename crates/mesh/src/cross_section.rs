//! A mesh seen along some of its axes: cells that lie behind each other are one stack.
//!
//! Every cell must be extruded along these axes: moving along one axis of its reference cell changes one of these coordinates alone, and no
//! other reference axis changes it.
//!
//! ```text
//! w_j = int l_j(xi) |dx/dxi| dxi,    l_j the polynomials of the nodes along the axis, of all axes their product           (weight of a node)
//! ```
//!
//! With them the mean of a polynomial through the nodes is exact, also where the nodes of a cell of the mesh are not evenly spaced.

use crate::Mesh;
use crate::geometry::CellMap;
use crate::lattice::digit;
use basis::{Lagrange, Matrix, gauss, gauss_lobatto};

/// The stacks of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossSection {
    /// The axes of space that remain, in their order.
    pub remaining: Vec<usize>,
    /// Nodes per direction.
    pub order: usize,
    /// Points that differ by less along each axis are one.
    pub tolerance: f64,
    /// The stacks, in the order of their centres, the first of the remaining axes first.
    pub stacks: Vec<Stack>,
}

/// Cells that lie behind each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Stack {
    /// Positions of its nodes, `[node][remaining axis]`; the first axis of the first cell that remains is the fastest.
    pub points: Vec<Vec<f64>>,
    /// The nodes of cells behind every one of these nodes.
    pub lines: Vec<Vec<LineNode>>,
}

/// A node of a cell on the line behind a node of a stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineNode {
    /// The cell.
    pub cell: usize,
    /// Its node, axis 0 fastest.
    pub node: usize,
    /// The part of the line, or of the plane, that belongs to it.
    pub weight: f64,
}

/// A cell that is extruded along the axes.
struct Extruded {
    centre: Vec<f64>,
    points: Vec<Vec<f64>>,
    lines: Vec<Vec<LineNode>>,
}

impl<const D: usize> Mesh<D> {
    /// The stacks along the axes `along`, with `order` Gauss-Lobatto nodes per direction. `None` if a cell is not extruded along them.
    pub fn cross_section(&self, order: usize, along: &[usize]) -> Option<CrossSection> {
        let remaining: Vec<usize> = (0..D).filter(|axis| !along.contains(axis)).collect();
        let rule = gauss_lobatto(order);
        let seen = View::<D> {
            map: CellMap::on_grid(self.order, &rule.points),
            nodes: order,
            lengths: &length_matrix(order, self.order),
            along,
            remaining: &remaining,
            tolerance: self.same_place(),
        };
        let cells: Option<Vec<Extruded>> =
            (0..self.n_cells()).map(|cell| seen.cell(cell, self.cell_coordinates(cell))).collect();
        let cells = cells?;
        let centres: Vec<&[f64]> = cells.iter().map(|cell| &cell.centre[..]).collect();
        let groups = clusters(&centres, seen.tolerance);
        let stacks = groups.iter().map(|stack| seen.united(&cells, stack)).collect::<Option<_>>()?;
        Some(CrossSection { stacks, order, tolerance: seen.tolerance, remaining })
    }
}

/// How the cells are seen.
struct View<'a, const D: usize> {
    map: CellMap<D>,
    /// Nodes per direction.
    nodes: usize,
    /// Those of [`length_matrix`].
    lengths: &'a Matrix,
    along: &'a [usize],
    remaining: &'a [usize],
    tolerance: f64,
}

impl<const D: usize> View<'_, D> {
    /// A cell, if it is extruded.
    fn cell(&self, cell: usize, coordinates: &[f64]) -> Option<Extruded> {
        let (x, n) = (self.map.positions(coordinates), self.nodes);
        let reference: Vec<usize> =
            self.along.iter().map(|&axis| self.reference_axis(&x, axis)).collect::<Option<_>>()?;
        let weights = self.weights(coordinates, &reference);
        let is_first = |node: &usize| reference.iter().all(|&axis| digit(*node, n, axis) == 0);
        let first: Vec<usize> = (0..x.len()).filter(is_first).collect();
        let points: Vec<Vec<f64>> =
            first.iter().map(|&node| self.remaining.iter().map(|&axis| x[node][axis]).collect()).collect();
        let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64;
        let centre = (0..self.remaining.len()).map(mean).collect();
        let weight = |node: usize| {
            reference.iter().zip(&weights).map(|(&a, weights)| weights[digit(node, n, a)]).product::<f64>()
        };
        let behind = |&start: &usize| -> Vec<LineNode> {
            let same =
                |node: &usize| (0..D).all(|a| reference.contains(&a) || digit(*node, n, a) == digit(start, n, a));
            (0..x.len()).filter(same).map(|node| LineNode { cell, node, weight: weight(node) }).collect()
        };
        Some(Extruded { lines: first.iter().map(behind).collect(), centre, points })
    }

    /// The reference axis of a cell with the nodes `x` along which the coordinate `axis` alone changes, if no other axis changes it.
    fn reference_axis(&self, x: &[[f64; D]], axis: usize) -> Option<usize> {
        let n = self.nodes;
        // How far coordinate i goes along reference axis a.
        let reach = |a: usize, i: usize| {
            let origin = |node: usize| node - digit(node, n, a) * n.pow(a as u32);
            (0..x.len()).map(|node| (x[node][i] - x[origin(node)][i]).abs()).fold(0.0, f64::max)
        };
        let is_along = |a: &usize| {
            (0..D).all(|i| (i == axis) == (reach(*a, i) > self.tolerance))
                && (0..D).all(|b| b == *a || reach(b, axis) <= self.tolerance)
        };
        (0..D).find(is_along)
    }

    /// (weight of a node) for each node along each of the reference axes `reference` of a cell with these `coordinates`.
    fn weights(&self, coordinates: &[f64], reference: &[usize]) -> Vec<Vec<f64>> {
        let along = |(&a, &axis): (&usize, &usize)| {
            let count = self.lengths.cols();
            // A common offset would cost digits.
            let x = |k: usize| coordinates[k * count.pow(a as u32) * D + axis] - coordinates[axis];
            let sense = x(count - 1).signum();
            let weight = |j: usize| self.lengths.row(j).iter().enumerate().map(|(k, l)| sense * l * x(k)).sum::<f64>();
            (0..self.nodes).map(weight).collect()
        };
        reference.iter().zip(self.along).map(along).collect()
    }

    /// The cells `stack` as one. `None` if their nodes do not lie behind each other.
    fn united(&self, cells: &[Extruded], stack: &[usize]) -> Option<Stack> {
        let first = &cells[stack[0]];
        let mut united = Stack { points: first.points.clone(), lines: first.lines.clone() };
        for cell in stack[1..].iter().map(|&cell| &cells[cell]) {
            for (point, line) in cell.points.iter().zip(&cell.lines) {
                let is_here = |other: &Vec<f64>| other.iter().zip(point).all(|(a, b)| (a - b).abs() <= self.tolerance);
                let place = united.points.iter().position(is_here)?;
                united.lines[place].extend(line);
            }
        }
        Some(united)
    }
}

/// int l_j dL_k/dxi dxi, `[j][k]`, for the polynomials l_j of `order` nodes and L_k of the nodes of the mesh.
fn length_matrix(order: usize, order_of_mesh: usize) -> Matrix {
    let rule = gauss((order + order_of_mesh - 2).div_ceil(2));
    let values = Lagrange::gauss_lobatto(order).value_matrix(&rule.points);
    let slopes = Lagrange::gauss_lobatto(order_of_mesh).derivative_matrix(&rule.points);
    let at = |q: usize, j: usize, k: usize| rule.weights[q] * values[(q, j)] * slopes[(q, k)];
    Matrix::from_fn(order, order_of_mesh, |j, k| (0..rule.points.len()).map(|q| at(q, j, k)).sum())
}

/// The numbers of points that agree to `tolerance`, in the order of their coordinates.
pub fn clusters(points: &[&[f64]], tolerance: f64) -> Vec<Vec<usize>> {
    let axes = points.first().map_or(0, |point| point.len());
    let mut groups = vec![(0..points.len()).collect::<Vec<_>>()];
    for axis in 0..axes {
        let at = |number: &usize| points[*number][axis];
        let split = |mut group: Vec<usize>| -> Vec<Vec<usize>> {
            group.sort_by(|a, b| at(a).total_cmp(&at(b)).then(a.cmp(b)));
            group.chunk_by(|a, b| at(b) - at(a) <= tolerance).map(<[usize]>::to_vec).collect()
        };
        groups = groups.into_iter().flat_map(split).collect();
    }
    groups.iter_mut().for_each(|group| group.sort_unstable());
    groups
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{BoxMesh, Curving};

    fn box_mesh(cells: [usize; 3]) -> Mesh<3> {
        let (lower, upper) = ([1.0, 0.0, -1.0], [2.0, 3.0, 1.0]);
        BoxMesh { lower, upper, cells, order: 3, curving: Curving::None, periodic: [false; 3] }.build().unwrap()
    }

    /// The weights of a line add up to its length, those of a plane to its area.
    #[test]
    fn a_box_has_a_stack_for_each_cell_of_its_section() {
        let mesh = box_mesh([4, 2, 5]);
        for (along, stacks, points, whole) in [(&[2][..], 8, 16, 2.0), (&[0], 10, 16, 1.0), (&[0, 2], 2, 4, 2.0)] {
            let section = mesh.cross_section(4, along).unwrap();
            assert_eq!(section.stacks.len(), stacks, "{along:?}");
            for stack in &section.stacks {
                assert_eq!((stack.points.len(), stack.lines.len()), (points, points));
                for line in &stack.lines {
                    let sum: f64 = line.iter().map(|node| node.weight).sum();
                    assert!((sum - whole).abs() < 1e-13, "{along:?}: {sum}");
                }
            }
        }
    }

    /// Cells whose reference axes are turned and mirrored lie behind each other all the same.
    #[test]
    fn nodes_on_a_line_have_the_same_remaining_coordinates() {
        let mesh = box_mesh([2, 3, 4]).scrambled(7);
        let rule = gauss_lobatto(3);
        let map = CellMap::<3>::on_grid(3, &rule.points);
        let section = mesh.cross_section(3, &[1]).unwrap();
        assert_eq!((section.stacks.len(), &section.remaining[..]), (8, &[0, 2][..]));
        for stack in &section.stacks {
            for (point, line) in stack.points.iter().zip(&stack.lines) {
                assert_eq!(line.len(), 9);
                for node in line {
                    let x = map.positions(mesh.cell_coordinates(node.cell))[node.node];
                    assert!((x[0] - point[0]).abs() + (x[2] - point[1]).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn curved_cells_are_extruded_along_z_alone() {
        let straight = box_mesh([2, 2, 2]);
        let bend = |x: &[f64; 3]| [x[0] + 0.05 * x[1].sin(), x[1] + 0.02 * x[0], x[2]];
        let coordinates = straight.coordinates.as_chunks::<3>().0.iter().flat_map(bend).collect();
        let mesh = Mesh { coordinates, ..straight };
        assert!(mesh.cross_section(3, &[2]).is_some());
        assert!(mesh.cross_section(3, &[0]).is_none() && mesh.cross_section(3, &[0, 2]).is_none());
    }

    /// Nodes nearer than 1e-9 of the diameter were one.
    #[test]
    fn nodes_of_thin_cells_have_lines_of_their_own() {
        let upper = [1000.0, 4e-6];
        let mesh = BoxMesh { upper, ..unit_box([2, 1]) }.build().unwrap();
        let section = mesh.cross_section(4, &[0]).unwrap();
        let [stack] = &section.stacks[..] else { panic!("{} stacks", section.stacks.len()) };
        assert!(stack.lines.iter().all(|line| line.len() == 8), "{:?}", stack.lines);
        let heights: Vec<&[f64]> = stack.points.iter().map(|point| &point[..]).collect();
        assert_eq!(clusters(&heights, section.tolerance).len(), 4);
    }

    /// The weights ignored the stretch of the mesh inside a cell.
    #[test]
    fn means_along_stretched_cells_are_exact() {
        let straight = BoxMesh { order: 4, ..unit_box([1, 2]) }.build().unwrap();
        let stretched = |x: &[f64; 2]| [x[0] + 0.9 * x[0] * (1.0 - x[0]) * (x[0] - 0.5), x[1]];
        let coordinates = straight.coordinates.as_chunks::<2>().0.iter().flat_map(stretched).collect();
        let mesh = Mesh { coordinates, ..straight }.scrambled(3);
        // The last order has fewer nodes than the mesh.
        for (order, power) in [(8, 2), (4, 1), (3, 0)] {
            let map = CellMap::<2>::on_grid(4, &gauss_lobatto(order).points);
            let section = mesh.cross_section(order, &[0]).unwrap();
            for line in section.stacks.iter().flat_map(|stack| &stack.lines) {
                let x = |node: &LineNode| map.positions(mesh.cell_coordinates(node.cell))[node.node][0];
                let mean: f64 = line.iter().map(|node| node.weight * x(node).powi(power)).sum();
                assert!((mean - 1.0 / f64::from(power + 1)).abs() < 1e-14, "{order}: {mean}");
            }
        }
    }

    fn unit_box(cells: [usize; 2]) -> BoxMesh<2> {
        let curving = Curving::None;
        BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells, order: 2, curving, periodic: [false; 2] }
    }

    #[test]
    fn clusters_are_sorted_and_forgive_rounding() {
        let points = [[1.0, 2.0], [0.0, 5.0], [1.0 + 1e-12, 1.0], [1.0 - 1e-12, 2.0]];
        let points: Vec<&[f64]> = points.iter().map(|point| &point[..]).collect();
        assert_eq!(clusters(&points, 1e-10), [vec![1], vec![2], vec![0, 3]]);
    }
}
