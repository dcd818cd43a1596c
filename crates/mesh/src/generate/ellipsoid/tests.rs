#![allow(clippy::unwrap_used)]
use super::*;
use crate::NodeNumbering;
use std::f64::consts::PI;

const SPHERE: EllipsoidMesh =
    EllipsoidMesh { semi_axes: [0.5; 3], outer_radius: 20.0, first_cell: 0.05, cells: [4, 4, 4, 7], order: 4 };

/// A wing of chord 1, thickness 6 % and span 3.
const WING: EllipsoidMesh =
    EllipsoidMesh { semi_axes: [0.5, 0.03, 1.5], first_cell: 0.01, cells: [6, 2, 8, 10], ..SPHERE };

/// Different numbers of cells along all axes, so that a patch with exchanged axes does not fit.
const EGG: EllipsoidMesh =
    EllipsoidMesh { semi_axes: [1.0, 0.7, 1.3], outer_radius: 3.0, first_cell: 0.3, cells: [3, 4, 5, 2], order: 4 };

/// Semi-axes of the far field: an ellipsoid with the foci of the wall.
fn far_axes(mesh: &EllipsoidMesh) -> [f64; 3] {
    let longest = mesh.semi_axes.into_iter().fold(0.0, f64::max);
    mesh.semi_axes.map(|a| (mesh.outer_radius.powi(2) - longest.powi(2) + a * a).sqrt())
}

/// The largest |(x/a)^2 + (y/b)^2 + (z/c)^2 - 1| over the nodes of a boundary, and their number with repetitions.
fn distance_from_ellipsoid(mesh: &Mesh<3>, boundary: &str, axes: [f64; 3]) -> (f64, usize) {
    let facets = mesh.boundary_facets().iter().filter(|facet| mesh.boundary_names()[facet.boundary] == boundary);
    let nodes: Vec<[f64; 3]> = facets.flat_map(|facet| mesh.face_positions(facet.side)).collect();
    let error = |x: &[f64; 3]| ((0..3).map(|i| (x[i] / axes[i]).powi(2)).sum::<f64>() - 1.0).abs();
    (nodes.iter().map(error).fold(0.0, f64::max), nodes.len())
}

#[test]
fn nodes_of_the_boundaries_lie_on_ellipsoids_with_the_same_foci() {
    for shape in [SPHERE, WING, EGG] {
        let [x, y, z, _] = shape.cells;
        for order in [2, 3, 5, 8] {
            let shape = EllipsoidMesh { order, ..shape };
            let mesh = shape.build().unwrap();
            for (boundary, axes) in [("wall", shape.semi_axes), ("far", far_axes(&shape))] {
                let (error, nodes) = distance_from_ellipsoid(&mesh, boundary, axes);
                assert_eq!(nodes, 2 * (x * y + y * z + z * x) * order * order);
                assert!(error < 1e-14, "{boundary} of {shape:?}: {error:e}");
            }
        }
    }
}

/// A closed surface of S quadrilaterals has 2 S edges, S + 2 vertices and S (N - 1)^2 + 2 nodes.
#[test]
fn patches_are_joined_to_closed_surfaces() {
    for shape in [SPHERE, WING, EGG, EllipsoidMesh { cells: [1, 1, 1, 1], order: 6, ..EGG }] {
        let [x, y, z, layers] = shape.cells;
        let surface = 2 * (x * y + y * z + z * x);
        let mesh = shape.build().unwrap();
        assert_eq!((mesh.n_cells(), shape.n_cells()), (surface * layers, surface * layers));
        assert_eq!(mesh.boundary_facets().len(), 2 * surface);
        assert_eq!(mesh.interior_facets().len(), surface * (layers - 1) + 2 * surface * layers);
        let vertices = mesh.corners.iter().max().unwrap() + 1;
        assert_eq!(vertices, (surface + 2) * (layers + 1));
        for order in [2, 5] {
            let nodes = NodeNumbering::new(&mesh, order).count;
            assert_eq!(nodes, (surface * (order - 1).pow(2) + 2) * (layers * (order - 1) + 1));
        }
    }
}

