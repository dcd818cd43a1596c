//! Triangles, tetrahedra and prisms, alone and mixed with quadrilaterals and hexahedra, are split.

use super::contents::{Contents, Encoding};
use super::drawing::{Drawing, all_shapes, extruded, square, tetrahedra};
use crate::gmsh::shape::Shape;
use crate::gmsh::{GmshError, Simplices};
use crate::{CellMap, Mesh, MeshError, Side, ValidityCheck, outward_area};
use basis::gauss_lobatto;

type Position = [f64; 3];

/// How far the domain is stretched: the map takes x = 1 to 1 + STRETCH.
const STRETCH: f64 = 0.1;

fn split<const D: usize>(contents: &Contents) -> Result<Mesh<D>, GmshError> {
    Mesh::from_gmsh_with(&contents.version4(Encoding::Text), &[], Simplices::Split)
}

/// A polynomial map of total degree p in D dimensions. Coordinate a depends on coordinates up to a, so on the unit
/// square or cube
///
/// ```text
/// X_a = x_a + s (x_0 + .. + x_{a-1})^p + c x_a^p,     volume = prod_a int (1 + c p x_a^{p-1}) dx_a = (1 + c)^D
/// ```
fn curved<const D: usize>(degree: usize) -> impl Fn(Position) -> Position {
    let power = move |x: f64| x.powi(degree as i32);
    move |x| {
        let moved = |a: usize| x[a] + 0.05 * power(x[..a].iter().sum()) * f64::from(a > 0) + STRETCH * power(x[a]);
        std::array::from_fn(|a| if a < D { moved(a) } else { x[a] })
    }
}

fn in_space(x: &[f64]) -> Position {
    [x[0], x[1], x.get(2).copied().unwrap_or(0.0)]
}

/// The curved split mesh is the straight split mesh, moved by the same map: every node, to round-off.
///
/// This fails if a node of the file is taken for another one, if the split is not exact, or if cells differ.
fn check_exact<const D: usize>(drawing: &Drawing, degree: usize) -> Mesh<D> {
    let straight = split::<D>(&drawing.file(1, |x| x)).unwrap().with_order(degree + 1);
    let mesh = split::<D>(&drawing.file(degree, curved::<D>(degree))).unwrap();
    assert_eq!(mesh.order(), degree + 1);
    assert_eq!(mesh.interior_facets(), straight.interior_facets());
    assert_eq!(
        (mesh.boundary_names(), mesh.boundary_facets()),
        (straight.boundary_names(), straight.boundary_facets())
    );
    assert_eq!(mesh.regions(), straight.regions());
    for (x, moved) in straight.coordinates().chunks_exact(D).zip(mesh.coordinates().chunks_exact(D)) {
        let expected = curved::<D>(degree)(in_space(x));
        assert!((0..D).all(|i| (expected[i] - moved[i]).abs() < 1e-13), "degree {degree}: {expected:?} {moved:?}");
    }
    mesh
}

/// The sum of the outward area vectors of some faces, exactly: each has degree 2 p (or p) along each axis.
fn area<const D: usize>(mesh: &Mesh<D>, sides: impl Iterator<Item = Side>) -> [f64; D] {
    let rule = gauss_lobatto(mesh.order() + 2);
    let mut sum = [0.0; D];
    for side in sides {
        let (axis, high) = (side.face / 2, side.face % 2);
        let end = [[-1.0], [1.0]][high];
        let points: [&[f64]; D] = std::array::from_fn(|a| if a == axis { &end[..] } else { &rule.points[..] });
        let jacobians = CellMap::new(mesh.order(), points).jacobians(mesh.cell_coordinates(side.cell));
        let n = rule.weights.len();
        for (q, jacobian) in jacobians.iter().enumerate() {
            let weight = (0..D - 1).map(|a| rule.weights[q / n.pow(a as u32) % n]).product::<f64>();
            let normal = outward_area(jacobian, side.face);
            (0..D).for_each(|i| sum[i] += weight * normal[i]);
        }
    }
    sum
}

