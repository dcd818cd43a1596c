#![allow(clippy::unwrap_used)]
use super::*;
use crate::geometry::nodal_coordinates;
use crate::testing::unit_box;

/// The nodal forces of the tractions q(point) on the boundaries with the given indices.
fn forces<const D: usize>(mesh: &Mesh<D>, boundaries: &[usize], q: impl Fn(&SurfacePoint<D>) -> [f64; D]) -> Vec<f64> {
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let surface = Surface::new(mesh, &numbering);
    let mut f = vec![0.0; numbering.count * D];
    boundaries.iter().for_each(|&boundary| surface.add(boundary, &q, &mut f));
    f
}

/// Resultant, and moment about the origin: x_i f_j - x_j f_i for (i, j) = (0, 1), and in 3-D the other two.
fn resultant_and_moment<const D: usize>(mesh: &Mesh<D>, f: &[f64]) -> Vec<f64> {
    let nodes = nodal_coordinates(mesh, &NodeNumbering::new(mesh, mesh.order()));
    let pairs = (0..D).flat_map(|i| (i + 1..D).map(move |j| (i, j)));
    let moment = |(i, j): (usize, usize)| {
        nodes.iter().zip(f.chunks_exact(D)).map(|(x, f)| x[i] * f[j] - x[j] * f[i]).sum::<f64>()
    };
    (0..D).map(|i| f.iter().skip(i).step_by(D).sum()).chain(pairs.map(moment)).collect()
}

/// A pressure all around a curved body has no resultant and no moment.
#[test]
fn a_pressure_all_around_is_in_equilibrium() {
    for order in [2, 3, 6] {
        let mesh = unit_box([3, 2], order, 0.03);
        let f = forces(&mesh, &[0, 1, 2, 3], |point| point.normal.map(|n| -2.0 * n));
        assert!(resultant_and_moment(&mesh, &f).iter().all(|r| r.abs() < 1e-14), "D = 2, N = {order}");
    }
    for order in [2, 3, 5] {
        let mesh = unit_box([2, 1, 2], order, 0.03);
        let f = forces(&mesh, &[0, 1, 2, 3, 4, 5], |point| point.normal.map(|n| -2.0 * n));
        assert!(resultant_and_moment(&mesh, &f).iter().all(|r| r.abs() < 1e-14), "D = 3, N = {order}");
    }
}

/// One curved side from A to B, traversed with the body on its left, for any curve. The integral of n ds is B - A
/// turned back by 90 degrees. The integral of x cross n ds is (|A|^2 - |B|^2) / 2.
#[test]
fn a_pressure_on_one_curved_side_knows_its_ends_alone() {
    let mesh = unit_box([3, 2], 5, 0.03);
    let nodes: Vec<[f64; 2]> = mesh
        .boundary_facets()
        .iter()
        .filter(|facet| facet.boundary == 1)
        .flat_map(|facet| mesh::face_nodes(2, 5, facet.side.face).into_iter().map(move |k| (facet.side.cell, k)))
        .map(|(cell, k)| [0, 1].map(|i| mesh.cell_coordinates(cell)[k * 2 + i]))
        .collect();
    let by_height = |x: &&[f64; 2], y: &&[f64; 2]| x[1].total_cmp(&y[1]);
    let (a, b) = (nodes.iter().min_by(by_height).unwrap(), nodes.iter().max_by(by_height).unwrap());
    let found = resultant_and_moment(&mesh, &forces(&mesh, &[1], |point| point.normal));
    let square = |x: &[f64; 2]| x[0] * x[0] + x[1] * x[1];
    let exact = [b[1] - a[1], a[0] - b[0], 0.5 * (square(a) - square(b))];
    assert!(found.iter().zip(exact).all(|(found, exact)| (found - exact).abs() < 1e-14), "{found:?}, {exact:?}");
}

/// A constant traction on one side of a box: its resultant is traction times area, each node bears a part of it.
#[test]
fn a_traction_on_a_plane_side_in_3d() {
    let mesh = unit_box([2, 3, 1], 4, 0.0);
    let f = forces(&mesh, &[1], |point| {
        assert!((point.position[0] - 1.0).abs() < 1e-14 && (point.normal[0] - 1.0).abs() < 1e-14);
        [1.0, 2.0, 3.0 * point.position[1]]
    });
    // Moments: x_0 f_1 - x_1 f_0 = 2 - 1/2, x_0 f_2 - x_2 f_0 = 3/2 - 1/2, x_1 f_2 - x_2 f_1 = 3/3 - 2/2.
    let exact = [1.0, 2.0, 1.5, 1.5, 1.0, 0.0];
    let found = resultant_and_moment(&mesh, &f);
    assert!(found.iter().zip(exact).all(|(found, exact)| (found - exact).abs() < 1e-14), "{found:?}");
}
