//! C0 numbering of Gauss-Lobatto nodes.

use crate::facet::face_nodes;
use crate::{Mesh, Side};
use std::collections::BTreeMap;

/// Global numbers of the Gauss-Lobatto nodes of order N of all cells: nodes at the same place, or at places that periodicity
/// identifies, have the same number.
///
/// Built from topology alone. Numbers increase in the order in which the cells first meet their nodes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeNumbering {
    /// The number of different nodes.
    pub count: usize,
    order: usize,
    nodes_per_cell: usize,
    cells: Vec<usize>,
}

impl NodeNumbering {
    /// Numbers the nodes of order `order`, which need not be the order of the geometry.
    pub fn new<const D: usize>(mesh: &Mesh<D>, order: usize) -> Self {
        let nodes_per_cell = order.pow(D as u32);
        let mut classes = Classes::new(mesh.n_cells() * nodes_per_cell);
        join_facets(mesh, order, &mut classes);
        join_edges(mesh, order, &mut classes);
        let (count, cells) = classes.numbers();
        NodeNumbering { count, order, nodes_per_cell, cells }
    }

    /// N, the number of nodes per direction in a cell.
    pub fn order(&self) -> usize {
        self.order
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

    /// The nodes on boundary number `boundary`, in increasing order, each once.
    pub fn on_boundary<const D: usize>(&self, mesh: &Mesh<D>, boundary: usize) -> Vec<usize> {
        let facets = mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary);
        let mut nodes: Vec<usize> = facets.flat_map(|facet| self.face::<D>(facet.side)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}

/// Joins the nodes on the two sides of every facet, periodic ones included.
fn join_facets<const D: usize>(mesh: &Mesh<D>, order: usize, classes: &mut Classes) {
    let nodes_per_cell = order.pow(D as u32);
    let lattices: Vec<Vec<usize>> = (0..2 * D).map(|face| face_nodes(D, order, face)).collect();
    for facet in mesh.interior_facets() {
        let (minus, plus) = (facet.minus, facet.plus);
        for (i, &node) in lattices[minus.face].iter().enumerate() {
            let twin = lattices[plus.face][facet.orientation.plus_index(D - 1, order, i)];
            classes.join(minus.cell * nodes_per_cell + node, plus.cell * nodes_per_cell + twin);
        }
    }
}

/// Joins nodes on edges with the same two vertices, running from the smaller number to the larger, and with them the vertices:
/// cells may touch in an edge without a chain of facets that connects them.
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

/// The edges of a cell: the corner where each starts, and the axis it follows.
fn cell_edges(dimension: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..dimension).flat_map(move |axis| (0..1 << dimension).filter(move |k| k >> axis & 1 == 0).map(move |k| (k, axis)))
}

/// The nodes, in the lattice of a cell with `n` nodes per direction, of the edge that starts at corner `start` along `axis`.
fn edge_nodes(dimension: usize, n: usize, start: usize, axis: usize) -> Vec<usize> {
    let corner: usize = (0..dimension).map(|a| (start >> a & 1) * (n - 1) * n.pow(a as u32)).sum();
    (0..n).map(|i| corner + i * n.pow(axis as u32)).collect()
}

/// Sets of nodes that are one node (union-find). The representative of a set is its smallest member.
struct Classes {
    parent: Vec<usize>,
}

impl Classes {
    fn new(count: usize) -> Self {
        Classes { parent: (0..count).collect() }
    }

    fn root(&mut self, mut node: usize) -> usize {
        while self.parent[node] != node {
            self.parent[node] = self.parent[self.parent[node]];
            node = self.parent[node];
        }
        node
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }

    /// The number of sets, and for each node the number of its set. Sets are numbered by their smallest members.
    fn numbers(mut self) -> (usize, Vec<usize>) {
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
