//! Zones that are lattices.

use super::{boundaries, lists, mesh, message};
use crate::tests::writer::{File, Node};
use mesh::{Mesh, Simplices};
use std::f64::consts::TAU;

/// The vertices of a lattice with spacing 1, mapped.
pub(super) fn box_of<const D: usize>(lengths: [usize; D], map: impl Fn([f64; D]) -> [f64; D]) -> Vec<[f64; D]> {
    let vertex = |mut index: usize| {
        lengths.map(|length| {
            let digit = index % length;
            index /= length;
            digit as f64
        })
    };
    (0..lengths.iter().product()).map(|index| map(vertex(index))).collect()
}

/// A zone in two dimensions.
fn plane_zone(base: &Node, name: &str, lengths: [usize; 2], map: impl Fn([f64; 2]) -> [f64; 2]) -> Node {
    let [i, j] = lengths.map(|length| length as i64);
    base.zone(name, "Structured", &[i, j, i - 1, j - 1, 0, 0], &box_of(lengths, map))
}

/// A box of 3 x 2 x 2 cells, sheared without symmetry, whose sides are given by vertices or by faces.
#[test]
fn a_box() {
    let sheared = |[x, y, z]: [f64; 3]| [x + 0.2 * y + 0.1 * z, 2.0 * y + 0.3 * z, z];
    let space: Mesh<3> = mesh(|file| {
        let sizes = [4, 3, 3, 3, 2, 2, 0, 0, 0];
        let zone = file.base(3, 3).zone("Zone", "Structured", &sizes, &box_of([4, 3, 3], sheared));
        let conditions = zone.node("ZoneBC", "ZoneBC_t");
        conditions.condition("left", "PointRange", &[1, 1, 1, 1, 3, 3], None);
        conditions.condition("right", "PointRange", &[4, 1, 1, 4, 2, 2], Some("IFaceCenter"));
        conditions.condition("bottom", "PointRange", &[1, 1, 1, 3, 1, 2], Some("FaceCenter"));
        conditions.condition("top", "PointRange", &[4, 3, 3, 1, 3, 1], Some("Vertex"));
        conditions.condition("front", "PointRange", &[1, 1, 1, 4, 3, 1], None);
        let back = box_of([4, 3], |x| x).into_iter().flat_map(|[i, j]| [i as i64 + 1, j as i64 + 1, 3]);
        conditions.condition("back", "PointList", &back.collect::<Vec<_>>(), None);
    });
    assert_eq!((space.n_cells(), space.order()), (12, 2));
    assert!((space.volume() - 24.0).abs() < 1e-12);
    let expected = [("left", 4), ("right", 4), ("bottom", 6), ("top", 6), ("front", 6), ("back", 6)];
    let mut found = boundaries(&space);
    let mut expected: Vec<(String, usize)> = expected.into_iter().map(|(name, count)| (name.into(), count)).collect();
    found.sort();
    expected.sort();
    assert_eq!(found, expected);
    // Cell 1 along i: its corners are vertices (2, 1, 1) and (3, 2, 2).
    let cell = space.cell_coordinates(1);
    let (low, high) = (sheared([1.0, 0.0, 0.0]), sheared([2.0, 1.0, 1.0]));
    assert!(cell[..3].iter().chain(&cell[21..]).zip(low.iter().chain(&high)).all(|(x, y)| (x - y).abs() < 1e-14));
}

/// Two zones side by side. The axes of the second one are exchanged, so that its cells are left-handed.
pub(super) fn two_zones(file: &File) {
    let base = file.base(2, 2);
    let first = plane_zone(&base, "A", [3, 3], |[i, j]| [0.5 * i, 0.1 * j]);
    let second = plane_zone(&base, "B", [3, 4], |[i, j]| [1.0 + 0.25 * j, 0.1 * i]);
    let conditions = first.node("ZoneBC", "ZoneBC_t");
    conditions.condition("left", "PointRange", &[1, 1, 1, 3], None);
    conditions.condition("wall", "PointRange", &[1, 1, 3, 1], None);
    conditions.condition("upper", "PointRange", &[1, 3, 3, 3], None);
    let conditions = second.node("ZoneBC", "ZoneBC_t");
    conditions.condition("right", "PointRange", &[1, 4, 3, 4], None);
    conditions.condition("wall", "PointRange", &[1, 1, 1, 4], None);
    conditions.condition("upper", "PointRange", &[3, 1, 3, 3], Some("IFaceCenter"));
    // Gmsh writes the interface both as such and as a boundary condition.
    conditions.condition("between", "PointRange", &[1, 1, 3, 1], None);
    let interface =
        second.node("ZoneGridConnectivity", "ZoneGridConnectivity_t").text("AB", "GridConnectivity1to1_t", "A");
    interface.integers("PointRange", "IndexRange_t", &[1, 1, 3, 1]);
}

#[test]
fn two_zones_are_joined() {
    let plane: Mesh<2> = mesh(two_zones);
    assert_eq!((plane.n_cells(), plane.interior_facets().len()), (4 + 6, 4 + 7 + 2));
    assert!((plane.volume() - 0.35).abs() < 1e-14);
    assert_eq!(boundaries(&plane), [("left".into(), 2), ("upper".into(), 5), ("wall".into(), 5), ("right".into(), 2)]);
    assert_eq!(lists(two_zones).unwrap().element_place(1), "/Base/A, cell (2, 1)");
}

