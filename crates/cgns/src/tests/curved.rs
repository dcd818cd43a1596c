//! Elements of every order at positions of an asymmetric mapping.

use super::{boundaries, mesh};
use crate::order::from_cgns;
use mesh::{Mesh, Shape, Simplices};

/// A mapping of degree `p` in each variable without any symmetry.
fn mapped([r, s, t]: [f64; 3], p: i32) -> [f64; 3] {
    [
        r + 0.05 * s.powi(p) + 0.03 * r * t.powi(p),
        1.3 * s + 0.04 * r.powi(p) * t + 0.02 * t.powi(p),
        0.8 * t + 0.06 * r * s.powi(p) + 0.05 * r.powi(p) * s.powi(p) * t.powi(p),
    ]
}

/// The positions of an element's nodes in the order of CGNS: the lattice index of each is known by its rank.
fn positions(shape: Shape, degree: usize, lattice: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut nodes = vec![[0.0; 3]; lattice.len()];
    for (index, &node) in from_cgns(shape, degree).iter().enumerate() {
        nodes[node] = lattice[index];
    }
    nodes
}

/// The lattice of a cube, axis 0 fastest.
fn cube(degree: usize) -> Vec<[f64; 3]> {
    let n = degree + 1;
    let x = |k: usize| k as f64 / degree as f64;
    (0..n * n * n).map(|k| [x(k % n), x(k / n % n), x(k / (n * n))]).collect()
}

/// The node number in the order of CGNS, from 1, at each lattice position, axis 0 fastest: layers along axis 2.
#[test]
fn numbers_of_the_standard() {
    let numbers = |shape, degree| from_cgns(shape, degree).iter().map(|node| node + 1).collect::<Vec<_>>();
    assert_eq!(numbers(Shape::Line, 4), [1, 3, 4, 5, 2]);
    assert_eq!(numbers(Shape::Quadrilateral, 2), [1, 5, 2, 8, 9, 6, 4, 7, 3]);
    assert_eq!(numbers(Shape::Quadrilateral, 3), [1, 5, 6, 2, 12, 13, 14, 7, 11, 16, 15, 8, 4, 10, 9, 3]);
    let rows = [[1, 5, 6, 7, 2], [16, 17, 18, 19, 8], [15, 24, 25, 20, 9], [14, 23, 22, 21, 10], [4, 13, 12, 11, 3]];
    assert_eq!(numbers(Shape::Quadrilateral, 4), rows.concat());
    assert_eq!(numbers(Shape::Triangle, 3), [1, 4, 5, 2, 9, 10, 6, 8, 7, 3]);
    assert_eq!(numbers(Shape::Tetrahedron, 2), [1, 5, 2, 7, 6, 3, 8, 9, 10, 4]);
    let layers = [&[1, 5, 6, 2, 10, 17, 7, 9, 8, 3][..], &[11, 18, 13, 20, 19, 15], &[12, 14, 16], &[4]];
    assert_eq!(numbers(Shape::Tetrahedron, 3), layers.concat());
    let layers = [[1, 7, 2, 9, 8, 3], [10, 16, 11, 18, 17, 12], [4, 13, 5, 15, 14, 6]];
    assert_eq!(numbers(Shape::Prism, 2), layers.concat());
    let layers = [
        [1, 7, 8, 2, 12, 25, 9, 11, 10, 3],
        [13, 26, 27, 15, 35, 39, 30, 34, 31, 17],
        [14, 29, 28, 16, 36, 40, 33, 37, 32, 18],
        [4, 19, 20, 5, 24, 38, 21, 23, 22, 6],
    ];
    assert_eq!(numbers(Shape::Prism, 3), layers.concat());
    let layers =
        [[1, 9, 2, 12, 21, 10, 4, 11, 3], [13, 22, 14, 25, 27, 23, 16, 24, 15], [5, 17, 6, 20, 26, 18, 8, 19, 7]];
    assert_eq!(numbers(Shape::Hexahedron, 2), layers.concat());
    let layers = [
        [1, 9, 10, 2, 16, 33, 34, 11, 15, 36, 35, 12, 4, 14, 13, 3],
        [17, 37, 38, 19, 50, 57, 58, 41, 49, 60, 59, 42, 23, 46, 45, 21],
        [18, 40, 39, 20, 51, 61, 62, 44, 52, 64, 63, 43, 24, 47, 48, 22],
        [5, 25, 26, 6, 32, 53, 54, 27, 31, 56, 55, 28, 8, 30, 29, 7],
    ];
    assert_eq!(numbers(Shape::Hexahedron, 3), layers.concat());
    let middle =
        [21, 54, 55, 56, 24, 83, 99, 100, 101, 63, 82, 106, 107, 102, 64, 81, 105, 104, 103, 65, 30, 74, 73, 72, 27];
    assert_eq!(numbers(Shape::Hexahedron, 4)[25..50], middle);
    let middle =
        [22, 61, 62, 57, 25, 84, 108, 109, 110, 70, 89, 115, 116, 111, 71, 88, 114, 113, 112, 66, 31, 75, 80, 79, 28];
    assert_eq!(numbers(Shape::Hexahedron, 4)[50..75], middle);
}

