//! A mesh whose dimension is known only after it is read.

use crate::{input_file, mesh_file};
use cgns::CgnsError;
use mesh::{GmshError, Mesh, MeshLists, Simplices, is_su2};
use std::fs::File;
use std::io::Read;
use std::path::Path;
use thiserror::Error;

/// Why a file gives no mesh.
#[derive(Debug, Error)]
pub enum MeshFileError {
    /// The file cannot be read, or its mesh does not fit into memory.
    #[error(transparent)]
    Read(#[from] std::io::Error),
    /// A file of CGNS holds no lists of a mesh.
    #[error(transparent)]
    Cgns(#[from] CgnsError),
    /// A file of Gmsh or SU2, or the lists of another file, give no mesh.
    #[error(transparent)]
    Mesh(#[from] GmshError),
}

/// The mesh of a file of Gmsh or SU2 in D dimensions.
fn in_dimension<const D: usize>(
    bytes: &[u8],
    periodic: &[(String, String)],
    simplices: Simplices,
) -> Result<Mesh<D>, GmshError> {
    match is_su2(bytes) {
        true => Mesh::from_su2(bytes, periodic, simplices),
        false => Mesh::from_gmsh_with(bytes, periodic, simplices),
    }
}

/// Whether the file at `path` is, or should be, a file of CGNS: by its ending or its first bytes.
fn is_cgns(path: &Path) -> std::io::Result<bool> {
    let mut beginning = Vec::new();
    File::open(path)?.take(8).read_to_end(&mut beginning)?;
    Ok(cgns::is_hdf5(&beginning) || path.extension().is_some_and(|extension| extension == "cgns"))
}

/// A mesh in two or three dimensions.
#[derive(Debug)]
pub enum AnyMesh {
    /// Two dimensions.
    Plane(Mesh<2>),
    /// Three dimensions.
    Space(Mesh<3>),
}

impl AnyMesh {
    /// The mesh of the file at `path`, of Gmsh, SU2 or CGNS: three-dimensional if it has cells of volumes. See
    /// [`Mesh::from_gmsh_with`], [`Mesh::from_su2`] and [`cgns::read`].
    ///
    /// # Errors
    /// If the file cannot be read or holds no mesh; the line, byte, node or element is named.
    pub fn read(path: &Path, periodic: &[(String, String)], simplices: Simplices) -> Result<Self, MeshFileError> {
        mesh_file::check(path)?;
        if is_cgns(path)? {
            return Ok(Self::of_lists(cgns::read(path)?, periodic, simplices)?);
        }
        Ok(Self::of_bytes(&input_file::read(path, u64::MAX)?, periodic, simplices)?)
    }

    fn of_lists(lists: MeshLists, periodic: &[(String, String)], simplices: Simplices) -> Result<Self, GmshError> {
        match lists.dimension() {
            3 => Mesh::from_lists(lists, periodic, simplices).map(AnyMesh::Space),
            _ => Mesh::from_lists(lists, periodic, simplices).map(AnyMesh::Plane),
        }
    }

    fn of_bytes(bytes: &[u8], periodic: &[(String, String)], simplices: Simplices) -> Result<Self, GmshError> {
        match in_dimension(bytes, periodic, simplices) {
            Err(GmshError::Dimension { volume: 0, .. }) => in_dimension(bytes, periodic, simplices).map(AnyMesh::Plane),
            read => read.map(AnyMesh::Space),
        }
    }

    /// N, the number of nodes per direction of the geometry.
    pub fn order(&self) -> usize {
        match self {
            AnyMesh::Plane(mesh) => mesh.order(),
            AnyMesh::Space(mesh) => mesh.order(),
        }
    }

    /// See [`Mesh::with_order`].
    pub fn with_order(self, order: usize) -> Self {
        match self {
            AnyMesh::Plane(mesh) => AnyMesh::Plane(mesh.with_order(order)),
            AnyMesh::Space(mesh) => AnyMesh::Space(mesh.with_order(order)),
        }
    }

    /// See [`Mesh::scrambled`].
    pub fn scrambled(self, seed: u64) -> Self {
        match self {
            AnyMesh::Plane(mesh) => AnyMesh::Plane(mesh.scrambled(seed)),
            AnyMesh::Space(mesh) => AnyMesh::Space(mesh.scrambled(seed)),
        }
    }
}
