//! Partitions of meshes of the generators: sizes, connection, cuts whose best weight is known.

#![allow(clippy::unwrap_used)]
use super::{blocks, coupling};
use crate::generate::{
    AirfoilMesh, AnnulusMesh, ChannelCylinderMesh, ChannelFlagMesh, DiscMesh, EllipsoidMesh, Extrusion,
};
use crate::{BoxMesh, Curving, Mesh, MeshError};

fn brick<const D: usize>(upper: [f64; D], cells: [usize; D], periodic: [bool; D]) -> Mesh<D> {
    BoxMesh { lower: [0.0; D], upper, cells, order: 2, curving: Curving::None, periodic }.build().unwrap()
}

fn airfoil(first_cell: f64, normal_cells: usize) -> Mesh<2> {
    AirfoilMesh { first_cell, normal_cells, ..AirfoilMesh::naca0012(2) }.build().unwrap()
}

/// 60 x 40 cells around a circle, with aspect ratios up to 5e4 at the wall.
fn o_mesh() -> Mesh<2> {
    AnnulusMesh { inner_radius: 0.5, outer_radius: 20.0, first_cell: 1e-6, cells: [60, 40], order: 3 }.build().unwrap()
}

/// The meshes in the plane.
fn plane_meshes() -> Vec<Mesh<2>> {
    let (extent, centre, cells) = ([2.2, 0.41], [0.2, 0.2], [8, 10, 20]);
    let cylinder = ChannelCylinderMesh { extent, centre, diameter: 0.1, first_cell: 0.002, cells, order: 3 };
    vec![
        brick([1.0; 2], [48, 48], [false; 2]),
        brick([1.0; 2], [20, 20], [true; 2]),
        airfoil(0.015, 12),
        airfoil(2e-4, 20),
        o_mesh(),
        cylinder.build().unwrap(),
        ChannelFlagMesh::turek_hron(3).build().unwrap(),
        DiscMesh { radius: 1.0, core_cells: 8, radial_cells: 10, order: 3 }.build().unwrap(),
    ]
}

/// The meshes in space.
fn space_meshes() -> Vec<Mesh<3>> {
    let sphere =
        EllipsoidMesh { semi_axes: [0.5; 3], outer_radius: 20.0, first_cell: 0.05, cells: [4, 4, 4, 8], order: 3 };
    let wing = Extrusion { lower: 0.0, depth: 1.0, layers: 4, periodic: true };
    vec![
        brick([1.0; 3], [9; 3], [false; 3]),
        brick([1.0; 3], [8; 3], [true; 3]),
        airfoil(2e-4, 12).extruded(&wing).unwrap(),
        sphere.build().unwrap(),
    ]
}

/// The number of facets at the cuts.
fn cut_facets<const D: usize>(mesh: &Mesh<D>, block: &[usize]) -> usize {
    mesh.interior_facets().iter().filter(|facet| block[facet.minus.cell] != block[facet.plus.cell]).count()
}

/// Sizes within one cell or 3 % of their mean, and every block in one piece.
fn check_blocks<const D: usize>(mesh: &Mesh<D>, count: usize) {
    let block = blocks(mesh, count).unwrap();
    let mut sizes = vec![0; count];
    block.iter().for_each(|&b| sizes[b] += 1);
    let mean = mesh.n_cells() as f64 / count as f64;
    assert!(sizes.iter().all(|&size| (f64::from(size) - mean).abs() <= (0.03 * mean).max(1.0)), "{sizes:?}");
    assert_eq!(coupling::graph(mesh).pieces(&block), count, "{count} blocks of {} cells", mesh.n_cells());
}

#[test]
fn a_count_without_a_partition_is_refused() {
    let mesh = brick([1.0; 2], [2, 2], [false; 2]);
    for count in [0, 5] {
        assert_eq!(blocks(&mesh, count), Err(MeshError::Blocks { count, cells: 4 }));
    }
    assert_eq!(blocks(&mesh, 1), Ok(vec![0; 4]));
    assert_eq!(blocks(&brick([1.0; 2], [1, 1], [true; 2]), 1), Ok(vec![0]));
    let mut each = blocks(&mesh, 4).unwrap();
    each.sort_unstable();
    assert_eq!(each, [0, 1, 2, 3]);
}

