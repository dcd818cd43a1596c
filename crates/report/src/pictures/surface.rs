//! The drawn part of a cell: in two dimensions the cell itself, in three its cut with a plane.

use super::patch::Patch;
use super::plane::Plane;
use super::raster::Triangles;
use crate::simplices::{crossed_simplices, crossings, simplices};

/// A straight piece of a line.
pub type LineSegment = [[f64; 2]; 2];

/// The drawn part of a cell: in two dimensions the cell itself, in three the cut with `plane`.
pub fn surface<const D: usize>(patch: &Patch<D>, plane: Plane) -> Triangles {
    let quantities = patch.values.len() / patch.points.len();
    let mut out = Triangles::default();
    if D == 2 {
        out.points = patch.points.iter().map(|x| [x[0], x[1]]).collect();
        out.values.clone_from(&patch.values);
        out.triangles =
            simplices::<D>(patch.parts).into_iter().map(|corners| std::array::from_fn(|i| corners[i])).collect();
        return out;
    }
    let heights: Vec<f64> = patch.points.iter().map(|point| plane.height(point)).collect();
    for corners in crossed_simplices::<D>(patch.parts, &heights) {
        let crossings = crossings(&corners, |corner| heights[corner]);
        let first = out.points.len();
        for &(a, b, part) in &crossings {
            out.points.push(between(plane, [&patch.points[a], &patch.points[b]], part));
            let value = |point: usize, q: usize| patch.values[point * quantities + q];
            out.values.extend((0..quantities).map(|q| mixed([value(a, q), value(b, q)], part)));
        }
        // Three corners, or four in an order in which two triangles make the cut.
        out.triangles.extend((2..crossings.len()).map(|k| [first + k - 2, first + k - 1, first + k]));
    }
    out
}

/// The value at the fraction `part` of the way from a to b. Structures have the same infinite value everywhere.
pub fn mixed([a, b]: [f64; 2], part: f64) -> f64 {
    if a == b { a } else { a + part * (b - a) }
}

/// The visible lines of face `face` of a cell.
pub fn face_lines<const D: usize>(points: &[[f64; D]], parts: usize, face: usize, plane: Plane) -> Vec<LineSegment> {
    let nodes = mesh::face_nodes(D, parts + 1, face);
    if D == 2 {
        let point = |node: usize| [points[node][0], points[node][1]];
        return nodes.windows(2).map(|pair| [point(pair[0]), point(pair[1])]).collect();
    }
    let heights: Vec<f64> = nodes.iter().map(|&node| plane.height(&points[node])).collect();
    let cut = |corners: Vec<usize>| {
        let end = |&(a, b, part): &(usize, usize, f64)| between(plane, [&points[nodes[a]], &points[nodes[b]]], part);
        let ends: Vec<[f64; 2]> = crossings(&corners, |corner| heights[corner]).iter().map(end).collect();
        (ends.len() == 2).then(|| [ends[0], ends[1]])
    };
    crossed_simplices::<2>(parts, &heights).into_iter().filter_map(cut).collect()
}

/// In the picture of a plane: the point at the fraction `part` of the way from `a` to `b`.
fn between<const D: usize>(plane: Plane, [a, b]: [&[f64; D]; 2], part: f64) -> [f64; 2] {
    plane.axes().map(|i| a[i] + part * (b[i] - a[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit cube or square cut into 4^D parts, with the value x + 2 y + 4 z.
    fn unit<const D: usize>() -> Patch<D> {
        let point =
            |p: usize| -> [f64; D] { std::array::from_fn(|axis| (p / 5_usize.pow(axis as u32) % 5) as f64 / 4.0) };
        let points: Vec<[f64; D]> = (0..5_usize.pow(D as u32)).map(point).collect();
        let values = points.iter().map(|x| (0..D).map(|i| x[i] * 2_f64.powi(i as i32)).sum()).collect();
        Patch { parts: 4, points, values }
    }

    fn area(surface: &Triangles) -> f64 {
        let area =
            |[a, b, c]: [[f64; 2]; 3]| 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
        surface.triangles.iter().map(|corners| area(corners.map(|corner| surface.points[corner]))).sum()
    }

    #[test]
    fn a_cut_has_the_area_and_the_values_of_the_plane() {
        for (axis, at) in [(2, 0.1), (2, 0.5), (2, 0.83), (0, 0.3), (1, 0.6)] {
            let plane = Plane { axis, at };
            let cut = surface(&unit::<3>(), plane);
            assert!((area(&cut) - 1.0).abs() < 1e-12, "{plane:?}: {}", area(&cut));
            let factor = |axis: usize| 2_f64.powi(axis as i32);
            let [right, up] = plane.axes().map(factor);
            for ([x, y], value) in cut.points.iter().zip(&cut.values) {
                assert!((value - (right * x + up * y + factor(axis) * at)).abs() < 1e-12);
            }
        }
        assert!(surface(&unit::<3>(), Plane { axis: 2, at: 1.5 }).triangles.is_empty());
        assert!((area(&surface(&unit::<2>(), Plane::ALL_OF_2D)) - 1.0).abs() < 1e-12);
    }

    /// Cuts through structures were white.
    #[test]
    fn a_structure_keeps_its_value_in_a_cut() {
        let mut structure = unit::<3>();
        structure.values.fill(super::super::patch::OF_STRUCTURE);
        let cut = surface(&structure, Plane { axis: 2, at: 0.1 });
        assert!(!cut.values.is_empty() && cut.values.iter().all(|value| *value == f64::INFINITY));
    }

    #[test]
    fn the_lines_of_a_face_have_its_length() {
        let length =
            |lines: Vec<LineSegment>| -> f64 { lines.iter().map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1])).sum() };
        for axis in 0..3 {
            let cut = Plane { axis, at: 0.3 };
            for face in 0..6 {
                // Faces parallel to the plane do not meet it.
                let expected = if face / 2 == axis { 0.0 } else { 1.0 };
                let length = length(face_lines(&unit::<3>().points, 4, face, cut));
                assert!((length - expected).abs() < 1e-12, "{axis}, {face}: {length}");
            }
        }
        for face in 0..4 {
            assert!((length(face_lines(&unit::<2>().points, 4, face, Plane::ALL_OF_2D)) - 1.0).abs() < 1e-12);
        }
    }
}
