//! C0 numbering of Gauss-Lobatto nodes.

use crate::facet::{corner_node, face_nodes};
use crate::{InteriorFacet, Mesh, Side};
use std::collections::BTreeMap;

/// Global numbers of the Gauss-Lobatto nodes of order N of all cells. Nodes at the same position, or at positions
/// identified by periodicity, have the same number.
///
/// Built from topology alone. Numbers increase in the order in which nodes first occur in the cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeNumbering {
    /// The number of different nodes.
    pub count: usize,
    order: usize,
    nodes_per_cell: usize,
    cells: Vec<usize>,
}

impl NodeNumbering {
    /// Numbers the nodes of order `order`, at least 2, which need not be the order of the geometry.
    pub fn new<const D: usize>(mesh: &Mesh<D>, order: usize) -> Self {
        let nodes_per_cell = order.pow(D as u32);
        let (count, cells) = numbered(mesh, order, |_| true);
        NodeNumbering { count, order, nodes_per_cell, cells }
    }

    /// The same nodes for other cells.
    pub(crate) fn with_cells(&self, cells: Vec<usize>) -> Self {
        NodeNumbering { cells, ..*self }
    }

    /// The numbering of the given cells alone, and the node here of each of its nodes, increasing.
    pub fn of_cells(&self, cells: &[usize]) -> (Self, Vec<usize>) {
        let mut nodes: Vec<usize> = cells.iter().flat_map(|&cell| self.cell(cell)).copied().collect();
        let mut numbers = nodes.clone();
        nodes.sort_unstable();
        nodes.dedup();
        numbers.iter_mut().for_each(|node| *node = nodes.partition_point(|other| other < node));
        (NodeNumbering { count: nodes.len(), cells: numbers, ..*self }, nodes)
    }

    /// N, the number of nodes per direction in a cell.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The number of cells.
    pub fn n_cells(&self) -> usize {
        self.cells.len() / self.nodes_per_cell
    }

    /// The global numbers of the N^D nodes of `cell`, axis 0 fastest.
    pub fn cell(&self, cell: usize) -> &[usize] {
        &self.cells[cell * self.nodes_per_cell..(cell + 1) * self.nodes_per_cell]
    }

    /// The global numbers of the N^(D-1) nodes of a face, in the order of the face's lattice.
    pub fn face<const D: usize>(&self, side: Side) -> Vec<usize> {
        let cell = self.cell(side.cell);
        face_nodes(D, self.order, side.face).into_iter().map(|k| cell[k]).collect()
    }

    /// The position in `mesh` of every C0 node, where the numbering has the order of the mesh. A node that periodicity identifies with others
    /// has one of their positions.
    ///
    /// # Panics
    /// If the orders differ.
    pub fn positions<const D: usize>(&self, mesh: &Mesh<D>) -> Vec<[f64; D]> {
        assert_eq!(self.order, mesh.order(), "the numbering has the order of the mesh");
        let mut positions = vec![[0.0; D]; self.count];
        for cell in 0..mesh.n_cells() {
            for (node, x) in self.cell(cell).iter().zip(mesh.cell_coordinates(cell).chunks_exact(D)) {
                positions[*node] = std::array::from_fn(|d| x[d]);
            }
        }
        positions
    }

