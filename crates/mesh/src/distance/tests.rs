#![allow(clippy::unwrap_used)]

use super::*;
use crate::generate::{AirfoilMesh, AnnulusMesh, Extrusion, RotatingBoxMesh};
use crate::random::SplitMix64;
use std::array::from_fn;

fn named<const D: usize>(mesh: &Mesh<D>, name: &str) -> usize {
    mesh.boundary_names().iter().position(|known| known == name).unwrap()
}

#[test]
fn distances_to_straight_sides_are_exact() {
    for order in [2, 3, 8] {
        let mesh = RotatingBoxMesh::unit(5, order).build().unwrap().scrambled(1);
        let [inner, outer] = ["inner", "outer"].map(|name| BoundaryDistance::new(&mesh, &[named(&mesh, name)]));
        let mut random = SplitMix64::new(3);
        for _ in 0..300 {
            let x: [f64; 2] = from_fn(|_| 0.5 * random.symmetric());
            let side = |half: f64, x: f64| (x.abs() - half).max(0.0);
            let to_box = side(0.1, x[0]).hypot(side(0.1, x[1]));
            if to_box > 0.0 {
                assert!((inner.at(&x) - to_box).abs() < 1e-15, "{x:?}: {:e}", inner.at(&x) - to_box);
            }
            let to_square = 0.5 - x[0].abs().max(x[1].abs());
            assert!((outer.at(&x) - to_square).abs() < 1e-15);
        }
    }
}

#[test]
fn distances_to_a_circle_are_as_good_as_its_polynomials() {
    let annulus = AnnulusMesh { inner_radius: 1.0, outer_radius: 3.0, first_cell: 0.5, cells: [12, 2], order: 8 };
    let plane = annulus.build().unwrap();
    let space = plane.extruded(&Extrusion { lower: 0.0, depth: 1.0, layers: 2, periodic: false }).unwrap().scrambled(2);
    let to_wall = BoundaryDistance::new(&plane, &[named(&plane, "wall")]);
    let to_wall_in_space = BoundaryDistance::new(&space, &[named(&space, "wall")]);
    let mut random = SplitMix64::new(5);
    for _ in 0..200 {
        let x: [f64; 2] = from_fn(|_| 2.0 * random.symmetric());
        let distance = (x[0].hypot(x[1]) - 1.0).abs();
        assert!((to_wall.at(&x) - distance).abs() < 1e-8, "{x:?}");
        // Beyond an end of the cylinder the nearest point is on its rim.
        let z = 1.5 * random.symmetric() + 0.5;
        let beyond = (-z).max(z - 1.0).max(0.0);
        let found = to_wall_in_space.at(&[x[0], x[1], z]);
        assert!((found - to_wall.at(&x).hypot(beyond)).abs() < 1e-14, "{x:?} {z}: {found}");
    }
}

/// Against the nearest of very many points, on facets that bend strongly and turn around a nose.
#[test]
fn nothing_on_the_boundary_is_nearer() {
    let mesh = AirfoilMesh { surface_cells: 4, trailing_edge_cell: 0.1, ..AirfoilMesh::naca0012(6) }.build().unwrap();
    let airfoil = named(&mesh, "airfoil");
    let distance = BoundaryDistance::new(&mesh, &[airfoil]);
    let dense: Vec<[f64; 2]> = {
        let facets = mesh.boundary_facets().iter().filter(|facet| facet.boundary == airfoil);
        let points: Vec<f64> = (0..=2000).map(|i| f64::from(i) / 1000.0 - 1.0).collect();
        let values = basis::Lagrange::gauss_lobatto(6).value_matrix(&points);
        let curve = |x: Vec<[f64; 2]>| {
            let at = |q: usize| from_fn(|i| values.row(q).iter().zip(&x).map(|(l, x)| l * x[i]).sum());
            (0..points.len()).map(at).collect::<Vec<_>>()
        };
        facets.flat_map(|facet| curve(mesh.face_positions(facet.side))).collect()
    };
    let apart = |pair: &[[f64; 2]]| (pair[0][0] - pair[1][0]).hypot(pair[0][1] - pair[1][1]);
    let spacing = dense.chunks(2001).flat_map(|facet| facet.windows(2)).map(apart).fold(0.0, f64::max);
    let mut random = SplitMix64::new(7);
    for k in 0..400 {
        // Near the airfoil, and far away.
        let size = if k % 2 == 0 { 0.2 } else { 20.0 };
        let x = [0.5 + (0.6 + size) * random.symmetric(), size * random.symmetric()];
        let brute = dense.iter().map(|y| (x[0] - y[0]).hypot(x[1] - y[1])).fold(f64::INFINITY, f64::min);
        let found = distance.at(&x);
        // The nearest of the points is at most half the spacing off along the curve, which is bent a little.
        let least = (brute * brute - 1.1 * (0.5 * spacing).powi(2)).max(0.0).sqrt();
        assert!(found <= brute + 1e-15 * size && found > least - 1e-14 * size, "{x:?}: {found} {brute}");
    }
}

#[test]
fn without_facets_everything_is_infinitely_far() {
    let mesh = RotatingBoxMesh::unit(5, 2).build().unwrap();
    assert_eq!(BoundaryDistance::new(&mesh, &[]).at(&[0.3, 0.2]), f64::INFINITY);
}
