//! Files written by scripts/make_gmsh_meshes.py, in the directory that STSOLVE_GMSH_MESHES names: the mesh of a CGNS file is
//! that of the Gmsh file.

use super::boundaries;
use mesh::{Mesh, Simplices};
use std::path::{Path, PathBuf};

/// The CGNS files. `None`, with a message, if there is no directory.
#[allow(clippy::print_stderr)]
fn files() -> Option<Vec<PathBuf>> {
    let Some(directory) = std::env::var_os("STSOLVE_GMSH_MESHES") else {
        eprintln!("skipped: STSOLVE_GMSH_MESHES is not set; see scripts/make_gmsh_meshes.py");
        return None;
    };
    let paths = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let files: Vec<PathBuf> = paths.filter(|path| path.extension().is_some_and(|end| end == "cgns")).collect();
    assert!(!files.is_empty());
    Some(files)
}

fn compare<const D: usize>(path: &Path, periodic: &[(String, String)]) {
    let lists = crate::read(path).unwrap_or_else(|error| unreachable!("{}: {error}", path.display()));
    let mesh = Mesh::<D>::from_lists(lists, periodic, Simplices::Split);
    let mesh = mesh.unwrap_or_else(|error| unreachable!("{}: {error}", path.display()));
    let text = path.to_string_lossy().replace(".cgns", "_v4.1_binary.msh");
    let gmsh = Mesh::<D>::from_gmsh_with(&std::fs::read(text).unwrap(), periodic, Simplices::Split).unwrap();
    assert_eq!((mesh.order(), mesh.n_cells()), (gmsh.order(), gmsh.n_cells()), "{}", path.display());
    assert!((mesh.volume() / gmsh.volume() - 1.0).abs() < 1e-13, "{}", path.display());
    assert_eq!(mesh.interior_facets().len(), gmsh.interior_facets().len(), "{}", path.display());
    let sorted = |mesh: &Mesh<D>| {
        let mut boundaries = boundaries(mesh);
        boundaries.sort();
        boundaries
    };
    assert_eq!(sorted(&mesh), sorted(&gmsh), "{}", path.display());
    let nodes = |mesh: &Mesh<D>| {
        let mut nodes: Vec<[i64; D]> = mesh.coordinates().chunks(D).map(rounded).collect();
        nodes.sort_unstable();
        nodes
    };
    assert!(nodes(&mesh) == nodes(&gmsh), "{}", path.display());
    let regions = |mesh: &Mesh<D>| mesh.regions().iter().map(|region| region.cells.len()).collect::<Vec<_>>();
    assert_eq!(regions(&mesh), regions(&gmsh), "{}", path.display());
}

/// A position up to 1e-9, away from the middle between two multiples.
fn rounded<const D: usize>(position: &[f64]) -> [i64; D] {
    std::array::from_fn(|i| ((position[i] + 3.1e-10) * 1e9).round() as i64)
}

#[test]
fn meshes_of_gmsh() {
    for path in files().unwrap_or_default() {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let joined = [("right".to_owned(), "left".to_owned())];
        let periodic: &[_] = if name.starts_with("periodic") { &joined } else { &[] };
        // Elements of degree 4 of simplices are refused.
        if name.starts_with("triangles_2_p4") || name.starts_with("tetrahedra_3_p4") || name.starts_with("mixed_2_p4") {
            assert!(crate::read(&path).unwrap_err().to_string().contains("not evenly spaced"), "{name}");
        } else if name.contains("_2_") {
            compare::<2>(&path, periodic);
        } else {
            compare::<3>(&path, periodic);
        }
    }
}
