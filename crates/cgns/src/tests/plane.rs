//! Quadrilaterals and triangles in one zone.

use super::{boundaries, lists, mesh, message};
use crate::tests::writer::File;
use mesh::{Mesh, Simplices};

/// The vertices of two squares side by side, row by row.
pub(super) const SQUARES: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0]];

/// Two squares whose boundaries are sections.
fn squares(file: &File) {
    let zone = file.base(2, 2).unstructured("Zone", 2, &SQUARES);
    zone.section("cells", 7, 1, 2, &[1, 2, 5, 4, 2, 3, 6, 5]);
    zone.section("wall", 3, 3, 4, &[1, 2, 2, 3, 6, 5, 5, 4]);
    zone.section("ends", 3, 7, 2, &[4, 1, 3, 6]);
}

#[test]
fn two_squares() {
    let plane: Mesh<2> = mesh(squares);
    assert_eq!((plane.order(), plane.n_cells()), (2, 2));
    assert!((plane.volume() - 2.0).abs() < 1e-14);
    assert_eq!(boundaries(&plane), [("wall".into(), 4), ("ends".into(), 2)]);
    let lists = lists(squares).unwrap();
    assert_eq!(lists.dimension(), 2);
    assert_eq!(lists.element_place(1), "/Base/Zone/cells, element 2");
    assert_eq!(lists.element_place(2), "/Base/Zone/wall, element 3");
    assert_eq!(lists.node_place(5), "/Base/Zone, vertex 6");
}

/// One square of nine nodes, x = s + t/10, y = t + s t/5 + 0.1 s^2, on the reference square.
#[test]
fn a_curved_square_of_nine_nodes() {
    let node = |[s, t]: [f64; 2]| [s + t / 10.0, t + s * t / 5.0 + 0.1 * s * s];
    let places =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5], [0.5, 0.5]];
    let plane: Mesh<2> = mesh(|file| {
        let zone = file.base(2, 2).unstructured("Zone", 1, &places.map(node));
        zone.section("cell", 9, 1, 1, &[1, 2, 3, 4, 5, 6, 7, 8, 9]);
        zone.section("side", 4, 2, 4, &[1, 2, 5, 2, 3, 6, 3, 4, 7, 4, 1, 8]);
    });
    // det = 1 (1 + s/5) - 1/10 (t/5 + s/5), integrated over the square.
    assert!((plane.volume() - (1.1 - 0.02)).abs() < 1e-14, "{}", plane.volume());
    assert_eq!(plane.order(), 3);
    // Gauss-Lobatto nodes of order 3 are equidistant.
    let expected: Vec<f64> = (0..9).flat_map(|k| node([(k % 3) as f64 / 2.0, (k / 3) as f64 / 2.0])).collect();
    assert!(plane.cell_coordinates(0).iter().zip(&expected).all(|(x, y)| (x - y).abs() < 1e-14));
}

/// A square of triangles beside one of a quadrilateral, in a mixed section with the boundaries.
#[test]
fn mixed_sections_are_split_on_request() {
    let write = |file: &File| {
        let zone = file.base(2, 3).unstructured("Zone", 3, &SQUARES);
        let nodes = [5, 1, 2, 5, 5, 1, 5, 4, 3, 1, 2, 7, 2, 3, 6, 5, 3, 2, 3, 3, 6, 5, 3, 5, 4, 3, 4, 1, 3, 3, 6];
        zone.section("all", 20, 1, 9, &nodes);
    };
    let lists = lists(write).unwrap();
    assert_eq!(lists.element_place(2), "/Base/Zone/all, element 4");
    let split = Mesh::<2>::from_lists(lists, &[], Simplices::Split).unwrap();
    assert_eq!(split.n_cells(), 3 + 3 + 2);
    assert!((split.volume() - 2.0).abs() < 1e-14);
    assert_eq!(boundaries(&split), [("all".into(), 10)]);
    let refused = message::<2>(write);
    assert!(refused.starts_with("/Base/Zone/all, element 1: this is the first of 2 triangles"), "{refused}");
    assert!(refused.contains("split_simplices"));
}

/// Integers of 4 bytes, reals of 4 bytes.
#[test]
fn short_numbers() {
    let plane: Mesh<2> = mesh(|file| {
        let zone = file.base(2, 2).array("Zone", "Zone_t", "I4", &[4_i32, 1, 0]);
        zone.text("ZoneType", "ZoneType_t", "Unstructured");
        let grid = zone.node("GridCoordinates", "GridCoordinates_t");
        grid.array("CoordinateX", "DataArray_t", "R4", &[0.0_f32, 1.0, 1.0, 0.0]);
        grid.array("CoordinateY", "DataArray_t", "R4", &[0.0_f32, 0.0, 1.0, 1.0]);
        let section = zone.array("cell", "Elements_t", "I4", &[7_i32, 0]);
        section.array("ElementRange", "IndexRange_t", "I4", &[1_i32, 1]);
        section.array("ElementConnectivity", "DataArray_t", "I4", &[1_i32, 2, 3, 4]);
        zone.section("sides", 3, 2, 4, &[1, 2, 2, 3, 3, 4, 4, 1]);
    });
    assert_eq!((plane.n_cells(), plane.volume()), (1, 1.0));
}

/// x is joined to x + 2.
#[test]
fn periodic_boundaries() {
    let lists = lists(|file| {
        let zone = file.base(2, 2).unstructured("Zone", 2, &SQUARES);
        zone.section("cells", 7, 1, 2, &[1, 2, 5, 4, 2, 3, 6, 5]);
        zone.section("wall", 3, 3, 4, &[1, 2, 2, 3, 6, 5, 5, 4]);
        zone.section("left", 3, 7, 1, &[4, 1]);
        zone.section("right", 3, 8, 1, &[3, 6]);
    });
    let pairs = [("left".to_owned(), "right".to_owned())];
    let plane = Mesh::<2>::from_lists(lists.unwrap(), &pairs, Simplices::Refuse).unwrap();
    assert_eq!(plane.interior_facets().len(), 2);
    assert_eq!(plane.boundary_facets().len(), 4);
}

/// The two squares with boundary conditions.
pub(super) fn squares_with_conditions(file: &File) {
    let zone = file.base(2, 2).unstructured("Zone", 2, &SQUARES);
    zone.section("cells", 7, 1, 2, &[1, 2, 5, 4, 2, 3, 6, 5]);
    zone.section("faces", 3, 3, 4, &[1, 2, 2, 3, 6, 5, 5, 4]);
    let conditions = zone.node("ZoneBC", "ZoneBC_t");
    conditions.condition("wall", "PointRange", &[3, 6], Some("EdgeCenter"));
    conditions.condition("left", "PointList", &[1, 4], Some("Vertex"));
    conditions.condition("right", "PointList", &[3, 6], None).text("FamilyName", "FamilyName_t", "exit");
}
