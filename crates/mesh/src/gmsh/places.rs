//! Messages about elements and nodes that are known by their place in a file rather than by a number.

use super::GmshError;
use crate::MeshError;

/// Elements or nodes that follow one another in a list, and their names in messages.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// The index of the first one in the list.
    pub first: usize,
    /// Their common name, such as `zone "A", element`.
    pub label: String,
    /// Their numbers.
    pub numbers: Numbers,
}

/// Numbers of elements or nodes that follow one another.
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// Consecutive numbers from this one on.
    From(u64),
    /// Indices from 1 in a lattice with these lengths, axis 0 fastest.
    Lattice(Vec<usize>),
}

impl Span {
    /// The name of an item of the span, by its index in the list.
    pub fn place(&self, index: usize) -> String {
        let offset = index.saturating_sub(self.first);
        match &self.numbers {
            Numbers::From(number) => format!("{} {}", self.label, number.saturating_add(offset as u64)),
            Numbers::Lattice(lengths) => format!("{} {}", self.label, lattice_index(offset, lengths)),
        }
    }
}

/// Indices from 1 as a text, `(i, j)`.
fn lattice_index(mut offset: usize, lengths: &[usize]) -> String {
    let mut indices = Vec::new();
    for length in lengths.iter().map(|&length| length.max(1)) {
        indices.push((1 + offset % length).to_string());
        offset /= length;
    }
    format!("({})", indices.join(", "))
}

/// The place of item `index` of a list with `spans`, which ascend.
pub(super) fn place(spans: &[Span], index: usize, otherwise: &str) -> String {
    match spans[..spans.partition_point(|span| span.first <= index)].last() {
        Some(span) => span.place(index),
        None => format!("{otherwise} {index}"),
    }
}

/// The remedy for surfaces that do not lie at constant z, in one plane or not.
fn not_plane(tilted: bool) -> &'static str {
    match tilted {
        true => "a mesh in two dimensions has constant z: rotate its plane into the x-y plane",
        false => {
            "the file has surfaces that do not lie in one plane, and no volumes: save the cells of the volumes too; a mesh in two \
             dimensions has constant z"
        }
    }
}

/// The words of messages about a file that is not Gmsh's.
pub(super) struct Words<'a> {
    /// The place of an element, from its number.
    pub(super) element: &'a dyn Fn(u64) -> String,
    /// The place of a node, from its number.
    pub(super) node: &'a dyn Fn(u64) -> String,
    /// The list of all nodes.
    pub(super) nodes: &'static str,
    /// The kind of item that names a boundary.
    pub(super) boundary: &'static str,
    /// The remedy for a face without a name.
    pub(super) name_it: &'static str,
    /// The remedy for a face in two boundaries.
    pub(super) list_once: &'static str,
    /// The remedy for a face of a boundary that lies inside of the mesh.
    pub(super) take_out: &'static str,
}

impl Words<'_> {
    /// The error with the place in the file and a remedy that does not speak of Gmsh.
    pub(super) fn tell(&self, error: GmshError) -> GmshError {
        let (place, problem) = match error {
            GmshError::Simplices { kind, count, element, .. } => {
                let remedy = "use quadrilaterals or hexahedra, or set `mesh.split_simplices = true` in the case";
                ((self.element)(element), format!("this is the first of {count} {kind}: {remedy}"))
            }
            GmshError::Degree { element, degree, first } => {
                let problem = format!("degree {degree}, the cells before it have degree {first}");
                ((self.element)(element), format!("{problem}: save all cells with one degree"))
            }
            GmshError::NoNode { element, node } => {
                ((self.element)(element), format!("{} is not among {}", (self.node)(node), self.nodes))
            }
            GmshError::NotPlane { node, z, first, tilted } => {
                let problem = format!("z = {z}, other nodes have {first}: {}", not_plane(tilted));
                ((self.node)(node), problem)
            }
            GmshError::RepeatedNode { element, node } => (
                (self.element)(element),
                format!("{} stands here twice: all nodes of a cell must differ", (self.node)(node)),
            ),
            GmshError::Stray { element, name } => {
                let problem = format!("the element of {} \"{name}\" is not a face of any cell", self.boundary);
                ((self.element)(element), problem)
            }
            GmshError::Cell { element, source, .. } => ((self.element)(element), source.to_string()),
            GmshError::Unnamed { element, source, .. } => {
                ((self.element)(element), format!("{source}: {}", self.name_it))
            }
            GmshError::Listed { element, source, .. } => {
                let is_twice = matches!(source, MeshError::TwoBoundaries { .. });
                let remedy = if is_twice { self.list_once } else { self.take_out };
                ((self.element)(element), format!("{source}: {remedy}"))
            }
            other => return other,
        };
        GmshError::At { place, problem }
    }
}