/// A ring of one zone, closed at a cut whose two sides have no condition.
#[test]
fn a_ring_is_closed_at_its_cut() {
    let plane: Mesh<2> = mesh(|file| {
        let circle = |[i, j]: [f64; 2]| {
            let (angle, radius) = (TAU * i / 16.0, 1.0 + 0.5 * j);
            [radius * angle.cos(), radius * angle.sin()]
        };
        let zone = plane_zone(&file.base(2, 2), "Zone", [17, 3], circle);
        let conditions = zone.node("ZoneBC", "ZoneBC_t");
        conditions.condition("body", "PointRange", &[1, 1, 17, 1], None);
        conditions.condition("far", "PointRange", &[1, 3, 17, 3], None);
    });
    assert_eq!((plane.n_cells(), plane.interior_facets().len()), (32, 16 + 32));
    let polygon = 16.0 / 2.0 * (TAU / 16.0).sin() * 3.0;
    assert!((plane.volume() - polygon).abs() < 1e-12);
}

/// Two zones above each other; between them a plate from x = 1 to 3, whose sides have conditions.
#[test]
fn the_sides_of_a_plate_stay_apart() {
    let plane: Mesh<2> = mesh(|file| {
        let base = file.base(2, 2);
        for (name, shift, side, outside) in [("A", 0.0, 2, 1), ("B", 1.0, 1, 2)] {
            let zone = plane_zone(&base, name, [5, 2], |[i, j]| [i, j + shift]);
            let conditions = zone.node("ZoneBC", "ZoneBC_t");
            conditions.condition("plate", "PointRange", &[2, side, 4, side], None);
            conditions.condition("far", "PointRange", &[1, outside, 5, outside], None);
            conditions.condition("left", "PointRange", &[1, 1, 1, 2], None);
            conditions.condition("right", "PointRange", &[5, 1, 5, 2], None);
        }
    });
    // Two joined faces between the zones, and three in each of them.
    assert_eq!(plane.interior_facets().len(), 2 + 2 * 3);
    assert!(boundaries(&plane).contains(&("plate".into(), 4)));
}

/// The two ends of a channel are a periodic interface.
#[test]
fn periodic_interfaces_are_boundaries() {
    let lists = lists(|file| {
        let zone = plane_zone(&file.base(2, 2), "Zone", [3, 3], |x| x);
        zone.node("ZoneBC", "ZoneBC_t").condition("bottom", "PointRange", &[1, 1, 3, 1], None);
        zone.node("More", "ZoneBC_t").condition("top", "PointRange", &[1, 3, 3, 3], None);
        let interfaces = zone.node("ZoneGridConnectivity", "ZoneGridConnectivity_t");
        for (name, i) in [("inlet", 1), ("outlet", 3)] {
            let interface = interfaces.text(name, "GridConnectivity1to1_t", "Zone");
            interface.integers("PointRange", "IndexRange_t", &[i, 1, i, 3]);
            interface.node("GridConnectivityProperty", "GridConnectivityProperty_t").node("Periodic", "Periodic_t");
        }
    });
    let pairs = [("inlet".to_owned(), "outlet".to_owned())];
    let plane = Mesh::<2>::from_lists(lists.unwrap(), &pairs, Simplices::Refuse).unwrap();
    assert_eq!((plane.interior_facets().len(), plane.boundary_facets().len()), (4 + 2, 4));
}

#[test]
fn messages_name_the_range() {
    let with = |points: &'static str, values: &'static [i64], location: Option<&'static str>| {
        message::<2>(|file| {
            let zone = plane_zone(&file.base(2, 2), "Zone", [3, 2], |x| x);
            zone.node("ZoneBC", "ZoneBC_t").condition("wall", points, values, location);
        })
    };
    let cases = [
        (with("PointRange", &[1, 1, 4, 1], None), "[[1, 4], [1, 1]] is not inside the zone"),
        (with("PointRange", &[0, 1, 3, 1], None), "is not inside the zone"),
        (with("PointRange", &[1, 1, 3, 2], None), "is no face: one index must be constant"),
        (with("PointRange", &[1, 1, 1, 1], None), "is no face: one index must be constant"),
        (with("PointRange", &[1, 1, 1, 1], Some("EdgeCenter")), "set GridLocation to IFaceCenter"),
        (with("PointRange", &[1, 1, 1, 3, 1, 1], None), "has the wrong number of indices"),
        (with("PointRange", &[1, 1, i64::MAX, 1], Some("EdgeCenter")), "is not inside the zone"),
        (with("PointRange", &[1, 1, 3], None), "it has 3 numbers, expected two per index"),
        (with("PointList", &[1, 1, 3], None), "there is no vertex [3], the zone has [3, 2, 1]"),
        (with("PointList", &[1, 1, 4, 1], None), "there is no vertex [4, 1]"),
        (with("PointList", &[1, 1, 3, 1], None), "there is no outer face between its 2 vertices"),
        (with("PointList", &[1, 1], Some("FaceCenter")), "a PointList of faces in a structured zone"),
        (with("PointRange", &[1, 1, 3, 1], None), "belongs to no boundary"),
    ];
    for (message, expected) in cases {
        assert!(message.starts_with("/Base/Zone") && message.contains(expected), "{expected}: {message}");
    }
}
