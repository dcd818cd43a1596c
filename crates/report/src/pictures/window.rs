//! Windows: the displayed part of the plane, and its number of pixels.

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
    pub label: &'static str,
    /// The part of the plane.
    pub extent: Extent,
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Whether it moves with the bodies; then `extent` is that of the first picture.
    pub follows: bool,
}

/// The largest ratio of width and height of a picture, either way.
const MOST_ELONGATED: f64 = 3.0;

impl Window {
    /// A window on `extent` of about `pixels` pixels, widened if it would be too elongated.
    pub fn new(label: &'static str, extent: Extent, pixels: f64) -> Self {
        let centre = [0, 1].map(|i| 0.5 * (extent.lower[i] + extent.upper[i]));
        let least = extent.length().max(f64::MIN_POSITIVE) / MOST_ELONGATED;
        let size = extent.size().map(|edge| edge.max(least));
        let pixel = (size[0] * size[1] / pixels).sqrt();
        let [width, height] = size.map(|edge| (edge / pixel).ceil().max(1.0));
        let half = [0.5 * width * pixel, 0.5 * height * pixel];
        let extent = Extent {
            lower: [centre[0] - half[0], centre[1] - half[1]],
            upper: [centre[0] + half[0], centre[1] + half[1]],
        };
        Window { label, extent, width: width as usize, height: height as usize, follows: false }
    }

    /// The same window elsewhere.
    pub fn shifted(&self, by: [f64; 2]) -> Self {
        Window { extent: self.extent.shifted(by), ..self.clone() }
    }

    /// The same part of the plane in about `pixels` pixels.
    pub fn with_pixels(&self, pixels: f64) -> Self {
        Window::new(self.label, self.extent, pixels)
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

/// Pixels of a picture of the bodies, of the whole domain beside it, and of the domain if there are no bodies.
const PIXELS: [f64; 3] = [420e3, 160e3, 420e3];

/// A boundary shorter than this fraction of the domain is a body in it.
const BODY: f64 = 0.5;

/// The margins around the bodies as fractions of their length; larger at the sides, because screens are wide.
const MARGIN: [f64; 2] = [0.9, 0.45];

/// The boundaries that are bodies in a domain, given their boxes.
pub fn bodies(domain: Extent, boundaries: &[Extent]) -> Vec<usize> {
    let is_body = |boundary: &Extent| !boundary.is_empty() && boundary.length() < BODY * domain.length();
    let bodies: Vec<usize> = (0..boundaries.len()).filter(|&boundary| is_body(&boundaries[boundary])).collect();
    let all = bodies.iter().fold(Extent::EMPTY, |all, &body| all.union(boundaries[body]));
    if all.length() > BODY * domain.length() { Vec::new() } else { bodies }
}

/// The windows on a domain with bodies in the box `near`: close to them, if there are some, and the whole.
pub fn windows(domain: Extent, near: Extent) -> Vec<Window> {
    if near.is_empty() {
        return vec![Window::new("whole domain", domain, PIXELS[2])];
    }
    let near = around(near).intersection(domain);
    vec![Window::new("near the walls", near, PIXELS[0]), Window::new("whole domain", domain, PIXELS[1])]
}

/// The window that moves with bodies in the box `bodies` at the first picture.
pub fn following(bodies: Extent) -> Window {
    Window { follows: true, ..Window::new("moving with the walls", around(bodies), PIXELS[0]) }
}

fn around(bodies: Extent) -> Extent {
    bodies.grown(MARGIN.map(|part| part * bodies.length()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(domain: Extent, boundaries: &[Extent]) -> Vec<Window> {
        let near = bodies(domain, boundaries).into_iter().fold(Extent::EMPTY, |all, body| all.union(boundaries[body]));
        windows(domain, near)
    }

    fn square(half: f64) -> Extent {
        Extent { lower: [-half; 2], upper: [half; 2] }
    }

    #[test]
    fn a_body_in_a_wide_domain_is_not_a_dot() {
        let body = Extent { lower: [0.0, -0.06], upper: [1.0, 0.06] };
        let found = of(square(100.0), &[square(100.0), body]);
        assert_eq!(found.iter().map(|window| window.label).collect::<Vec<_>>(), ["near the walls", "whole domain"]);
        let [chord, total] = [1.0 * found[0].scale(), found[0].width as f64];
        assert!(chord > 0.3 * total, "{chord} of {total} pixels");
    }

    #[test]
    fn walls_around_the_domain_are_no_bodies() {
        let bottom = Extent { lower: [-1.0, -1.0], upper: [1.0, -1.0] };
        assert_eq!(of(square(1.0), &[bottom, square(1.0)]).len(), 1);
    }

    #[test]
    fn pixels_are_square_and_a_strip_is_widened() {
        let strip = Extent { lower: [0.0, 0.0], upper: [8.0, 0.1] };
        let window = Window::new("", strip, 1e5);
        let [x, y] = window.extent.size();
        assert!((x / window.width as f64 - y / window.height as f64).abs() < 1e-12 && y > 2.6);
        assert_eq!(window.pixel(window.extent.lower), [0.0, window.height as f64]);
    }
}
