//! All mesh generators, and their errors.

use super::*;
use tempfile::TempDir;

/// A case that moves a mesh; its boundaries rest.
const MOVED: &str = "[motion]\nboundary.others = \"fixed\"\n[time]\norder = 1\nend = 1\nslabs = 1\n[mesh]\n";

/// A file as Gmsh would write it, with two square cells, left and right of x = 1.
const TWO_CELLS: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat
$PhysicalNames\n4\n1 1 \"left\"\n1 2 \"right\"\n1 3 \"bottom\"\n1 4 \"top\"\n$EndPhysicalNames
$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n$EndNodes
$Elements\n8\n1 1 2 1 1 1 4\n2 1 2 2 1 3 6\n3 1 2 3 1 1 2\n4 1 2 3 1 2 3\n5 1 2 4 1 4 5\n6 1 2 4 1 5 6
7 3 2 9 1 1 2 5 4\n8 3 2 9 1 2 3 6 5\n$EndElements
";

fn with_mesh(mesh: &str) -> Result<AnyCase, Box<CaseError>> {
    check_text(&format!("{MOVED}{mesh}"), &[])
}

fn plane_mesh(mesh: &str) -> ::mesh::Mesh<2> {
    match with_mesh(mesh) {
        Ok(AnyCase::Plane(case)) => case.mesh,
        other => panic!("{other:?}"),
    }
}