/// `Mesh::new` gives nodes that neighbours share one position. It hardly moves them: both sides have computed the same.
#[test]
fn both_sides_of_a_facet_have_the_same_positions() {
    for shape in [SPHERE, WING, EGG] {
        let mesh = shape.build().unwrap();
        let cells: Vec<Cell> = (0..6).flat_map(|face| shape.cells_over(face)).collect();
        let computed = shape.coordinates(&cells, &shape.growth().unwrap());
        let moved = computed.iter().zip(mesh.coordinates()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(moved <= 1e-15 * shape.outer_radius, "{shape:?}: {moved:e}");
        for facet in mesh.interior_facets() {
            let (minus, plus) = (mesh.face_positions(facet.minus), mesh.face_positions(facet.plus));
            for (i, x) in minus.iter().enumerate() {
                assert_eq!(*x, plus[facet.orientation.plus_index(2, shape.order, i)]);
            }
        }
    }
}

/// The volume within polynomial faces of N nodes has the error of their nodes squared: order 2 (N - 1) in the size of the cells.
#[test]
fn the_volume_converges_with_twice_the_degree() {
    let exact = 4.0 / 3.0 * PI * (far_axes(&EGG).iter().product::<f64>() - EGG.semi_axes.iter().product::<f64>());
    for (order, expected) in [(2, 2.0), (3, 4.0), (4, 6.0)] {
        let error = |refined: usize| {
            let cells = [3 * refined, 4 * refined, 5 * refined, 2];
            (EllipsoidMesh { order, cells, ..EGG }.build().unwrap().volume() / exact - 1.0).abs()
        };
        let rate = (error(2) / error(4)).log2();
        assert!((rate - expected).abs() < 0.1, "order {order}: {rate}, error {:e}", error(4));
    }
}

#[test]
fn layers_grow_along_the_shortest_semi_axis() {
    for (shape, shortest, longest) in [(SPHERE, 0, 1), (WING, 1, 2)] {
        let mesh = shape.build().unwrap();
        // An even number of cells has a vertex on the semi-axis.
        let on_axis = |axis: usize| {
            let nodes = mesh.coordinates().as_chunks::<3>().0.iter();
            let vertices = nodes.filter(move |x| x[axis] > 0.0 && (0..3).all(|i| i == axis || x[i].abs() < 1e-12));
            let mut heights: Vec<f64> = vertices.map(|x| x[axis]).collect();
            heights.sort_by(f64::total_cmp);
            heights.dedup();
            heights
        };
        let (heights, growth) = (on_axis(shortest), shape.growth().unwrap());
        assert_eq!(heights.len(), 3 * shape.cells[3] + 1);
        assert!((heights[3] - heights[0] - shape.first_cell).abs() < 1e-15);
        assert!((heights[6] - heights[3] - shape.first_cell * growth.factor()).abs() < 1e-14);
        assert!((on_axis(longest).last().unwrap() / shape.outer_radius - 1.0).abs() < 1e-14);
    }
}

/// The equator of a sphere with 4 cells along x and y has 16 vertices at multiples of 22.5 degrees.
#[test]
fn cells_divide_the_angles_of_a_sphere_evenly() {
    let mesh = EllipsoidMesh { order: 2, ..SPHERE }.build().unwrap();
    let vertices = mesh.coordinates().as_chunks::<3>().0.iter();
    let equator = vertices.filter(|x| x[2].abs() < 1e-12 && norm(x) < 0.5 + 1e-12);
    let angles: Vec<f64> = equator.map(|x| x[1].atan2(x[0]) / (PI / 8.0)).collect();
    assert_eq!(angles.len(), 16 * 4);
    assert!(angles.iter().all(|angle| (angle - angle.round()).abs() < 1e-13), "{angles:?}");
}

/// Along the long semi-axes l grows with the square of h. Degree 2 does not follow the growth by 4.3^2, degree 3 does.
#[test]
fn a_flat_wall_at_order_3_needs_slow_growth() {
    let fast = EllipsoidMesh { cells: [6, 2, 8, 6], order: 3, ..WING };
    assert!((fast.growth().unwrap().factor() - 4.3358).abs() < 1e-4);
    assert!(matches!(fast.build(), Err(MeshError::Inverted { .. })));
    assert_eq!(EllipsoidMesh { order: 4, ..fast }.build().err(), None);
    let slow = EllipsoidMesh { cells: [6, 2, 8, 8], ..fast };
    assert!((slow.growth().unwrap().factor() - 2.7774).abs() < 1e-4);
    assert_eq!(slow.build().err(), None);
}

#[test]
fn cells_of_spheres_and_wings_are_valid_at_any_order() {
    for order in 2..=8 {
        for shape in [SPHERE, WING] {
            assert_eq!(EllipsoidMesh { order, ..shape }.build().err(), None, "order {order}");
        }
    }
    let thin = EllipsoidMesh { first_cell: 1e-5, cells: [4, 4, 4, 20], ..SPHERE };
    assert_eq!(thin.build().err(), None);
    for semi_axes in [[0.03, 1.5, 0.5], [1.5, 0.5, 0.03], [0.03, 0.03, 1.5]] {
        assert_eq!(EllipsoidMesh { semi_axes, cells: [4, 4, 4, 10], ..WING }.build().err(), None, "{semi_axes:?}");
    }
}

#[test]
fn impossible_ellipsoids_are_refused() {
    let refused = |mesh: EllipsoidMesh, parts: &[&str]| {
        let message = mesh.build().unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in: {message}"));
    };
    refused(
        EllipsoidMesh { semi_axes: [0.5, 0.0, 0.5], ..SPHERE },
        &["ellipsoid", "semi-axis along y is 0", "positive"],
    );
    refused(EllipsoidMesh { semi_axes: [0.5, 0.5, f64::NAN], ..SPHERE }, &["semi-axis along z is NaN"]);
    refused(EllipsoidMesh { outer_radius: 1.5, ..WING }, &["far field is 1.5", "more than every semi-axis"]);
    refused(EllipsoidMesh { outer_radius: f64::INFINITY, ..WING }, &["far field is inf"]);
    refused(EllipsoidMesh { first_cell: 0.0, ..WING }, &["first cell is 0"]);
    refused(EllipsoidMesh { first_cell: 19.51, ..SPHERE }, &["first cell is 19.51", "less than the distance"]);
    refused(EllipsoidMesh { outer_radius: 1e200, ..SPHERE }, &["first cell", "less than the distance"]);
    for (axis, name) in ["along x", "along y", "along z", "outwards"].into_iter().enumerate() {
        let mut cells = SPHERE.cells;
        cells[axis] = 0;
        refused(EllipsoidMesh { cells, ..SPHERE }, &[&format!("number of cells {name} is 0"), "1 to 100000"]);
    }
    assert_eq!(EllipsoidMesh { order: 1, ..SPHERE }.build().unwrap_err(), MeshError::Order { order: 1 });
}
