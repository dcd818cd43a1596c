//! SU2 files: the same mesh as from Gmsh, or an error that names the line.

use crate::random::SplitMix64;
use crate::{Mesh, Simplices, is_su2};

const SQUARES: &str = "% two squares
NDIME= 2
NELEM= 2 % quadrilaterals
9 0 1 4 3 0
9 1 2 5 4 1

NPOIN= 6 6
0 0 0
1 0 1
2 0 2
0 1 3
1 1 4
2 1 5
NMARK= 2
MARKER_TAG= wall
MARKER_ELEMS= 4
3 0 1
3 1 2
3 5 4
3 4 3
MARKER_TAG= ends
MARKER_ELEMS= 2
3 3 0
3 2 5 1
";

/// The same squares as Gmsh writes them.
const SQUARES_OF_GMSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat
$PhysicalNames\n2\n1 1 \"wall\"\n1 2 \"ends\"\n$EndPhysicalNames
$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n$EndNodes
$Elements\n8\n1 1 2 1 1 1 2\n2 1 2 1 1 2 3\n3 1 2 1 1 6 5\n4 1 2 1 1 5 4\n5 1 2 2 1 4 1\n6 1 2 2 1 3 6
7 3 2 0 1 1 2 5 4\n8 3 2 0 1 2 3 6 5\n$EndElements
";

const CUBES: &str =
    "NDIME=3\nNPOIN=12\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n0 0 2\n1 0 2\n1 1 2\n0 1 2
NELEM=2\n12 0 1 2 3 4 5 6 7\n12 4 5 6 7 8 9 10 11
NMARK=2\nMARKER_TAG=low\nMARKER_ELEMS=1\n9 0 1 2 3\nMARKER_TAG=rest\nMARKER_ELEMS=9
9 8 9 10 11\n9 0 1 5 4\n9 1 2 6 5\n9 2 3 7 6\n9 3 0 4 7\n9 4 5 9 8\n9 5 6 10 9\n9 6 7 11 10\n9 7 4 8 11
";

const CUBES_OF_GMSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat
$PhysicalNames\n2\n2 1 \"low\"\n2 2 \"rest\"\n$EndPhysicalNames
$Nodes\n12\n0 0 0 0\n1 1 0 0\n2 1 1 0\n3 0 1 0\n4 0 0 1\n5 1 0 1\n6 1 1 1\n7 0 1 1\n8 0 0 2\n9 1 0 2\n10 1 1 2\n11 0 1 2\n$EndNodes
$Elements\n12\n1 3 2 1 1 0 1 2 3\n2 3 2 2 1 8 9 10 11\n3 3 2 2 1 0 1 5 4\n4 3 2 2 1 1 2 6 5\n5 3 2 2 1 2 3 7 6
6 3 2 2 1 3 0 4 7\n7 3 2 2 1 4 5 9 8\n8 3 2 2 1 5 6 10 9\n9 3 2 2 1 6 7 11 10\n10 3 2 2 1 7 4 8 11
11 5 2 0 1 0 1 2 3 4 5 6 7\n12 5 2 0 1 4 5 6 7 8 9 10 11\n$EndElements
";

fn read<const D: usize>(text: &str) -> Result<Mesh<D>, String> {
    Mesh::from_su2(text.as_bytes(), &[], Simplices::Refuse).map_err(|error| error.to_string())
}

/// The message for the squares in which `from`, once in the text, is replaced.
fn spoiled(from: &str, to: &str) -> String {
    assert_eq!(SQUARES.matches(from).count(), 1, "{from}");
    read::<2>(&SQUARES.replace(from, to)).unwrap_err()
}

