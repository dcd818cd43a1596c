//! `mesh.file`

use crate::any_mesh::{AnyMesh, MeshFileError};
use crate::cause::Cause;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw;
use ::mesh::{GmshError, MeshError, Simplices};
use std::path::Path;

/// What a pair of periodic boundaries may be.
const TRANSLATES: &str = "two boundaries that are translates of each other, facet by facet, each in one pair";

/// The mesh of a file of Gmsh, SU2 or CGNS, in the order of the file.
pub(super) fn read(checker: &Checker<'_>, raw: &raw::Mesh, file: &Path) -> Checked<AnyMesh> {
    let (key, path) = (Key::new("mesh.file"), checker.beside_case(file));
    let pairs: Vec<(String, String)> = raw.periodic.iter().map(|[one, other]| (one.clone(), other.clone())).collect();
    let refused = |error: MeshFileError| match error {
        MeshFileError::Read(error) => checker.error(&key, Cause::File { path: path.clone(), error }),
        MeshFileError::Mesh(GmshError::NoBoundary { name, known }) => {
            let unknown = Cause::Unknown { kind: "boundary", name, accepted: known, belongs: None };
            checker.error(&Key::new("mesh.periodic"), unknown)
        }
        error => match entry_of(&error, &pairs) {
            Some(entry) => checker.combination(&Key::new("mesh.periodic").entry(entry), &error.to_string(), TRANSLATES),
            None => checker.error(&key, Cause::MeshFile { path: path.clone(), error }),
        },
    };
    let simplices = if raw.split_simplices == Some(true) { Simplices::Split } else { Simplices::Refuse };
    let mesh = AnyMesh::read(&path, &pairs, simplices).map_err(refused)?;
    check_names(checker, &key, &mesh)?;
    Ok(mesh)
}

/// The entry of `mesh.periodic` that an error is about: the file may be right.
fn entry_of(error: &MeshFileError, pairs: &[(String, String)]) -> Option<usize> {
    match error {
        MeshFileError::Mesh(GmshError::JoinedTwice { pair, .. }) => Some(*pair),
        MeshFileError::Mesh(GmshError::Mesh(
            MeshError::PairCount { minus, plus, .. }
            | MeshError::PeriodicMismatch { minus, plus, .. }
            | MeshError::SameSide { minus, plus, .. },
        )) => pairs.iter().position(|(one, other)| (one, other) == (minus, plus)),
        _ => None,
    }
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
    let problem = format!(
        "the name of a physical group, marker or boundary condition, {name:?}, is not a name that can be printed on one line"
    );
    Err(checker.combination(key, &problem, "names of printable characters"))
}
