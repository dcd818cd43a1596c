//! The generators of meshes, and what changes the generated mesh.

use super::*;

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
