#![allow(clippy::unwrap_used)]
//! Files written here by hand, the same files damaged, and files that Gmsh wrote.

mod contents;
mod damaged;
mod drawing;
mod foreign;
mod lists;
mod remedies;
mod sample;
mod split;
mod su2;
mod written_by_gmsh;

use super::{FilePosition, GmshError};
use crate::{Mesh, MeshError};
use contents::Encoding;
use sample::{Sample, two_cells};

/// One square with corners 1 2 3 4 and sides of two groups, one of them without a name.
const SQUARE_2: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat
$PhysicalNames\n2\n1 7 \"wall of glass\"\n2 1 \"fluid\"\n$EndPhysicalNames
$Nodes\n5\n1 0 0 1\n2 2 0 1\n3 2 1 1\n4 0 1 1\n9 5 5 5\n$EndNodes
$Elements\n6\n1 15 2 0 1 1\n2 1 2 7 1 1 2\n3 1 2 7 2 2 3\n4 1 2 7 3 3 4\n5 1 2 8 4 4 1\n6 3 2 1 1 1 2 3 4\n$EndElements
";

const SQUARE_4: &str = "$MeshFormat\r\n4.1 0 8\r\n$EndMeshFormat\r
$Comments\nanything $Nodes\n$EndComments
$PhysicalNames\n1\n1 7 \"wall of glass\"\n$EndPhysicalNames
$Entities\n1 2 1 0\n1 0 0 0 0\n1 0 0 0 1 1 1 1 7 0\n2 0 0 0 1 1 1 1 8 2 1 -1\n1 0 0 0 1 1 1 0 0\n$EndEntities
$Nodes\n2 5 1 9\n0 1 0 2\n1\n2\n0 0 1\n2 0 1\n2 1 1 3\n3\n4\n9\n2 1 1 0.5 0.5\n0 1 1 0.5 0.5\n5 5 5 0.5 0.5\n$EndNodes
$Elements\n3 5 1 5\n1 1 1 3\n1 1 2\n2 2 3\n3 3 4\n1 2 1 1\n4 4 1\n2 1 3 1\n5 1 2 3 4\n$EndElements
";

fn read(text: &str) -> Result<Mesh<2>, GmshError> {
    Mesh::from_gmsh(text.as_bytes(), &[])
}

/// The error of a text in which `from`, once in it, is replaced.
fn spoiled(text: &str, from: &str, to: &str) -> GmshError {
    assert_eq!(text.matches(from).count(), 1, "{from}");
    read(&text.replace(from, to)).unwrap_err()
}

#[test]
fn a_square_in_both_versions() {
    for text in [SQUARE_2, SQUARE_4] {
        let mesh = read(text).unwrap();
        assert_eq!((mesh.order(), mesh.n_cells(), mesh.volume()), (2, 1, 2.0));
        assert_eq!(mesh.boundary_names(), ["wall of glass", "8"]);
        assert_eq!(
            mesh.boundary_facets().iter().map(|f| (f.boundary, f.side.face)).collect::<Vec<_>>(),
            [(0, 1), (0, 2), (0, 3), (1, 0)]
        );
    }
}

#[test]
fn a_left_handed_cell_is_turned() {
    let mesh = read(&SQUARE_2.replace("1 2 3 4\n$End", "4 3 2 1\n$End")).unwrap();
    assert_eq!(mesh.volume(), 2.0);
    let mesh = Sample { left_handed: true }.version4(Encoding::Text);
    let right = two_cells().version4(Encoding::Text);
    let (left, right) = (Mesh::<2>::from_gmsh(&mesh, &[]).unwrap(), Mesh::<2>::from_gmsh(&right, &[]).unwrap());
    assert!((left.volume() - right.volume()).abs() < 1e-15);
}

#[test]
fn curved_cells_in_every_encoding() {
    let sample = two_cells();
    let expected = Mesh::<2>::from_gmsh(&sample.version4(Encoding::Text), &[]).unwrap();
    assert_eq!((expected.order(), expected.n_cells(), expected.interior_facets().len()), (3, 2, 1));
    assert_eq!(expected.boundary_names(), ["inflow", "wall", "outflow"]);
    // The nodes of degree 2 are equidistant and Gauss-Lobatto nodes at once.
    let x = expected.position(1, &[0.0, 1.0]);
    assert!((0..2).all(|i| (x[i] - sample.position(3, 2)[i]).abs() < 1e-15), "{x:?}");
    assert!((expected.volume() - sample.area()).abs() < 1e-14);
    for encoding in Encoding::ALL {
        assert_eq!(Mesh::from_gmsh(&sample.version2(encoding), &[]).unwrap(), expected, "{encoding:?}");
        assert_eq!(Mesh::from_gmsh(&sample.version4(encoding), &[]).unwrap(), expected, "{encoding:?}");
    }
}