#[test]
fn the_mesh_is_that_of_gmsh() {
    assert!(is_su2(SQUARES.as_bytes()) && is_su2(CUBES.as_bytes()));
    let plane = read::<2>(SQUARES).unwrap();
    assert_eq!(plane, Mesh::from_gmsh(SQUARES_OF_GMSH.as_bytes(), &[]).unwrap());
    assert_eq!((plane.order(), plane.n_cells(), plane.volume()), (2, 2, 2.0));
    assert_eq!(plane.boundary_names(), ["wall", "ends"]);
    let space = read::<3>(CUBES).unwrap();
    assert_eq!(space, Mesh::from_gmsh(CUBES_OF_GMSH.as_bytes(), &[]).unwrap());
    assert_eq!((space.n_cells(), space.boundary_names()), (2, &["low".to_owned(), "rest".to_owned()][..]));
}

#[test]
fn left_handed_cells_are_turned_and_lists_come_in_any_order() {
    let turned = read::<2>(&SQUARES.replace("9 0 1 4 3 0", "9 0 3 4 1")).unwrap();
    assert_eq!((turned.n_cells(), turned.volume()), (2, 2.0));
    let (head, markers) = SQUARES.split_once("NMARK").unwrap();
    let (cells, points) = head.split_once("NPOIN").unwrap();
    let (dimension, cells) = cells.split_once("NELEM").unwrap();
    let shuffled =
        format!("{dimension}\nNZONE= 1\nAOA= 1.5\nNMARK{markers}NPOIN{points}NELEM{cells}\r\nFFD_NBOX= 1\nany");
    assert_eq!(read::<2>(&shuffled).unwrap(), read::<2>(SQUARES).unwrap());
}

#[test]
fn keys_may_be_in_small_letters() {
    let keys = ["NDIME", "NELEM", "NPOIN", "NMARK", "MARKER_TAG", "MARKER_ELEMS"];
    let change =
        |change: fn(&str) -> String| keys.iter().fold(SQUARES.to_owned(), |text, key| text.replace(key, &change(key)));
    let mixed = change(|key| key[..1].to_owned() + &key[1..].to_ascii_lowercase());
    for text in [change(str::to_ascii_lowercase), mixed] {
        assert!(!text.contains("NDIME") && is_su2(text.as_bytes()), "{text}");
        let ending = format!("{text}ffd_nbox= 1\nany");
        assert_eq!(read::<2>(&ending).unwrap(), read::<2>(SQUARES).unwrap());
    }
}

#[test]
fn triangles_are_refused_or_split() {
    let text = SQUARES.replace("NELEM= 2", "NELEM= 3").replace("9 0 1 4 3 0", "5 0 1 4\n5 0 4 3");
    let message = read::<2>(&text).unwrap_err();
    assert!(message.starts_with("line 4: this is the first of 2 triangles") && message.contains("split_simplices"));
    // The square beside the triangles is cut along y.
    let split = Mesh::<2>::from_su2(text.as_bytes(), &[], Simplices::Split).unwrap();
    assert_eq!(split.n_cells(), 3 + 3 + 2);
    assert!((split.volume() - 2.0).abs() < 1e-14);
}

#[test]
fn a_byte_order_mark_is_passed_over() {
    let text = format!("\u{feff}{}", SQUARES.replace("% two squares\n", ""));
    assert!(is_su2(text.as_bytes()) && read::<2>(&text).is_ok());
}

