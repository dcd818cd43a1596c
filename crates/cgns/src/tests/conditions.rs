//! Boundary conditions in every form.

use super::plane::SQUARES;
use super::{boundaries, mesh};
use crate::tests::writer::{File, Node};
use mesh::Mesh;

/// Two squares with faces 3 to 8 as one section: wall 3, 4, 5, 6, left 7, right 8.
fn squares(file: &File) -> (Node, Node) {
    let zone = file.base(2, 2).unstructured("Zone", 2, &SQUARES);
    zone.section("cells", 7, 1, 2, &[1, 2, 5, 4, 2, 3, 6, 5]);
    zone.section("faces", 3, 3, 6, &[1, 2, 2, 3, 6, 5, 5, 4, 4, 1, 3, 6]);
    let conditions = zone.node("ZoneBC", "ZoneBC_t");
    (zone, conditions)
}

/// The boundaries with conditions whose numbers are those of faces.
fn of_faces(range: &str, list: &str, location: Option<&str>) -> Vec<(String, usize)> {
    boundaries::<2>(&mesh(|file| {
        let (_, conditions) = squares(file);
        conditions.condition("wall", range, &[3, 6], location);
        conditions.condition("ends", list, &[8, 7], location);
    }))
}

#[test]
fn numbers_of_faces() {
    let expected = [("ends".into(), 2), ("wall".into(), 4)];
    assert_eq!(of_faces("PointRange", "PointList", Some("EdgeCenter")), expected);
    assert_eq!(of_faces("PointRange", "PointList", Some("FaceCenter")), expected);
    assert_eq!(of_faces("ElementRange", "ElementList", None), expected);
}

#[test]
fn numbers_of_vertices() {
    let plane: Mesh<2> = mesh(|file| {
        let (_, conditions) = squares(file);
        conditions.condition("bottom", "PointRange", &[1, 3], None);
        conditions.condition("top", "PointList", &[6, 5, 4], Some("Vertex"));
        conditions.condition("left", "PointList", &[1, 4], None);
        conditions.condition("right", "PointList", &[3, 6], None);
    });
    let expected = [("bottom".into(), 2), ("left".into(), 1), ("right".into(), 1), ("top".into(), 2)];
    assert_eq!(boundaries(&plane), expected);
}

#[test]
fn families_name_boundaries_and_regions() {
    let plane: Mesh<2> = mesh(|file| {
        let (zone, conditions) = squares(file);
        zone.text("FamilyName", "FamilyName_t", "gas");
        for (name, range, family) in [("BC1", [3, 4], "wall"), ("BC2", [5, 6], "wall"), ("BC3", [7, 8], "")] {
            let condition = conditions.condition(name, "PointRange", &range, Some("EdgeCenter"));
            condition.text("FamilyName", "FamilyName_t", family);
        }
    });
    assert_eq!(boundaries(&plane), [("wall".into(), 4), ("BC3".into(), 2)]);
    assert_eq!((plane.regions().len(), plane.regions()[0].name.as_str()), (1, "gas"));
}

/// As Gmsh writes them: numbers of elements at CellCenter, groups as families of families, cells as a condition too, and
/// interfaces that repeat the conditions.
#[test]
fn conditions_of_gmsh() {
    let plane: Mesh<2> = mesh(|file| {
        let base = file.base(2, 2);
        let zone = base.unstructured("Zone", 2, &SQUARES);
        zone.section("S_1", 7, 7, 2, &[1, 2, 5, 4, 2, 3, 6, 5]);
        zone.section("L_1", 3, 1, 6, &[1, 2, 2, 3, 6, 5, 5, 4, 4, 1, 3, 6]);
        let conditions = zone.node("ZoneBC", "ZoneBC_t");
        for (name, range, group) in [("L_1", [1, 6], "wall"), ("S_1", [7, 8], "gas")] {
            let condition = conditions.condition(name, "PointRange", &range, Some("CellCenter"));
            condition.text("FamilyName", "FamilyName_t", name);
            base.node(name, "Family_t").text(group, "FamilyName_t", group);
        }
        let interfaces = zone.node("ZoneGridConnectivity", "ZoneGridConnectivity_t");
        for (name, vertices) in [("side", vec![1, 4]), ("corner", vec![1])] {
            let interface = interfaces.text(name, "GridConnectivity_t", "Zone");
            interface.text("GridConnectivityType", "GridConnectivityType_t", "Abutting1to1");
            interface.integers("PointList", "IndexArray_t", &vertices);
            interface.node("GridConnectivityProperty", "GridConnectivityProperty_t").node("Periodic", "Periodic_t");
        }
    });
    assert_eq!(boundaries(&plane), [("wall".into(), 6)]);
    assert_eq!(
        (plane.regions().len(), plane.regions()[0].cells.len(), plane.regions()[0].name.as_str()),
        (1, 2, "gas")
    );
}

/// Two zones of a cube each, which share a face; a third face is named in both.
#[test]
fn two_zones_of_hexahedra() {
    let space: Mesh<3> = mesh(|file| {
        let base = file.base(3, 3);
        for (name, shift) in [("A", 0.0), ("B", 1.0)] {
            let cube = crate::tests::structured::box_of([2, 2, 2], |[x, y, z]| [x + shift, y, z]);
            let zone = base.unstructured(name, 1, &cube);
            zone.text("FamilyName", "FamilyName_t", name);
            zone.section("cell", 17, 1, 1, &[1, 2, 4, 3, 5, 6, 8, 7]);
            let end = if shift == 0.0 { [1, 3, 7, 5] } else { [2, 4, 8, 6] };
            zone.section("end", 7, 2, 1, &end);
            zone.section("side", 7, 3, 4, &[1, 2, 4, 3, 5, 6, 8, 7, 1, 2, 6, 5, 3, 4, 8, 7]);
        }
    });
    assert_eq!((space.n_cells(), space.interior_facets().len()), (2, 1));
    assert!((space.volume() - 2.0).abs() < 1e-14);
    assert_eq!(boundaries(&space), [("end".into(), 2), ("side".into(), 8)]);
    assert_eq!(space.regions().len(), 2);
}