#[test]
fn named_boundaries_are_joined() {
    let file = two_cells().version4(Encoding::Text);
    let pair = |minus: &str, plus: &str| [(minus.to_owned(), plus.to_owned())];
    let mesh = Mesh::<2>::from_gmsh(&file, &pair("outflow", "inflow")).unwrap();
    assert_eq!(mesh.boundary_names(), ["wall"]);
    assert_eq!(mesh.interior_facets().iter().filter(|facet| facet.periodic).count(), 1);
    let error = Mesh::<2>::from_gmsh(&file, &pair("outflow", "exit")).unwrap_err();
    assert!(matches!(&error, GmshError::NoBoundary { name, known } if name == "exit" && known.len() == 3), "{error}");
}

#[test]
fn syntax_errors_name_line_and_expectation() {
    let error = spoiled(SQUARE_2, "3 2 1 1\n", "3 2 one 1\n");
    let expected = GmshError::Syntax {
        place: FilePosition::Line(13),
        expected: "the position of a node".to_owned(),
        found: "\"one\"".to_owned(),
    };
    assert_eq!(error, expected);
    assert_eq!(error.to_string(), "line 13: expected the position of a node, found \"one\"");
    assert!(spoiled(SQUARE_2, "$EndNodes", "$EndNode").to_string().contains("expected $EndNodes, found \"$EndNode\""));
    assert!(spoiled(SQUARE_2, "2.2 0 8", "2.2 0 4").to_string().starts_with("line 2: expected a version"));
    assert!(spoiled(SQUARE_4, "1 7 \"wall of glass\"", "1 7 wall").to_string().contains("line 9"));
    assert!(matches!(read(""), Err(GmshError::Syntax { place: FilePosition::Line(1), .. })));
    let error = spoiled(SQUARE_4, "4.1 0 8", "4 0 8");
    assert_eq!(error, GmshError::Version { place: FilePosition::Line(2), version: "4".to_owned() });
    let half = SQUARE_2.find("$Elements").unwrap();
    assert_eq!(read(&SQUARE_2[..half]).unwrap_err(), GmshError::NoSection { section: "Elements" });
}

#[test]
fn errors_of_a_binary_file_name_the_byte() {
    let mut file = two_cells().version4(Encoding::LittleEndian);
    file.truncate(1500);
    let error = Mesh::<2>::from_gmsh(&file, &[]).unwrap_err();
    assert!(
        matches!(&error, GmshError::Syntax { place: FilePosition::Byte(byte), .. } if (1490..=1500).contains(byte)),
        "{error}"
    );
}

#[test]
fn meshes_that_are_none_are_refused() {
    let error = spoiled(SQUARE_2, "6 3 2 1 1 1 2 3 4", "6 7 2 1 1 1 2 3 4 9");
    assert!(matches!(error, GmshError::Element { place: FilePosition::Line(24), code: 7, .. }), "{error}");
    let error = spoiled(SQUARE_2, "6 3 2 1 1 1 2 3 4", "6 3 2 1 1 1 2 3 17");
    assert_eq!(error, GmshError::NoNode { element: 6, node: 17 });
    let error = spoiled(SQUARE_2, "6 3 2 1 1 1 2 3 4", "6 3 2 1 1 1 2 3 3");
    assert_eq!(error, GmshError::RepeatedNode { element: 6, node: 3 });
    let error = spoiled(SQUARE_2, "4 1 2 7 3 3 4", "4 1 2 7 3 2 4");
    assert_eq!(error, GmshError::Stray { element: 4, name: "wall of glass".to_owned() });
    let error = spoiled(SQUARE_2, "4 0 1 1\n9", "4 0 1 2\n9");
    assert_eq!(error, GmshError::NotPlane { node: 4, z: 2.0, first: 1.0, tilted: false });
    let error = spoiled(SQUARE_2, "5 1 2 8 4 4 1", "5 1 2 0 4 4 1");
    assert!(
        matches!(
            error,
            GmshError::Unnamed { element: 6, named: true, source: MeshError::Unnamed { cell: 0, face: 0, .. }, .. }
        ),
        "{error}"
    );
    let error = Mesh::<3>::from_gmsh(SQUARE_2.as_bytes(), &[]).unwrap_err();
    assert_eq!(error, GmshError::Dimension { dimension: 3, surface: 1, volume: 0 });
}

