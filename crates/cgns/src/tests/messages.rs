//! Messages name the node and the remedy.

use super::plane::SQUARES;
use super::writer::{File, Node};
use super::{lists, message};
use crate::kind::Kind;
use crate::{CgnsError, is_cgns, read};

/// A zone of two squares, to which a test adds what is wrong.
fn squares(file: &File) -> Node {
    file.base(2, 2).unstructured("Zone", 2, &SQUARES)
}

const CELLS: [i64; 8] = [1, 2, 5, 4, 2, 3, 6, 5];

/// The message for a section of the two squares.
fn of_section(code: i64, first: i64, count: i64, nodes: &[i64]) -> String {
    message::<2>(|file| {
        squares(file).section("cells", code, first, count, nodes);
    })
}

#[test]
fn sections() {
    let cases = [
        (
            of_section(7, 1, 2, &[1, 2, 5, 4, 2, 3, 7, 5]),
            "/cells, element 2: there is no vertex 7, they count from 1 to 6",
        ),
        (of_section(7, 1, 2, &[0, 2, 5, 4, 2, 3, 6, 5]), "/cells, element 1: there is no vertex 0"),
        (of_section(7, 1, 2, &[i64::MIN, 2, 5, 4, 2, 3, 6, 5]), "/cells, element 1: there is no vertex -"),
        (of_section(7, 1, 3, &CELLS), "/cells: its ElementConnectivity ends in element 3"),
        (of_section(7, 1, 1, &CELLS), "/cells: its ElementConnectivity has 4 numbers more"),
        (of_section(7, 1, 0, &CELLS), "/cells: its ElementRange is 1 to 0, which is empty"),
        (of_section(7, -4, 2, &CELLS), "/cells: its ElementRange is -4 to -3"),
        (of_section(7, 1, i64::MAX, &CELLS), "/cells: its ElementConnectivity ends in element 3"),
        (of_section(20, 1, 2, &[7, 1, 2, 5, 4]), "/cells: its ElementConnectivity ends in element 2"),
        (of_section(20, 1, 1, &[99, 1, 2, 5, 4]), "/cells: elements of type 99 are not supported"),
        (of_section(8, 1, 1, &CELLS), "/cells: elements of the kind QUAD_8, without all inner nodes, are not"),
        (of_section(42, 1, 1, &CELLS), "/cells: elements of the kind TRI_15, whose inner nodes are not evenly spaced"),
        (of_section(22, 1, 2, &CELLS), "/cells: elements of the kinds NGON_n and NFACE_n"),
        (of_section(12, 1, 2, &CELLS), "/cells: pyramids are not supported"),
        (of_section(17, 1, 1, &CELLS), "/cells: elements HEXA_8 are volumes"),
        (of_section(3, 1, 4, &CELLS), ": it has no cells of dimension 2: save sections of quadrilaterals"),
        (of_section(7, 1, 2, &[1, 2, 4, 5, 2, 3, 6, 5]), "/cells, element 1: "),
        (of_section(7, 1, 2, &CELLS), "/cells, element 1: face 2 of cell 0 at [0.5, 0.0] has no neighbour"),
    ];
    for (message, expected) in cases {
        assert!(message.starts_with(&format!("/Base/Zone{expected}")), "{expected}: {message}");
    }
    assert!(of_section(7, 1, 2, &CELLS).contains("must belong to a boundary condition"));
}

/// The message for a boundary condition of the two squares.
fn of_condition(write: impl FnOnce(&Node)) -> String {
    message::<2>(|file| {
        let zone = squares(file);
        zone.section("cells", 7, 1, 2, &CELLS);
        zone.section("faces", 3, 3, 1, &[1, 2]);
        write(&zone.node("ZoneBC", "ZoneBC_t"));
    })
}

#[test]
fn conditions() {
    let with = |points: &'static str, values: &'static [i64], location: &'static str| {
        of_condition(move |conditions| drop(conditions.condition("wall", points, values, Some(location))))
    };
    let cases = [
        (with("PointList", &[4], "EdgeCenter"), ": no section of the zone has an element 4"),
        (with("PointRange", &[3, i64::MAX], "EdgeCenter"), ": no section of the zone has an element 4"),
        (with("PointRange", &[i64::MIN, 3], "CellCenter"), ": no section of the zone has an element -922"),
        (with("PointList", &[7], "Vertex"), ": there is no vertex 7"),
        (with("PointRange", &[1, i64::MAX], "Vertex"), ": there is no vertex 9223372036854775807"),
        (with("PointList", &[1, 6], "Vertex"), ": there is no outer face between its 2 vertices"),
        (with("PointList", &[1], "Nowhere"), ": its GridLocation is Nowhere"),
        (of_condition(|list| drop(list.node("wall", "BC_t"))), ": it has neither PointList nor PointRange"),
    ];
    for (message, expected) in cases {
        assert!(message.starts_with(&format!("/Base/Zone/ZoneBC/wall{expected}")), "{expected}: {message}");
    }
}

