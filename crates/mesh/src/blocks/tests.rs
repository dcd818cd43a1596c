#![allow(clippy::unwrap_used)]
use super::{blocks, colours};
use crate::generate::AirfoilMesh;
use crate::{BoxMesh, Curving, Mesh, MeshError};

fn brick<const D: usize>(upper: [f64; D], cells: [usize; D], periodic: [bool; D]) -> Mesh<D> {
    BoxMesh { lower: [0.0; D], upper, cells, order: 2, curving: Curving::None, periodic }.build().unwrap()
}

fn check<const D: usize>(mesh: &Mesh<D>, count: usize) -> Vec<usize> {
    let block = blocks(mesh, count).unwrap();
    let mut sizes = vec![0; count];
    block.iter().for_each(|&b| sizes[b] += 1);
    let mean = mesh.n_cells() as f64 / count as f64;
    assert!(sizes.iter().all(|&size| (f64::from(size) - mean).abs() <= (0.03 * mean).max(1.0)), "{sizes:?}");
    let colour = colours(mesh, &block);
    for facet in mesh.interior_facets() {
        let (a, b) = (facet.minus.cell, facet.plus.cell);
        assert!(block[a] == block[b] || (colour[a].is_some() && colour[b].is_some() && colour[a] != colour[b]));
    }
    block
}

#[test]
fn a_count_without_a_partition_is_refused() {
    let mesh = brick([1.0; 2], [2, 2], [false; 2]);
    for count in [0, 5] {
        assert_eq!(blocks(&mesh, count), Err(MeshError::Blocks { count, cells: 4 }));
    }
    assert_eq!(blocks(&mesh, 1), Ok(vec![0; 4]));
}

#[test]
fn blocks_are_balanced() {
    for count in [2, 3, 4, 8, 16, 64] {
        check(&brick([1.0; 2], [48, 48], [false; 2]), count);
        check(&brick([1.0; 3], [9; 3], [true; 3]), count);
        check(&AirfoilMesh::naca0012(2).build().unwrap(), count);
    }
}