    /// The nodes on boundary number `boundary`, in increasing order, each once.
    pub fn on_boundary<const D: usize>(&self, mesh: &Mesh<D>, boundary: usize) -> Vec<usize> {
        let facets = mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary);
        let mut nodes: Vec<usize> = facets.flat_map(|facet| self.face::<D>(facet.side)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}

/// Gives coincident nodes of `mesh` identical positions: the position in the first cell that has them. Neighbours agree on the
/// geometry, but may have computed it in different orders of operations.
pub(crate) fn unite_nodes<const D: usize>(mesh: &mut Mesh<D>) {
    let (count, numbers) = numbered(mesh, mesh.order, |facet| !facet.periodic);
    let mut places: Vec<Option<[f64; D]>> = vec![None; count];
    for (number, x) in numbers.into_iter().zip(mesh.coordinates.chunks_exact_mut(D)) {
        let place = places[number].get_or_insert_with(|| std::array::from_fn(|i| x[i]));
        x.copy_from_slice(place);
    }
}

/// The number of different nodes of order `order`, and the number of every node of every cell. Nodes on facets for which `joins` holds,
/// and on edges with the same vertices, are identified.
pub(crate) fn numbered<const D: usize>(
    mesh: &Mesh<D>,
    order: usize,
    joins: impl Fn(&InteriorFacet) -> bool,
) -> (usize, Vec<usize>) {
    let mut classes = Classes::new(mesh.n_cells() * order.pow(D as u32));
    join_facets(mesh, order, joins, &mut classes);
    join_edges(mesh, order, &mut classes);
    classes.numbers()
}

/// Identifies the nodes on the two sides of every facet for which `joins` holds.
fn join_facets<const D: usize>(
    mesh: &Mesh<D>,
    order: usize,
    joins: impl Fn(&InteriorFacet) -> bool,
    classes: &mut Classes,
) {
    let nodes_per_cell = order.pow(D as u32);
    let lattices: Vec<Vec<usize>> = (0..2 * D).map(|face| face_nodes(D, order, face)).collect();
    for facet in mesh.interior_facets().iter().filter(|facet| joins(facet)) {
        let (minus, plus) = (facet.minus, facet.plus);
        for (i, &node) in lattices[minus.face].iter().enumerate() {
            let twin = lattices[plus.face][facet.orientation.plus_index(D - 1, order, i)];
            classes.join(minus.cell * nodes_per_cell + node, plus.cell * nodes_per_cell + twin);
        }
    }
}

/// Identifies nodes on edges with the same two vertices, running from the smaller vertex number to the larger, and the
/// vertices. Cells may touch in an edge without a chain of facets that connects them.
fn join_edges<const D: usize>(mesh: &Mesh<D>, order: usize, classes: &mut Classes) {
    let nodes_per_cell = order.pow(D as u32);
    let mut edges = BTreeMap::new();
    let mut vertices = BTreeMap::new();
    for cell in 0..mesh.n_cells() {
        for (start, axis) in cell_edges(D) {
            let corners = mesh.corners(cell);
            let (from, to) = (corners[start], corners[start | 1 << axis]);
            let mut nodes = edge_nodes(D, order, start, axis);
            nodes.iter_mut().for_each(|node| *node += cell * nodes_per_cell);
            if from > to {
                nodes.reverse();
            }
            for (vertex, node) in [(from.min(to), nodes[0]), (from.max(to), nodes[order - 1])] {
                classes.join(*vertices.entry(vertex).or_insert(node), node);
            }
            let first: &Vec<usize> = edges.entry((from.min(to), from.max(to))).or_insert_with(|| nodes.clone());
            first.iter().zip(&nodes).for_each(|(&a, &b)| classes.join(a, b));
        }
    }
}

/// The edges of a cell: first corner and axis.
fn cell_edges(dimension: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..dimension).flat_map(move |axis| (0..1 << dimension).filter(move |k| k >> axis & 1 == 0).map(move |k| (k, axis)))
}

/// The nodes, in the lattice of a cell with `n` nodes per direction, of the edge that starts at corner `start` along
/// `axis`.
fn edge_nodes(dimension: usize, n: usize, start: usize, axis: usize) -> Vec<usize> {
    (0..n).map(|i| corner_node(dimension, n, start) + i * n.pow(axis as u32)).collect()
}

/// Sets of identified nodes (union-find). The representative of a set is its smallest member.
pub(crate) struct Classes {
    parent: Vec<usize>,
}

impl Classes {
    pub(crate) fn new(count: usize) -> Self {
        Classes { parent: (0..count).collect() }
    }

    fn root(&mut self, mut node: usize) -> usize {
        while self.parent[node] != node {
            self.parent[node] = self.parent[self.parent[node]];
            node = self.parent[node];
        }
        node
    }

