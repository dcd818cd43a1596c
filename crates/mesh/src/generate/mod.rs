//! Meshes made from a few numbers.

mod box_mesh;
mod curving;

pub use box_mesh::{BOX_BOUNDARIES, BoxMesh};
pub use curving::Curving;
