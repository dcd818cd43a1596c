//! Iso-surfaces by marching tetrahedra.

use super::super::surface::mixed;
use super::surface::TriangleSurface;
use crate::simplices::{crossings, simplices};
use tensor::cofactor;

/// The surface q = `level` in a cell on a lattice of points with `parts` parts along each axis, axis 0 fastest. In each tetrahedron q is
/// linear, and the surface a triangle or two. `values` are `[point][quantity]`.
pub fn iso_surface((points, parts): (&[[f64; 3]], usize), q: &[f64], level: f64, values: &[f64]) -> TriangleSurface {
    let tetrahedra = simplices::<3>(parts);
    let gradients = gradients(points, &tetrahedra, q);
    let quantities = values.len() / points.len();
    let mut out = TriangleSurface::default();
    for corners in &tetrahedra {
        let crossings = crossings(corners, |corner| q[corner] - level);
        let first = out.points.len();
        for &(a, b, part) in &crossings {
            out.points.push(between(&points[a], &points[b], part));
            out.normals.push(between(&gradients[a], &gradients[b], part));
            let value = |point: usize, k: usize| values[point * quantities + k];
            out.values.extend((0..quantities).map(|k| mixed([value(a, k), value(b, k)], part)));
        }
        out.triangles.extend((2..crossings.len()).map(|k| [first + k - 2, first + k - 1, first + k]));
    }
    out
}

/// Means of the gradients of q in the tetrahedra at each point, weighted by volume and not normalised.
///
/// With the edges e_j of a tetrahedron and the differences d_j of q along them, e_j . grad q = d_j:
///
/// ```text
/// det E grad q = cof E d,     E = (e_1 e_2 e_3)                                                                           (tetrahedron)
/// ```
fn gradients(points: &[[f64; 3]], tetrahedra: &[Vec<usize>], q: &[f64]) -> Vec<[f64; 3]> {
    let mut gradients = vec![[0.0; 3]; points.len()];
    for corners in tetrahedra {
        let edge = |i: usize, j: usize| points[corners[j + 1]][i] - points[corners[j]][i];
        let edges: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| edge(i, j)));
        let cofactor = cofactor(&edges);
        let side = tensor::determinant(&edges, &cofactor).signum();
        let slope = |i: usize| -> f64 { (0..3).map(|j| cofactor[i][j] * (q[corners[j + 1]] - q[corners[j]])).sum() };
        for &corner in corners {
            (0..3).for_each(|i| gradients[corner][i] += side * slope(i));
        }
    }
    gradients
}

fn between(a: &[f64; 3], b: &[f64; 3], part: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + part * (b[i] - a[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;
    use tensor::{cross, dot, norm};

    /// A curved cell around the origin: the cube [-1, 1]^3, bent, with `parts` parts along each axis.
    fn bent(parts: usize) -> Vec<[f64; 3]> {
        let n = parts + 1;
        let xi = |digit: usize| 2.0 * digit as f64 / parts as f64 - 1.0;
        let point = |[a, b, c]: [f64; 3]| [a + 0.1 * b * b, b - 0.1 * a * c, c + 0.1 * (a - b) * c];
        (0..n * n * n).map(|p| point([p % n, p / n % n, p / n / n].map(xi))).collect()
    }

    /// The sphere of radius 1/2 in a curved cell: the largest distance of its corners from the sphere, its area.
    fn sphere(parts: usize) -> [f64; 2] {
        let points = bent(parts);
        let q: Vec<f64> = points.iter().map(|x| -dot(x, x)).collect();
        let values: Vec<f64> = points.iter().flat_map(|x| [x[0], 1.0]).collect();
        let surface = iso_surface((&points, parts), &q, -0.25, &values);
        let area = |corners: &[usize; 3]| {
            let [a, b, c] = corners.map(|corner| surface.points[corner]);
            let [u, v] = [b, c].map(|end| std::array::from_fn::<f64, 3, _>(|i| end[i] - a[i]));
            0.5 * norm(&cross(&u, &v))
        };
        for ((x, n), values) in surface.points.iter().zip(&surface.normals).zip(surface.values.chunks(2)) {
            // Linear values are exact, and the normal of a sphere points to its centre where q is largest.
            assert!((values[0] - x[0]).abs() < 1e-12 && (values[1] - 1.0).abs() < 1e-12);
            assert!(dot(x, n) < -0.9 * norm(x) * norm(n), "{x:?}: {n:?}");
        }
        let distance = surface.points.iter().map(|x| (norm(x) - 0.5).abs()).fold(0.0, f64::max);
        [distance, surface.triangles.iter().map(area).sum()]
    }

    /// Corners lie on the sphere up to the curvature of q along an edge of length h, at most h^2/(4 r) here; so does the area.
    #[test]
    fn a_sphere_has_its_radius_and_area() {
        let errors = [8, 16].map(|parts| {
            let [distance, area] = sphere(parts);
            [distance, (area - PI).abs()]
        });
        let h = 2.0 / 16.0 * 3_f64.sqrt() * 1.3;
        assert!(errors[1][0] < h * h / 2.0 && errors[1][0] > 0.0, "{errors:?}");
        assert!(errors[1][1] < 0.03 * PI, "{errors:?}");
        // Second order.
        assert!((0..2).all(|k| errors[0][k] > 3.0 * errors[1][k]), "{errors:?}");
    }

    #[test]
    fn a_plane_is_exact_and_levels_beyond_the_values_are_empty() {
        let points = bent(4);
        let q: Vec<f64> = points.iter().map(|x| x[2]).collect();
        let surface = iso_surface((&points, 4), &q, 0.3, &q);
        assert!(!surface.triangles.is_empty() && surface.points.iter().all(|x| (x[2] - 0.3).abs() < 1e-14));
        assert!(surface.normals.iter().all(|n| n[2] > 0.0 && n[0].hypot(n[1]) < 1e-12 * n[2]));
        assert!(iso_surface((&points, 4), &q, 2.0, &q).triangles.is_empty());
    }
}
