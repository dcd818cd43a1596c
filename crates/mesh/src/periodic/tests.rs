//! Boundaries that are translates of each other.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::generate::Segment;
use crate::{BoxMesh, Curving};

#[test]
fn opposite_sides_of_a_box_could_be_joined() {
    let translated = |curving| {
        let cells = [3, 2];
        let frame = BoxMesh { lower: [0.0; 2], upper: [2.0, 1.0], cells, order: 3, curving, periodic: [false; 2] };
        frame.build().unwrap().scrambled(2).translated_boundaries()
    };
    let pair = |minus, plus, translation| PeriodicPair { minus, plus, translation };
    assert_eq!(translated(Curving::None), [pair(0, 1, [2.0, 0.0]), pair(2, 3, [0.0, 1.0])]);
    // Opposite sides that bulge further than their cells are thick.
    let (cells, curving) = ([32, 2], Curving::Wavy { amplitude: 0.05 });
    let frame = BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells, order: 5, curving, periodic: [true; 2] };
    assert_eq!(frame.build().unwrap().boundary_names(), [""; 0]);
    // Inside the box nodes move, on the boundary they do not.
    assert_eq!(translated(Curving::Random { amplitude: 0.02, seed: 1 }).len(), 2);
}

/// A box of `cells` cells, mapped, with a thin plate: the vertices at its places are doubled for the cells above it. `far` has all sides
/// but the periodic ones along axis 0.
fn with_plate<const D: usize>(cells: [usize; D], on_plate: impl Fn(&[f64; D]) -> bool, y: f64) -> Mesh<D> {
    let frame = BoxMesh {
        lower: [0.0; D],
        upper: cells.map(|n| n as f64),
        cells,
        order: 2,
        curving: Curving::None,
        periodic: [false; D],
    };
    let mesh = frame.build().unwrap();
    let (mut corners, doubled) = (mesh.corners.clone(), 1 + mesh.corners.iter().max().unwrap());
    for cell in 0..mesh.n_cells() {
        let nodes = mesh.cell_coordinates(cell).as_chunks::<D>().0;
        let is_above = nodes.iter().map(|x| x[1]).sum::<f64>() > y * nodes.len() as f64;
        for (k, _) in nodes.iter().enumerate().filter(|(_, x)| is_above && x[1] == y && on_plate(x)) {
            corners[(cell << D) + k] += doubled;
        }
    }
    let mut boundaries = vec![("left".to_owned(), vec![]), ("right".to_owned(), vec![]), ("far".to_owned(), vec![])];
    let mut faces: BTreeMap<Vec<usize>, Vec<Side>> = BTreeMap::new();
    for side in (0..mesh.n_cells()).flat_map(|cell| (0..2 * D).map(move |face| Side { cell, face })) {
        let place = crate::facet::face_nodes(D, 2, side.face).into_iter().map(|k| corners[(side.cell << D) + k]);
        faces.entry(crate::topology::face_key(place.collect())).or_default().push(side);
    }
    for side in faces.into_values().filter(|sides| sides.len() == 1).flatten() {
        let x = mesh.face_centre(side)[0];
        let number = if x == 0.0 {
            0
        } else if x == cells[0] as f64 {
            1
        } else {
            2
        };
        boundaries[number].1.push(side);
    }
    Mesh::new(2, corners, mesh.coordinates.clone(), boundaries, vec![]).unwrap()
}

/// The same mesh, with its boundaries joined in `pairs`.
fn in_pairs<const D: usize>(mesh: &Mesh<D>, pairs: Vec<PeriodicPair<D>>) -> Result<Mesh<D>, MeshError> {
    let sides = |boundary| {
        let facets = mesh.boundary_facets.iter().filter(move |facet| facet.boundary == boundary);
        facets.map(|facet| facet.side).collect()
    };
    let boundaries = mesh.boundary_names.iter().cloned().zip((0..).map(sides)).collect();
    Mesh::new(mesh.order, mesh.corners.clone(), mesh.coordinates.clone(), boundaries, pairs)
}

/// The same mesh, with the pair of boundaries that could be joined.
fn joined<const D: usize>(mesh: &Mesh<D>) -> Mesh<D> {
    let pairs = mesh.translated_boundaries();
    let pair = *pairs.iter().find(|pair| [pair.minus, pair.plus] == [0, 1]).unwrap();
    in_pairs(mesh, vec![pair]).unwrap()
}

/// Whether all facets join the cells at the same place of both sides, and no node moved.
fn check_joined<const D: usize>(mesh: &Mesh<D>, facets: usize) {
    let periodic = joined(mesh);
    assert_eq!(periodic.coordinates, mesh.coordinates);
    assert_eq!(periodic.boundary_names(), ["far"]);
    let joints: Vec<_> = periodic.interior_facets().iter().filter(|facet| facet.periodic).collect();
    assert_eq!(joints.len(), facets);
    for facet in joints {
        assert_eq!(mesh.face_centre(facet.minus)[1..], mesh.face_centre(facet.plus)[1..]);
    }
}

