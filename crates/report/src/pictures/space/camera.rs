//! Directions of pictures in space. Rays are parallel.

use super::super::bounds::{Cuboid, Extent};
use tensor::{cross, dot};

/// A direction from which surfaces are seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Its name in the page.
    pub label: &'static str,
    /// The direction in words.
    pub direction: &'static str,
    /// The unit vector to the right of the picture.
    right: [f64; 3],
    /// The unit vector upward in the picture.
    up: [f64; 3],
    /// The unit vector from the surfaces toward the eye.
    toward: [f64; 3],
}

impl Camera {
    /// All directions. The axis y points upward, as in pictures of the plane.
    pub fn all() -> [Camera; 4] {
        [
            Camera::at("vortices, oblique", "seen obliquely from the side of low x and high z", -40.0, 25.0),
            Camera::at("vortices, from behind", "seen obliquely from the side of high x and low z", 140.0, 25.0),
            Camera::at("vortices, along z", "seen against the axis z", 0.0, 0.0),
            Camera::at("vortices, along y", "seen against the axis y", 0.0, 90.0),
        ]
    }

    /// The direction with angles in degrees: around the axis y from the axis z toward x, and above the plane of x and z.
    ///
    /// ```text
    /// toward = (cos e sin a, sin e, cos e cos a),     right = (cos a, 0, -sin a),     up = toward x right                      (camera)
    /// ```
    fn at(label: &'static str, direction: &'static str, around: f64, above: f64) -> Self {
        let ((sin_a, cos_a), (sin_e, cos_e)) = (around.to_radians().sin_cos(), above.to_radians().sin_cos());
        let (toward, right) = ([cos_e * sin_a, sin_e, cos_e * cos_a], [cos_a, 0.0, -sin_a]);
        Camera { label, direction, right, up: cross(&toward, &right), toward }
    }

    /// The coordinates of a point in the picture.
    pub fn project(&self, x: &[f64; 3]) -> [f64; 2] {
        [dot(&self.right, x), dot(&self.up, x)]
    }

    /// How near a point is, up to a constant.
    pub fn nearness(&self, x: &[f64; 3]) -> f64 {
        dot(&self.toward, x)
    }

    /// The part of the picture that shows some boxes.
    pub fn extent(&self, shown: &[Cuboid]) -> Extent {
        Extent::of(shown.iter().flat_map(Cuboid::corners).map(|corner| self.project(&corner)))
    }

    /// The unit vector toward the light: above the eye, to the left.
    pub fn light(&self) -> [f64; 3] {
        let mix = |i: usize| 0.7 * self.toward[i] + 0.6 * self.up[i] - 0.387 * self.right[i];
        std::array::from_fn(mix)
    }

    /// Whether the side to which `normal` points is visible.
    pub fn sees(&self, normal: &[f64; 3]) -> bool {
        dot(&self.toward, normal) > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_and_right_handed() {
        for camera in Camera::all() {
            let axes = [camera.right, camera.up, camera.toward];
            for (i, a) in axes.iter().enumerate() {
                for (j, b) in axes.iter().enumerate() {
                    assert!((dot(a, b) - f64::from(i == j)).abs() < 1e-14, "{}: {i}, {j}", camera.label);
                }
            }
            assert!((dot(&cross(&axes[0], &axes[1]), &axes[2]) - 1.0).abs() < 1e-14);
            assert!((dot(&camera.light(), &camera.light()) - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn against_z_the_picture_is_that_of_the_plane() {
        let camera = Camera::all()[2];
        assert_eq!(camera.project(&[1.0, 2.0, 3.0]), [1.0, 2.0]);
        assert!(camera.nearness(&[0.0, 0.0, 1.0]) > camera.nearness(&[5.0, 5.0, 0.0]));
        let above = Camera::all()[3].project(&[1.0, 2.0, 3.0]);
        assert!((above[0] - 1.0).abs() < 1e-14 && (above[1] + 3.0).abs() < 1e-14, "{above:?}");
    }
}
