//! Cuts through the flow in three dimensions, at several positions along each axis, at one time.

use super::Encoded;
use super::bounds::{Cuboid, Extent};
use super::plane::Plane;
use super::quantity::{PictureQuantity, Range};
use super::snapshot::Snapshot;
use super::view::View;
use super::window::Window;
use rayon::prelude::*;
use tensor::AXES;

/// A window on planes across one axis.
pub struct Cut {
    /// The window, at the first position.
    pub window: Window,
    /// The positions of the plane on the axis, from low to high.
    pub positions: Vec<f64>,
    /// The pictures at each position.
    pub views: Vec<Encoded>,
}

/// Positions along an axis.
const POSITIONS: usize = 7;

/// Where the planes lie between two of the positions at equal distances: slightly beside the middle. Planes on the faces of cells would belong
/// to the cells of either side.
const PLACE: f64 = 0.501;

/// Pixels of a picture.
const PIXELS: f64 = 80e3;

/// The cuts of a snapshot in three dimensions. M = D + 2.
///
/// # Errors
/// As [`super::encode::picture`].
pub fn cuts<const D: usize, const M: usize>(
    view: &View<D>,
    snapshot: &Snapshot<D>,
    quantities: &[(PictureQuantity, Range)],
) -> Result<Vec<Cut>, png::EncodingError> {
    let Some(near) = view.near else { return Ok(Vec::new()) };
    let cut = |axis: usize| {
        let positions = positions(near, axis);
        let planes = positions.par_iter().map(|&at| window(near, Plane { axis, at }, PIXELS));
        let encoded = |window: Window| {
            let drawn = view.draw::<M>(snapshot, &[window], quantities);
            drawn.iter().map(|(drawn, shift)| drawn.encode(quantities, *shift)).collect::<Result<Vec<_>, _>>()
        };
        let views: Vec<Vec<Encoded>> = planes.map(encoded).collect::<Result<_, _>>()?;
        let window = window(near, Plane { axis, at: positions[0] }, PIXELS);
        Ok(Cut { window, positions, views: views.into_iter().flatten().collect() })
    };
    (0..D).map(cut).collect()
}

/// The plane across the axis `name` in the middle of a box, at the position where the page begins.
pub fn middle(near: Cuboid, name: &str) -> Option<Plane> {
    let axis = AXES.iter().position(|axis| *axis == name)?;
    Some(Plane { axis, at: positions(near, axis)[POSITIONS / 2] })
}

/// The window on the part of a plane within a box.
pub fn window(near: Cuboid, plane: Plane, pixels: f64) -> Window {
    let corners = [near.lower, near.upper].map(|corner| plane.project(&corner));
    let [axis, right, up] = [plane.axis, plane.axes()[0], plane.axes()[1]].map(|axis| AXES[axis]);
    let note = format!(
        "Shown is a cut at the last time, across the axis {axis}; {right} points to the right and {up} upward."
    );
    let window = Window::new(&format!("cut {axis}"), Extent::of(corners), pixels);
    Window { plane, note, ..window }
}

/// Positions at equal distances on an axis of a box.
fn positions(near: Cuboid, axis: usize) -> Vec<f64> {
    let [lower, upper] = [near.lower[axis], near.upper[axis]];
    (0..POSITIONS).map(|k| lower + (k as f64 + PLACE) / POSITIONS as f64 * (upper - lower)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_shows_the_box_across_its_axis() {
        let near = Cuboid { lower: [0.0, 10.0, 20.0], upper: [4.0, 13.0, 22.0] };
        let window = window(near, Plane { axis: 0, at: 1.0 }, 600.0);
        assert_eq!(window.label, "cut x");
        // z from 20 to 22 to the right, y from 10 to 13 upward.
        assert!(
            (window.extent.lower[0] - 20.0).abs() < 0.1 && (window.extent.upper[1] - 13.0).abs() < 0.1,
            "{window:?}"
        );
        assert!(window.note.contains("z points to the right and y upward"), "{}", window.note);
    }

    #[test]
    fn positions_are_inside_and_beside_the_middle() {
        let near = Cuboid { lower: [-1.0; 3], upper: [1.0; 3] };
        let positions = positions(near, 1);
        assert!(positions.len() == POSITIONS && positions.is_sorted() && positions[0] > -1.0 && positions[6] < 1.0);
        assert!(positions[3] > 0.0 && positions[3] < 1e-3, "{positions:?}");
        assert_eq!(middle(near, "y"), Some(Plane { axis: 1, at: positions[3] }));
        assert_eq!(middle(near, "w"), None);
    }
}
