//! Lists of nodes and elements that another crate has read from its file.

use super::element::Kind;
use super::file::{Element, File};
use super::places::{Span, Words, place};
use super::shape::{Node, Shape};
use super::{GmshError, Simplices, convert};
use crate::Mesh;
use std::collections::BTreeMap;

/// Nodes, elements and names: everything that a mesh is made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshLists {
    /// Positions of the nodes. Elements refer to nodes by their index.
    pub nodes: Vec<[f64; 3]>,
    /// Cells, and faces of cells that belong to a boundary.
    pub elements: Vec<ListedElement>,
    /// Names of boundaries and regions. Elements refer to names by their index.
    pub names: Vec<String>,
    /// The places of nodes in the file, ascending.
    pub node_places: Vec<Span>,
    /// The places of elements in the file, ascending.
    pub element_places: Vec<Span>,
}

/// An element of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct ListedElement {
    /// The shape.
    pub shape: Shape,
    /// The degree p: each edge has p + 1 equidistant nodes.
    pub degree: usize,
    /// The nodes in the order of their reference coordinates, axis 0 fastest. The coordinates of a simplex are those with
    /// a sum of at most 1; a prism is the product of a triangle and a line.
    pub nodes: Vec<usize>,
    /// The names to which the element belongs: boundaries for a face, regions for a cell.
    pub names: Vec<usize>,
}

impl MeshLists {
    /// The highest dimension of an element.
    pub fn dimension(&self) -> usize {
        self.elements.iter().map(|element| element.shape.dimension()).max().unwrap_or(0)
    }

    /// The place of an element in the file, by its index.
    pub fn element_place(&self, index: usize) -> String {
        place(&self.element_places, index, "element")
    }

    /// The place of a node in the file, by its index.
    pub fn node_place(&self, index: usize) -> String {
        place(&self.node_places, index, "node")
    }
}

/// The mesh of `lists`.
pub(super) fn mesh<const D: usize>(
    lists: MeshLists,
    periodic: &[(String, String)],
    simplices: Simplices,
) -> Result<Mesh<D>, GmshError> {
    let (element_places, node_places) = (lists.element_places.clone(), lists.node_places.clone());
    let words = Words {
        element: &|index| place(&element_places, index as usize, "element"),
        node: &|index| place(&node_places, index as usize, "node"),
        nodes: "the nodes of the file",
        boundary: "boundary",
        name_it: "every face without a neighbour must belong to a boundary condition",
        list_once: "leave it in one boundary condition",
        take_out: "take it out of the boundary condition, or put the cells on its two sides into different regions",
    };
    convert::mesh(&file(lists)?, periodic, simplices).map_err(|error| words.tell(error))
}

/// The lists in the form of a Gmsh file.
fn file(lists: MeshLists) -> Result<File, GmshError> {
    let mut orders = BTreeMap::new();
    let mut elements = Vec::with_capacity(lists.elements.len());
    for (index, element) in lists.elements.into_iter().enumerate() {
        let wrong = |problem: String| GmshError::At { place: place(&lists.element_places, index, "element"), problem };
        let (shape, degree) = (element.shape, element.degree);
        let kind = Kind::known(shape, degree)
            .ok_or_else(|| wrong(format!("{shape:?} elements of degree {degree} are not supported")))?;
        let order = orders.entry(kind).or_insert_with(|| gmsh_order(kind));
        if element.nodes.len() != order.len() {
            return Err(wrong(format!("it has {} nodes, expected {}", element.nodes.len(), order.len())));
        }
        let nodes = order.iter().map(|&k| element.nodes[k] as u64).collect();
        let groups = element.names.iter().map(|&name| name as i64).collect();
        elements.push(Element { number: index as u64, kind, groups, nodes });
    }
    let of_dimension = |dimension| lists.names.iter().enumerate().map(move |(k, name)| ((dimension, k as i64), name));
    let names = (0..=3).flat_map(of_dimension).map(|(key, name)| (key, name.clone())).collect();
    let nodes = lists.nodes.into_iter().enumerate().map(|(k, position)| (k as u64, position)).collect();
    Ok(File { names, nodes, elements, volumes: false })
}

/// For each node in the order of Gmsh, its index in the order of reference coordinates.
fn gmsh_order(kind: Kind) -> Vec<usize> {
    let reversed = |&[i, j, k]: &Node| [k, j, i];
    let mut ascending: Vec<_> = kind.nodes().iter().map(reversed).collect();
    ascending.sort_unstable();
    let index = |node: &Node| ascending.partition_point(|other| *other < reversed(node));
    kind.nodes().iter().map(index).collect()
}
