//! Windows: the displayed part of the plane, and its number of pixels.

use super::plane::Plane;
use super::space::Camera;
use super::track::Track;

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The corner with the smallest coordinates.
    pub lower: [f64; 2],
    /// The corner with the largest coordinates.
    pub upper: [f64; 2],
}

impl Extent {
    /// The empty box; every point extends it.
    pub const EMPTY: Extent = Extent { lower: [f64::INFINITY; 2], upper: [f64::NEG_INFINITY; 2] };

    /// The smallest box that contains also `point`.
    pub fn with(self, point: [f64; 2]) -> Self {
        let [x, y] = point;
        Extent {
            lower: [self.lower[0].min(x), self.lower[1].min(y)],
            upper: [self.upper[0].max(x), self.upper[1].max(y)],
        }
    }

    /// The box of some points.
    pub fn of(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// The smallest box that contains both.
    pub fn union(self, other: Self) -> Self {
        if other.is_empty() { self } else { self.with(other.lower).with(other.upper) }
    }

    /// Whether there is no point in it.
    pub fn is_empty(&self) -> bool {
        !(self.lower[0] <= self.upper[0] && self.lower[1] <= self.upper[1])
    }

    /// Lengths of the edges.
    pub fn size(&self) -> [f64; 2] {
        [self.upper[0] - self.lower[0], self.upper[1] - self.lower[1]]
    }

    /// The point in the middle.
    pub fn centre(&self) -> [f64; 2] {
        [0, 1].map(|i| 0.5 * (self.lower[i] + self.upper[i]))
    }

    /// The longer edge.
    pub fn length(&self) -> f64 {
        self.size()[0].max(self.size()[1])
    }

    /// The box with a margin added on every side, one per axis.
    pub fn grown(self, [x, y]: [f64; 2]) -> Self {
        let Extent { lower, upper } = self;
        Extent { lower: [lower[0] - x, lower[1] - y], upper: [upper[0] + x, upper[1] + y] }
    }

    /// The same box elsewhere.
    pub fn shifted(self, by: [f64; 2]) -> Self {
        let moved = |x: [f64; 2]| [x[0] + by[0], x[1] + by[1]];
        Extent { lower: moved(self.lower), upper: moved(self.upper) }
    }

    /// The intersection of both.
    pub fn intersection(self, other: Self) -> Self {
        let pick = |f: fn(f64, f64) -> f64, a: [f64; 2], b: [f64; 2]| [f(a[0], b[0]), f(a[1], b[1])];
        Extent { lower: pick(f64::max, self.lower, other.lower), upper: pick(f64::min, self.upper, other.upper) }
    }
}

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