#[test]
fn blocks_are_balanced_and_connected() {
    for mesh in plane_meshes() {
        [2, 3, 8, 16].iter().for_each(|&count| check_blocks(&mesh, count));
    }
    for mesh in space_meshes() {
        [2, 8].iter().for_each(|&count| check_blocks(&mesh, count));
    }
}

#[test]
fn simple_boxes_are_cut_as_they_should_be() {
    let facets = |cells, periodic, count| {
        let mesh = brick(cells_as_lengths(cells), cells, periodic);
        cut_facets(&mesh, &blocks(&mesh, count).unwrap())
    };
    assert_eq!(facets([30, 1], [false; 2], 2), 1);
    assert_eq!(facets([30, 1], [false; 2], 5), 4);
    assert_eq!(facets([30, 1], [true, false], 3), 3);
    assert_eq!(facets([16, 16], [false; 2], 2), 16);
    assert_eq!(facets([16, 16], [false; 2], 4), 32);
    assert_eq!(facets([48, 48], [false; 2], 16), 6 * 48);
    assert_eq!(facets([16, 16], [true; 2], 4), 64);
    let cube = brick([1.0; 3], [8; 3], [false; 3]);
    assert_eq!(cut_facets(&cube, &blocks(&cube, 8).unwrap()), 3 * 64);
}

fn cells_as_lengths<const D: usize>(cells: [usize; D]) -> [f64; D] {
    cells.map(|n| n as f64)
}

/// Cells 1000 times longer than high are cut across the length only, also where other cuts have fewer facets.
#[test]
fn thin_cells_stay_with_their_neighbours_across() {
    for (cells, count) in [([20, 20], 4), ([10, 40], 5), ([24, 8], 8)] {
        let mesh = brick([cells[0] as f64, 1e-3 * cells[1] as f64], cells, [false; 2]);
        let block = blocks(&mesh, count).unwrap();
        assert!(
            mesh.interior_facets().iter().all(|f| f.minus.face / 2 == 0 || block[f.minus.cell] == block[f.plus.cell])
        );
        assert_eq!(cut_facets(&mesh, &block), (count - 1) * cells[1]);
    }
}

/// No cut between two cells that are more than 20 times longer along their facet than across.
#[test]
fn boundary_layers_are_not_cut_along_the_wall() {
    for mesh in [airfoil(0.015, 12), airfoil(2e-4, 20), o_mesh()] {
        for count in [2, 4, 8] {
            let (block, graph) = (blocks(&mesh, count).unwrap(), coupling::graph(&mesh));
            let strong = |v: usize| graph.edges(v).iter().filter(|edge| edge.1 > 200).all(|e| block[e.0] == block[v]);
            assert!((0..graph.len()).all(strong), "{count} blocks of {} cells", mesh.n_cells());
        }
    }
}

/// The generators place nodes to round-off, and other machines round otherwise: that must not matter.
#[test]
fn round_off_of_the_nodes_does_not_matter() {
    for mesh in plane_meshes() {
        let mut moved = mesh.clone();
        moved.coordinates.iter_mut().for_each(|x| *x *= 1.0 + 3e-15);
        let block = blocks(&mesh, 5);
        assert!(block.is_ok() && block == blocks(&mesh, 5));
        assert_eq!(block, blocks(&moved, 5));
        assert_eq!(block, blocks(&mesh.with_order(4), 5));
    }
}

#[test]
fn separate_meshes_are_not_cut() {
    let square = brick([1.0; 2], [8, 8], [false; 2]);
    let vertices = square.corners.iter().max().unwrap() + 1;
    let corners = square.corners.iter().copied().chain(square.corners.iter().map(|v| v + vertices)).collect();
    let shifted = square.coordinates.iter().map(|x| x + 3.0);
    let coordinates = square.coordinates.iter().copied().chain(shifted).collect();
    let sides = square.boundary_facets.iter().map(|facet| facet.side);
    let sides = sides.flat_map(|side| [side, crate::Side { cell: side.cell + 64, ..side }]).collect();
    let mesh = Mesh::<2>::new(2, corners, coordinates, vec![("wall".to_owned(), sides)], vec![]).unwrap();
    for (count, cut) in [(2, 0), (4, 16)] {
        assert_eq!(cut_facets(&mesh, &blocks(&mesh, count).unwrap()), cut);
        check_blocks(&mesh, count);
    }
}
