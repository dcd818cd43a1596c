//! Structures that the tests share.
#![allow(dead_code)]

use elasticity::{Material, Structure};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};

/// A box with a corner at the origin, curved inside.
pub fn box_mesh<const D: usize>(upper: [f64; D], cells: [usize; D], order: usize, amplitude: f64) -> Mesh<D> {
    let curving = Curving::Smooth { amplitude };
    BoxMesh { lower: [0.0; D], upper, cells, order, curving, periodic: [false; D] }.build().unwrap()
}

/// The body with the components `fixed(boundary)` of every boundary held.
pub fn structure<const D: usize>(
    mesh: Mesh<D>,
    material: Material,
    density: f64,
    fixed: impl Fn(&str) -> [bool; D],
) -> Structure<D> {
    let numbering = NodeNumbering::new(&mesh, mesh.order());
    let mut entries = vec![[false; D]; numbering.count];
    for (index, name) in mesh.boundary_names().iter().enumerate() {
        for node in numbering.on_boundary(&mesh, index) {
            (0..D).for_each(|i| entries[node][i] |= fixed(name)[i]);
        }
    }
    Structure::new(mesh, numbering, material, density, entries).unwrap()
}
