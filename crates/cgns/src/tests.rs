//! Files that the tests write: meshes, and what is no mesh.

#![allow(clippy::unwrap_used)]

mod conditions;
mod curved;
mod damaged;
mod messages;
mod plane;
mod structured;
mod writer;
mod written_by_gmsh;

use crate::{CgnsError, read};
use mesh::{Mesh, MeshLists, Simplices};
use writer::File;

/// The lists of the file that `write` writes.
fn lists(write: impl FnOnce(&File)) -> Result<MeshLists, CgnsError> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mesh.cgns");
    write(&File::create(&path));
    read(&path)
}

/// The mesh of the file that `write` writes.
fn mesh<const D: usize>(write: impl FnOnce(&File)) -> Mesh<D> {
    Mesh::from_lists(lists(write).unwrap(), &[], Simplices::Refuse).unwrap()
}

/// The message of the error that the file gives as lists or as a mesh.
fn message<const D: usize>(write: impl FnOnce(&File)) -> String {
    match lists(write) {
        Err(error) => error.to_string(),
        Ok(lists) => Mesh::<D>::from_lists(lists, &[], Simplices::Refuse).unwrap_err().to_string(),
    }
}

/// The boundaries of a mesh with their numbers of faces.
fn boundaries<const D: usize>(mesh: &Mesh<D>) -> Vec<(String, usize)> {
    let faces = |k: usize| mesh.boundary_facets().iter().filter(|facet| facet.boundary == k).count();
    mesh.boundary_names().iter().enumerate().map(|(k, name)| (name.clone(), faces(k))).collect()
}