fn mesh_in_space(mesh: &str) -> ::mesh::Mesh<3> {
    match with_mesh(mesh) {
        Ok(AnyCase::Space(case)) => case.mesh,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_defaults_are_those_of_the_generators() {
    use ::mesh::generate::{AirfoilMesh, BladeMesh, RotatingBoxMesh};
    let given = |keys: &str| plane_mesh(&format!("order = 3\n{keys}"));
    assert_eq!(given("generate.rotating_box.cells_per_side = 5"), RotatingBoxMesh::unit(5, 3).build().unwrap());
    assert_eq!(given("generate.airfoil = {}"), AirfoilMesh::naca0012(3).build().unwrap());
    // The symmetric airfoil of four digits is that of its thickness, bit for bit.
    assert_eq!(given("generate.airfoil.naca = \"0012\""), AirfoilMesh::naca0012(3).build().unwrap());
    assert_ne!(given("generate.airfoil.naca = \"0013\""), AirfoilMesh::naca0012(3).build().unwrap());
    assert_eq!(given("generate.turbine_blade = {}"), BladeMesh::low_pressure_turbine(3).unwrap().build().unwrap());
    let defaults = with_mesh("order = 2\ngenerate.airfoil.first_cell = 0.02").unwrap().about().defaults.clone();
    let of = |key: &str| defaults.iter().find(|(k, _)| k == key).map(|(_, value)| value.as_str());
    assert_eq!(of("mesh.generate.airfoil.far_field"), Some("100.0"));
    assert_eq!(of("mesh.generate.airfoil.first_cell"), None);
}

#[test]
fn every_generator_takes_its_parameters() {
    let boundaries = |keys: &str| plane_mesh(&format!("order = 2\n{keys}")).boundary_names().to_vec();
    let channel = "generate.channel = { extent = [4, 1], cells = [8, 4], wall_ratio = 3";
    assert_eq!(boundaries(&format!("{channel} }}")), ["inflow", "outflow", "bottom", "top"]);
    assert_eq!(boundaries(&format!("{channel}, periodic = true }}")), ["bottom", "top"]);
    let annulus = "generate.annulus = { inner_radius = 1, outer_radius = 3, first_cell = 0.2, cells = [8, 3] }";
    assert_eq!(boundaries(annulus), ["wall", "far"]);
    let cylinder = "generate.channel_cylinder = { extent = [2.2, 0.41], centre = [0.2, 0.2], diameter = 0.1, first_cell = 0.02, \
                    cells = [2, 2, 3] }";
    let mut around_cylinder = boundaries(cylinder);
    around_cylinder.sort();
    assert_eq!(around_cylinder, ["bottom", "cylinder", "inflow", "outflow", "top"]);
    assert_eq!(boundaries("generate.disc = { radius = 2, core_cells = 2, radial_cells = 1 }"), ["wall"]);
    let space = mesh_in_space("order = 2\ngenerate.channel = { extent = [4, 1, 2], cells = [4, 2, 2] }");
    assert_eq!((space.n_cells(), space.volume()), (16, 8.0));
    assert!(!space.boundary_names().contains(&"front".to_owned()), "periodic along z");
    assert_eq!(boundaries(&format!("generate.closed_body = {{ points = {DIAMOND}, {AROUND} }}")), ["wall", "far"]);
    let ellipsoid = mesh_in_space(&format!("order = 4\n{ELLIPSOID}"));
    assert_eq!(
        (ellipsoid.n_cells(), ellipsoid.boundary_names()),
        (2 * 11 * 4, &["wall".to_owned(), "far".to_owned()][..])
    );
}

/// Points of a rounded body.
const DIAMOND: &str = "[[1, 0], [0.7, 0.7], [0, 1], [-0.7, 0.7], [-1, 0], [-0.7, -0.7], [0, -1], [0.7, -0.7]]";

/// The other keys of a mesh around it.
const AROUND: &str = "outer_radius = 5, first_cell = 0.1, cells = [16, 6]";

/// The same mesh from a list and from a file, with a name and comments, whatever separates the numbers.
#[test]
fn a_closed_body_may_come_from_a_list_or_a_file() {
    let directory = TempDir::new().unwrap();
    let file = directory.path().join("body.csv");
    let check = || {
        let text = format!("{MOVED}order = 3\ngenerate.closed_body = {{ points = \"body.csv\", {AROUND} }}\n");
        AnyCase::check(&Document::parse(&directory.path().join("case.toml"), text, &[])?)
    };
    let list = plane_mesh(&format!("order = 3\ngenerate.closed_body = {{ points = {DIAMOND}, {AROUND} }}"));
    assert_eq!(list.n_cells(), 16 * 6);
    for separator in [",", "; ", "\t"] {
        let points = ["1 0", "0.7 0.7", "0 1", "-0.7 0.7", "-1 0", "-0.7 -0.7", "0 -1", "0.7 -0.7"];
        let lines: String = points.map(|point| format!("{}\n", point.replace(' ', separator))).concat();
        std::fs::write(&file, format!("# a body\nx{separator}y\n\n{lines}")).unwrap();
        let AnyCase::Plane(case) = check().unwrap_or_else(|error| panic!("{error}")) else { panic!("two dimensions") };
        assert_eq!(case.mesh, list);
    }
    for (text, parts) in [
        ("x,y\n1,0\n0,1,2\n", ["points = \"body.csv\"`", "body.csv:3: `0,1,2` is not a point"]),
        ("1,0\n0,nan\n", ["points = \"body.csv\"`", "body.csv:2: `0,nan` is not a point"]),
        ("x,y\n", ["points = \"body.csv\"`", "the number of points is 0"]),
        ("1,0\n0,1\n".repeat(1001).as_str(), ["points = \"body.csv\"`", "accepted: at most 2000 points"]),
    ] {
        std::fs::write(&file, text).unwrap();
        let message = check().unwrap_err().to_string();
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    }
    std::fs::remove_file(&file).unwrap();
    assert!(check().unwrap_err().to_string().contains("cannot read"));
}

#[test]
fn what_is_wrong_with_a_closed_body_is_named_by_its_key() {
    for (right, wrong, expected) in [
        ("radius = 5", "radius = 0.9", ["closed_body.outer_radius = 0.9`", "a positive number"]),
        ("cell = 0.1", "cell = 0", ["closed_body.first_cell = 0`", "a positive number"]),
        ("cell = 0.1", "cell = 4.9", ["closed_body.first_cell = 4.9`", "less than the radius"]),
        ("[16, 6]", "[2, 6]", ["closed_body.cells[0] = 2`", "at least 3"]),
        ("[16, 6]", "[16, 0]", ["closed_body.cells[1] = 0`", "1 to 100000"]),
        ("[16, 6]", "[100000, 100000]", ["closed_body.cells = [1", "fewer cells"]),
        ("[0.7, 0.7], ", "[1, 0], ", ["closed_body.points", "a positive number"]),
        ("[0.7, 0.7], ", "[0.7], ", ["closed_body.points[1]", "2 entries"]),
        (DIAMOND, "3", ["closed_body.points = 3`", "the name of a file in quotes"]),
        ("[0, 1], ", "[0, -0.9], ", ["`mesh.generate.closed_body", "does not cross itself"]),
    ] {
        let keys = format!("generate.closed_body = {{ points = {DIAMOND}, {AROUND} }}");
        assert!(keys.contains(right));
        let message = with_mesh(&format!("order = 3\n{}", keys.replace(right, wrong))).unwrap_err().to_string();
        assert!(expected.iter().all(|part| message.contains(part)), "{message}");
    }
}

/// A valid mesh of the generator, which errors change in one number.
const ELLIPSOID: &str =
    "generate.ellipsoid = { semi_axes = [1, 0.7, 1.3], outer_radius = 4, first_cell = 0.3, cells = [1, 2, 3, 4] }";

#[test]
fn what_is_wrong_with_an_ellipsoid_is_named_by_its_key() {
    for (right, wrong, expected) in [
        ("0.7,", "0,", ["ellipsoid.semi_axes[1] = 0`", "a positive number"]),
        ("0.7, ", "", ["ellipsoid.semi_axes = [1, 1.3]`", "3 entries"]),
        ("radius = 4", "radius = 1.3", ["ellipsoid.outer_radius = 1.3`", "more than every semi-axis"]),
        ("cell = 0.3", "cell = 0", ["ellipsoid.first_cell = 0`", "a positive number"]),
        ("cell = 0.3", "cell = 3.5", ["ellipsoid.first_cell = 3.5`", "less than the distance"]),
        ("[1, 2, 3, 4]", "[0, 2, 3, 4]", ["ellipsoid.cells[0] = 0`", "1 to 100000"]),
        ("[1, 2, 3, 4]", "[1, 2, 3, 0]", ["ellipsoid.cells[3] = 0`", "1 to 100000"]),
        ("[1, 2, 3, 4]", "[100000, 100000, 3, 100000]", ["ellipsoid.cells = [1", "fewer cells"]),
        ("] }", "] }\nextrude = { depth = 1, layers = 2 }", ["`mesh.extrude", "three dimensions already"]),
    ] {
        let keys = ELLIPSOID.replace(right, wrong);
        assert_ne!(keys, ELLIPSOID);
        let message = with_mesh(&format!("order = 4\n{keys}")).unwrap_err().to_string();
        expected.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}

/// A flap of 0.1 x 1 in a channel of 6 x 4.
const FLAP: &str = "generate.box = { lower = [0, 0], upper = [6, 4], cells = [22, 12], \
                    segments = { x = [{ end = 2.95, cells = 10, size_ratio = 0.1 }, { end = 3.05, cells = 2 }, { end = 6, cells = 10, size_ratio = 10 }] }, \
                    regions = { flap = { lower = [2.95, 0], upper = [3.05, 1] } } }";

#[test]
fn generated_meshes_have_regions() {
    let regions = |mesh: &::mesh::Mesh<2>| -> Vec<_> {
        mesh.regions().iter().map(|region| (region.name.clone(), region.cells.len())).collect()
    };
    let flap = plane_mesh(&format!("order = 2\n{FLAP}"));
    assert_eq!(regions(&flap), [("flap".to_owned(), 6), ("rest".to_owned(), 22 * 12 - 6)]);
    let flag = plane_mesh("order = 3\ngenerate.channel_flag = { cells = { across = 1 } }");
    assert_eq!(regions(&flag), [("fluid".to_owned(), 6 * 30 + 22 * 12 + 14), ("flag".to_owned(), 14)]);
    let box_in_box = "order = 2\ngenerate.box = { lower = [0, 0, 0], upper = [3, 3, 3], cells = [3, 3, 3], \
                      regions.core = { lower = [1, 1, 1], upper = [2, 2, 2] } }\nscramble = 1";
    let core = mesh_in_space(box_in_box).part(&["core"]).unwrap();
    assert_eq!((core.cells, core.mesh.boundary_facets().len()), (vec![13], 6));
}

#[test]
fn any_plane_mesh_can_be_extruded_and_scrambled() {
    let keys = "order = 3\ngenerate.rotating_box.cells_per_side = 5\nextrude = { lower = -1, depth = 0.5, layers = 2";
    let mesh = mesh_in_space(&format!("{keys} }}\nscramble = 4"));
    assert_eq!(mesh.n_cells(), 2 * 24);
    assert!((mesh.volume() - 0.48).abs() < 1e-14);
    assert_eq!(mesh.boundary_names()[2..], ["front", "back"]);
    assert_eq!(mesh_in_space(&format!("{keys}, periodic = true }}")).boundary_names().len(), 2);
}

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

#[test]
fn a_blade_may_come_from_a_file_of_points() {
    let directory = TempDir::new().unwrap();
    let file = directory.path().join("blade.txt");
    // A lens in the direction of the flow.
    let point = |k: usize| std::f64::consts::TAU * k as f64 / 24.0;
    let line = |k: usize| format!("{} {}\n", 0.5 + 0.5 * point(k).cos(), 0.08 * point(k).sin());
    let write = |text: &str| std::fs::write(&file, text).unwrap();
    let check = || {
        let keys = "order = 2\n[mesh.generate.turbine_blade]\nprofile = { file = \"blade.txt\" }\n\
                    inflow_angle = 0\noutflow_angle = 0\n";
        let text = format!("{MOVED}{keys}");
        AnyCase::check(&Document::parse(&directory.path().join("case.toml"), text, &[])?)
    };
    write(&format!("# x y\n\n{}", (0..24).map(line).collect::<String>()));
    let AnyCase::Plane(case) = check().unwrap_or_else(|error| panic!("{error}")) else { panic!("two dimensions") };
    let area = (0.6 + 0.8 + 1.0 + 0.1) * 0.798 - std::f64::consts::PI * 0.04;
    assert!((case.mesh.volume() / area - 1.0).abs() < 0.02, "{} {area}", case.mesh.volume());
    write("0 0\n1 o\n");
    let message = check().unwrap_err().to_string();
    assert!(message.contains("profile.file = \"blade.txt\"`") && message.contains("blade.txt:2: `1 o` is not a point"));
    write("0 0\n1 0\n");
    assert!(check().unwrap_err().to_string().contains("the number of points is 2"));
    std::fs::remove_file(&file).unwrap();
    assert!(check().unwrap_err().to_string().contains("cannot read"));
}

/// Keys below `[mesh]` after the order, and parts of the message.
const BAD: &[(&str, &[&str])] = &[
    ("", &["`mesh`", "there is no mesh", "`file`"]),
    ("periodic = [[\"a\", \"b\"]]\ngenerate.airfoil = {}", &["`mesh.periodic", "joined by name"]),
    (
        "split_simplices = true\ngenerate.disc = { radius = 2, core_cells = 2, radial_cells = 1 }",
        &["`mesh.split_simplices", "only cells of a file"],
    ),
    ("file = \"none.msh\"", &["`mesh.file = \"none.msh\"`", "cannot read dir/none.msh"]),
    ("generate.airfoli = {}", &["unknown choice `airfoli`", "did you mean `airfoil`"]),
    ("generate.rotating_box = { cells_per_side = 5, sides = 1 }", &["rotating_box.sides = 1`", "did you mean `side`"]),
    ("generate.rotating_box = { cells_per_side = 7 }", &["rotating_box.cells_per_side = 7`", "multiples of 5"]),
    ("generate.rotating_box = { cells_per_side = 5, side = -1 }", &["rotating_box.side = -1`", "a positive number"]),
    ("generate.rotating_box = { cells_per_side = 5, hole = 2 }", &["rotating_box.hole = 2`", "less than the side"]),
    ("generate.rotating_box = { cells_per_side = 100000 }", &["cells_per_side = 100000`", "fewer cells"]),
    ("generate.channel = { extent = [1], cells = [2] }", &["channel.extent = [1]`", "two or three"]),
    ("generate.channel = { extent = [1, 0], cells = [2, 2] }", &["channel.extent[1] = 0`", "a positive number"]),
    ("generate.channel = { extent = [1, 1], cells = [0, 2] }", &["channel.cells[0] = 0`", "1 or more"]),
    ("generate.channel = { extent = [1, 1], cells = [2] }", &["channel.cells = [2]`", "2 entries"]),
    (
        "generate.channel = { extent = [1, 1], cells = [2, 2], wall_ratio = 0 }",
        &["channel.wall_ratio = 0`", "a positive number"],
    ),
    (
        "generate.annulus = { inner_radius = 0, outer_radius = 3, first_cell = 0.2, cells = [8, 3] }",
        &["annulus.inner_radius = 0`", "a positive number"],
    ),
    (
        "generate.annulus = { inner_radius = 1, outer_radius = 1, first_cell = 0.2, cells = [8, 3] }",
        &["annulus.outer_radius = 1`", "a positive number"],
    ),
    (
        "generate.annulus = { inner_radius = 1, outer_radius = 3, first_cell = 9, cells = [8, 3] }",
        &["annulus.first_cell = 9`", "less than the width"],
    ),
    (
        "generate.annulus = { inner_radius = 1, outer_radius = 3, first_cell = 0.2, cells = [2, 3] }",
        &["annulus.cells[0] = 2`", "at least 3"],
    ),
    (
        "generate.annulus = { inner_radius = 1, outer_radius = 3, first_cell = 0.2, cells = [8, 0] }",
        &["annulus.cells[1] = 0`", "1 to 100000"],
    ),
    ("generate.disc = { radius = 0, core_cells = 2, radial_cells = 1 }", &["disc.radius = 0`", "a positive number"]),
    ("generate.disc = { core_cells = 0, radial_cells = 1 }", &["disc.core_cells = 0`", "1 to 100000"]),
    ("generate.disc = { core_cells = 2, radial_cells = 0 }", &["disc.radial_cells = 0`", "1 to 100000"]),
    ("generate.airfoil.thickness = 0", &["airfoil.thickness = 0`", "more than 0"]),
    ("generate.airfoil.far_field = 1", &["airfoil.far_field = 1`", "at least 2 chords"]),
    ("generate.airfoil.first_cell = 1", &["airfoil.first_cell = 1`", "1e-8 to 0.2"]),
    ("generate.airfoil.trailing_edge_cell = 0.5", &["airfoil.trailing_edge_cell = 0.5`", "smooth distribution"]),
    ("generate.airfoil.surface_cells = 1", &["airfoil.surface_cells = 1`", "2 or more"]),
    ("generate.airfoil.wake_cells = 0", &["airfoil.wake_cells = 0`", "1 to 100000"]),
    ("generate.airfoil.near_wake = { extent = 60, cells = 4 }", &["airfoil.near_wake.extent = 60`", "at most half"]),
    ("generate.airfoil.near_wake = { extent = 2, cells = 10 }", &["airfoil.near_wake.cells = 10`", "fewer than"]),
    ("generate.airfoil.near_wall = { extent = 0, cells = 4 }", &["airfoil.near_wall.extent = 0`", "more than 0"]),
    ("generate.airfoil.near_wall = { extent = 1, cells = 0 }", &["airfoil.near_wall.cells = 0`", "1 or more"]),
    ("generate.airfoil.normal_cells = 0", &["airfoil.normal_cells = 0`", "1 to 100000"]),
    ("generate.turbine_blade.pitch = 0", &["turbine_blade.pitch = 0`", "a positive number"]),
    ("generate.turbine_blade.inflow_angle = 90", &["turbine_blade.inflow_angle = 90`", "between -87 and 87"]),
    ("generate.turbine_blade.outflow_angle = -90", &["turbine_blade.outflow_angle = -90`", "between -87 and 87"]),
    ("generate.turbine_blade.inflow_distance = 0", &["turbine_blade.inflow_distance = 0`", "a positive number"]),
    ("generate.turbine_blade.outflow_distance = 0", &["turbine_blade.outflow_distance = 0`", "a positive number"]),
    ("generate.turbine_blade.layer = 0", &["turbine_blade.layer = 0`", "a positive number"]),
    ("generate.turbine_blade.first_cell = 1", &["turbine_blade.first_cell = 1`", "less than the layer"]),
    ("generate.turbine_blade.cells.side = 0", &["turbine_blade.cells.side = 0`", "1 to 100000"]),
    ("generate.turbine_blade.cells.end = 0", &["turbine_blade.cells.end = 0`", "1 to 100000"]),
    ("generate.turbine_blade.cells.normal = 0", &["turbine_blade.cells.normal = 0`", "1 to 100000"]),
    ("generate.turbine_blade.cells.gap = 0", &["turbine_blade.cells.gap = 0`", "1 to 100000"]),
    ("generate.turbine_blade.cells.before = 0", &["turbine_blade.cells.before = 0`", "1 to 100000"]),
    ("generate.turbine_blade.cells.after = 0", &["turbine_blade.cells.after = 0`", "1 to 100000"]),
    (
        "generate.turbine_blade.profile = \"t107\"",
        &["turbine_blade.profile", "unknown choice", "`low_pressure_turbine`"],
    ),
    (
        "generate.disc = { core_cells = 2, radial_cells = 1 }\nextrude = { depth = 0, layers = 2 }",
        &["`mesh.extrude.depth = 0`", "a positive number"],
    ),
    (
        "generate.disc = { core_cells = 2, radial_cells = 1 }\nextrude = { depth = 1, layers = 0 }",
        &["`mesh.extrude.layers = 0`", "1 to 100000"],
    ),
    (
        "generate.disc = { core_cells = 2, radial_cells = 1 }\nextrude = { depth = 1, layers = 2, lower = nan }",
        &["`mesh.extrude.lower = nan`", "number"],
    ),
    (
        "generate.box = { lower = [0, 0, 0], upper = [1, 1, 1], cells = [1, 1, 1] }\nextrude = { depth = 1, layers = 2 }",
        &["`mesh.extrude", "three dimensions already"],
    ),
    ("generate.channel_flag.flag_end = 0.3", &["channel_flag.flag_end = 0.3`", "more than twice x of the centre"]),
    ("generate.channel_flag.cells.along = 0", &["channel_flag.cells.along = 0`", "1 to 100000"]),
    ("generate.channel_flag.thickness = 0.2", &["channel_flag.thickness = 0.2`", "less than the diameter"]),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], regions.a = { lower = [0, 0], upper = [0.4, 1] } }",
        &["regions.a.upper[0] = 0.4`", "not between cells", "is at 0.5"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], regions.a = { lower = [0, 0], upper = [0, 1] } }",
        &["box.regions.a", "has no cells"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], regions.rest = { lower = [0, 0], upper = [0.5, 1] } }",
        &["box.regions.rest", "another name"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], regions.a = { lower = [0], upper = [0.5, 1] } }",
        &["regions.a.lower = [0]`", "2 entries"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], segments.x = [{ end = 1, cells = 3 }] }",
        &["segments.x[0]", "expected 1 after 2 cells"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], segments.z = [{ end = 1, cells = 2 }] }",
        &["segments.z", "no such axis"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], size_ratio = [2, 1], segments.x = [{ end = 1, cells = 2 }] }",
        &["segments.x", "no effect"],
    ),
];

