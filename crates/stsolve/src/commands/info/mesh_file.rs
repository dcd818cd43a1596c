//! The contents of a mesh file.

use super::mesh_facts::MeshFacts;
use crate::commands::print;
use crate::commands::table::Table;
use case::{AnyMesh, MeshFileError};
use mesh::Simplices;
use serde_json::{Map, Value};
use simulation::Failure;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The beginning of a Gmsh file.
const BEGINNING: &[u8] = b"$MeshFormat";

/// A file is searched for the keys of SU2 and for a name of CGNS up to this length, in bytes.
const SEARCHED: u64 = 1 << 16;

/// Whether the file at `path` is, or should be, a file of Gmsh, SU2 or CGNS.
pub(super) fn is_one(path: &Path) -> bool {
    let mut beginning = Vec::new();
    // A file that cannot be read is reported later.
    let read = File::open(path).map(|file| file.take(SEARCHED).read_to_end(&mut beginning));
    path.extension().is_some_and(|extension| extension == "msh" || extension == "su2" || extension == "cgns")
        || matches!(read, Ok(Ok(_)) if is_mesh(&beginning))
}

/// Whether a file with these first bytes holds a mesh.
fn is_mesh(beginning: &[u8]) -> bool {
    beginning.starts_with(BEGINNING) || mesh::is_su2(beginning) || cgns::is_cgns(beginning)
}

/// Describes the file of Gmsh, SU2 or CGNS at `path`. Where its cells would have to be split, that is told first.
///
/// # Errors
/// If the file cannot be read or holds no mesh; the line, byte, node, element or cell is named.
pub(super) fn info(path: &Path, json: bool) -> Result<(), Failure> {
    let in_file = |error: MeshFileError| anyhow::anyhow!("{}: {error}", path.display());
    let (mesh, problem) = match AnyMesh::read(path, &[], Simplices::Refuse) {
        Err(error) => match AnyMesh::read(path, &[], Simplices::Split) {
            Ok(mesh) => (Ok(mesh), Some(in_file(error).to_string())),
            Err(_) => (Err(error), None),
        },
        mesh => (mesh, None),
    };
    let facts = match mesh.map_err(|error| Failure::bad_input(in_file(error)))? {
        AnyMesh::Plane(mesh) => MeshFacts::new(path, &mesh),
        AnyMesh::Space(mesh) => MeshFacts::new(path, &mesh),
    };
    if json {
        let problem = problem.map(|problem| ("problem".to_owned(), Value::from(problem)));
        let object: Map<String, Value> = facts.json().into_iter().chain(problem).collect();
        return print(&Value::Object(object).to_string());
    }
    let before = problem.map(|problem| format!("{problem}\n\nThe mesh with `mesh.split_simplices = true`:\n"));
    print(&before.into_iter().chain(facts.tables().iter().map(Table::text)).collect::<Vec<_>>().join("\n"))
}