/// Each vertex took the nearest of the other side, and both sides of a plate are as near.
#[test]
fn a_plate_that_reaches_periodic_planes_is_joined_on_both_of_its_sides() {
    check_joined(&with_plate([4, 4], |_| true, 2.0), 4);
    check_joined(&with_plate([4, 4], |x| x[0] < 1.5 || x[0] > 2.5, 2.0), 4);
    check_joined(&with_plate([2, 4, 4], |x| x[2] > 0.5 && x[2] < 3.5, 2.0), 16);
    check_joined(&with_plate([2, 2, 2], |x| x[2] < 1.5, 1.0).scrambled(4), 4);
}

/// Both sides of the seam of a pipe are at the same place, up to round-off, so that vertices of the ends took those of the wrong side.
#[test]
fn a_pipe_is_closed_at_its_seam_and_joined_at_its_ends() {
    for (around, centre, turns) in [(8, 0.0, 0.0), (8, 100.0, 0.0), (8, 5.0, 1.0), (3, 100.0, 0.0)] {
        let order = if around < 8 { 8 } else { 4 };
        let frame = BoxMesh {
            lower: [1.0, 0.0, 0.0],
            upper: [2.0, 1.0, 1.0],
            cells: [2, around, 2],
            order,
            curving: Curving::None,
            periodic: [false, true, true],
        };
        let map = |x: &[f64; 3]| {
            let angle = std::f64::consts::TAU * (x[1] + turns * x[2]);
            [centre + x[0] * angle.cos(), centre + x[0] * angle.sin(), 2.0 * x[2]]
        };
        let segment = |end, cells| vec![Segment { end, cells, ratio: 1.0 }];
        let segments = [segment(2.0, 2), segment(1.0, around), segment(1.0, 2)];
        let mesh = frame.build_in_regions(&segments, &[], &map).unwrap();
        assert_eq!(mesh.boundary_names(), ["left", "right"]);
        let count = mesh.interior_facets().iter().filter(|facet| facet.periodic).count();
        assert_eq!(count, 2 * 2 + 2 * around);
    }
}

/// Both sides of a slit are in one boundary, and those of another slit in the other one: four faces have the same corners.
#[test]
fn faces_at_one_place_are_joined_with_those_that_face_them() {
    let lower = [[0.0, 0.0], [1.0, 0.0], [0.0, 5.0], [1.0, 5.0]];
    let corner = |[x, y]: [f64; 2], k: usize| [x + (k % 2) as f64, y + (k / 2) as f64];
    let coordinates = lower.iter().flat_map(|x| (0..4).flat_map(|k| corner(*x, k))).collect();
    let slit = |cell: usize| vec![Side { cell, face: 1 }, Side { cell: cell + 1, face: 0 }];
    let faces = (0..4).flat_map(|cell| (0..4).map(move |face| Side { cell, face }));
    let far = faces.filter(|side| !slit(0).contains(side) && !slit(2).contains(side)).collect();
    let boundaries = vec![("minus".to_owned(), slit(0)), ("plus".to_owned(), slit(2)), ("far".to_owned(), far)];
    let pair = PeriodicPair { minus: 0, plus: 1, translation: [0.0, 5.0] };
    let mesh = Mesh::new(2, (0..16).collect(), coordinates, boundaries, vec![pair]).unwrap();
    let cells: Vec<_> = mesh.interior_facets().iter().map(|facet| [facet.minus.cell, facet.plus.cell]).collect();
    assert_eq!(cells, [[0, 3], [1, 2]]);
}

/// A box of 2 cells along each axis, all sides periodic, whose nodes have an error of `error`.
fn shaken<const D: usize>(order: usize, error: f64) -> Result<Mesh<D>, MeshError> {
    let (curving, periodic) = (Curving::Wavy { amplitude: 0.03 }, [false; D]);
    let frame = BoxMesh { lower: [3.0; D], upper: [4.5; D], cells: [2; D], order, curving, periodic };
    let mut mesh = frame.build().unwrap();
    let (count, numbers) = crate::numbering::numbered(&mesh, order, |_| true);
    let mut random = crate::random::SplitMix64::new(3);
    let moves: Vec<[f64; D]> = (0..count).map(|_| std::array::from_fn(|_| error * random.symmetric())).collect();
    for (x, number) in mesh.coordinates.as_chunks_mut::<D>().0.iter_mut().zip(numbers) {
        *x = std::array::from_fn(|i| x[i] + moves[number][i]);
    }
    let translation = |axis| std::array::from_fn(|i| if i == axis { 1.5 } else { 0.0 });
    let pairs = (0..D).map(|axis| PeriodicPair { minus: 2 * axis, plus: 2 * axis + 1, translation: translation(axis) });
    in_pairs(&mesh, pairs.collect())
}

