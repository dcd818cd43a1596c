//! The plane that a picture shows.

/// A plane on which one coordinate is constant. In two dimensions there is one plane, [`Plane::ALL_OF_2D`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// The axis across it.
    pub axis: usize,
    /// The coordinate on this axis.
    pub at: f64,
}

impl Plane {
    /// The plane of runs in two dimensions.
    pub const ALL_OF_2D: Plane = Plane { axis: 2, at: 0.0 };

    /// The axes to the right and upward in the picture. The axis y points upward wherever it can.
    pub fn axes(self) -> [usize; 2] {
        match self.axis {
            0 => [2, 1],
            1 => [0, 2],
            _ => [0, 1],
        }
    }

    /// The coordinates of a point in the picture.
    pub fn project<const D: usize>(self, x: &[f64; D]) -> [f64; 2] {
        self.axes().map(|axis| x[axis])
    }

    /// How far a point lies above the plane; 0 in two dimensions.
    pub fn height<const D: usize>(self, x: &[f64; D]) -> f64 {
        x.get(self.axis).map_or(0.0, |x| x - self.at)
    }

    /// Whether the box from `lower` to `upper` meets the plane.
    pub fn meets<const D: usize>(self, lower: &[f64; D], upper: &[f64; D]) -> bool {
        self.height(lower) <= 0.0 && self.height(upper) >= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_a_picture_are_the_others() {
        for axis in 0..3 {
            let [right, up] = Plane { axis, at: 0.0 }.axes();
            assert_eq!(right + up + axis, 3, "{axis}");
        }
        assert_eq!(Plane { axis: 0, at: 0.0 }.project(&[1.0, 2.0, 3.0]), [3.0, 2.0]);
        assert_eq!(Plane::ALL_OF_2D.project(&[1.0, 2.0]), [1.0, 2.0]);
    }

    #[test]
    fn a_box_meets_the_planes_through_it() {
        let plane = |at: f64| Plane { axis: 1, at };
        let meets = |at: f64| plane(at).meets(&[0.0, 1.0, 0.0], &[9.0, 2.0, 9.0]);
        assert!(meets(1.5) && !meets(0.5) && !meets(2.5));
        assert!(Plane::ALL_OF_2D.meets(&[5.0, 5.0], &[6.0, 6.0]));
        assert_eq!(plane(2.0).height(&[0.0, 5.0, 0.0]), 3.0);
    }
}