    pub(crate) fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }

    /// The number of sets, and for each node the number of its set. Sets are numbered by their smallest members.
    pub(crate) fn numbers(mut self) -> (usize, Vec<usize>) {
        let mut count = 0;
        let mut numbers = vec![0; self.parent.len()];
        for node in 0..numbers.len() {
            let root = self.root(node);
            if root == node {
                numbers[node] = count;
                count += 1;
            } else {
                numbers[node] = numbers[root];
            }
        }
        (count, numbers)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::mesh::point;
    use crate::scramble::Turn;
    use crate::{BoxMesh, Curving};

    fn wavy_box<const D: usize>(cells: [usize; D], periodic: [bool; D]) -> Mesh<D> {
        let curving = Curving::Wavy { amplitude: 0.03 };
        BoxMesh { lower: [0.0; D], upper: [1.0; D], cells, order: 3, curving, periodic }.build().unwrap()
    }

    #[test]
    fn some_cells_have_a_numbering_of_their_own() {
        let mesh = wavy_box([4, 3], [true, false]);
        let whole = NodeNumbering::new(&mesh, 4);
        let cells = [7, 2, 3];
        let (own, nodes) = whole.of_cells(&cells);
        assert_eq!((own.count, own.n_cells(), own.order()), (nodes.len(), 3, 4));
        assert!(nodes.windows(2).all(|pair| pair[0] < pair[1]));
        for (place, &cell) in cells.iter().enumerate() {
            let found: Vec<usize> = own.cell(place).iter().map(|&node| nodes[node]).collect();
            assert_eq!(found, whole.cell(cell));
        }
    }

    /// Nodes of order n with the same number have the same position, up to periods of 1 along the periodic axes. Nodes
    /// with different numbers have different positions.
    fn assert_numbers_are_places<const D: usize>(mesh: &Mesh<D>, n: usize, periodic: [bool; D]) {
        let numbering = NodeNumbering::new(mesh, n);
        let fine = mesh.with_order(n);
        let mut places: Vec<Option<[f64; D]>> = vec![None; numbering.count];
        let distance = |x: &[f64; D], y: &[f64; D]| {
            let along = |a: usize| (x[a] - y[a]) - if periodic[a] { (x[a] - y[a]).round() } else { 0.0 };
            (0..D).map(|a| along(a).abs()).fold(0.0, f64::max)
        };
        for cell in 0..mesh.n_cells() {
            for (k, &number) in numbering.cell(cell).iter().enumerate() {
                let x = point(fine.cell_coordinates(cell), k);
                let place = places[number].get_or_insert(x);
                assert!(distance(place, &x) < 1e-13, "node {number} is at {place:?} and at {x:?}");
            }
        }
        let places: Vec<[f64; D]> = places.into_iter().map(Option::unwrap).collect();
        for (i, x) in places.iter().enumerate() {
            assert!(places[..i].iter().all(|y| distance(x, y) > 1e-6), "two nodes at {x:?}");
        }
    }

    fn every_pair_of_rotations<const D: usize>(orders: &[usize]) {
        let mut cells = [1; D];
        cells[0] = 2;
        let mesh = wavy_box(cells, [false; D]);
        let rotations: Vec<_> = Turn::<D>::all().into_iter().filter(Turn::is_rotation).collect();
        for first in &rotations {
            for second in &rotations {
                let turned = mesh.turned(&[*first, *second]);
                for &n in orders {
                    let numbering = NodeNumbering::new(&turned, n);
                    assert_eq!(numbering.count, (2 * n - 1) * n.pow(D as u32 - 1));
                    assert_numbers_are_places(&turned, n, [false; D]);
                }
            }
        }
    }

    #[test]
    fn two_quadrilaterals_in_every_rotation() {
        every_pair_of_rotations::<2>(&[2, 3, 4, 7]);
    }

    #[test]
    fn two_hexahedra_in_every_rotation() {
        every_pair_of_rotations::<3>(&[2, 3, 4]);
    }

    /// Neighbours interpolate in different orders of operations, and their last bits once differed.
    #[test]
    fn nodes_that_are_shared_are_the_same_to_the_bit() {
        let cells = [2, 2, 2];
        let curving = Curving::Wavy { amplitude: 0.03 };
        let (lower, upper) = ([1e6; 3], [1e6 + 1.0; 3]);
        let mesh = BoxMesh { lower, upper, cells, order: 4, curving, periodic: [false; 3] }.build().unwrap();
        let fine = mesh.scrambled(5).with_order(6);
        let numbering = NodeNumbering::new(&fine, 6);
        let mut places: Vec<Option<[f64; 3]>> = vec![None; numbering.count];
        for cell in 0..fine.n_cells() {
            for (k, &number) in numbering.cell(cell).iter().enumerate() {
                let x = point(fine.cell_coordinates(cell), k);
                assert_eq!(*places[number].get_or_insert(x), x, "node {number}");
            }
        }
    }

    #[test]
    fn scrambled_boxes() {
        let mesh = wavy_box([3, 2], [false; 2]).scrambled(5);
        assert_numbers_are_places(&mesh, 5, [false; 2]);
        let mesh = wavy_box([2, 2, 2], [false; 3]).scrambled(5);
        assert_numbers_are_places(&mesh, 4, [false; 3]);
    }

    #[test]
    fn periodic_boxes_have_as_many_nodes_as_a_torus() {
        for cells in [[1, 1], [2, 1], [3, 4]] {
            let mesh = wavy_box(cells, [true; 2]).scrambled(1);
            assert_eq!(NodeNumbering::new(&mesh, 5).count, 16 * cells[0] * cells[1]);
            assert_numbers_are_places(&mesh, 5, [true; 2]);
        }
        for cells in [[1, 1, 1], [1, 2, 3]] {
            let mesh = wavy_box(cells, [true, false, true]).scrambled(1);
            assert_eq!(NodeNumbering::new(&mesh, 4).count, 9 * cells[0] * cells[2] * (3 * cells[1] + 1));
            assert_numbers_are_places(&mesh, 4, [true, false, true]);
        }
    }

    /// Only two opposite cells of a 2 x 2 (x 2) box are kept, turned: they touch in a vertex; in 3-D also in an edge.
    fn two_touching_cells<const D: usize>(cells: [usize; D], keep: [usize; 2]) -> Mesh<D> {
        let whole = wavy_box(cells, [false; D]).scrambled(9);
        let corners = keep.iter().flat_map(|&cell| whole.corners(cell).to_vec()).collect();
        let coordinates = keep.iter().flat_map(|&cell| whole.cell_coordinates(cell).to_vec()).collect();
        let sides = (0..2).flat_map(|cell| (0..2 * D).map(move |face| Side { cell, face })).collect();
        Mesh::new(3, corners, coordinates, vec![("all".to_owned(), sides)], vec![]).unwrap()
    }

    #[test]
    fn cells_that_touch_in_a_vertex_or_an_edge_share_its_nodes() {
        let n = 5;
        for (mesh, shared) in [(two_touching_cells([2, 2, 1], [0, 3]), n), (two_touching_cells([2, 2, 2], [0, 7]), 1)] {
            assert_eq!(NodeNumbering::new(&mesh, n).count, 2 * n.pow(3) - shared);
            assert_numbers_are_places(&mesh, n, [false; 3]);
        }
        assert_eq!(NodeNumbering::new(&two_touching_cells([2, 2], [0, 3]), n).count, 2 * n * n - 1);
    }

    #[test]
    fn nodes_on_a_boundary_are_those_on_its_side() {
        let mesh = BoxMesh { curving: Curving::None, ..unit_box() }.build().unwrap().scrambled(3);
        let numbering = NodeNumbering::new(&mesh, 4);
        let fine = mesh.with_order(4);
        for (boundary, name) in mesh.boundary_names().iter().enumerate() {
            let side = crate::generate::BOX_BOUNDARIES.iter().position(|n| n == name).unwrap();
            let on_side = |x: &[f64; 3]| (x[side / 2] - (side % 2) as f64).abs() < 1e-12;
            let cells = (0..mesh.n_cells())
                .flat_map(|cell| numbering.cell(cell).iter().enumerate().map(move |(k, g)| (cell, k, *g)));
            let mut expected: Vec<usize> = cells
                .filter(|&(cell, k, _)| on_side(&point(fine.cell_coordinates(cell), k)))
                .map(|node| node.2)
                .collect();
            expected.sort_unstable();
            expected.dedup();
            assert_eq!(numbering.on_boundary(&mesh, boundary), expected);
        }
        assert_eq!(mesh.boundary_names().len(), 6);
    }

    fn unit_box() -> BoxMesh<3> {
        let curving = Curving::None;
        BoxMesh { lower: [0.0; 3], upper: [1.0; 3], cells: [2, 3, 1], order: 2, curving, periodic: [false; 3] }
    }
}