#[test]
fn messages_name_line_and_remedy() {
    let without_marker = spoiled("MARKER_ELEMS= 2\n3 3 0\n3 2 5 1", "MARKER_ELEMS= 1\n3 3 0");
    assert!(without_marker.starts_with("line 5: ") && without_marker.contains("MARKER_TAG"), "{without_marker}");
    let cases = [
        ("NMARK= 2", "NMARK= 3", "line 24: expected 3 markers"),
        ("NELEM= 2", "NELEM= 1", "line 5: expected a key"),
        ("NELEM= 2", "NELEM= 3", "line 7: expected element 3 of 3, found `NPOIN= 6 6`"),
        ("NELEM= 2", "NELEM= 0", "line 3: expected the number of elements, 1 or more"),
        ("NELEM= 2", "NELEM= -2", "line 3: expected the number of elements"),
        ("NPOIN= 6 6", "NPOIN= 7", "line 14: expected point 7 of 7"),
        ("NPOIN= 6 6", "NPOIN= 5", "line 13: expected a key"),
        ("NDIME= 2", "NDIME= 4", "line 2: expected the dimension, 2 or 3, found `4`"),
        ("NDIME= 2\n", "", "line 2: expected NDIME="),
        ("NDIME= 2\n", "NDIME= 2\nNDIME= 2\n", "line 3: expected one line NDIME="),
        ("9 0 1 4 3 0", "9 0 1 4 17", "line 4: point 17 is not among"),
        ("9 0 1 4 3 0", "9 0 1 4 4 0", "line 4: point 4 stands here twice"),
        ("9 0 1 4 3 0", "9 0 1 4", "line 4: expected a node of element 1 of 2, found `the end of the line`"),
        ("9 0 1 4 3 0", "9 0 1 4 3 0 7", "line 4: expected the end of the line, found `7`"),
        ("9 0 1 4 3 0", "14 0 1 4 3 0", "line 4: expected the VTK type 9"),
        ("3 3 0", "3 0 4", "line 23: the element of marker \"ends\" is not a face of any cell"),
        ("MARKER_ELEMS= 4", "9", "line 16: expected MARKER_ELEMS="),
        ("1 0 1\n", "1 x 1\n", "line 9: expected a coordinate of point 2 of 6, a finite number, found `x`"),
        ("1 0 1\n", "1 inf 1\n", "line 9: expected a coordinate of point 2 of 6, a finite number, found `inf`"),
        ("3 2 5 1\n", "3 2 5 1\nrubbish\n", "line 25: expected a key"),
        ("NMARK= 2", "NZONE= 2", "line 14: expected NZONE= 1"),
        ("NMARK= 2", "NMARKS= 2", "line 14: expected one of the keys"),
    ];
    for (from, to, expected) in cases {
        let message = spoiled(from, to);
        assert!(message.starts_with(expected), "{from} -> {to}: {message}");
    }
}

/// A defect that was: the message named a number at the end of the line, and no remedy.
#[test]
fn a_curved_file_of_gmsh_is_told_to_be_straight() {
    let message = spoiled("9 0 1 4 3 0", "9 0 1 4 3 6 7 8 9 10 0");
    assert!(
        message.starts_with("line 4: expected the end of the line, found `7`: elements of SU2 are straight"),
        "{message}"
    );
    assert!(message.contains("here with 4 nodes") && message.contains("`Mesh.ElementOrder = 1`"), "{message}");
}

/// A defect that was: these messages had no remedy.
#[test]
fn faces_that_are_listed_twice_or_inside_have_a_remedy() {
    let twice = spoiled("MARKER_ELEMS= 2\n3 3 0", "MARKER_ELEMS= 3\n3 0 1\n3 3 0");
    assert!(twice.contains("\"wall\" and in boundary \"ends\": list the face below one MARKER_TAG, once"), "{twice}");
    let inside = spoiled("MARKER_ELEMS= 2\n3 3 0", "MARKER_ELEMS= 3\n3 1 4\n3 3 0");
    assert!(inside.contains("but has a neighbour: take the face out of the marker"), "{inside}");
    assert!(twice.starts_with("line 4: ") && inside.starts_with("line 4: "), "{twice} {inside}");
}

#[test]
fn damage_never_panics() {
    let mut random = SplitMix64::new(22);
    let (mut refused, tried) = (0, 4000);
    for _ in 0..tried {
        let mut bytes = if random.below(2) == 0 { SQUARES } else { CUBES }.as_bytes().to_vec();
        for _ in 0..=random.below(3) {
            let place = random.below(bytes.len());
            bytes[place] = [b' ', b'9', b'-', b'=', b'\n', random.below(256) as u8][random.below(6)];
        }
        bytes.truncate(bytes.len() - random.below(3));
        let plane = Mesh::<2>::from_su2(&bytes, &[], Simplices::Split).is_ok();
        refused += usize::from(!plane && Mesh::<3>::from_su2(&bytes, &[], Simplices::Split).is_err());
    }
    assert!(refused > tried / 2 && refused < tried, "{refused} of {tried} refused");
}
