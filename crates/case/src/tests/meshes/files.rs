//! Meshes of files: Gmsh, SU2 and CGNS.

use super::*;

/// A file as Gmsh would write it, with two square cells, left and right of x = 1.
const TWO_CELLS: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat
$PhysicalNames\n4\n1 1 \"left\"\n1 2 \"right\"\n1 3 \"bottom\"\n1 4 \"top\"\n$EndPhysicalNames
$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n$EndNodes
$Elements\n8\n1 1 2 1 1 1 4\n2 1 2 2 1 3 6\n3 1 2 3 1 1 2\n4 1 2 3 1 2 3\n5 1 2 4 1 4 5\n6 1 2 4 1 5 6
7 3 2 9 1 1 2 5 4\n8 3 2 9 1 2 3 6 5\n$EndElements
";

#[test]
fn a_file_has_an_order_that_may_be_raised() {
    let directory = TempDir::new().unwrap();
    std::fs::write(directory.path().join("two.msh"), TWO_CELLS).unwrap();
    let check = |keys: &str| {
        let text = format!("{MOVED}file = \"two.msh\"\n{keys}");
        AnyCase::check(&Document::parse(&directory.path().join("case.toml"), text, &[])?)
    };
    let AnyCase::Plane(case) = check("").unwrap() else { panic!("two dimensions") };
    assert_eq!((case.mesh.order(), case.mesh.n_cells(), case.mesh.volume()), (2, 2, 2.0));
    assert!(case.about.defaults.contains(&("mesh.order".to_owned(), "2, that of the file".to_owned())));
    let AnyCase::Plane(case) = check("order = 5\nperiodic = [[\"left\", \"right\"]]").unwrap() else { panic!() };
    assert_eq!((case.mesh.order(), case.mesh.boundary_names().len()), (5, 2));
    let AnyCase::Space(case) = check("extrude = { depth = 1, layers = 3 }").unwrap() else { panic!("extruded") };
    assert_eq!(case.mesh.n_cells(), 6);
    for (keys, expected) in [
        ("order = 1", ["`mesh.order = 1`", "2 to 16"]),
        ("periodic = [[\"left\", \"rigth\"]]", ["`mesh.periodic", "did you mean `right`"]),
        ("periodic = [[\"left\", \"top\"]]", ["`mesh.periodic[0]", "have 1 and 2 faces"]),
        // These named the file and the numbers of boundaries.
        ("periodic = [[\"left\", \"left\"]]", ["`mesh.periodic[0]", "boundary \"left\" is joined twice"]),
        (
            "periodic = [[\"left\", \"right\"], [\"right\", \"left\"]]",
            ["`mesh.periodic[1]", "boundary \"right\" is joined twice"],
        ),
        ("generate.airfoil = {}", ["given twice", "one of `generate` and `file`"]),
    ] {
        let message = check(keys).unwrap_err().to_string();
        expected.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
    std::fs::write(directory.path().join("two.msh"), TWO_CELLS.replace("5 1 1 0", "5 1 one 0")).unwrap();
    let message = check("").unwrap_err().to_string();
    assert!(
        message.contains("`mesh.file = \"two.msh\"`") && message.contains("two.msh: line 17: expected"),
        "{message}"
    );
}

/// The two squares of [`TWO_CELLS`] as SU2 writes them.
const TWO_CELLS_OF_SU2: &str =
    "NDIME= 2\nNELEM= 2\n9 0 1 4 3\n9 1 2 5 4\nNPOIN= 6\n0 0\n1 0\n2 0\n0 1\n1 1\n2 1\nNMARK= 4
MARKER_TAG= left\nMARKER_ELEMS= 1\n3 0 3\nMARKER_TAG= right\nMARKER_ELEMS= 1\n3 2 5
MARKER_TAG= bottom\nMARKER_ELEMS= 2\n3 0 1\n3 1 2\nMARKER_TAG= top\nMARKER_ELEMS= 2\n3 3 4\n3 4 5\n";

#[test]
fn a_file_of_su2_gives_the_mesh_of_gmsh() {
    let directory = TempDir::new().unwrap();
    let check = |contents: &str, keys: &str| {
        std::fs::write(directory.path().join("two.su2"), contents).unwrap();
        let text = format!("{MOVED}file = \"two.su2\"\n{keys}");
        AnyCase::check(&Document::parse(&directory.path().join("case.toml"), text, &[])?)
    };
    for keys in ["", "order = 4\nperiodic = [[\"left\", \"right\"]]"] {
        let [AnyCase::Plane(su2), AnyCase::Plane(gmsh)] =
            [TWO_CELLS_OF_SU2, TWO_CELLS].map(|contents| check(contents, keys).unwrap())
        else {
            panic!("two dimensions")
        };
        assert!(su2.mesh.n_cells() == 2 && (su2.mesh.volume() - 2.0).abs() < 1e-14);
        // Gmsh's file names a region as well.
        assert_eq!(su2.mesh.coordinates(), gmsh.mesh.coordinates());
        assert_eq!(su2.mesh.boundary_names(), gmsh.mesh.boundary_names());
        assert_eq!(su2.mesh.boundary_facets(), gmsh.mesh.boundary_facets());
        assert_eq!(su2.mesh.interior_facets(), gmsh.mesh.interior_facets());
    }
    let message = check(&TWO_CELLS_OF_SU2.replace("3 0 3", "3 0 x"), "").unwrap_err().to_string();
    assert!(message.contains("two.su2: line 15: expected a node of element 1 of 1 of marker left"), "{message}");
}

/// A file of CGNS is recognised by its ending, or by the first bytes of HDF5. Its contents are tests of the crate `cgns`.
#[test]
fn files_of_cgns_are_told_apart() {
    let directory = TempDir::new().unwrap();
    let check = |name: &str, contents: &[u8]| {
        std::fs::write(directory.path().join(name), contents).unwrap();
        let text = format!("{MOVED}file = \"{name}\"\n");
        let document = Document::parse(&directory.path().join("case.toml"), text, &[]).unwrap();
        AnyCase::check(&document).unwrap_err().to_string()
    };
    assert!(check("two.cgns", b"$MeshFormat").contains("two.cgns: this is no HDF5 file"));
    assert!(check("two.cgns", b"@(#)ADF Database Version").contains("cgnsconvert -h"));
    assert!(check("two.msh", b"\x89HDF\r\n\x1a\n").contains("two.msh: /: the HDF5 library cannot read this part"));
}

#[test]
fn triangles_of_a_file_are_split_on_request() {
    let directory = TempDir::new().unwrap();
    let triangles = "7 2 2 9 1 1 2 5\n9 2 2 9 1 1 5 4\n8 3 2 9 1 2 3 6 5\n";
    let text =
        TWO_CELLS.replace("7 3 2 9 1 1 2 5 4\n8 3 2 9 1 2 3 6 5\n", triangles).replace("$Elements\n8", "$Elements\n9");
    std::fs::write(directory.path().join("three.msh"), text).unwrap();
    let check = |keys: &str| {
        let text = format!("{MOVED}file = \"three.msh\"\n{keys}");
        AnyCase::check(&Document::parse(&directory.path().join("case.toml"), text, &[])?)
    };
    let AnyCase::Plane(case) = check("split_simplices = true").unwrap() else { panic!("two dimensions") };
    // The square beside the triangles is cut along y.
    assert_eq!((case.mesh.order(), case.mesh.n_cells()), (2, 3 + 3 + 2));
    assert!((case.mesh.volume() - 2.0).abs() < 1e-14);
    assert_eq!(case.mesh.boundary_names(), ["left", "right", "bottom", "top"]);
    for keys in ["", "split_simplices = false"] {
        let message = check(keys).unwrap_err().to_string();
        for part in ["`mesh.file", "2 triangles", "Mesh.SubdivisionAlgorithm = 1", "mesh.split_simplices = true"] {
            assert!(message.contains(part), "no {part} in:\n{message}");
        }
    }
}
