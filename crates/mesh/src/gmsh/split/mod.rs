//! Triangles, tetrahedra and prisms are cut into quadrilaterals and hexahedra.
//!
//! A triangle becomes three quadrilaterals, which meet at its centre and at the middles of its edges; a tetrahedron
//! becomes four hexahedra. A prism becomes three hexahedra, or six if the edges between its triangles are cut. Next to them, quadrilaterals
//! become two or four and hexahedra two, four or eight cells, where one of their edges is cut.
//!
//! The pieces have the degree of the file and exactly its shape, see [`polynomial`]. Edges and faces are cut at
//! the means of their corners in reference coordinates, so pieces of neighbours coincide.
//!
//! The price is the shape of the pieces. With straight edges the smallest over the largest det J is, for any triangle or
//! tetrahedron,
//!
//! ```text
//! triangle (1/12) / (1/4) = 1/3,     tetrahedron (1/108) / (1/8) = 2/27.                                (quality)
//! ```
//!
//! | module | holds |
//! |---|---|
//! | `edges` | which edges are cut |
//! | `twins` | edges that coincide on periodic boundaries |
//! | `pieces` | the pieces of each shape |
//! | `polynomial` | the shape of a piece |

mod edges;
mod pieces;
mod polynomial;
mod twins;

use super::GmshError;
use super::element::Kind;
use super::file::{Element, File};
use basis::Matrix;
pub(super) use edges::CutEdges;
use std::collections::BTreeMap;

/// The corners of a piece: for each, in the order of the lattice of a cell, the nodes whose mean it is, increasing.
pub(super) type Corners = Vec<Vec<u64>>;

/// A piece of a kind of elements: its corners, as numbers of corners of the element, and its nodes.
struct Pattern {
    corners: Vec<Vec<usize>>,
    to_gauss_lobatto: Matrix,
}

/// Cuts elements; remembers the pieces of each kind.
pub(super) struct Splitter<'a> {
    file: &'a File,
    edges: CutEdges,
    patterns: BTreeMap<(Kind, Vec<bool>), Vec<Pattern>>,
}

impl<'a> Splitter<'a> {
    pub(super) fn new(file: &'a File, edges: CutEdges) -> Self {
        Splitter { file, edges, patterns: BTreeMap::new() }
    }

    /// Whether `element` is cut.
    pub(super) fn cuts(&self, element: &Element) -> bool {
        self.edges.cuts(element).contains(&true)
    }

    /// The corners of the pieces of `element`, or of `element` itself if it is not cut.
    pub(super) fn corners(&self, element: &Element) -> Vec<Corners> {
        let pieces = pieces::pieces(element.kind.shape, &self.edges.cuts(element));
        pieces.iter().map(|piece| means(element, &piece.corners(element.kind.shape))).collect()
    }

    /// The pieces of `cell`: their corners and the positions of their Gauss-Lobatto nodes, `[node][D]`.
    pub(super) fn pieces<const D: usize>(&mut self, cell: &Element) -> Result<Vec<(Corners, Vec<f64>)>, GmshError> {
        let positions = self.file.positions::<D>(cell)?;
        let cuts = self.edges.cuts(cell);
        let patterns = self.patterns.entry((cell.kind, cuts)).or_insert_with_key(|(kind, cuts)| patterns(*kind, cuts));
        let piece = |pattern: &Pattern| (means(cell, &pattern.corners), pattern.positions(&positions));
        Ok(patterns.iter().map(piece).collect())
    }
}

fn patterns(kind: Kind, cuts: &[bool]) -> Vec<Pattern> {
    let pattern = |piece: &pieces::Piece| Pattern {
        corners: piece.corners(kind.shape),
        to_gauss_lobatto: polynomial::to_gauss_lobatto(kind, piece),
    };
    pieces::pieces(kind.shape, cuts).iter().map(pattern).collect()
}

impl Pattern {
    /// The positions of the nodes of the piece from those of the element.
    fn positions<const D: usize>(&self, nodes: &[[f64; D]]) -> Vec<f64> {
        let sum = |weights: &[f64], i: usize| weights.iter().zip(nodes).map(|(weight, x)| weight * x[i]).sum::<f64>();
        let rows = (0..self.to_gauss_lobatto.rows()).map(|q| self.to_gauss_lobatto.row(q));
        rows.flat_map(|weights| (0..D).map(move |i| sum(weights, i))).collect()
    }
}

/// Sets of corners as sets of nodes.
fn means(element: &Element, corners: &[Vec<usize>]) -> Corners {
    let mean = |corners: &Vec<usize>| {
        let mut nodes: Vec<u64> = corners.iter().map(|&corner| element.nodes[corner]).collect();
        nodes.sort_unstable();
        nodes
    };
    corners.iter().map(mean).collect()
}
