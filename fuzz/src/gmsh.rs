//! Any bytes as a Gmsh file.

use mesh::{Mesh, Simplices};

/// Reads a mesh; true if it is valid in two or three dimensions. Must return for any bytes.
pub fn read(bytes: &[u8]) -> bool {
    let plane = Mesh::<2>::from_gmsh_with(bytes, &[], Simplices::Split);
    let space = Mesh::<3>::from_gmsh_with(bytes, &[], Simplices::Split);
    let is_mesh = plane.is_ok() || space.is_ok();
    // The error must have a message for any input.
    let told = [plane.err(), space.err()].into_iter().flatten().map(|error| error.to_string().len());
    is_mesh || told.sum::<usize>() == 0
}
