//! Every solver on the meshes it is made for: iterations, and agreement of all solvers.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use elasticity::{ElasticMesh, Material, Solver, Stiffness};
use mesh::generate::{AirfoilMesh, BladeMesh, Extrusion, RotatingBoxMesh};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use std::f64::consts::PI;

/// A mesh, its stiffness, and how its boundaries move.
struct Case<'a, const D: usize> {
    name: String,
    mesh: Mesh<D>,
    stiffness: Stiffness<'a, D>,
    boundary: &'a dyn Fn(&str, &[f64; D]) -> [f64; D],
}

/// The mesh with its solver, and the displacement of its boundaries.
fn prepared<const D: usize>(case: &Case<'_, D>, solver: Solver) -> (ElasticMesh<D>, Vec<f64>) {
    let mesh = &case.mesh;
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let mut boundary_of = vec![None; numbering.count];
    for (boundary, name) in mesh.boundary_names().iter().enumerate() {
        numbering.on_boundary(mesh, boundary).into_iter().for_each(|node| boundary_of[node] = Some(name));
    }
    let constrained: Vec<[bool; D]> = boundary_of.iter().map(|boundary| [boundary.is_some(); D]).collect();
    let material = Material::new(1.0, 0.4).unwrap();
    let elastic = ElasticMesh::with_solver(mesh, &numbering, material, case.stiffness, &constrained, solver).unwrap();
    let at_node = |(x, name): (&[f64; D], &Option<&String>)| name.map_or([0.0; D], |name| (case.boundary)(name, x));
    let d = elastic.coordinates().iter().zip(&boundary_of).flat_map(at_node).collect();
    (elastic, d)
}

/// The displacement to a relative residual, and the iterations.
fn solution<const D: usize>(case: &Case<'_, D>, solver: Solver, tolerance: f64) -> (Vec<f64>, usize) {
    let (elastic, mut d) = prepared(case, solver);
    let report = elastic.extend(&mut d, tolerance).unwrap();
    (d, report.iterations)
}

/// CG takes at most `cg` and `multigrid` iterations to 1e-10, and agrees with the direct solver to 1e-9.
fn assert_solvers<const D: usize>(case: &Case<'_, D>, cg: usize, multigrid: usize) {
    for (solver, most) in [(Solver::ConjugateGradients, cg), (Solver::Multigrid, multigrid)] {
        let (_, iterations) = solution(case, solver, 1e-10);
        println!("{}: {iterations} iterations of {solver:?}", case.name);
        assert!(iterations <= most, "{}: {iterations} iterations of {solver:?}, at most {most}", case.name);
    }
    let (direct, none) = solution(case, Solver::Direct, 1e-13);
    let (iterative, _) = solution(case, Solver::ConjugateGradients, 1e-14);
    assert_eq!(none, 0);
    let size = direct.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
    let difference = direct.iter().zip(&iterative).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    assert!(difference <= 1e-9 * size, "{}: {difference:e} of {size}", case.name);
}

/// A rotation by `degrees` about `centre`.
fn turned(x: &[f64; 2], centre: [f64; 2], degrees: f64) -> [f64; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let r = [x[0] - centre[0], x[1] - centre[1]];
    [cos * r[0] - sin * r[1] - r[0], sin * r[0] + cos * r[1] - r[1]]
}

#[test]
fn square() {
    for (order, cells) in [(4, 24), (8, 10), (16, 5)] {
        let curving = Curving::Wavy { amplitude: 0.02 };
        let mesh =
            BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells: [cells; 2], order, curving, periodic: [false; 2] };
        let boundary = &|_: &str, x: &[f64; 2]| [0.1 * (3.0 * x[1]).sin(), 0.1 * x[0] * x[1]];
        let (name, mesh) = (format!("square, N = {order}"), mesh.build().unwrap());
        assert_solvers(&Case { name, mesh, stiffness: Stiffness::Constant, boundary }, 30, 40);
    }
}

/// E = 1 + 100 / (1 + (d / d_0)^2),  d = max(0, min(dist_in - d_0, dist_out + 2 d_0)),  d_0 = 0.05: law (5) of Diosady & Murman (2018).
fn wall_distance_stiffness(x: &[f64; 2]) -> f64 {
    let d_0 = 0.05;
    let outside = x.map(|x| (x.abs() - 0.1).max(0.0));
    let (to_inner, to_outer) = (outside[0].hypot(outside[1]), 0.5 - x[0].abs().max(x[1].abs()));
    let d = (to_inner - d_0).min(to_outer + 2.0 * d_0).max(0.0);
    1.0 + 100.0 / (1.0 + (d / d_0).powi(2))
}

#[test]
fn rotating_box() {
    for (order, cells) in [(4, 20), (8, 10), (16, 5)] {
        let mesh = RotatingBoxMesh::unit(cells, order).build().unwrap();
        let boundary = &|name: &str, x: &[f64; 2]| if name == "inner" { turned(x, [0.0; 2], 20.0) } else { [0.0; 2] };
        let stiffness = Stiffness::Function(&wall_distance_stiffness);
        assert_solvers(&Case { name: format!("rotating box, N = {order}"), mesh, stiffness, boundary }, 30, 40);
    }
}

