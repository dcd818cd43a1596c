//! All mesh generators, files of meshes, and their errors.

use super::*;
use tempfile::TempDir;

mod bad_keys;
mod files;
mod generators;
mod shapes;

/// A case that moves a mesh; its boundaries rest.
const MOVED: &str = "[motion]\nboundary.others = \"fixed\"\n[time]\norder = 1\nend = 1\nslabs = 1\n[mesh]\n";

/// Points of a rounded body.
const DIAMOND: &str = "[[1, 0], [0.7, 0.7], [0, 1], [-0.7, 0.7], [-1, 0], [-0.7, -0.7], [0, -1], [0.7, -0.7]]";

/// The other keys of a mesh around it.
const AROUND: &str = "outer_radius = 5, first_cell = 0.1, cells = [16, 6]";

/// A valid mesh of the generator, which errors change in one number.
const ELLIPSOID: &str =
    "generate.ellipsoid = { semi_axes = [1, 0.7, 1.3], outer_radius = 4, first_cell = 0.3, cells = [1, 2, 3, 4] }";

fn with_mesh(mesh: &str) -> Result<AnyCase, Box<CaseError>> {
    check_text(&format!("{MOVED}{mesh}"), &[])
}

fn plane_mesh(mesh: &str) -> ::mesh::Mesh<2> {
    match with_mesh(mesh) {
        Ok(AnyCase::Plane(case)) => case.mesh,
        other => panic!("{other:?}"),
    }
}

fn mesh_in_space(mesh: &str) -> ::mesh::Mesh<3> {
    match with_mesh(mesh) {
        Ok(AnyCase::Space(case)) => case.mesh,
        other => panic!("{other:?}"),
    }
}
