//! The contents of a mesh file.

use crate::commands::print;
use crate::commands::quality::smallest_scaled_jacobian;
use crate::commands::table::Table;
use case::{AnyMesh, MeshFileError};
use mesh::{Mesh, Simplices};
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
    let tables = match mesh.map_err(|error| Failure::bad_input(in_file(error)))? {
        AnyMesh::Plane(mesh) => tables(path, &mesh),
        AnyMesh::Space(mesh) => tables(path, &mesh),
    };
    if json {
        let problem = problem.map(|problem| ("problem".to_owned(), Value::from(problem)));
        let object: Map<String, Value> = tables.iter().map(Table::json).chain(problem).collect();
        return print(&Value::Object(object).to_string());
    }
    let before = problem.map(|problem| format!("{problem}\n\nThe mesh with `mesh.split_simplices = true`:\n"));
    print(&before.into_iter().chain(tables.iter().map(Table::text)).collect::<Vec<_>>().join("\n"))
}

fn tables<const D: usize>(path: &Path, mesh: &Mesh<D>) -> [Table; 4] {
    let (cell, aspect_ratio) = largest((0..mesh.n_cells()).map(|cell| mesh.aspect_ratio(cell)));
    let mut shape = Table::new(&path.display().to_string());
    shape
        .row("dimension", D, "")
        .row("cells", mesh.n_cells(), "")
        .row("order", mesh.order(), "nodes per direction")
        .row("volume", mesh.volume(), "")
        .row("largest aspect ratio", aspect_ratio, "")
        .row("  in cell", cell, "")
        .row("smallest scaled Jacobian", smallest_scaled_jacobian(mesh), "sampled")
        // Every mesh that was read is valid.
        .row("valid", "yes", "det J > 0 is proved in every cell");
    let mut boundaries = Table::new("boundaries");
    for (boundary, name) in mesh.boundary_names().iter().enumerate() {
        let facets = mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary).count();
        boundaries.row(name, facets, "facets");
    }
    let mut periodic = Table::new("boundaries that are translates of each other and could be periodic");
    for pair in mesh.translated_boundaries() {
        let [minus, plus] = [pair.minus, pair.plus].map(|boundary| mesh.boundary_names()[boundary].as_str());
        periodic.row(&format!("{minus}, {plus}"), pair.translation.to_vec(), "apart");
    }
    [shape, boundaries, regions(mesh), periodic]
}

fn regions<const D: usize>(mesh: &Mesh<D>) -> Table {
    let mut regions = Table::new("regions, and boundaries between them");
    for region in mesh.regions() {
        regions.row(&region.name, region.cells.len(), "cells");
    }
    for (name, sides) in mesh.interfaces() {
        regions.row(name, sides.len(), "facets");
    }
    regions
}

/// The largest value, and its place.
fn largest(values: impl Iterator<Item = f64>) -> (usize, f64) {
    values.enumerate().fold((0, 0.0), |largest, value| if value.1 > largest.1 { value } else { largest })
}
