//! A manufactured displacement on curved meshes: the error in L2 falls like h^N.
//!
//! The displacement is a product of sines and cosines, and the stiffness varies smoothly. The body force -div sigma comes from the same
//! law by nested dual numbers.
#![allow(clippy::unwrap_used)]

use crate::common::{body_force, displacement, held_box};
use basis::{Lagrange, gauss};
use elasticity::{ElasticMesh, Lame, Material, Solver, Stiffness};
use mesh::{CellMap, Mesh, NodeNumbering};
use tensor::{Transcendental, det};

/// E(x) / E_0
fn stiffness<T: Transcendental, const D: usize>(x: &[T; D]) -> T {
    (x[0] - x[D - 1] * 0.5).sin() * 0.5 + 1.0
}

/// Visits all points of a rule of `n` points per direction in every cell: cell, point index, position, weight det J.
fn at_points<const D: usize>(mesh: &Mesh<D>, n: usize, mut visit: impl FnMut(usize, usize, [f64; D], f64)) {
    let rule = gauss(n);
    let map = CellMap::on_grid(mesh.order(), &rule.points);
    for cell in 0..mesh.n_cells() {
        let nodes = mesh.cell_coordinates(cell);
        for (point, (x, jacobian)) in map.positions(nodes).into_iter().zip(map.jacobians(nodes)).enumerate() {
            let weight: f64 = (0..D as u32).map(|axis| rule.weights[point / n.pow(axis) % n]).product();
            visit(cell, point, x, weight * det(&jacobian));
        }
    }
}

/// int f . phi_k for every C0 node k.
fn load<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering, lame: Lame) -> Vec<f64> {
    let (order, n) = (numbering.order(), numbering.order() + 3);
    let values = Lagrange::gauss_lobatto(order).value_matrix(&gauss(n).points);
    let mut forces = vec![0.0; numbering.count * D];
    at_points(mesh, n, |cell, point, x, weight| {
        let force =
            body_force(&x, |x, gradient| lame.stress(gradient).map(|row| row.map(|sigma| sigma * stiffness(x))));
        for (k, &node) in numbering.cell(cell).iter().enumerate() {
            let phi: f64 =
                (0..D as u32).map(|axis| values[(point / n.pow(axis) % n, k / order.pow(axis) % order)]).product();
            (0..D).for_each(|i| forces[node * D + i] += weight * phi * force[i]);
        }
    });
    forces
}

/// |d_h - d| in L2.
fn error<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering, d: &[f64]) -> f64 {
    let n = numbering.order() + 3;
    // The map of a cell interpolates any vector given at the nodes.
    let map = CellMap::<D>::on_grid(numbering.order(), &gauss(n).points);
    let interpolated = |cell| {
        let nodes: Vec<f64> = numbering.cell(cell).iter().flat_map(|&node| d[node * D..][..D].to_vec()).collect();
        map.positions(&nodes)
    };
    let cells: Vec<_> = (0..mesh.n_cells()).map(interpolated).collect();
    let mut square = 0.0;
    at_points(mesh, n, |cell, point, x, weight| {
        let exact = displacement(&x);
        square += (0..D).map(|i| weight * (cells[cell][point][i] - exact[i]).powi(2)).sum::<f64>();
    });
    square.sqrt()
}

/// The error with `cells` cells per direction.
fn solution_error<const D: usize>(cells: usize, order: usize) -> f64 {
    let (mesh, numbering, constrained) = held_box::<D>(cells, order);
    let material = Material::new(2.0, 0.3).unwrap();
    let modulus = |x: &[f64; D]| stiffness(x);
    // In 3-D, and for one solution, multigrid is faster than a factorisation.
    let solver = if D == 2 { Solver::Automatic } else { Solver::Multigrid };
    let stiffness = Stiffness::Function(&modulus);
    let elastic = ElasticMesh::with_solver(&mesh, &numbering, material, stiffness, &constrained, solver).unwrap();
    let mut d: Vec<f64> = elastic.coordinates().iter().flat_map(displacement).collect();
    d.iter_mut().zip(constrained.as_flattened()).for_each(|(d, c)| *d = if *c { *d } else { 0.0 });
    elastic.solve(&load(&mesh, &numbering, material.lame()), &mut d, 1e-13).unwrap();
    error(&mesh, &numbering, &d)
}

/// The order between the two meshes is at least N - 0.2.
fn assert_order<const D: usize>(order: usize, cells: [usize; 2]) {
    let [coarse, fine] = cells.map(|cells| solution_error::<D>(cells, order));
    let found = (coarse / fine).ln() / (cells[1] as f64 / cells[0] as f64).ln();
    assert!(found >= order as f64 - 0.2, "D = {D}, N = {order}: order {found:.2}, errors {coarse:e}, {fine:e}");
}

#[test]
fn displacement_converges_with_order_n_in_2d() {
    for (order, cells) in
        [(2, [16, 32]), (3, [12, 24]), (4, [8, 16]), (5, [8, 16]), (6, [6, 12]), (7, [5, 10]), (8, [4, 8])]
    {
        assert_order::<2>(order, cells);
    }
}

#[test]
fn displacement_converges_with_order_n_in_3d() {
    for (order, cells) in [(2, [7, 14]), (3, [4, 8]), (4, [3, 6]), (5, [3, 5]), (6, [3, 5]), (7, [3, 4]), (8, [3, 4])] {
        assert_order::<3>(order, cells);
    }
}
