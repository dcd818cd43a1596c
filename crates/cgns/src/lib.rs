//! Nodes, elements and boundary conditions of CGNS files in HDF5.
//!
//! CGNS is a tree of nodes, each with a name, a label (its type) and perhaps an array. In HDF5 a node is a group, its
//! array the data set ` data`. The tree of a mesh is
//!
//! ```text
//! CGNSBase_t                 dimension of the cells, of space
//!   Zone_t                   number of vertices and cells
//!     ZoneType_t             Structured or Unstructured
//!     GridCoordinates_t      CoordinateX, CoordinateY, CoordinateZ
//!     Elements_t             a section: the kind, ElementRange, ElementConnectivity
//!     ZoneBC_t / BC_t        PointList or PointRange, GridLocation, FamilyName
//!     ZoneGridConnectivity_t interfaces between zones
//! ```
//!
//! [`read`] makes [`MeshLists`] of it, from which [`mesh::Mesh::from_lists`] makes a mesh. Outer faces without a boundary
//! condition are joined to faces with corners at the same positions, in the same or another zone. Units, solutions and
//! everything else are ignored.
//!
//! This crate and `output` are the only links to libhdf5.
//!
//! ```
//! use mesh::{Mesh, Simplices};
//! use std::path::Path;
//!
//! fn wing(path: &Path) -> Result<Mesh<3>, Box<dyn std::error::Error>> {
//!     let lists = cgns::read(path)?;
//!     Ok(Mesh::from_lists(lists, &[], Simplices::Refuse)?)
//! }
//!
//! // The file of another program is refused by its first bytes.
//! let directory = tempfile::tempdir()?;
//! let path = directory.path().join("wing.cgns");
//! std::fs::write(&path, "$MeshFormat")?;
//! assert!(!cgns::is_cgns(b"$MeshFormat"));
//! assert!(wing(&path).is_err_and(|error| error.to_string().contains("HDF5")));
//! # Ok::<(), std::io::Error>(())
//! ```
//!
//! | module | holds |
//! |---|---|
//! | `node` | the tree |
//! | `kind`, `order` | kinds of elements, and the order of their nodes |
//! | `base` | from the file to lists |
//! | `lists` | the lists while they are made |
//! | `unstructured` | zones of sections |
//! | `section`, `numbered` | elements of a section; elements of a zone by their numbers |
//! | `structured` | zones that are lattices |
//! | `condition` | boundary conditions, and periodic interfaces, which become boundaries |
//! | `faces` | faces of elements, outer faces |
//! | `join` | zones with common vertices |
//! | `error` | errors of files |

mod base;
mod condition;
mod error;
mod faces;
mod join;
mod kind;
mod lists;
mod node;
mod numbered;
mod order;
mod section;
mod structured;
#[cfg(test)]
mod tests;
mod unstructured;

pub use error::CgnsError;

use mesh::MeshLists;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The first bytes of an HDF5 file.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

/// The first bytes of a CGNS file in the format ADF.
const ADF: &[u8] = b"@(#)ADF Database Version";

/// The name of a node that every CGNS file has.
const VERSION: &[u8] = b"CGNSLibraryVersion";

/// Whether a file with these first bytes is an HDF5 file, which a CGNS mesh is.
pub fn is_hdf5(bytes: &[u8]) -> bool {
    bytes.starts_with(HDF5)
}

/// Whether a file with these first bytes, some tens of thousands, is a CGNS file in HDF5. It need not be opened: libhdf5
/// may crash on a damaged file.
pub fn is_cgns(bytes: &[u8]) -> bool {
    is_hdf5(bytes) && bytes.windows(VERSION.len()).any(|window| window == VERSION)
}

/// The mesh in the CGNS file at `path`. Its dimension is [`MeshLists::dimension`].
///
/// # Errors
/// If the file cannot be read or holds no mesh; the node and the element are named.
pub fn read(path: &Path) -> Result<MeshLists, CgnsError> {
    check_format(path)?;
    base::read(&node::root(path)?)
}

/// Refuses files that are not HDF5, by their first bytes.
fn check_format(path: &Path) -> Result<(), CgnsError> {
    let mut beginning = Vec::new();
    let read = File::open(path).and_then(|file| file.take(ADF.len() as u64).read_to_end(&mut beginning));
    read.map_err(|error| CgnsError::Read(error.to_string()))?;
    match beginning {
        bytes if is_hdf5(&bytes) => Ok(()),
        bytes if bytes.starts_with(ADF) => Err(CgnsError::Adf),
        _ => Err(CgnsError::NotHdf5),
    }
}