/// A uniform flow through each cell, and through the mesh, leaves nothing behind; the boundary at x = 0 is a unit plane.
fn check_closed<const D: usize>(mesh: &Mesh<D>) {
    let is_zero = |area: [f64; D]| area.iter().all(|x| x.abs() < 1e-13);
    for cell in 0..mesh.n_cells() {
        assert!(is_zero(area(mesh, (0..2 * D).map(|face| Side { cell, face }))), "cell {cell}");
    }
    assert!(is_zero(area(mesh, mesh.boundary_facets().iter().map(|facet| facet.side))));
}

fn facets_of<const D: usize>(mesh: &Mesh<D>, name: &str) -> usize {
    let boundary = mesh.boundary_names().iter().position(|known| known == name).unwrap();
    mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary).count()
}

fn region_sizes<const D: usize>(mesh: &Mesh<D>) -> Vec<(&str, usize)> {
    mesh.regions().iter().map(|region| (&region.name[..], region.cells.len())).collect()
}

#[test]
fn curved_triangles_are_exact() {
    for degree in 1..=6 {
        let mesh = check_exact::<2>(&square(4, |_, _| true).shaken(degree as u64), degree);
        assert_eq!(mesh.n_cells(), 3 * 32);
        assert!((mesh.volume() - (1.0 + STRETCH).powi(2)).abs() < 1e-13, "degree {degree}: {}", mesh.volume());
        check_closed(&mesh);
        assert_eq!([facets_of(&mesh, "left"), facets_of(&mesh, "right"), facets_of(&mesh, "other")], [8, 8, 16]);
        assert_eq!(region_sizes(&mesh), [("near", 48), ("far", 48)]);
    }
}

#[test]
fn curved_tetrahedra_are_exact() {
    for degree in 1..=4 {
        let mesh = check_exact::<3>(&tetrahedra(2).shaken(degree as u64), degree);
        assert_eq!(mesh.n_cells(), 4 * 48);
        assert!((mesh.volume() - (1.0 + STRETCH).powi(3)).abs() < 1e-13, "degree {degree}: {}", mesh.volume());
        check_closed(&mesh);
        // Eight triangles on each side.
        assert_eq!([facets_of(&mesh, "left"), facets_of(&mesh, "right"), facets_of(&mesh, "other")], [24, 24, 96]);
        assert_eq!(region_sizes(&mesh), [("near", 96), ("far", 96)]);
    }
}

/// Prisms of an extruded mesh are not cut along z.
#[test]
fn curved_prisms_are_exact_and_become_three_hexahedra() {
    for degree in 1..=4 {
        let mesh = check_exact::<3>(&extruded(&square(2, |_, _| true), 2).shaken(degree as u64), degree);
        assert_eq!(mesh.n_cells(), 3 * 16);
        assert!((mesh.volume() - (1.0 + STRETCH).powi(3)).abs() < 1e-13, "degree {degree}: {}", mesh.volume());
        check_closed(&mesh);
        assert_eq!([facets_of(&mesh, "left"), facets_of(&mesh, "right"), facets_of(&mesh, "other")], [8, 8, 64]);
    }
}

/// A column of triangles in squares: rows of squares are cut along x, the triangles' column along both axes.
#[test]
fn quadrilaterals_are_cut_where_triangles_need_it() {
    for degree in 1..=4 {
        let mesh = check_exact::<2>(&square(4, |i, _| i == 1).shaken(degree as u64), degree);
        // 8 triangles; 12 squares cut in one direction.
        assert_eq!(mesh.n_cells(), 3 * 8 + 2 * 12);
        check_closed(&mesh);
        assert_eq!([facets_of(&mesh, "left"), facets_of(&mesh, "right"), facets_of(&mesh, "other")], [8, 8, 10]);
        let mesh = check_exact::<2>(&square(4, |i, j| (i, j) == (1, 2)), degree);
        // 2 triangles, 6 squares beside, above and below them, 9 that are left alone.
        assert_eq!(mesh.n_cells(), 3 * 2 + 2 * 6 + 9);
        let mesh = check_exact::<3>(&extruded(&square(3, |i, j| (i, j) == (1, 2)), 2), degree);
        assert_eq!(mesh.n_cells(), 2 * (3 * 2 + 2 * 4 + 4));
        check_closed(&mesh);
    }
}

#[test]
fn all_shapes_fit_together() {
    for degree in 1..=4 {
        let mesh = check_exact::<3>(&all_shapes(), degree);
        // Every edge of the prisms is cut, and the edges of the hexahedron along y and z.
        assert_eq!(mesh.n_cells(), 3 * 6 + 2 * 4 + 4);
        check_closed(&mesh);
    }
}

