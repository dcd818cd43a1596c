//! `[mesh]`

use super::generate::Generate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The mesh at rest: give `generate` or `file`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mesh {
    /// N, the nodes per direction of the geometry and of the displacement of the mesh, 2 to 16: degree N - 1. A generated mesh
    /// requires it. A file has its own order, which is the default and the minimum. A higher order keeps the shape of the
    /// cells and refines their displacement.
    pub order: Option<usize>,
    /// The generator of the mesh.
    pub generate: Option<Generate>,
    /// A file of Gmsh, MSH 4.1 or 2.2, of SU2, or of CGNS in HDF5, relative to the case file: quadrilaterals or hexahedra. In a
    /// Gmsh file physical groups of curves (in three dimensions surfaces) are the boundaries, those of surfaces (volumes) the
    /// regions. In an SU2 file markers are the boundaries, in a CGNS file boundary conditions by their families. For triangles, tetrahedra and prisms see `split_simplices`.
    pub file: Option<PathBuf>,
    /// Pairs of boundaries of the file, by name, that are translates of each other: they are joined and lose their names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub periodic: Vec<[String; 2]>,
    /// Splits the triangles of the file into 3 quadrilaterals, its tetrahedra into 4 hexahedra, its prisms into 3, or 6 next to
    /// tetrahedra. Quadrilaterals and hexahedra are cut where a neighbour is. The pieces have the order and exactly the shape
    /// of the file; the scaled Jacobian is 1/3 or less in a piece of a triangle or prism, 2/27 or less in one of a tetrahedron.
    /// Without this key, triangles, tetrahedra and prisms are an error.
    pub split_simplices: Option<bool>,
    /// Extrudes a two-dimensional mesh.
    pub extrude: Option<Extrude>,
    /// Turns the axes of every cell at random, by this seed. This is a test of the program: results must not change.
    pub scramble: Option<u64>,
}

/// The extrusion of a two-dimensional mesh along z. Its ends are the boundaries front (z low) and back.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Extrude {
    /// z of the front.
    #[serde(default)]
    pub lower: f64,
    /// The extent along z.
    pub depth: f64,
    /// The number of layers of cells, all of the same height.
    pub layers: usize,
    /// Whether front and back are joined.
    #[serde(default)]
    pub periodic: bool,
}
