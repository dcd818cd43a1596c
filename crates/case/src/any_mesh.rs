//! A mesh whose dimension is known only after it is read.

use mesh::{GmshError, Mesh, Simplices, is_su2};

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

/// A mesh in two or three dimensions.
#[derive(Debug)]
pub enum AnyMesh {
    /// Two dimensions.
    Plane(Mesh<2>),
    /// Three dimensions.
    Space(Mesh<3>),
}

impl AnyMesh {
    /// The mesh of a file of Gmsh or SU2, see [`Mesh::from_gmsh`]: three-dimensional if it has cells of volumes.
    pub fn from_file(bytes: &[u8], periodic: &[(String, String)]) -> Result<Self, GmshError> {
        Self::from_file_with(bytes, periodic, Simplices::Refuse)
    }

    /// The same, see [`Mesh::from_gmsh_with`] and [`Mesh::from_su2`].
    pub fn from_file_with(
        bytes: &[u8],
        periodic: &[(String, String)],
        simplices: Simplices,
    ) -> Result<Self, GmshError> {
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
