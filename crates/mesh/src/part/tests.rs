#![allow(clippy::unwrap_used)]
use super::*;
use crate::mesh::point;
use crate::{BoxMesh, Curving, REST, Region};
use std::collections::BTreeSet;

/// The boundaries of a mesh, as they are given to make one.
fn boundaries<const D: usize>(mesh: &Mesh<D>) -> Vec<(String, Vec<Side>)> {
    let sides = |boundary| {
        let facets = mesh.boundary_facets.iter().filter(move |facet| facet.boundary == boundary);
        facets.map(|facet| facet.side).collect()
    };
    let outer = mesh.boundary_names.iter().cloned().enumerate().map(|(index, name)| (name, sides(index)));
    let mut boundaries: Vec<(String, Vec<Side>)> = outer.collect();
    for (name, inner) in &mesh.interfaces {
        match boundaries.iter_mut().find(|(other, _)| other == name) {
            Some((_, sides)) => sides.extend(inner),
            None => boundaries.push((name.clone(), inner.clone())),
        }
    }
    boundaries
}

/// `mesh` with other regions, its facets found again.
fn rebuilt<const D: usize>(mesh: &Mesh<D>, regions: Vec<Region>) -> Result<Mesh<D>, MeshError> {
    Mesh::of_regions(mesh.order, mesh.corners.clone(), mesh.coordinates.clone(), boundaries(mesh), vec![], regions)
}

fn region(name: &str, cells: &[usize]) -> Region {
    Region { name: name.to_owned(), cells: cells.to_vec() }
}

fn wavy_box<const D: usize>(cells: [usize; D]) -> Mesh<D> {
    let curving = Curving::Wavy { amplitude: 0.03 };
    BoxMesh { lower: [0.0; D], upper: [1.0; D], cells, order: 4, curving, periodic: [false; D] }.build().unwrap()
}

/// A flap of one column of cells, on the bottom of a box.
fn flap<const D: usize>(cells: [usize; D], solid: &[usize]) -> Mesh<D> {
    rebuilt(&wavy_box(cells), vec![region("flap", solid)]).unwrap().scrambled(4)
}

/// The parts are meshes in their own right, with the facets that their corners imply, and have every cell of the whole once.
fn assert_parts<const D: usize>(mesh: &Mesh<D>, interface_facets: usize) {
    let (solid, fluid) = (mesh.part(&["flap"]).unwrap(), mesh.part_without(&["flap"]).unwrap());
    assert_eq!(fluid, mesh.part(&[REST]).unwrap());
    for (part, other) in [(&solid, REST), (&fluid, "flap")] {
        assert_eq!(rebuilt(&part.mesh, part.mesh.regions.clone()).unwrap(), part.mesh);
        let boundary = part.mesh.boundary_names.iter().position(|name| name == other).unwrap();
        let facets = part.mesh.boundary_facets.iter().filter(|facet| facet.boundary == boundary);
        assert_eq!(facets.count(), interface_facets);
        for (cell, &whole) in part.cells.iter().enumerate() {
            assert_eq!(part.mesh.cell_coordinates(cell), mesh.cell_coordinates(whole));
        }
    }
    let cells: BTreeSet<usize> = solid.cells.iter().chain(&fluid.cells).copied().collect();
    assert_eq!((cells.len(), solid.cells.len() + fluid.cells.len()), (mesh.n_cells(), mesh.n_cells()));
}

#[test]
fn parts_are_meshes() {
    let plane = flap([4, 3], &[1, 5]);
    assert_parts(&plane, 5);
    assert_eq!(plane.part(&["flap"]).unwrap().mesh.boundary_names(), ["bottom", REST]);
    assert_eq!(plane.part(&[REST]).unwrap().mesh.boundary_names(), ["left", "right", "bottom", "top", "flap"]);
    assert_parts(&flap([3, 3, 2], &[4, 13]), 8);
}

/// The position of every C0 node.
fn places<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering) -> Vec<[f64; D]> {
    // Interpolation rounds, even to the order that the mesh has.
    let fine = if numbering.order() == mesh.order { mesh.clone() } else { mesh.with_order(numbering.order()) };
    let mut places = vec![[f64::NAN; D]; numbering.count];
    for cell in 0..mesh.n_cells() {
        let nodes = numbering.cell(cell).iter().enumerate();
        nodes.for_each(|(k, &node)| places[node] = point(fine.cell_coordinates(cell), k));
    }
    places
}

/// Interface nodes lie on each other, to the bit at the order of the mesh, and are those of the boundaries between the parts.
fn assert_interface<const D: usize>(mesh: &Mesh<D>, order: usize, count: usize) {
    let (solid, fluid) = (mesh.part(&["flap"]).unwrap(), mesh.part_without(&["flap"]).unwrap());
    let numberings = [&solid, &fluid].map(|part| NodeNumbering::new(&part.mesh, order));
    let [in_solid, in_fluid] = [0, 1].map(|k| places(&[&solid, &fluid][k].mesh, &numberings[k]));
    let pairs = mesh.interface(&solid, &fluid, order).unwrap();
    assert_eq!(pairs.len(), count);
    for &(a, b) in &pairs {
        let distance = (0..D).map(|i| (in_solid[a][i] - in_fluid[b][i]).abs()).fold(0.0, f64::max);
        assert!(distance <= if order == mesh.order { 0.0 } else { 1e-15 }, "{distance:e}");
    }
    let boundary = |part: &Part<D>, name: &str| part.mesh.boundary_names.iter().position(|n| n == name).unwrap();
    let of_solid: Vec<usize> = pairs.iter().map(|pair| pair.0).collect();
    let mut of_fluid: Vec<usize> = pairs.iter().map(|pair| pair.1).collect();
    of_fluid.sort_unstable();
    assert_eq!(of_solid, numberings[0].on_boundary(&solid.mesh, boundary(&solid, REST)));
    assert_eq!(of_fluid, numberings[1].on_boundary(&fluid.mesh, boundary(&fluid, "flap")));
}

