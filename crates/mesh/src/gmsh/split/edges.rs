//! The edges that are cut in two.

use super::pieces::edges;
use super::twins;
use crate::gmsh::file::{Element, File};
use crate::gmsh::shape::Shape;
use crate::numbering::Classes;
use std::collections::BTreeMap;

/// Nodes at the ends of an edge, the smaller first.
type Edge = [u64; 2];

/// The set to which all edges of triangles and tetrahedra belong.
const CUT: usize = 0;

/// The edges that are cut: those of triangles and tetrahedra, and of the triangles of prisms. Every edge opposite to one of them in a
/// quadrilateral, a prism or a hexahedron is cut, too, and so on across the mesh. Twins on periodic boundaries are cut alike.
///
/// So neighbours agree about every facet, and few quadrilaterals and hexahedra are cut.
#[derive(Default)]
pub(in crate::gmsh) struct CutEdges {
    numbers: BTreeMap<Edge, usize>,
    sets: Vec<usize>,
}

impl CutEdges {
    /// The edges of `cells` that are cut; `periodic` has pairs of names of boundaries.
    pub(in crate::gmsh) fn new<const D: usize>(file: &File, cells: &[&Element], periodic: &[(String, String)]) -> Self {
        if cells.iter().all(|cell| cell.kind.shape.is_product_of_lines()) {
            return CutEdges::default();
        }
        let numbers = numbered(cells);
        let mut classes = Classes::new(CUT + 1 + numbers.len());
        cells.iter().for_each(|cell| join_opposite(cell, &numbers, &mut classes));
        for [edge, twin] in twins::edges::<D>(file, periodic) {
            if let (Some(&edge), Some(&twin)) = (numbers.get(&edge), numbers.get(&twin)) {
                classes.join(edge, twin);
            }
        }
        CutEdges { numbers, sets: classes.numbers().1 }
    }

    /// The shape of `element` is a product of simplices: tells for each whether it is cut.
    pub(in crate::gmsh) fn cuts(&self, element: &Element) -> Vec<bool> {
        let is_cut = |edge: &Edge| self.numbers.get(edge).is_some_and(|&number| self.sets[number] == CUT);
        let dimensions = element.kind.shape.factors().iter();
        dimensions.zip(edges_of(element)).map(|(&d, edges)| d > 1 || edges.first().is_some_and(is_cut)).collect()
    }
}

/// Numbers of the edges, in the order of first appearance.
fn numbered(cells: &[&Element]) -> BTreeMap<Edge, usize> {
    let mut numbers = BTreeMap::new();
    for edge in cells.iter().flat_map(|cell| edges_of(cell)).flatten() {
        let next = CUT + 1 + numbers.len();
        numbers.entry(edge).or_insert(next);
    }
    numbers
}

/// Edges of `cell` along the same line of a product are cut together. Edges of triangles and tetrahedra are always cut.
fn join_opposite(cell: &Element, numbers: &BTreeMap<Edge, usize>, classes: &mut Classes) {
    for (&dimension, edges) in cell.kind.shape.factors().iter().zip(edges_of(cell)) {
        let first = if dimension > 1 { CUT } else { numbers[&edges[0]] };
        edges.iter().for_each(|edge| classes.join(first, numbers[edge]));
    }
}

/// The edges of `element` along each of its simplices.
pub(super) fn edges_of(element: &Element) -> Vec<Vec<Edge>> {
    let edge = |[i, j]: [usize; 2]| sorted([element.nodes[i], element.nodes[j]]);
    let shape: Shape = element.kind.shape;
    edges(shape).into_iter().map(|edges| edges.into_iter().map(edge).collect()).collect()
}

fn sorted([a, b]: Edge) -> Edge {
    [a.min(b), a.max(b)]
}
