//! Lines with smooth edges, as a layer above a picture.

use super::raster::centres;
use super::window::Window;

/// The fraction of each pixel covered by lines, 0 to 1, `[row][column]`.
#[derive(Clone, Debug, PartialEq)]
pub struct LineLayer {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The coverage.
    pub coverage: Vec<f32>,
}

impl LineLayer {
    /// No lines in `window`.
    pub fn new(window: &Window) -> Self {
        let Window { width, height, .. } = *window;
        LineLayer { width, height, coverage: vec![0.0; width * height] }
    }

    /// Draws the line from `a` to `b`, `thickness` pixels wide, with a strength from 0 to 1. Drawing it twice has no
    /// further effect.
    pub fn draw(&mut self, window: &Window, ends: [[f64; 2]; 2], thickness: f64, strength: f64) {
        self.draw_pixels(ends.map(|end| window.pixel(end)), thickness, strength);
    }

    /// The same between points in pixels.
    pub fn draw_pixels(&mut self, [a, b]: [[f64; 2]; 2], thickness: f64, strength: f64) {
        let reach = 0.5 * thickness + 0.5;
        let around = |i: usize, count| centres([a[i].min(b[i]) - reach, a[i].max(b[i]) + reach, a[i]], count);
        for row in around(1, self.height) {
            for column in around(0, self.width) {
                let distance = distance([column as f64 + 0.5, row as f64 + 0.5], a, b);
                let covered = (strength * (reach - distance).clamp(0.0, 1.0)) as f32;
                let pixel = &mut self.coverage[row * self.width + column];
                *pixel = pixel.max(covered);
            }
        }
    }
}

/// The distance of a point from the line between `a` and `b`.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let [along, to] = [[b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]];
    let square = along[0] * along[0] + along[1] * along[1];
    let part = if square > 0.0 { ((along[0] * to[0] + along[1] * to[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    (to[0] - part * along[0]).hypot(to[1] - part * along[1])
}

#[cfg(test)]
mod tests {
    use super::super::bounds::Extent;
    use super::*;

    #[test]
    fn a_line_covers_its_length_times_its_thickness() {
        let window = Window::new("", Extent { lower: [0.0; 2], upper: [1.0; 2] }, 1e4);
        let mut lines = LineLayer::new(&window);
        let line = [[0.2, 0.5], [0.8, 0.5]];
        lines.draw(&window, line, 2.0, 1.0);
        let covered: f32 = lines.coverage.iter().sum();
        // 60 pixels long, two wide, with round ends.
        assert!((covered - 123.0).abs() < 3.0, "{covered}");
        let once = lines.clone();
        lines.draw(&window, line, 2.0, 1.0);
        assert_eq!(lines, once);
    }
}