#[test]
fn what_is_wrong_with_a_mesh_is_named_by_its_key() {
    for (keys, expected) in BAD {
        let message = with_mesh(&format!("order = 2\n{keys}")).unwrap_err().to_string();
        let line = message.split(':').nth(1).unwrap();
        assert!(line.parse::<usize>().is_ok_and(|line| line >= 7), "no line of [mesh]: {message}");
        expected.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
    let message = with_mesh("generate.airfoil = {}").unwrap_err().to_string();
    assert!(message.contains("the order of the mesh is missing"), "{message}");
}

/// Airfoils by their four digits and by points of a file, end to end.
#[test]
fn airfoils_with_camber_are_meshes() {
    let directory = tempfile::tempdir().unwrap();
    let case = |key: &str| {
        let text = format!(
            "mesh = {{ order = 3, generate.airfoil = {{ {key}, far_field = 10 }} }}\nflow = {{ order = 2, initial.uniform = {{ \
             velocity = [1, 0], mach = 0.2 }}, boundary = {{ airfoil = \"slip_wall\", far = {{ far_field = {{ velocity = [1, 0], mach = \
             0.2 }} }} }} }}\ntime = {{ order = 1, end = 1, slabs = 1 }}\n"
        );
        AnyCase::check(&Document::parse(&directory.path().join("case.toml"), text, &[])?)
    };
    let wall = |case: Result<AnyCase, Box<CaseError>>| -> Vec<[f64; 2]> {
        let Ok(AnyCase::Plane(case)) = case else { panic!("{case:?}") };
        let wall = case.mesh.boundary_names().iter().position(|name| name == "airfoil").unwrap();
        let facets = case.mesh.boundary_facets().iter().filter(|facet| facet.boundary == wall);
        let nodes = facets.flat_map(|facet| {
            let x = case.mesh.cell_coordinates(facet.side.cell);
            ::mesh::face_nodes(2, 3, facet.side.face).into_iter().map(|k| [x[2 * k], x[2 * k + 1]]).collect::<Vec<_>>()
        });
        nodes.collect()
    };
    // The largest ordinate of the NACA 4412 is 0.098, the smallest -0.0288 (Abbott & von Doenhoff).
    let naca = wall(case("naca = \"4412\""));
    let [lowest, highest] = [f64::min, f64::max].map(|pick| naca.iter().map(|x| x[1]).reduce(pick).unwrap());
    assert!((highest - 0.098).abs() < 1e-3 && (lowest + 0.0288).abs() < 5e-4, "{lowest} {highest}");
    // Its own points, as a file.
    let mut above: Vec<[f64; 2]> = naca.clone();
    above.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let nose = above[0];
    let middle = |x: f64| if x < 0.4 { 0.25 * x * (0.8 - x) } else { (0.2 + 0.8 * x - x * x) / 9.0 };
    let (mut upper, mut lower): (Vec<_>, Vec<_>) = above[1..].iter().copied().partition(|x| x[1] > middle(x[0]));
    upper.push([1.0, 0.0]);
    upper.reverse();
    upper.push(nose);
    upper.append(&mut lower);
    let text: String = upper.iter().map(|[x, y]| format!("  {x:.9}  {y:.9}\n")).collect();
    std::fs::write(directory.path().join("airfoil.dat"), format!("NACA 4412\n{text}")).unwrap();
    let points = wall(case("profile = \"airfoil.dat\""));
    let apart =
        |x: &[f64; 2]| naca.iter().map(|other| (other[0] - x[0]).hypot(other[1] - x[1])).fold(f64::INFINITY, f64::min);
    assert!(points.iter().map(apart).fold(0.0, f64::max) < 0.01);
    for (key, part) in [
        ("naca = \"2012\"", "four digits such as \"2412\""),
        ("naca = \"2412\", profile = \"airfoil.dat\"", "given twice"),
        ("profile = \"none.dat\"", "cannot read"),
    ] {
        let message = case(key).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    }
    std::fs::write(directory.path().join("airfoil.dat"), "1 0\n0 0\n1 0.001\n").unwrap();
    let message = case("profile = \"airfoil.dat\"").unwrap_err().to_string();
    assert!(message.contains("3 points define no airfoil") && message.contains("accepted: points from"), "{message}");
}

/// Formulas of the position move the nodes of a box.
#[test]
fn a_map_bends_a_box_to_half_a_ring() {
    let half_ring = |map: &str| {
        format!(
            "order = 7\ngenerate.box = {{ lower = [1, 0], upper = [2, 3.141592653589793], cells = [2, 8], map = {map} }}"
        )
    };
    let mesh = plane_mesh(&half_ring("[\"x*cos(y)\", \"x*sin(y)\"]"));
    assert!((mesh.volume() - 1.5 * std::f64::consts::PI).abs() < 1e-8);
    for (map, parts) in [
        ("[\"x*cos(y)\", \"-x*sin(y)\"]", ["mesh.generate.box.map", "det J"]),
        ("[\"x*cos(y)\"]", ["mesh.generate.box.map", "2"]),
        ("[\"x*cos(y)\", \"x*t\"]", ["mesh.generate.box.map[1]", "`t`"]),
        ("[\"x*cos(y)\", \"1/(x - 1)\"]", ["coordinate", "finite"]),
    ] {
        let message = with_mesh(&half_ring(map)).unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}