/// det J of the mapping at a point, by differences that are exact to 1e-9.
fn determinant(x: [f64; 3], p: i32) -> f64 {
    let h = 1e-4;
    let mut columns = [[0.0; 3]; 3];
    for (axis, column) in columns.iter_mut().enumerate() {
        let (mut high, mut low) = (x, x);
        high[axis] += h;
        low[axis] -= h;
        let (high, low) = (mapped(high, p), mapped(low, p));
        *column = std::array::from_fn(|i| (high[i] - low[i]) / (2.0 * h));
    }
    let [a, b, c] = columns;
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// The volume of the mapped cube by the midpoint rule with 60^3 points.
fn volume(p: i32) -> f64 {
    let n = 60;
    let x = |k: usize| (k as f64 + 0.5) / n as f64;
    (0..n * n * n).map(|k| determinant([x(k % n), x(k / n % n), x(k / (n * n))], p)).sum::<f64>() / (n * n * n) as f64
}

const FACES: [i64; 24] = [1, 4, 3, 2, 1, 2, 6, 5, 2, 3, 7, 6, 3, 4, 8, 7, 4, 1, 5, 8, 5, 6, 7, 8];

#[test]
fn curved_hexahedra() {
    for (degree, code) in [(1, 17), (2, 19), (3, 39), (4, 56)] {
        let p = degree as i32;
        let lattice: Vec<[f64; 3]> = cube(degree).into_iter().map(|x| mapped(x, p)).collect();
        let space: Mesh<3> = mesh(|file| {
            let nodes = positions(Shape::Hexahedron, degree, &lattice);
            let zone = file.base(3, 3).unstructured("Zone", 1, &nodes);
            zone.section("cell", code, 1, 1, &(1..=nodes.len() as i64).collect::<Vec<_>>());
            zone.section("faces", 7, 2, 6, &FACES);
        });
        assert_eq!((space.n_cells(), space.order()), (1, degree + 1));
        assert_eq!(boundaries(&space), [("faces".into(), 6)]);
        assert!((space.volume() - volume(p)).abs() < 1e-4, "degree {degree}: {} {}", space.volume(), volume(p));
        let nodes = basis_nodes(degree + 1);
        for (k, x) in space.cell_coordinates(0).chunks(3).enumerate() {
            let n = degree + 1;
            let exact = mapped([nodes[k % n], nodes[k / n % n], nodes[k / (n * n)]], p);
            assert!(
                x.iter().zip(exact).all(|(x, y)| (x - y).abs() < 1e-13),
                "degree {degree} node {k}: {x:?} {exact:?}"
            );
        }
    }
}

/// Gauss-Lobatto nodes on [0, 1].
fn basis_nodes(order: usize) -> Vec<f64> {
    let nodes: &[f64] = match order {
        2 => &[-1.0, 1.0],
        3 => &[-1.0, 0.0, 1.0],
        4 => &[-1.0, -0.447_213_595_499_957_9, 0.447_213_595_499_957_9, 1.0],
        _ => &[-1.0, -0.654_653_670_707_977_2, 0.0, 0.654_653_670_707_977_2, 1.0],
    };
    nodes.iter().map(|x| (x + 1.0) / 2.0).collect()
}

/// The lattice of a simplex or prism: positions with r + s (+ t) up to 1.
fn simplex(shape: Shape, degree: usize) -> Vec<[f64; 3]> {
    let inside = |[r, s, t]: &[f64; 3]| r + s + if shape == Shape::Prism { 0.0 } else { *t } <= 1.0 + 1e-12;
    cube(degree).into_iter().filter(inside).collect()
}

/// The pieces fill the mapped tetrahedron or prism: the mapping is linear in sum, so that its volume is exact.
#[test]
fn tetrahedra_and_prisms_are_split() {
    for (shape, degree, code, faces, volume) in [
        (Shape::Tetrahedron, 1, 10, &TETRAHEDRON_FACES[..], 1.0 / 6.0),
        (Shape::Tetrahedron, 2, 11, &TETRAHEDRON_FACES, 1.0 / 6.0),
        (Shape::Tetrahedron, 3, 30, &TETRAHEDRON_FACES, 1.0 / 6.0),
        (Shape::Prism, 1, 14, &PRISM_FACES, 0.5),
        (Shape::Prism, 2, 16, &PRISM_FACES, 0.5),
        (Shape::Prism, 3, 36, &PRISM_FACES, 0.5),
    ] {
        let p = degree as i32;
        // A shear of z by a polynomial of x and y, and of y by one of x, keeps volumes.
        let sheared = |[x, y, z]: [f64; 3]| {
            let y = y + 0.1 * x.powi(p);
            [x, y, z + 0.1 * if p == 1 { y } else { x * x - x }]
        };
        let lattice: Vec<[f64; 3]> = simplex(shape, degree).into_iter().map(sheared).collect();
        let lists = super::lists(|file| {
            let nodes = positions(shape, degree, &lattice);
            let zone = file.base(3, 3).unstructured("Zone", 1, &nodes);
            zone.section("cell", code, 1, 1, &(1..=nodes.len() as i64).collect::<Vec<_>>());
            let count = if shape == Shape::Prism { 5 } else { 4 };
            zone.section("faces", 20, 2, count, faces);
        });
        let space = Mesh::<3>::from_lists(lists.unwrap(), &[], Simplices::Split).unwrap();
        assert!((space.volume() - volume).abs() < 1e-14, "{shape:?} {degree}: {}", space.volume());
    }
}

const TETRAHEDRON_FACES: [i64; 16] = [5, 1, 3, 2, 5, 1, 2, 4, 5, 2, 3, 4, 5, 3, 1, 4];
const PRISM_FACES: [i64; 23] = [5, 1, 3, 2, 5, 4, 5, 6, 7, 1, 2, 5, 4, 7, 2, 3, 6, 5, 7, 3, 1, 4, 6];
