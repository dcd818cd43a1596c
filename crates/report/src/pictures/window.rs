//! Windows: the displayed part of the plane, and its number of pixels.

use super::bounds::Extent;
use super::plane::Plane;
use super::space::Camera;
use super::track::Track;

/// A part of the plane in pixels of one size in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Its name in the page.
    pub label: String,
    /// The plane that it shows without a camera.
    pub plane: Plane,
    /// The part of `plane`, or of the plane of projection of `camera`.
    pub extent: Extent,
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The faces that it moves with; then `extent` is that of the first picture.
    pub follows: Option<Track>,
    /// The direction of a picture of surfaces in space; `None` for a picture of the plane.
    pub camera: Option<Camera>,
    /// What its pictures show, as a sentence for the page.
    pub note: String,
}

/// The largest ratio of width and height of a picture, either way.
const MOST_ELONGATED: f64 = 3.0;

impl Window {
    /// A window on `extent` of about `pixels` pixels, widened if it would be too elongated.
    pub fn new(label: &str, extent: Extent, pixels: f64) -> Self {
        let centre = extent.centre();
        let least = extent.length().max(f64::MIN_POSITIVE) / MOST_ELONGATED;
        let size = extent.size().map(|edge| edge.max(least));
        // Not the root of the product, which may be below all numbers.
        let pixel = size[0].sqrt() * size[1].sqrt() / pixels.sqrt();
        let [width, height] = size.map(|edge| (edge / pixel).ceil().max(1.0));
        let half = [0.5 * width * pixel, 0.5 * height * pixel];
        let extent = Extent {
            lower: [centre[0] - half[0], centre[1] - half[1]],
            upper: [centre[0] + half[0], centre[1] + half[1]],
        };
        let [label, note] = [label, ""].map(str::to_owned);
        let [width, height] = [width, height].map(|pixels| pixels as usize);
        Window { label, plane: Plane::ALL_OF_2D, extent, width, height, follows: None, camera: None, note }
    }

    /// The same window elsewhere.
    pub fn shifted(&self, by: [f64; 2]) -> Self {
        Window { extent: self.extent.shifted(by), ..self.clone() }
    }

    /// The same part of the plane in about `pixels` pixels.
    pub fn with_pixels(&self, pixels: f64) -> Self {
        let Window { extent, width, height, .. } = Window::new(&self.label, self.extent, pixels);
        Window { extent, width, height, ..self.clone() }
    }

    /// The same part of the plane with about `width` pixels per row.
    pub fn with_width(&self, width: usize) -> Self {
        let [x, y] = self.extent.size();
        self.with_pixels((width * width) as f64 * y / x)
    }

    /// Pixels per length.
    pub fn scale(&self) -> f64 {
        self.width as f64 / self.extent.size()[0]
    }

    /// Coordinates in pixels, the first row on top: pixel (i, j) has its centre at (i + 1/2, j + 1/2).
    pub fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let scale = self.scale();
        [(x - self.extent.lower[0]) * scale, (self.extent.upper[1] - y) * scale]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_square_and_a_strip_is_widened() {
        let strip = Extent { lower: [0.0, 0.0], upper: [8.0, 0.1] };
        let window = Window::new("", strip, 1e5);
        let [x, y] = window.extent.size();
        assert!((x / window.width as f64 - y / window.height as f64).abs() < 1e-12 && y > 2.6);
        assert_eq!(window.pixel(window.extent.lower), [0.0, window.height as f64]);
        let wide = window.with_width(600);
        assert!(wide.width.abs_diff(600) <= 1 && wide.width.abs_diff(3 * wide.height) <= 3, "{wide:?}");
    }
}