/// Two tetrahedra with a common face, the corners of each listed in all 24 orders: the face must be seen alike.
#[test]
fn neighbours_in_any_orientation_share_their_face() {
    let corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]].map(|x| x.map(f64::from)).to_vec();
    let all = |places: [usize; 4]| orders(4).into_iter().map(move |order| order.iter().map(|&k| places[k]).collect());
    let (firsts, seconds): (Vec<Vec<usize>>, Vec<Vec<usize>>) =
        (all([0, 1, 2, 3]).collect(), all([4, 1, 2, 3]).collect());
    for (i, first) in firsts.iter().enumerate() {
        for (j, second) in seconds.iter().enumerate() {
            let cells = vec![(Shape::Tetrahedron, first.clone()), (Shape::Tetrahedron, second.clone())];
            let drawing = Drawing { dimension: 3, corners: corners.clone(), cells };
            // The face has one inner node at degree 3, three at degree 4.
            let mesh = check_exact::<3>(&drawing, if i == 0 || j == 0 { 4 } else { 3 });
            assert_eq!((mesh.n_cells(), mesh.interior_facets().len()), (8, 2 * 6 + 3));
        }
    }
}

/// (quality), for cells of any form.
#[test]
fn pieces_of_straight_cells_have_the_documented_quality() {
    fn scaled_jacobians<const D: usize>(drawing: &Drawing) -> Vec<f64> {
        let mesh = split::<D>(&drawing.file(1, |x| x)).unwrap();
        let check = ValidityCheck::<D>::new(mesh.order(), &[0.0]);
        (0..mesh.n_cells()).map(|cell| check.bound(mesh.cell_coordinates(cell)).scaled_jacobian()).collect()
    }
    let near = |values: Vec<f64>, expected: f64| values.iter().all(|value| (value - expected).abs() < 1e-12);
    assert!(near(scaled_jacobians::<2>(&square(3, |_, _| true).shaken(7)), 1.0 / 3.0));
    assert!(near(scaled_jacobians::<3>(&extruded(&square(3, |_, _| true), 1)), 1.0 / 3.0));
    assert!(near(scaled_jacobians::<3>(&tetrahedra(2).shaken(7)), 2.0 / 27.0));
}

fn orders(n: usize) -> Vec<Vec<usize>> {
    if n == 0 {
        return vec![Vec::new()];
    }
    let inserted = |order: &Vec<usize>, place: usize| {
        let mut longer = order.clone();
        longer.insert(place, n - 1);
        longer
    };
    orders(n - 1).iter().flat_map(|order| (0..n).map(move |place| inserted(order, place))).collect()
}

#[test]
fn every_version_and_encoding_gives_the_same_pieces() {
    let plane = square(3, |i, j| i + j > 2).shaken(5).file(3, curved::<2>(3));
    let space = all_shapes().file(2, curved::<3>(2));
    for encoding in Encoding::ALL {
        for version in [Contents::version2, Contents::version4] {
            let read = Mesh::<2>::from_gmsh_with(&version(&plane, encoding), &[], Simplices::Split);
            assert_eq!(read.unwrap(), split::<2>(&plane).unwrap());
            let read = Mesh::<3>::from_gmsh_with(&version(&space, encoding), &[], Simplices::Split);
            assert_eq!(read.unwrap(), split::<3>(&space).unwrap());
        }
    }
}

#[test]
fn a_mesh_without_simplices_stays_as_it_is() {
    let file = square(3, |_, _| false).shaken(1).file(4, curved::<2>(4)).version4(Encoding::Text);
    assert_eq!(Mesh::<2>::from_gmsh_with(&file, &[], Simplices::Split), Mesh::<2>::from_gmsh(&file, &[]));
}

