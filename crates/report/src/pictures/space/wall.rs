//! Walls as surfaces.

use super::super::bounds::in_space;
use super::surface::TriangleSurface;
use crate::pictures::scheme::PARTS;
use crate::pictures::snapshot::Snapshot;
use crate::simplices::simplices;
use tensor::cross;

/// A face of a cell on a wall, seen from the flow.
pub fn wall_surface<const D: usize>(
    snapshot: &Snapshot<D>,
    cell: usize,
    face: usize,
    fineness: usize,
) -> TriangleSurface {
    let points = snapshot.points(cell, fineness);
    let nodes = mesh::face_nodes(D, PARTS[fineness] + 1, face).into_iter();
    let quantities = snapshot.quantities();
    lattice_surface(nodes.map(|node| in_space(&points[node])).collect(), PARTS[fineness], face, quantities)
}

/// A lattice of points on the face `face` of a cell. The normals point into the cell.
fn lattice_surface(points: Vec<[f64; 3]>, parts: usize, face: usize, quantities: usize) -> TriangleSurface {
    let inward = -mesh::tangent_sign(face);
    let normal = |p: usize| {
        let tangents = [0, 1].map(|axis| tangent(&points, parts, p, axis));
        cross(&tangents[0], &tangents[1]).map(|n| inward * n)
    };
    TriangleSurface {
        normals: (0..points.len()).map(normal).collect(),
        values: vec![f64::NAN; quantities * points.len()],
        triangles: simplices::<2>(parts).into_iter().map(|corners| [corners[0], corners[1], corners[2]]).collect(),
        points,
        one_sided: true,
    }
}

/// The difference of the neighbours of point `p` along an axis of the lattice.
fn tangent(points: &[[f64; 3]], parts: usize, p: usize, axis: usize) -> [f64; 3] {
    let stride = (parts + 1).pow(axis as u32);
    let place = p / stride % (parts + 1);
    let before = if place > 0 { p - stride } else { p };
    let after = if place < parts { p + stride } else { p };
    std::array::from_fn(|i| points[after][i] - points[before][i])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The faces of the unit cube: every normal points toward its centre.
    #[test]
    fn normals_point_into_the_cell() {
        let lattice: Vec<[f64; 3]> =
            (0..27).map(|p| [p % 3, p / 3 % 3, p / 9].map(|digit: i32| 0.5 * f64::from(digit))).collect();
        for face in 0..6 {
            let points = mesh::face_nodes(3, 3, face).into_iter().map(|node| lattice[node]).collect();
            let surface = lattice_surface(points, 2, face, 1);
            assert_eq!(surface.triangles.len(), 8);
            for (x, n) in surface.points.iter().zip(&surface.normals) {
                let inward: f64 = (0..3).map(|i| (0.5 - x[i]) * n[i]).sum();
                assert!(inward > 0.0, "face {face}: {n:?} at {x:?}");
            }
        }
    }
}
