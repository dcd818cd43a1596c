//! The nodes on cuts, and the pieces that they form.

use crate::substructures::taken;
use mesh::NodeNumbering;
use std::collections::BTreeMap;

/// The nodes that several blocks have and that are not held.
pub(super) struct Interface<const D: usize> {
    /// These C0 nodes, increasing. Their indices here are **places**.
    pub(super) nodes: Vec<usize>,
    /// The places of every block, increasing.
    pub(super) of_block: Vec<Vec<usize>>,
    /// Connected sets of nodes that the same blocks have, in the order of their first places.
    pub(super) pieces: Vec<Piece>,
    /// For every block its pieces, each with its rows in a vector of the block's interface, `[node][component]`.
    pieces_of_block: Vec<Vec<(usize, Vec<usize>)>>,
    /// The position of the node at every place.
    pub(super) positions: Vec<[f64; D]>,
    /// Whether a component is held, at every place.
    pub(super) held: Vec<[bool; D]>,
    vector_length: usize,
}

/// Connected nodes of the interface that the same blocks have: a face between two blocks, an edge, or a vertex.
pub(super) struct Piece {
    /// Increasing.
    pub(super) places: Vec<usize>,
    /// The blocks that have them, increasing.
    pub(super) blocks: Vec<usize>,
}

impl<const D: usize> Interface<D> {
    /// The interface of `blocks`, lists of cells.
    pub(super) fn new(
        blocks: &[Vec<usize>],
        numbering: &NodeNumbering,
        constrained: &[[bool; D]],
        coordinates: &[[f64; D]],
    ) -> Self {
        let mut blocks_of_node = vec![Vec::new(); numbering.count];
        for (block, cells) in blocks.iter().enumerate() {
            let nodes = cells.iter().flat_map(|&cell| numbering.cell(cell));
            nodes.for_each(|&node| push_new(&mut blocks_of_node[node], block));
        }
        let at_cut = |&node: &usize| blocks_of_node[node].len() > 1 && constrained[node] != [true; D];
        let nodes: Vec<usize> = (0..numbering.count).filter(at_cut).collect();
        let blocks_of_place: Vec<&Vec<usize>> = nodes.iter().map(|&node| &blocks_of_node[node]).collect();
        let mut of_block = vec![Vec::new(); blocks.len()];
        for (place, blocks) in blocks_of_place.iter().enumerate() {
            blocks.iter().for_each(|&block| of_block[block].push(place));
        }
        let positions: Vec<[f64; D]> = nodes.iter().map(|&node| coordinates[node]).collect();
        let held = nodes.iter().map(|&node| constrained[node]).collect();
        let pieces = pieces(numbering, &nodes, &blocks_of_place);
        let pieces_of_block = pieces_of_blocks::<D>(&pieces, &of_block);
        Interface { of_block, pieces, pieces_of_block, positions, held, vector_length: numbering.count * D, nodes }
    }

    /// The place of a C0 node.
    pub(super) fn place(&self, node: usize) -> Option<usize> {
        self.nodes.binary_search(&node).ok()
    }

    /// The length of a vector of all C0 nodes.
    pub(super) fn vector_length(&self) -> usize {
        self.vector_length
    }

    /// The entries of the interface of a vector of all C0 nodes.
    pub(super) fn take(&self, x: &[f64]) -> Vec<f64> {
        taken::<D>(&self.nodes, x)
    }

    /// Adds a vector of the interface of a block.
    pub(super) fn add_part(&self, block: usize, part: &[f64], u: &mut [f64]) {
        for (&place, part) in self.of_block[block].iter().zip(part.chunks_exact(D)) {
            u[place * D..][..D].iter_mut().zip(part).for_each(|(u, part)| *u += part);
        }
    }

    /// The pieces of a block, each with its rows in a vector of the block's interface.
    pub(super) fn pieces_of(&self, block: usize) -> impl Iterator<Item = (usize, &[usize])> {
        self.pieces_of_block[block].iter().map(|(piece, rows)| (*piece, &rows[..]))
    }

    /// The pieces of which `block` is the first block.
    pub(super) fn led_by(&self, block: usize) -> impl Iterator<Item = usize> {
        self.pieces_of(block).map(|(piece, _)| piece).filter(move |&piece| self.pieces[piece].blocks[0] == block)
    }

    /// The entries of a vector of the interface of a block, by pieces.
    pub(super) fn parts(&self, block: usize, x: &[f64]) -> BTreeMap<usize, Vec<f64>> {
        self.pieces_of(block).map(|(piece, rows)| (piece, rows.iter().map(|&row| x[row]).collect())).collect()
    }

    /// The mean position of nodes.
    pub(super) fn centre(&self, places: &[usize]) -> [f64; D] {
        let mut centre = [0.0; D];
        for &place in places {
            (0..D).for_each(|i| centre[i] += self.positions[place][i] / places.len() as f64);
        }
        centre
    }
}

impl Piece {
    /// Whether all values are constraints.
    pub(super) fn is_vertex<const D: usize>(&self) -> bool {
        self.places.len() == 1 || (D == 2 && self.blocks.len() > 2)
    }

    /// Whether two blocks share it, and it is more than a vertex.
    pub(super) fn is_face<const D: usize>(&self) -> bool {
        self.blocks.len() == 2 && !self.is_vertex::<D>()
    }
}

/// The pieces of every block, with their rows.
fn pieces_of_blocks<const D: usize>(pieces: &[Piece], of_block: &[Vec<usize>]) -> Vec<Vec<(usize, Vec<usize>)>> {
    let mut of_blocks = vec![Vec::new(); of_block.len()];
    for (number, piece) in pieces.iter().enumerate() {
        for &block in &piece.blocks {
            let first = |place: &usize| of_block[block].partition_point(|other| other < place) * D;
            let rows = piece.places.iter().flat_map(|place| first(place)..first(place) + D).collect();
            of_blocks[block].push((number, rows));
        }
    }
    of_blocks
}

fn push_new(list: &mut Vec<usize>, block: usize) {
    if list.last() != Some(&block) {
        list.push(block);
    }
}

/// The pieces, in the order of their first places. Two nodes are connected if a cell has both.
fn pieces(numbering: &NodeNumbering, nodes: &[usize], blocks_of_place: &[&Vec<usize>]) -> Vec<Piece> {
    let mut root: Vec<usize> = (0..nodes.len()).collect();
    for cell in 0..numbering.n_cells() {
        let mut first: BTreeMap<&Vec<usize>, usize> = BTreeMap::new();
        for place in numbering.cell(cell).iter().filter_map(|node| nodes.binary_search(node).ok()) {
            let other = *first.entry(blocks_of_place[place]).or_insert(place);
            join(&mut root, place, other);
        }
    }
    let mut pieces: BTreeMap<usize, Piece> = BTreeMap::new();
    for place in 0..nodes.len() {
        let blocks = blocks_of_place[place];
        let new = || Piece { places: Vec::new(), blocks: blocks.clone() };
        pieces.entry(find(&mut root, place)).or_insert_with(new).places.push(place);
    }
    pieces.into_values().collect()
}

/// Joins two sets; the smaller root is the root of both.
fn join(root: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find(root, a), find(root, b));
    root[a.max(b)] = a.min(b);
}

fn find(root: &mut [usize], mut a: usize) -> usize {
    while root[a] != a {
        root[a] = root[root[a]];
        a = root[a];
    }
    a
}