/// The message was: expected "$MeshFormat", found "$MeshFormat".
#[test]
fn a_byte_order_mark_is_passed_over() {
    assert!(read(SQUARE_2).is_ok() && read(&format!("\u{feff}{SQUARE_2}")).is_ok());
}

/// The second definition used to replace the first one silently.
#[test]
fn what_is_defined_twice_is_refused() {
    let error = spoiled(SQUARE_2, "4 0 1 1\n9 5", "3 0 1 1\n9 5");
    assert_eq!(error, GmshError::Twice { place: FilePosition::Line(14), what: "node", number: 3 });
    let error = spoiled(SQUARE_4, "3\n4\n9\n2 1 1", "3\n3\n9\n2 1 1");
    assert!(matches!(error, GmshError::Twice { place: FilePosition::Line(_), what: "node", number: 3 }), "{error}");
    let error = spoiled(SQUARE_2, "2 1 \"fluid\"", "1 7 \"fluid\"");
    assert_eq!(error, GmshError::Twice { place: FilePosition::Line(7), what: "physical group", number: 7 });
    let error = read(&format!("{SQUARE_2}$Nodes\n0\n$EndNodes\n")).unwrap_err();
    assert!(
        matches!(&error, GmshError::SecondSection { section, place: FilePosition::Line(26) } if section == "Nodes"),
        "{error}"
    );
}

#[test]
fn an_inverted_cell_is_named_by_its_element() {
    // Node 3 is moved across the diagonal, so the cell folds.
    let error = spoiled(SQUARE_2, "3 2 1 1\n", "3 -1 -1 1\n");
    let GmshError::Cell { element: 6, degree: 1, source: MeshError::Inverted { cell: 0, determinant, .. } } = error
    else {
        unreachable!("{error}")
    };
    assert!(determinant < 0.0);
}

#[test]
fn cells_of_different_degree_are_refused() {
    let file = String::from_utf8(two_cells().version2(Encoding::Text)).unwrap();
    let line = file.lines().find(|line| line.split(' ').nth(1) == Some("10")).unwrap();
    let words: Vec<&str> = line.split(' ').collect();
    let straight = format!("{} 3 {}", words[0], words[2..9].join(" "));
    let error = read(&file.replace(line, &straight)).unwrap_err();
    assert!(matches!(error, GmshError::Degree { degree: 2, first: 1, .. }), "{error}");
}

/// Two squares of two regions, and a line between them.
const TWO_REGIONS: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat
$PhysicalNames\n4\n1 7 \"wall\"\n1 8 \"wet\"\n2 1 \"fluid\"\n2 2 \"plate\"\n$EndPhysicalNames
$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n$EndNodes
$Elements\n9\n1 1 2 7 1 1 2\n2 1 2 7 1 2 3\n3 1 2 7 2 3 6\n4 1 2 7 3 5 6\n5 1 2 7 3 4 5\n6 1 2 7 4 1 4\n7 1 2 8 5 2 5
8 3 2 1 1 1 2 5 4\n9 3 2 2 2 2 3 6 5\n$EndElements
";

/// "is listed in boundary wall and in boundary wall".
#[test]
fn a_facet_listed_twice_under_the_same_name_is_there_once() {
    let twice = TWO_REGIONS.replace("$Elements\n9\n", "$Elements\n11\n10 1 2 7 1 2 1\n11 1 2 8 5 5 2\n");
    assert_eq!(read(&twice), read(TWO_REGIONS));
    assert!(read(&twice).is_ok());
}

/// "periodic pair 0 refers to boundary 0", a number that no file has.
#[test]
fn boundaries_that_are_joined_twice_are_named() {
    let file = two_cells().version4(Encoding::Text);
    let pair = |minus: &str, plus: &str| (minus.to_owned(), plus.to_owned());
    let joined_twice = |pairs: &[(String, String)]| match Mesh::<2>::from_gmsh(&file, pairs) {
        Err(GmshError::JoinedTwice { pair, name }) => (pair, name),
        other => unreachable!("{other:?}"),
    };
    assert_eq!(joined_twice(&[pair("wall", "wall")]), (0, "wall".to_owned()));
    let second = [pair("outflow", "inflow"), pair("wall", "inflow")];
    assert_eq!(joined_twice(&second), (1, "inflow".to_owned()));
}

