//! Messages say what to do.

use super::{SQUARE_2, SQUARE_4, TWO_REGIONS, read, spoiled};
use crate::{Mesh, Simplices};

/// Two sides of a box, all of it that Gmsh saves without a physical volume: as quadrilaterals or as triangles.
fn sides_of_a_box(elements: &str) -> String {
    let count = elements.lines().count();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"wall\"\n$EndPhysicalNames\n\
         $Nodes\n6\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 1 0 1\n6 1 1 1\n$EndNodes\n\
         $Elements\n{count}\n{elements}$EndElements\n"
    )
}

/// Defects that were: quadrilaterals were said to need constant z, and triangles to need splitting.
#[test]
fn a_box_without_a_physical_volume_is_told_to_lack_one() {
    let whole = sides_of_a_box("1 3 2 1 1 1 2 3 4\n2 3 2 1 2 2 5 6 3\n");
    let cut = sides_of_a_box("1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n3 2 2 1 2 2 5 6\n4 2 2 1 2 2 6 3\n");
    for text in [whole, cut] {
        for simplices in [Simplices::Refuse, Simplices::Split] {
            let error = Mesh::<2>::from_gmsh_with(text.as_bytes(), &[], simplices).unwrap_err().to_string();
            for part in ["node 5 lies at z = 1", "no volumes", "`Physical Volume(\"fluid\") = Volume{:};`", "`gmsh -3`"]
            {
                assert!(error.contains(part), "no {part} in: {error}");
            }
            assert!(!error.contains("split_simplices"), "{error}");
        }
    }
}

/// A side of a box, and a plane mesh that was rotated.
#[test]
fn a_plane_mesh_in_another_plane_is_told_to_rotate() {
    let text = SQUARE_2.replace("3 2 1 1\n4 0 1 1\n", "3 2 1 3\n4 0 1 3\n");
    let error = read(&text).unwrap_err().to_string();
    for part in ["node 3 lies at z = 3, others at 1", "all nodes lie in another plane", "`Rotate`", "Physical Volume"] {
        assert!(error.contains(part), "no {part} in: {error}");
    }
}

/// A defect that was: one named side of a box at constant z was said to need names of its curves only.
#[test]
fn one_surface_of_a_geometry_with_volumes_is_told_to_lack_them() {
    let of_plane = SQUARE_4.replace("1 1 1 1 7 0", "1 1 1 0 0").replace("1 1 1 1 8 2", "1 1 1 0 2");
    let message = |text: &str| read(text).unwrap_err().to_string();
    let in_space = of_plane
        .replace("1 2 1 0\n1 0 0 0 0", "1 2 1 1\n1 0 0 0 0")
        .replace("1 0 0 0 1 1 1 0 0\n$EndEntities", "1 0 0 0 1 1 1 0 0\n1 0 0 0 1 1 1 0 0\n$EndEntities");
    assert!(message(&in_space).contains("`Physical Volume(\"fluid\") = Volume{:};`"), "{}", message(&in_space));
    assert!(message(&of_plane).contains("no physical curve"), "{}", message(&of_plane));
    assert!(!message(&of_plane).contains("Volume"), "{}", message(&of_plane));
}

/// A defect that was: these messages had no remedy, and named no element.
#[test]
fn faces_that_are_listed_twice_or_inside_have_a_remedy() {
    let twice = spoiled(SQUARE_2, "5 1 2 8 4 4 1", "5 1 2 8 4 3 4").to_string();
    assert!(twice.starts_with("element 6: face 3 of cell 0 is listed in boundary"), "{twice}");
    assert!(twice.ends_with("leave it in one `Physical Curve`, so that it has one name"), "{twice}");
    let inside = spoiled(TWO_REGIONS, "9 3 2 2 2 2 3 6 5", "9 3 2 1 2 2 3 6 5").to_string();
    assert!(
        inside.contains("but has a neighbour: take the curve inside of the mesh out of `Physical Curve`"),
        "{inside}"
    );
    assert!(inside.ends_with("different groups `Physical Surface`"), "{inside}");
}
