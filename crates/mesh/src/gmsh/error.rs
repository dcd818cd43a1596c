//! Errors of Gmsh files.

use super::remedies;
use crate::MeshError;
use std::fmt;
use thiserror::Error;

/// The place of an error in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilePosition {
    /// In a text file: the line, counted from 1.
    Line(usize),
    /// In a binary file: the byte, counted from 0.
    Byte(usize),
}

impl fmt::Display for FilePosition {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            FilePosition::Line(line) => write!(f, "line {line}"),
            FilePosition::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Why a file of Gmsh or SU2, or the lists of another file, give no mesh. Elements and nodes have the numbers of the file.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GmshError {
    /// The file does not follow the format.
    #[error("{place}: expected {expected}, found {found}")]
    Syntax {
        /// The place.
        place: FilePosition,
        /// The expected input.
        expected: String,
        /// The input found.
        found: String,
    },
    /// The file has another format.
    #[error("this is {format}: save the mesh as a file of Gmsh, MSH 4.1 or 2.2, of SU2, or of CGNS in HDF5")]
    Format {
        /// The format, with its article.
        format: &'static str,
    },
    /// An unsupported version of the format.
    #[error("{place}: version {version} of the MSH format is not supported: save as 4.1 or 2.2")]
    Version {
        /// The place.
        place: FilePosition,
        /// The version.
        version: String,
    },
    /// An unsupported kind of element.
    #[error(
        "{place}: elements of type {code} ({kind}) are not supported: use points, lines, quadrilaterals, hexahedra and, \
         to be split, triangles, tetrahedra and prisms, all with all nodes"
    )]
    Element {
        /// The place.
        place: FilePosition,
        /// Gmsh's number of the type.
        code: i64,
        /// Its name.
        kind: &'static str,
    },
    /// A section is missing.
    #[error("the file has no section ${section}")]
    NoSection {
        /// Its name.
        section: &'static str,
    },
    /// A section occurs twice.
    #[error("{place}: the file has a second section ${section}: keep one")]
    SecondSection {
        /// The beginning of the second one.
        place: FilePosition,
        /// Its name.
        section: String,
    },
    /// A node, or a physical group, is defined twice.
    #[error("{place}: {what} {number} is defined a second time: give every one a number of its own")]
    Twice {
        /// The place of the second definition.
        place: FilePosition,
        /// The kind of the item.
        what: &'static str,
        /// Its number.
        number: u64,
    },
    /// Triangles, tetrahedra or prisms, which are not to be split.
    #[error("the file has {count} {kind}, the first is element {element}: {}", remedies::simplices(*dimension))]
    Simplices {
        /// Their name.
        kind: &'static str,
        /// Their number.
        count: usize,
        /// The first one.
        element: u64,
        /// The dimension of the mesh.
        dimension: usize,
    },
    /// There are no cells of the requested dimension, or cells of a higher one.
    #[error(
        "the file has {surface} elements of surfaces and {volume} of volumes, which is no mesh in {dimension} dimensions{}",
        remedies::dimension(*surface, *volume)
    )]
    Dimension {
        /// The requested dimension.
        dimension: usize,
        /// Triangles and quadrilaterals in the file.
        surface: usize,
        /// Tetrahedra, prisms and hexahedra in the file.
        volume: usize,
    },
    /// Cells of different degrees.
    #[error(
        "element {element} has degree {degree}, the cells before it degree {first}: save all cells with one degree"
    )]
    Degree {
        /// The first element that differs.
        element: u64,
        /// Its degree.
        degree: usize,
        /// The degree of the first cell.
        first: usize,
    },
    /// An element has a node that the file does not list.
    #[error("element {element} has node {node}, which is not in section $Nodes")]
    NoNode {
        /// The element.
        element: u64,
        /// The node.
        node: u64,
    },
    /// The cells are surfaces that do not lie at constant z.
    #[error(
        "node {node} lies at z = {z}, others at {first}, while a mesh in two dimensions has constant z{}",
        remedies::not_plane(*tilted)
    )]
    NotPlane {
        /// The node.
        node: u64,
        /// Its z.
        z: f64,
        /// z of the first node of the first cell.
        first: f64,
        /// Whether all nodes lie in one plane.
        tilted: bool,
    },
    /// An element names a node more than once.
    #[error("element {element} names node {node} twice: all nodes of a cell must differ")]
    RepeatedNode {
        /// The element.
        element: u64,
        /// The node.
        node: u64,
    },
    /// A named element of dimension D - 1 is not a face of a cell.
    #[error(
        "element {element} of boundary \"{name}\" is not a face of any cell: a physical group for the cells beside it too, or none for it; if \
         they have one, the corners of a cell there are not in order, or its nodes are there twice"
    )]
    Stray {
        /// The element.
        element: u64,
        /// The name of its physical group.
        name: String,
    },
    /// A periodic pair names a boundary that does not exist.
    #[error("there is no boundary \"{name}\" to be joined; the file has {known:?}")]
    NoBoundary {
        /// The name.
        name: String,
        /// The names that exist.
        known: Vec<String>,
    },
    /// A boundary is in two periodic pairs, or in one twice.
    #[error("boundary \"{name}\" is joined twice: a pair has two different boundaries, and a boundary is in one pair")]
    JoinedTwice {
        /// The pair in which it is not alone, counted from 0.
        pair: usize,
        /// The name.
        name: String,
    },
    /// A cell is inverted or degenerate.
    #[error("element {element}: {source}{}", remedies::cell(*degree))]
    Cell {
        /// The element.
        element: u64,
        /// Its degree.
        degree: usize,
        /// The error; its cells are counted from 0 in the order of the file. Pieces of elements count as cells.
        source: MeshError,
    },
    /// A side of a cell has no neighbour and is in no physical group.
    #[error("element {element}: {source}: {}", remedies::unnamed(*dimension, *named, *volumes))]
    Unnamed {
        /// The element.
        element: u64,
        /// The dimension of the mesh.
        dimension: usize,
        /// Whether the file names other boundaries.
        named: bool,
        /// Whether the geometry of the file has volumes.
        volumes: bool,
        /// The error.
        source: MeshError,
    },
    /// A face is listed in two boundaries, or lies inside of the mesh.
    #[error("element {element}: {source}: {}", remedies::listed(*dimension, source))]
    Listed {
        /// The element of its cell.
        element: u64,
        /// The dimension of the mesh.
        dimension: usize,
        /// The error.
        source: MeshError,
    },
    /// An error of a file that identifies elements by lines, or by sections and numbers.
    #[error("{place}: {problem}")]
    At {
        /// The line, or the section with the number of the element.
        place: String,
        /// The problem, with the remedy.
        problem: String,
    },
    /// The cells do not form a mesh.
    #[error(transparent)]
    Mesh(MeshError),
}
