//! Files that are no Gmsh file, and files without names, are told apart with a remedy.

use super::{SQUARE_2, read, spoiled};
use crate::Mesh;

fn message(bytes: &[u8]) -> String {
    Mesh::<2>::from_gmsh(bytes, &[]).unwrap_err().to_string()
}

#[test]
fn formats_of_others_are_named() {
    let su2 = b"% two triangles\nNZONE= 1\n  NDIME = 2\nNELEM= 2\n5 0 1 2 0\n";
    let known: [(&[u8], &str); 6] = [
        (b"\x89HDF\r\n\x1a\n\0\0\0", "CGNS"),
        (b"@(#)ADF Database Version B02012>", "CGNS"),
        (su2, "SU2"),
        (b"NDIME=3", "SU2"),
        // As Gmsh writes them.
        (b" MeshVersionFormatted 2\n Dimension\n 3\n", "Medit"),
        (b"*Heading\n box.inp\n*NODE\n", "Abaqus"),
    ];
    for (bytes, name) in known {
        assert!(message(bytes).contains(name) && message(bytes).contains("MSH 4.1"), "{}", message(bytes));
    }
    // A Gmsh file may say so in a comment.
    let commented = SQUARE_2.replace("$Nodes\n", "$Comments\nNDIME= 2\n$EndComments\n$Nodes\n");
    assert!(read(&commented).is_ok());
    assert!(message(b"solid cube").starts_with("line 1: expected $MeshFormat"));
}

#[test]
fn boundaries_without_a_name_are_told_with_the_remedy() {
    // Every line without a group, then one of four.
    let lines = ["2 7 1 1 2", "2 7 2 2 3", "2 7 3 3 4", "2 8 4 4 1"];
    let without =
        lines.iter().fold(SQUARE_2.to_owned(), |text, line| text.replace(line, &format!("2 0{}", &line[3..])));
    let error = read(&without).unwrap_err().to_string();
    assert!(error.contains("no physical curve") && error.contains("Physical Surface("), "{error}");
    let error = spoiled(SQUARE_2, "5 1 2 8 4 4 1", "5 1 2 0 4 4 1").to_string();
    assert!(error.contains("element 6") && error.contains("Physical Curve(") && error.contains("Coherence"), "{error}");
}

/// Gmsh saves only elements of physical groups if there are any.
#[test]
fn a_file_without_cells_names_the_missing_group() {
    let error = spoiled(SQUARE_2, "6 3 2 1 1 1 2 3 4", "6 1 2 7 1 3 1").to_string();
    assert!(error.contains("Physical Surface("), "{error}");
}
