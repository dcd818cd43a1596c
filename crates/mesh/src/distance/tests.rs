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

/// The least squared distance of x to a curve through equally spaced points: that of the nearest point, or of the parabola
/// through it and its neighbours.
fn nearest(curve: &[[f64; 2]], x: &[f64; 2]) -> f64 {
    let square = |y: &[f64; 2]| (x[0] - y[0]).powi(2) + (x[1] - y[1]).powi(2);
    let squares: Vec<f64> = curve.iter().map(square).collect();
    let k = (0..squares.len()).min_by(|a, b| squares[*a].total_cmp(&squares[*b])).unwrap();
    if k == 0 || k + 1 == squares.len() {
        return squares[k];
    }
    let (slope, bend) = (0.5 * (squares[k + 1] - squares[k - 1]), squares[k + 1] - 2.0 * squares[k] + squares[k - 1]);
    squares[k] - 0.5 * slope * slope / bend
}

/// Against the nearest of very many points, on facets that are strongly curved, also around a nose.
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
    let mut random = SplitMix64::new(7);
    for k in 0..400 {
        // Near the airfoil, and far away.
        let size = if k % 2 == 0 { 0.2 } else { 20.0 };
        let x = [0.5 + (0.6 + size) * random.symmetric(), size * random.symmetric()];
        let brute = dense.chunks(2001).map(|facet| nearest(facet, &x)).fold(f64::INFINITY, f64::min).sqrt();
        let found = distance.at(&x);
        assert!((found - brute).abs() < 1e-9 * (1.0 + size), "{x:?}: {found} {brute}");
    }
}

#[test]
fn without_facets_everything_is_infinitely_far() {
    let mesh = RotatingBoxMesh::unit(5, 2).build().unwrap();
    assert_eq!(BoundaryDistance::new(&mesh, &[]).at(&[0.3, 0.2]), f64::INFINITY);
}
