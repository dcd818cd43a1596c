//! Meshes of files. SU2 files have straight cells, see `su2`. Files of Gmsh are MSH 4.1 and 2.2, text and binary, with
//! quadrilaterals and hexahedra of degree 1 to 10. Triangles, tetrahedra and prisms may be split into them.
//!
//! A file contributes its cells (elements of dimension D), the elements of dimension D - 1 that belong to a physical
//! group, and the names of those groups: they become the boundaries. Physical groups of cells become regions; a boundary
//! may lie between two of them. A group without a name is named by its number. Points, elements of dimension D - 1
//! without a group and `$Periodic` are ignored: the caller names the boundaries to be joined.
//!
//! A left-handed cell (a surface whose normal points down) is turned into a right-handed one. A cell whose det J
//! changes sign is refused.
//!
//! | module | holds |
//! |---|---|
//! | `source` | numbers and lines of a file, in text or binary |
//! | `file` | sections and versions; `version2`, `version4` the two layouts of nodes and elements |
//! | `foreign` | files of other programs |
//! | `su2` | SU2 files, read into the same lists |
//! | `lists` | lists that another crate has read from its file |
//! | `places` | messages about elements that are known by their place |
//! | `element`, `shape` | kinds of elements, their shapes and the order of their nodes |
//! | `split` | pieces of triangles, tetrahedra and prisms |
//! | `cells` | from elements to cells |
//! | `plane` | whether surfaces are a mesh in the plane |
//! | `convert` | from the file's lists to a [`Mesh`] |
//! | `remedies` | the parts of messages that say what to do |

mod cells;
mod convert;
mod element;
mod error;
mod file;
mod foreign;
mod lists;
mod places;
mod plane;
mod remedies;
mod shape;
mod source;
mod split;
mod su2;
#[cfg(test)]
mod tests;
mod version2;
mod version4;

pub use error::{FilePosition, GmshError};
pub use foreign::is_su2;
pub use lists::{ListedElement, MeshLists};
pub use places::{Numbers, Span};
pub use shape::Shape;

use crate::Mesh;

/// The treatment of triangles, tetrahedra and prisms in a Gmsh file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Simplices {
    /// They are an error.
    #[default]
    Refuse,
    /// They are split: a triangle into 3 quadrilaterals, a tetrahedron into 4 hexahedra, a prism into 3, or into 6 next to
    /// tetrahedra. Quadrilaterals and hexahedra are cut where one of their edges is cut. The pieces fill exactly the same space.
    Split,
}

impl<const D: usize> Mesh<D> {
    /// The mesh in the Gmsh file `bytes`: MSH 4.1 or 2.2, text or binary. Degree p, 1 to 10, becomes order p + 1;
    /// equidistant nodes are replaced by Gauss-Lobatto nodes of the same polynomials.
    ///
    /// Physical groups of dimension D - 1 become boundaries, groups of dimension D become regions. They take the name of the group, or its
    /// number if it has no name. `periodic` names pairs of boundaries that are translates of each other and are joined. With D = 2 the mesh
    /// lies in a plane of constant z. Left-handed cells are turned. Errors name the line, byte or element. The conditions of [`Mesh::new`]
    /// hold too.
    pub fn from_gmsh(bytes: &[u8], periodic: &[(String, String)]) -> Result<Self, GmshError> {
        Self::from_gmsh_with(bytes, periodic, Simplices::Refuse)
    }

    /// The same with triangles, tetrahedra and prisms treated as `simplices` says. Boundaries and regions consist of the
    /// pieces of their elements.
    pub fn from_gmsh_with(
        bytes: &[u8],
        periodic: &[(String, String)],
        simplices: Simplices,
    ) -> Result<Self, GmshError> {
        convert::mesh(&file::read(bytes)?, periodic, simplices)
    }

    /// The mesh in the SU2 file `bytes`, of order 2. Markers become boundaries. Else as [`Mesh::from_gmsh_with`]; errors
    /// name the line.
    pub fn from_su2(bytes: &[u8], periodic: &[(String, String)], simplices: Simplices) -> Result<Self, GmshError> {
        convert::mesh(&su2::read(bytes)?, periodic, simplices).map_err(su2::in_file)
    }

    /// The mesh of `lists`. Else as [`Mesh::from_gmsh_with`]; errors name the places that `lists` gives.
    pub fn from_lists(
        lists: MeshLists,
        periodic: &[(String, String)],
        simplices: Simplices,
    ) -> Result<Self, GmshError> {
        lists::mesh(lists, periodic, simplices)
    }
}