#[test]
fn bases_zones_and_coordinates() {
    let cases = [
        (message::<2>(|_| ()), "/: there is no CGNSBase_t"),
        (message::<2>(|file| drop(file.base(2, 2))), "/Base: there is no zone"),
        (message::<2>(|file| drop(file.base(1, 2))), "/Base: cells have dimension 1 and space 2"),
        (message::<2>(|file| drop(file.base(3, 2))), "/Base: cells have dimension 3 and space 2"),
        (
            message::<2>(|file| drop(file.base(2, 2).integers("Zone", "Zone_t", &[4]))),
            "/Base/Zone: its ZoneType is nothing",
        ),
        (
            message::<2>(|file| drop(file.base(2, 2).zone("Zone", "Magic", &[4], &SQUARES))),
            "/Base/Zone: its ZoneType is Magic",
        ),
        (
            message::<2>(|file| drop(file.base(2, 2).zone("Zone", "Structured", &[4], &SQUARES))),
            "/Base/Zone: it has 1 sizes",
        ),
        (
            message::<2>(|file| drop(file.base(2, 2).zone("Zone", "Unstructured", &[7, 2, 0], &SQUARES))),
            "/Base/Zone/GridCoordinates/CoordinateX: it has 6 values, the zone has 7 vertices",
        ),
        (
            message::<2>(|file| drop(file.base(2, 2).zone("Zone", "Unstructured", &[-7, 2, 0], &SQUARES))),
            "/Base/Zone: it has the size -7",
        ),
        (
            message::<2>(|file| {
                drop(file.base(2, 2).zone("Zone", "Structured", &[i64::MAX, i64::MAX, 0, 0, 0, 0], &SQUARES))
            }),
            "/Base/Zone: its size",
        ),
        (
            message::<2>(|file| drop(file.base(2, 2).zone("Zone", "Structured", &[6, 1, 5, 0, 0, 0], &SQUARES))),
            "/Base/Zone: it has 1 vertices along an axis",
        ),
        (
            message::<3>(|file| drop(file.base(3, 3).unstructured("Zone", 2, &SQUARES))),
            "/Base/Zone/GridCoordinates: it has no CoordinateZ, but CoordinateX, CoordinateY",
        ),
        (
            message::<2>(|file| drop(file.base(2, 2).unstructured("Zone", 2, &[[0.0, f64::NAN]; 6]))),
            "/Base/Zone/GridCoordinates/CoordinateY: the value of vertex 1 is NaN",
        ),
    ];
    for (message, expected) in cases {
        assert!(message.starts_with(expected), "{expected}: {message}");
    }
    let not_plane = message::<2>(|file| {
        let zone = file.base(2, 3).unstructured("Zone", 2, &SQUARES.map(|[x, y]| [x, y, x]));
        zone.section("cells", 7, 1, 2, &CELLS);
    });
    assert!(not_plane.starts_with("/Base/Zone, vertex 2: z = 1, other nodes have 0"), "{not_plane}");
}

#[test]
fn links_and_other_interfaces() {
    let link = message::<2>(|file| drop(squares(file).with_type("cells", "Elements_t", "LK")));
    assert!(link.starts_with("/Base/Zone/cells: this is a link") && link.contains("cgnsconvert"), "{link}");
    let overset = message::<2>(|file| {
        let interfaces = squares(file).node("ZoneGridConnectivity", "ZoneGridConnectivity_t");
        interfaces.text("gap", "GridConnectivity_t", "B").text("Type", "GridConnectivityType_t", "Overset");
    });
    assert!(overset.starts_with("/Base/Zone/ZoneGridConnectivity/gap: this interface is Overset"), "{overset}");
}

#[test]
fn other_formats() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mesh.cgns");
    assert!(matches!(read(&path), Err(CgnsError::Read(_))));
    for (bytes, expected) in
        [(&b"@(#)ADF Database Version B02012>"[..], CgnsError::Adf), (b"$MeshFormat", CgnsError::NotHdf5)]
    {
        std::fs::write(&path, bytes).unwrap();
        assert_eq!(read(&path).unwrap_err(), expected);
    }
    drop(lists(|_| ()));
    File::create(&path).base(2, 2);
    assert!(is_cgns(&std::fs::read(&path).unwrap()));
    assert!(!is_cgns(b"\x89HDF\r\n\x1a\n"));
}

/// Elements with the highest numbers that there are.
#[test]
fn high_numbers() {
    let lists = lists(|file| {
        let zone = squares(file);
        zone.section("a", 7, i64::MAX, 1, &CELLS[..4]);
        zone.section("b", 7, 1, 1, &CELLS[4..]);
        zone.section("sides", 3, 3, 6, &[1, 2, 2, 3, 6, 5, 5, 4, 4, 1, 3, 6]);
    });
    assert_eq!(lists.unwrap().element_place(0), "/Base/Zone/a, element 9223372036854775807");
}

/// What other programs add to a file.
#[test]
fn nodes_without_a_label_are_ignored() {
    let lists = lists(|file| {
        let zone = squares(file);
        zone.section("cells", 7, 1, 2, &CELLS);
        zone.section("sides", 3, 3, 6, &[1, 2, 2, 3, 6, 5, 5, 4, 4, 1, 3, 6]);
        zone.foreign("notes");
    });
    assert_eq!(lists.unwrap().elements.len(), 8);
}

#[test]
fn complete_kinds() {
    let complete = |code: &i64| Kind::from_code(*code).is_ok_and(|kind| kind.check_cell().is_ok());
    let codes: Vec<i64> = (0..60).filter(complete).collect();
    assert_eq!(codes, [2, 3, 4, 5, 6, 7, 9, 10, 11, 14, 16, 17, 19, 24, 26, 28, 30, 36, 39, 40, 44, 56]);
}