#[test]
fn parts_share_the_nodes_of_their_interface() {
    let (plane, space) = (flap([4, 3], &[1, 5]), flap([3, 3, 2], &[4, 13]));
    for n in [2, 4, 5] {
        assert_interface(&plane, n, 5 * (n - 1) + 1);
        // Four sides of the column, 2 cells high.
        assert_interface(&space, n, 4 * (n - 1) * (2 * (n - 1) + 1));
    }
}

#[test]
fn nodes_of_a_part_are_nodes_of_the_whole() {
    let mesh = flap([4, 3], &[1, 5]);
    let part = mesh.part(&["flap"]).unwrap();
    let (own, whole) = (NodeNumbering::new(&part.mesh, 4), NodeNumbering::new(&mesh, 4));
    let (places, in_whole) = (places(&part.mesh, &own), places(&mesh, &whole));
    for (node, number) in part.nodes_in_whole(&own, &whole).into_iter().enumerate() {
        assert_eq!(places[node], in_whole[number]);
    }
}

/// Between the two cells of a box lies a facet with a name.
fn named_interface(name: &str) -> Mesh<2> {
    let mut mesh = wavy_box([2, 1]);
    mesh.interfaces = vec![(name.to_owned(), vec![Side { cell: 1, face: 0 }])];
    rebuilt(&mesh, vec![region("fluid", &[0]), region("plate", &[1])]).unwrap()
}

#[test]
fn facets_between_regions_keep_their_names() {
    for mesh in [named_interface("wet"), named_interface("wet").scrambled(2)] {
        assert_eq!(mesh.boundary_names(), ["left", "right", "bottom", "top"]);
        for (name, outer) in [("fluid", "left"), ("plate", "right")] {
            assert_eq!(mesh.part(&[name]).unwrap().mesh.boundary_names(), [outer, "bottom", "top", "wet"]);
        }
        let whole = mesh.part(&["plate", "fluid"]).unwrap();
        assert_eq!((&whole.mesh, whole.cells), (&mesh, vec![0, 1]));
    }
    let extrusion = crate::generate::Extrusion { lower: 0.0, depth: 1.0, layers: 2, periodic: false };
    let space = named_interface("wet").extruded(&extrusion).unwrap();
    let plate = space.part(&["plate"]).unwrap();
    assert_eq!(plate.mesh.boundary_names(), ["right", "bottom", "top", "front", "back", "wet"]);
    assert_eq!((plate.cells, space.regions().len()), (vec![1, 3], 2));
    assert_eq!(plate.mesh.boundary_facets().iter().filter(|facet| facet.boundary == 5).count(), 2);
}

#[test]
fn impossible_regions_are_refused() {
    let mesh = wavy_box([4, 1]);
    let refused = |regions| rebuilt(&mesh, regions).unwrap_err();
    assert_eq!(refused(vec![region("a", &[1]), region("a", &[2])]), MeshError::RegionTwice { name: "a".to_owned() });
    assert_eq!(refused(vec![region("a", &[])]), MeshError::EmptyRegion { name: "a".to_owned() });
    assert!(matches!(refused(vec![region("a", &[4])]), MeshError::NoSuchCell { cell: 4, cells: 4, .. }));
    // A facet with a name between two cells of one region.
    let mut named = named_interface("wet");
    named.interfaces = vec![("wet".to_owned(), vec![Side { cell: 0, face: 1 }])];
    assert!(matches!(rebuilt(&named, vec![]), Err(MeshError::Inside { name, .. }) if name == "wet"));
}

#[test]
fn impossible_parts_are_refused() {
    let mesh = rebuilt(&wavy_box([4, 1]), vec![region("a", &[0]), region("b", &[3])]).unwrap();
    let known = ["a", "b", REST].map(str::to_owned).to_vec();
    assert_eq!(
        mesh.part(&["flap"]).unwrap_err(),
        MeshError::NoRegion { name: "flap".to_owned(), known: known.clone() }
    );
    assert_eq!(mesh.part_without(&["a", "b", REST]).unwrap_err(), MeshError::NothingLeft { names: known });
    let (a, b) = (mesh.part(&["a"]).unwrap(), mesh.part(&["b"]).unwrap());
    assert!(matches!(mesh.interface(&a, &b, 2), Err(MeshError::Apart { first, .. }) if first == ["a"]));
    let overlapping = rebuilt(&wavy_box([4, 1]), vec![region("all", &[0, 1, 2, 3]), region("b", &[3])]).unwrap();
    assert!(matches!(overlapping.part(&["b"]), Err(MeshError::TwoRegions { cell: 3, .. })));
    let error = named_interface("left").part(&["fluid"]).unwrap_err();
    assert_eq!(error, MeshError::InterfaceName { name: "left".to_owned() });
}