#[test]
fn physical_surfaces_become_regions_and_lines_between_them_interfaces() {
    let mesh = read(TWO_REGIONS).unwrap();
    let regions: Vec<_> = mesh.regions().iter().map(|region| (&region.name[..], &region.cells[..])).collect();
    assert_eq!(regions, [("fluid", &[0][..]), ("plate", &[1])]);
    assert_eq!(mesh.boundary_names(), ["wall"]);
    assert_eq!(mesh.part(&["plate"]).unwrap().mesh.boundary_names(), ["wall", "wet"]);
    // Without a name the line is not there, and the boundary has that of the other region.
    let unnamed = read(&TWO_REGIONS.replace("7 1 2 8 5 2 5", "7 1 2 0 5 2 5")).unwrap();
    assert_eq!(unnamed.part(&["plate"]).unwrap().mesh.boundary_names(), ["wall", "fluid"]);
    // Within one region a line with a name is no boundary.
    let error = spoiled(TWO_REGIONS, "9 3 2 2 2 2 3 6 5", "9 3 2 1 2 2 3 6 5");
    assert!(
        matches!(error, GmshError::Listed { element: 8, source: MeshError::Inside { name, .. }, .. } if name == "wet")
    );
    // A cell without a physical surface.
    let rest = read(&TWO_REGIONS.replace("8 3 2 1 1 1 2 5 4", "8 3 2 0 1 1 2 5 4")).unwrap();
    assert_eq!(rest.part(&["plate"]).unwrap().mesh.boundary_names(), ["wall", "wet"]);
    assert_eq!(rest.part_without(&["plate"]).unwrap(), rest.part(&[crate::REST]).unwrap());
}

/// A node far away that no element uses let the surface of a body pass as a plane mesh.
#[test]
fn nodes_that_no_element_uses_hide_no_slope() {
    let far = SQUARE_2.replace("9 5 5 5", "9 1e9 5 5");
    assert!(read(&far).is_ok());
    let error = spoiled(&far, "4 0 1 1\n9", "4 0 1 1.1\n9");
    assert_eq!(error, GmshError::NotPlane { node: 4, z: 1.1, first: 1.0, tilted: false });
}

/// Elements of a mesh that Gmsh has partitioned belong to parts of entities: it seemed to have no names.
#[test]
fn a_partitioned_mesh_has_its_names() {
    let (before, rest) = SQUARE_4.split_once("$Entities").unwrap();
    let (_, after) = rest.split_once("$EndEntities\n").unwrap();
    let parts = "$Entities\n0 0 0 0\n$EndEntities\n$PartitionedEntities\n2\n1\n5 1\n1 2 1 0\n1 0 3 1 1 0 0 0 0
1 1 4 2 1 2 0 0 0 1 1 1 1 7 0\n2 1 5 1 2 0 0 0 1 1 1 1 8 2 1 -1\n1 2 4 1 1 0 0 0 1 1 1 0 0\n$EndPartitionedEntities\n";
    let mesh = read(&format!("{before}{parts}{after}")).unwrap();
    assert_eq!(mesh.boundary_names(), ["wall of glass", "8"]);
}

/// A cell that was listed twice, from another corner on, was blamed on its sides.
#[test]
fn a_cell_is_the_same_from_every_corner_on() {
    let twice =
        SQUARE_2.replace("$Elements\n6", "$Elements\n7").replace("1 2 3 4\n$End", "1 2 3 4\n7 3 2 5 1 2 3 4 1\n$End");
    let mesh = read(&twice).unwrap();
    assert_eq!((mesh.n_cells(), mesh.regions().len()), (1, 2));
}

#[test]
fn comments_may_stand_before_the_format() {
    assert!(read(&format!("$Comments\nof two\n$EndComments\n$Comments\nlines\n$EndComments\n{SQUARE_2}")).is_ok());
}

/// A cell was named, but not the line of its node.
#[test]
fn a_position_that_is_not_finite_is_told_with_its_line() {
    for number in ["nan", "-inf"] {
        let error = spoiled(SQUARE_2, "2 2 0 1\n", &format!("2 2 {number} 1\n")).to_string();
        assert!(error.starts_with("line 12: expected the position of a node, in finite numbers"), "{error}");
    }
}
