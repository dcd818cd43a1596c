//! `mesh.file`

use crate::any_mesh::AnyMesh;
use crate::checker::{Checked, Checker};
use crate::error::Cause;
use crate::key::Key;
use crate::mesh_file;
use crate::raw;
use ::mesh::{GmshError, Simplices};
use std::path::Path;

/// The mesh of a file of Gmsh or SU2, in the order of the file.
pub(super) fn read(checker: &Checker<'_>, raw: &raw::Mesh, file: &Path) -> Checked<AnyMesh> {
    let (key, path) = (Key::new("mesh.file"), checker.beside_case(file));
    let bytes =
        mesh_file::read(&path).map_err(|error| checker.error(&key, Cause::File { path: path.clone(), error }))?;
    let pairs: Vec<(String, String)> = raw.periodic.iter().map(|[one, other]| (one.clone(), other.clone())).collect();
    let refused = |error: GmshError| match &error {
        GmshError::NoBoundary { name, known } => {
            let unknown = Cause::Unknown { kind: "boundary", name: name.clone(), accepted: known.clone() };
            checker.error(&Key::new("mesh.periodic"), unknown)
        }
        _ => checker.error(&key, Cause::MeshFile { path: path.clone(), error }),
    };
    let simplices = if raw.split_simplices == Some(true) { Simplices::Split } else { Simplices::Refuse };
    let mesh = AnyMesh::from_file_with(&bytes, &pairs, simplices).map_err(refused)?;
    check_names(checker, &key, &mesh)?;
    Ok(mesh)
}

/// Names of boundaries become names of columns and parts of messages, each on one line.
fn check_names(checker: &Checker<'_>, key: &Key, mesh: &AnyMesh) -> Checked<()> {
    let names = match mesh {
        AnyMesh::Plane(mesh) => mesh.boundary_names(),
        AnyMesh::Space(mesh) => mesh.boundary_names(),
    };
    let Some(name) = names.iter().find(|name| name.is_empty() || name.contains(char::is_control)) else {
        return Ok(());
    };
    let problem =
        format!("the name of a physical group or marker, {name:?}, is not a name that can be printed on one line");
    Err(checker.combination(key, &problem, "names of printable characters"))
}