/// Length over height of the most stretched cell, by the edges from its first corner.
fn aspect_ratio(mesh: &Mesh<2>) -> f64 {
    let n = mesh.order();
    let of_cell = |cell: usize| {
        let node = |k: usize| [0, 1].map(|i| mesh.cell_coordinates(cell)[2 * k + i]);
        let edge = |k: usize| (node(k)[0] - node(0)[0]).hypot(node(k)[1] - node(0)[1]);
        edge(n - 1) / edge(n * (n - 1))
    };
    (0..mesh.n_cells()).map(of_cell).fold(0.0, |m, ratio| f64::max(m, ratio.max(ratio.recip())))
}

#[test]
fn airfoil_with_boundary_layer() {
    let sizes = [(4, [24, 12, 24], 0.02, 50), (8, [12, 6, 12], 0.02, 60), (16, [6, 6, 8], 0.1, 100)];
    for (order, [surface_cells, wake_cells, normal_cells], trailing_edge_cell, multigrid) in sizes {
        let airfoil =
            AirfoilMesh { far_field: 10.0, first_cell: 2e-3, trailing_edge_cell, ..AirfoilMesh::naca0012(order) };
        let mesh = AirfoilMesh { surface_cells, wake_cells, normal_cells, ..airfoil }.build().unwrap();
        let aspect = aspect_ratio(&mesh);
        assert!(aspect >= 900.0, "{aspect}");

        let boundary = &|name: &str, x: &[f64; 2]| match name {
            "airfoil" => turned(x, [0.25, 0.0], 5.0).map(|d| d + 0.1),
            _ => [0.0; 2],
        };
        let stiffness = Stiffness::InverseJacobian { power: 1.0 };
        assert_solvers(&Case { name: format!("airfoil, N = {order}"), mesh, stiffness, boundary }, 30, multigrid);
    }
}

#[test]
fn cube() {
    for aspect in [1.0, 100.0] {
        for order in 3..=8 {
            let (upper, cells, curving) = ([aspect, 1.0, 1.0], [15 / (order - 1); 3], Curving::None);
            let mesh = BoxMesh { lower: [0.0; 3], upper, cells, order, curving, periodic: [false; 3] }.build().unwrap();
            let boundary =
                &|_: &str, x: &[f64; 3]| [(x[0] / aspect + 2.0 * x[1]).sin(), x[0] / aspect * x[2], x[1] * x[2]];
            let name = format!("cube, aspect ratio {aspect}, N = {order}");
            assert_solvers(&Case { name, mesh, stiffness: Stiffness::Constant, boundary }, 46, 50);
        }
    }
}

/// A defect that was: the levels of thin cells that are extruded were nearly dense, and took minutes.
#[test]
fn extruded_boundary_layer() {
    let extrusion = Extrusion { lower: 0.0, depth: 0.1, layers: 2, periodic: true };
    let mesh = BladeMesh::low_pressure_turbine(4).unwrap().build().unwrap().extruded(&extrusion).unwrap();
    let boundary = &|name: &str, x: &[f64; 3]| match name {
        "blade" => [0.01 * (60.0 * x[0]).sin(), 0.01 * (20.0 * PI * x[2]).cos(), 0.0],
        _ => [0.0; 3],
    };
    let case = Case { name: "blade".to_owned(), mesh, stiffness: Stiffness::InverseJacobian { power: 1.0 }, boundary };
    let (elastic, mut d) = prepared(&case, Solver::Multigrid);
    let iterations = elastic.extend(&mut d, 1e-10).unwrap().iterations;
    let free = elastic.constrained().iter().filter(|constrained| !**constrained).count();
    let bytes = elastic.solver_bytes() / free;
    println!("blade: {iterations} iterations, {bytes} bytes per unknown");
    assert!(iterations <= 85 && bytes <= 2000, "{iterations} iterations, {bytes} bytes per unknown");
}

/// Boundary-layer cells that are 10^5 times longer than high, and stiffer than the far field by ten orders of magnitude. One pass of the
/// factor is accurate to 1e-5 there, although its residual is at round-off.
#[test]
fn extreme_stretching() {
    let airfoil = AirfoilMesh::naca0012(4);
    let mesh = AirfoilMesh { first_cell: 3e-5, wake_cells: 12, normal_cells: 24, ..airfoil }.build().unwrap();
    assert!(aspect_ratio(&mesh) > 1e5);
    let boundary = &|name: &str, x: &[f64; 2]| match name {
        "airfoil" => turned(x, [0.25, 0.0], 5.0).map(|d| d + 0.1),
        _ => [0.0; 2],
    };
    let stiffness = Stiffness::InverseJacobian { power: 1.0 };
    let case = Case { name: "thin airfoil cells".into(), mesh, stiffness, boundary };
    let (direct, _) = solution(&case, Solver::Direct, 1e-10);
    let (iterative, _) = solution(&case, Solver::ConjugateGradients, 1e-16);
    let difference = direct.iter().zip(&iterative).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    assert!(difference < 1e-8, "{difference:e}");
}
