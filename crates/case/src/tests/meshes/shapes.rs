//! Meshes around bodies whose shape is given by points or numbers, and the errors of these.

use super::*;

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
        // The thickness was ignored.
        ("naca = \"2412\", thickness = 0.15", "given twice"),
        ("profile = \"none.dat\"", "cannot read"),
    ] {
        let message = case(key).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    }
    std::fs::write(directory.path().join("airfoil.dat"), "1 0\n0 0\n1 0.001\n").unwrap();
    let message = case("profile = \"airfoil.dat\"").unwrap_err().to_string();
    assert!(message.contains("3 points define no airfoil") && message.contains("accepted: points from"), "{message}");
}
