#![allow(clippy::unwrap_used)]
use super::*;
use crate::testing::{distance, largest, noise, unit_box};
use mesh::NodeNumbering;

const DENSITY: f64 = 1.7;

fn mass<const D: usize>(mesh: &Mesh<D>, order: usize) -> (Mass<D>, NodalBatches<D>, NodeNumbering) {
    let numbering = NodeNumbering::new(mesh, order);
    let batches = NodalBatches::new(&numbering);
    (Mass::new(mesh, &batches, order, DENSITY), batches, numbering)
}

/// All points of a rule of `n` points per direction in `cell`: position, w det J, and phi_k for every node of the cell.
fn points<const D: usize>(mesh: &Mesh<D>, order: usize, n: usize, cell: usize) -> Vec<([f64; D], f64, Vec<f64>)> {
    let rule = gauss(n);
    let map = CellMap::on_grid(mesh.order(), &rule.points);
    let values = Lagrange::gauss_lobatto(order).value_matrix(&rule.points);
    let phi = |q: usize, k: usize| {
        (0..D as u32).map(|axis| values[(q / n.pow(axis) % n, k / order.pow(axis) % order)]).product()
    };
    let nodes = mesh.cell_coordinates(cell);
    let weighted = rule.tensor_weights(D).into_iter().zip(map.determinants(nodes)).map(|(w, det)| w * det);
    let points = map.positions(nodes).into_iter().zip(weighted).enumerate();
    points.map(|(q, (x, w))| (x, w, (0..order.pow(D as u32)).map(|k| phi(q, k)).collect())).collect()
}

/// M against the matrix assembled point by point, with the same points.
fn agrees_with_assembled<const D: usize>(mesh: &Mesh<D>, order: usize) {
    let (mass, batches, numbering) = mass(mesh, order);
    let v = noise(numbering.count * D);
    let mut expected = vec![0.0; v.len()];
    for cell in 0..mesh.n_cells() {
        let nodes = numbering.cell(cell);
        for (_, weight, phi) in points(mesh, order, quadrature_points(D, order, mesh.order()), cell) {
            for i in 0..D {
                let at_point: f64 = nodes.iter().zip(&phi).map(|(node, phi)| phi * v[node * D + i]).sum();
                nodes.iter().zip(&phi).for_each(|(k, phi)| expected[k * D + i] += DENSITY * weight * phi * at_point);
            }
        }
    }
    let mut found = vec![f64::NAN; v.len()];
    mass.apply(&batches, &v, &mut found);
    assert!(distance(&found, &expected) < 1e-14 * largest(&expected), "D = {D}, N = {order}");
}

#[test]
fn matrix_free_is_assembled() {
    agrees_with_assembled(&unit_box([11, 1], 3, 0.03), 3);
    agrees_with_assembled(&unit_box([3, 2], 4, 0.03), 6);
    agrees_with_assembled(&unit_box([2, 2, 3], 3, 0.03), 3);
}

/// M times a constant is int rho phi_k dx, here by a rule with more points than needed; the sum is the mass of the curved
/// body.
fn constants_are_exact<const D: usize>(mesh: &Mesh<D>) {
    let order = mesh.order();
    let (mass, batches, numbering) = mass(mesh, order);
    let mut expected = vec![0.0; numbering.count * D];
    for cell in 0..mesh.n_cells() {
        for (_, weight, phi) in points(mesh, order, 3 * order, cell) {
            for (node, phi) in numbering.cell(cell).iter().zip(phi) {
                (0..D).for_each(|i| expected[node * D + i] += DENSITY * weight * phi * (i + 1) as f64);
            }
        }
    }
    let constant: Vec<f64> = (0..expected.len()).map(|entry| (entry % D + 1) as f64).collect();
    let mut found = vec![0.0; expected.len()];
    mass.apply(&batches, &constant, &mut found);
    assert!(distance(&found, &expected) < 1e-14, "D = {D}, N = {order}");
    let total: f64 = found.iter().step_by(D).sum();
    assert!((total - DENSITY * mesh.volume()).abs() < 1e-13, "D = {D}, N = {order}: {total}");
}

#[test]
fn inertia_of_a_body_moved_as_a_whole_is_exact() {
    for order in [2, 3, 5, 8] {
        constants_are_exact(&unit_box([3, 2], order, 0.03));
    }
    for order in [2, 3, 5] {
        constants_are_exact(&unit_box([2, 1, 2], order, 0.03));
    }
}

/// Resultant and moment of gravity on a curved body: its mass, and its centroid times its mass.
#[test]
fn body_force_has_the_resultant_and_moment_of_the_mass() {
    let mesh = unit_box([3, 2], 5, 0.03);
    let (mass, batches, numbering) = mass(&mesh, 5);
    let mut f = vec![0.0; numbering.count * 2];
    mass.load(&batches, |_| [0.0, -2.0], &mut f);
    let nodes = crate::geometry::nodal_coordinates(&mesh, &numbering);
    let moment: f64 = nodes.iter().zip(f.chunks_exact(2)).map(|(x, f)| x[0] * f[1] - x[1] * f[0]).sum();
    let parts = mesh.volumes_and_centroids();
    let exact: f64 = parts.iter().map(|(volume, centroid)| -2.0 * volume * centroid[0]).sum();
    assert!((f.iter().skip(1).step_by(2).sum::<f64>() + 2.0 * mesh.volume()).abs() < 1e-14);
    assert!((moment - exact).abs() < 1e-14);
    assert!(f.iter().step_by(2).all(|f| *f == 0.0));
}

/// N nodes would give a diagonal mass; the consistent mass gives the kinetic energy of a rotation of a curved body.
#[test]
fn kinetic_energy_of_a_rotation() {
    let mesh = unit_box([2, 2], 4, 0.03);
    let (mass, batches, numbering) = mass(&mesh, 4);
    let nodes = crate::geometry::nodal_coordinates(&mesh, &numbering);
    let v: Vec<f64> = nodes.iter().flat_map(|x| [-x[1], x[0]]).collect();
    let mut momentum = vec![0.0; v.len()];
    mass.apply(&batches, &v, &mut momentum);
    let found: f64 = v.iter().zip(&momentum).map(|(v, p)| v * p).sum();
    let cells = (0..mesh.n_cells()).flat_map(|cell| points(&mesh, 4, 12, cell));
    let exact: f64 = cells.map(|(x, weight, _)| DENSITY * weight * (x[0] * x[0] + x[1] * x[1])).sum();
    assert!((found - exact).abs() < 1e-12, "{found} against {exact}");
}
