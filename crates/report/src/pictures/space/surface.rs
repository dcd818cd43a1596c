//! Surfaces of triangles in space.

use super::super::bounds::Cuboid;
use super::places::Places;
use tensor::norm;

/// Triangles with a normal and several values at each corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleSurface {
    /// The corners.
    pub points: Vec<[f64; 3]>,
    /// A vector along the normal at each corner, of any length.
    pub normals: Vec<[f64; 3]>,
    /// Values at the corners, `[corner][quantity]`; NaN on walls.
    pub values: Vec<f64>,
    /// The triangles, by their corners.
    pub triangles: Vec<[usize; 3]>,
    /// Whether only the side to which the normals point is seen.
    pub one_sided: bool,
}

impl TriangleSurface {
    /// All surfaces as one. They have the same quantities and sides.
    pub fn joined(surfaces: Vec<TriangleSurface>) -> Self {
        let mut all = TriangleSurface::default();
        for surface in surfaces {
            let first = all.points.len();
            all.triangles.extend(surface.triangles.iter().map(|corners| corners.map(|corner| first + corner)));
            all.points.extend(surface.points);
            all.normals.extend(surface.normals);
            all.values.extend(surface.values);
            all.one_sided = surface.one_sided;
        }
        all
    }

    /// The same surface with one normal at each place: the mean of those that its parts have there. So the light shows no edges between cells.
    pub fn with_common_normals(mut self, places: Places) -> Self {
        let unit = |n: &[f64; 3]| n.map(|component| component / norm(n).max(f64::MIN_POSITIVE));
        let sums = places.sums(self.points.iter().zip(&self.normals).map(|(point, normal)| (point, unit(normal))));
        self.normals =
            self.points.iter().map(|point| sums.get(&places.of(point)).copied().unwrap_or_default()).collect();
        self
    }

    /// The triangles with their first corner in a box.
    pub fn within(mut self, outer: Cuboid) -> Self {
        let points = &self.points;
        self.triangles.retain(|corners| outer.contains(&points[corners[0]]));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_have_a_common_normal_where_they_meet() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let part = |normal: [f64; 3], other: usize| TriangleSurface {
            points: vec![points[0], points[1], points[other]],
            normals: vec![normal; 3],
            ..TriangleSurface::default()
        };
        let both = TriangleSurface::joined(vec![part([0.0, 0.0, 2.0], 2), part([0.0, 4.0, 0.0], 3)]);
        let normals = both.with_common_normals(Places::new(1.0)).normals;
        assert_eq!((normals[0], normals[1], normals[2]), ([0.0, 1.0, 1.0], normals[4], [0.0, 0.0, 1.0]));
    }

    #[test]
    fn joined_surfaces_keep_their_corners() {
        let one = |x: f64| TriangleSurface {
            points: vec![[x; 3]; 3],
            normals: vec![[0.0; 3]; 3],
            values: vec![x; 3],
            triangles: vec![[0, 1, 2]],
            one_sided: true,
        };
        let both = TriangleSurface::joined(vec![one(1.0), one(2.0)]);
        assert_eq!(both.triangles, [[0, 1, 2], [3, 4, 5]]);
        assert_eq!((both.points[3], both.values[3], both.one_sided), ([2.0; 3], 2.0, true));
        let near = both.within(Cuboid { lower: [0.0; 3], upper: [1.5; 3] });
        assert_eq!(near.triangles, [[0, 1, 2]]);
    }
}
