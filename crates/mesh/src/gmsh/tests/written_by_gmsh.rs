//! Files written by scripts/make_gmsh_meshes.py, in the directory that STSOLVE_GMSH_MESHES names.

use crate::{Mesh, NodeNumbering, Simplices};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

/// SHAPE_DIMENSION_pDEGREE_vVERSION_ENCODING.msh
struct Name {
    shape: String,
    dimension: usize,
    degree: usize,
}

fn parse(path: &Path) -> Name {
    let stem = path.file_stem().unwrap().to_str().unwrap();
    let parts: Vec<&str> = stem.split('_').collect();
    let (dimension, degree) = (parts[1].parse().unwrap(), parts[2][1..].parse().unwrap());
    Name { shape: parts[0].to_owned(), dimension, degree }
}

/// The files by shape, dimension and degree: four of each. `None`, with a message, if there is no directory.
#[allow(clippy::print_stderr)]
fn files() -> Option<BTreeMap<(String, usize, usize), Vec<PathBuf>>> {
    let Some(directory) = std::env::var_os("STSOLVE_GMSH_MESHES") else {
        eprintln!("skipped: STSOLVE_GMSH_MESHES is not set; see scripts/make_gmsh_meshes.py");
        return None;
    };
    let mut files: BTreeMap<_, Vec<PathBuf>> = BTreeMap::new();
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "msh") {
            let Name { shape, dimension, degree } = parse(&path);
            files.entry((shape, dimension, degree)).or_default().push(path);
        }
    }
    assert!(!files.is_empty());
    Some(files)
}

/// One mesh from four files: both versions, text and binary.
fn common_mesh<const D: usize>(shape: &str, paths: &[PathBuf], periodic: &[(String, String)]) -> Mesh<D> {
    assert_eq!(paths.len(), 4, "{paths:?}");
    let version = |path: &Path| path.to_string_lossy().contains("_v4");
    let read = |path: &PathBuf| {
        let mesh = Mesh::from_gmsh_with(&std::fs::read(path).unwrap(), periodic, Simplices::Split);
        mesh.unwrap_or_else(|error| unreachable!("{}: {error}", path.display()))
    };
    let first = read(&paths[0]);
    for path in &paths[1..] {
        let mesh = read(path);
        let (a, b) = (mesh.volume(), first.volume());
        assert!((a / b - 1.0).abs() < 1e-14, "{}: volume {a}, {b}", path.display());
        assert_eq!((mesh.n_cells(), mesh.boundary_names()), (first.n_cells(), first.boundary_names()));
        // The versions list elements of different types in different orders.
        if shape == "mixed" && version(path) != version(&paths[0]) {
            continue;
        }
        assert!(mesh.interior_facets() == first.interior_facets(), "{}", path.display());
        assert!(mesh.boundary_facets() == first.boundary_facets(), "{}", path.display());
        // Text has 16 digits; interpolation from equidistant nodes of degree 10 multiplies errors by up to 30^D.
        let close = |(x, y): (&f64, &f64)| (x - y).abs() < 1e-12;
        assert!(mesh.coordinates().iter().zip(first.coordinates()).all(close), "{}", path.display());
    }
    first
}

fn check<const D: usize>(shape: &str, degree: usize, paths: &[PathBuf]) -> f64 {
    let joined = [("right".to_owned(), "left".to_owned())];
    let mesh = common_mesh::<D>(shape, paths, if shape == "periodic" { &joined } else { &[] });
    assert_eq!(mesh.order(), degree + 1);
    let mut names: Vec<&str> = mesh.boundary_names().iter().map(String::as_str).collect();
    names.sort_unstable();
    let (expected, volume): (&[&str], f64) = match (shape, D) {
        ("quarter" | "turned", 2) => (&["inner", "left", "outer", "right"], 0.75 * PI),
        ("quarter", _) => (&["back", "front", "inner", "left", "outer", "right"], 0.75 * PI),
        ("disc" | "triangles", 2) => (&["wall"], PI),
        ("disc" | "prisms" | "tetrahedra", _) => (&["ends", "wall"], PI),
        _ => (&["walls"], 1.0),
    };
    assert_eq!(names, expected);
    // The middles of cut edges lie on the polynomials of the file, not on the circle.
    let near = if ["triangles", "prisms", "tetrahedra"].contains(&shape) { accuracy(degree.min(4)) } else { 1e-10 };
    assert_boundaries_are_round(shape, &mesh, near);
    if shape == "periodic" {
        // 3 p nodes along x, 2 p + 1 along y, p + 1 along z.
        let nodes = 3 * degree * (2 * degree + 1) * if D == 3 { degree + 1 } else { 1 };
        assert_eq!(NodeNumbering::new(&mesh, degree + 1).count, nodes);
    }
    (mesh.volume() / volume - 1.0).abs()
}

/// How near a polynomial of degree `degree` is to a circle.
fn accuracy(degree: usize) -> f64 {
    0.1_f64.powi(degree.min(6) as i32)
}

/// The corners of cells on curved boundaries lie on their circles.
fn assert_boundaries_are_round<const D: usize>(shape: &str, mesh: &Mesh<D>, near: f64) {
    for facet in mesh.boundary_facets() {
        let radius = match (shape, mesh.boundary_names()[facet.boundary].as_str()) {
            ("quarter" | "turned", "inner") | ("disc" | "triangles" | "prisms" | "tetrahedra", "wall") => 1.0,
            ("quarter" | "turned", "outer") => 2.0,
            _ => continue,
        };
        for x in mesh.face_corner_positions(facet.side) {
            assert!((x[0].hypot(x[1]) - radius).abs() < near, "{shape} {x:?}");
        }
    }
}

#[test]
fn every_shape_degree_version_and_encoding() {
    let Some(files) = files() else { return };
    for ((shape, dimension, degree), paths) in files {
        let error = match dimension {
            2 => check::<2>(&shape, degree, &paths),
            _ => check::<3>(&shape, degree, &paths),
        };
        // A wrong order of nodes would make cells invalid; nodes off the circle would stop the convergence. Gmsh itself
        // is accurate to about 1e-6 on extruded surfaces.
        assert!(error < accuracy(degree), "{shape} {dimension} degree {degree}: {error:e}");
    }
}