/// Nodes of a file with ten digits kept two positions, and a uniform flow stayed uniform only up to their distance.
#[test]
fn images_of_nodes_are_exact_translates() {
    fn check<const D: usize>(order: usize) {
        let mesh = shaken::<D>(order, 1e-10).unwrap();
        for facet in mesh.interior_facets().iter().filter(|facet| facet.periodic) {
            let (minus, plus) = (mesh.face_positions(facet.minus), mesh.face_positions(facet.plus));
            for (k, x) in minus.iter().enumerate() {
                let y = plus[facet.orientation.plus_index(D - 1, order, k)];
                let first = plus[facet.orientation.plus_index(D - 1, order, 0)];
                let differs = |i: usize| ((y[i] - x[i]) - (first[i] - minus[0][i])).abs();
                assert!((0..D).all(|i| differs(i) < 1e-14), "{x:?} {y:?}");
            }
        }
        let exact = shaken::<D>(order, 0.0).unwrap();
        let moved = mesh.coordinates.iter().zip(&exact.coordinates).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(moved < 2e-10 && moved > 1e-12, "{moved:e}");
    }
    check::<2>(2);
    check::<2>(5);
    check::<3>(2);
    check::<3>(4);
}

/// Faces with edges of 1e-6 and of `height` at a wall, in a mesh with a diameter of 1400 and an error of the translation of `error`.
fn thin(height: f64, error: f64) -> Result<Mesh<2>, MeshError> {
    let nodes = [[0.0, 0.0], [1e3, 0.0], [0.0, 1e-6], [1e3, height], [0.0, 1e3], [1e3, 1e3]];
    let corners = vec![0, 1, 2, 3, 2, 3, 4, 5];
    let coordinates = corners.iter().flat_map(|&k: &usize| nodes[k]).collect();
    let on = |face| vec![Side { cell: 0, face }, Side { cell: 1, face }];
    let far = vec![Side { cell: 0, face: 2 }, Side { cell: 1, face: 3 }];
    let boundaries = vec![("l".to_owned(), on(0)), ("r".to_owned(), on(1)), ("far".to_owned(), far)];
    let pairs = vec![PeriodicPair { minus: 0, plus: 1, translation: [1e3, error] }];
    Mesh::new(2, corners, coordinates, boundaries, pairs)
}

/// The tolerance was that of the diameter of the mesh alone, as large as the cells at a wall.
#[test]
fn thin_faces_have_a_tolerance_of_their_own() {
    // The translation between the sides of a file with few digits is less exact than thin faces are.
    assert!(thin(1e-6, 0.0).is_ok() && thin(1e-6, 1e-8).is_ok());
    for (height, largest) in [(1.4e-6, 0.25e-6), (1.1e-6, 1e-10)] {
        let error = thin(height, 0.0).unwrap_err();
        let MeshError::PeriodicMismatch { distance, tolerance, .. } = error else { unreachable!("{error}") };
        assert!((distance - (height - 1e-6)).abs() < 1e-12, "{distance:e}");
        assert!((tolerance / largest - 1.0).abs() < 0.5, "{tolerance:e}");
    }
}

/// The translation was that between the means: all nodes were apart by the mean error, and the first one, which is right, was named.
#[test]
fn one_wrong_point_does_not_change_the_translation() {
    let from: Vec<[f64; 2]> = (0..7).map(|i| [0.1 * f64::from(i), f64::from(i * i % 5)]).collect();
    let mut to: Vec<[f64; 2]> = from.iter().map(|x| [x[0] + 0.25, x[1] - 2.0]).rev().collect();
    to[2][0] += 1e-3;
    let found = translation(&from, &to);
    assert!((found[0] - 0.25).abs() < 1e-15 && found[1] == -2.0, "{found:?}");
}

/// Nodes of periodic sides moved walls between these sides out of their planes, by the mean of their noise.
#[test]
fn aligned_nodes_stay_on_planes_along_the_translation() {
    let frame = BoxMesh {
        lower: [0.0; 2],
        upper: [1.0; 2],
        cells: [2; 2],
        order: 4,
        curving: Curving::None,
        periodic: [false; 2],
    };
    let mut mesh = frame.build().unwrap();
    let right = mesh.coordinates.as_chunks_mut::<2>().0.iter_mut().filter(|x| x[0] == 1.0);
    right.filter(|x| x[1] > 0.0 && x[1] < 1.0).for_each(|x| x[1] += 1e-10 * x[1]);
    let pair = PeriodicPair { minus: 0, plus: 1, translation: [1.0, 0.0] };
    let mesh = in_pairs(&mesh, vec![pair]).unwrap();
    let heights = mesh.coordinates.as_chunks::<2>().0.iter().map(|x| x[1]);
    assert!(heights.clone().all(|y| y == 0.0 || y > 0.01), "the bottom");
    assert!(heights.clone().all(|y| y == 1.0 || y < 0.99), "the top");
}

/// Small cells far from the origin had gaps of the last place of their coordinates.
#[test]
fn no_gap_is_smaller_than_rounding() {
    let far = |size: f64| {
        let (lower, upper) = ([1e6; 2], [1e6 + size; 2]);
        let frame = BoxMesh { lower, upper, cells: [2; 2], order: 2, curving: Curving::None, periodic: [false; 2] };
        gap_tolerance(&frame.build().unwrap())
    };
    assert!(far(0.1) > 1e-9 && far(0.1) < 1e-8, "{:e}", far(0.1));
    assert!(far(1e3) > 1e-6, "{:e}", far(1e3));
}