/// Three quadrilaterals around a point, one of them two triangles. The strip of cells from the lower half of "left" ends
/// at the upper half of "right", so without the twins one half of each would be cut, and not the same.
#[test]
fn periodic_boundaries_are_cut_alike() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [1.0, 1.0], [0.0, 1.0], [0.0, 0.5], [0.45, 0.5]];
    let (whole, triangle) = (Shape::Quadrilateral, Shape::Triangle);
    let cells = vec![
        (triangle, vec![6, 5, 0]),
        (triangle, vec![6, 0, 1]),
        (whole, vec![6, 1, 2, 3]),
        (whole, vec![6, 3, 4, 5]),
    ];
    let drawing = Drawing { dimension: 2, corners: corners.map(|[x, y]| [x, y, 0.0]).to_vec(), cells };
    let file = drawing.file(1, |[x, y, z]| [x + 0.2 - 0.4 * (y - 0.5).abs(), y, z]).version2(Encoding::Text);
    let joined = [("left".to_owned(), "right".to_owned())];
    let mesh = Mesh::<2>::from_gmsh_with(&file, &joined, Simplices::Split).unwrap();
    assert_eq!((mesh.n_cells(), mesh.boundary_names()), (3 + 3 + 4 + 4, &["other".to_owned()][..]));
    assert_eq!(mesh.interior_facets().iter().filter(|facet| facet.periodic).count(), 4);
    // Apart, the two boundaries have three facets each.
    let mesh = Mesh::<2>::from_gmsh_with(&file, &[], Simplices::Split).unwrap();
    assert_eq!([facets_of(&mesh, "left"), facets_of(&mesh, "right")], [3, 3]);
}

/// The translation was that between the means: no edges coincided, the boundaries were cut in different ways, and the error counted faces.
#[test]
fn one_wrong_node_of_a_periodic_boundary_is_named() {
    let drawing = square(6, |i, j| i % 5 == 0 && j > 1);
    let moved = |[x, y, z]: [f64; 3]| [x, if x == 1.0 && y == 0.5 { 0.501 } else { y }, z];
    let file = drawing.file(1, moved).version2(Encoding::Text);
    let joined = [("left".to_owned(), "right".to_owned())];
    let error = Mesh::<2>::from_gmsh_with(&file, &joined, Simplices::Split).unwrap_err().to_string();
    // The middle between the wrong node and the one below.
    assert!(error.contains("the point [1.0, 0.417") && error.contains("of \"right\" is 5.0000"), "{error}");
}

#[test]
fn simplices_are_refused_with_both_remedies() {
    let refused = |drawing: &Drawing| {
        let file = drawing.file(2, |x| x).version4(Encoding::Text);
        match drawing.dimension {
            2 => Mesh::<2>::from_gmsh(&file, &[]).unwrap_err().to_string(),
            _ => Mesh::<3>::from_gmsh(&file, &[]).unwrap_err().to_string(),
        }
    };
    let cases = [
        (square(3, |i, _| i == 0), "6 triangles", "Mesh.SubdivisionAlgorithm = 1"),
        (tetrahedra(1), "6 tetrahedra", "Mesh.SubdivisionAlgorithm = 2"),
        (extruded(&square(2, |_, _| true), 1), "8 prisms", "Mesh.SubdivisionAlgorithm = 2"),
    ];
    for (drawing, count, subdivision) in cases {
        let message = refused(&drawing);
        for part in [count, subdivision, "Mesh.RecombineAll", "mesh.split_simplices = true"] {
            assert!(message.contains(part), "no {part} in: {message}");
        }
    }
    // Triangles are no mesh in space, so the file is one of the plane.
    let file = square(2, |_, _| true).file(1, |x| x).version4(Encoding::Text);
    let error = Mesh::<3>::from_gmsh(&file, &[]).unwrap_err();
    assert_eq!(error, GmshError::Dimension { dimension: 3, surface: 8, volume: 0 });
}

#[test]
fn an_inverted_piece_is_named_by_its_element_with_the_remedy() {
    // The middle of an edge of the first cell goes beyond the opposite corner.
    let mut contents = square(1, |_, _| true).file(2, |x| x);
    let (first, triangle) = contents.elements.iter().enumerate().find(|(_, element)| element.0 == 9).unwrap();
    let middle = triangle.2[3];
    contents.nodes[middle - 1] = [0.5, 2.0, 0.0];
    let error = split::<2>(&contents).unwrap_err();
    let GmshError::Cell { element, degree: 2, source: MeshError::Inverted { .. } } = error else {
        unreachable!("{error}")
    };
    assert_eq!(element, first as u64 + 1);
    assert!(error.to_string().contains("Mesh.HighOrderOptimize"), "{error}");
}
