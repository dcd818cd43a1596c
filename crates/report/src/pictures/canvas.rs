//! Pictures of three bytes per pixel.

use super::colour::Colour;
use super::lines::LineLayer;

/// A picture of three bytes per pixel.
pub struct Canvas {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue, `[row][column]`.
    pub pixels: Vec<u8>,
}

impl Canvas {
    /// A canvas of one colour.
    pub fn new(width: usize, height: usize, ground: Colour) -> Self {
        Canvas { width, height, pixels: ground.repeat(width * height) }
    }

    /// Sets a pixel, if there is one.
    pub fn set(&mut self, column: usize, row: usize, colour: Colour) {
        if column < self.width && row < self.height {
            self.pixels[3 * (row * self.width + column)..][..3].copy_from_slice(&colour);
        }
    }

    /// Draws lines of one colour from the row `top` on, of which a `part` covers what is below.
    pub fn cover(&mut self, lines: &LineLayer, top: usize, colour: Colour, part: f64) {
        let below = self.pixels.get_mut(3 * top * self.width..).unwrap_or_default();
        for (pixel, covered) in below.chunks_exact_mut(3).zip(&lines.coverage) {
            let part = part * f64::from(*covered);
            for (old, new) in pixel.iter_mut().zip(colour) {
                *old = (f64::from(*old) + part * (f64::from(new) - f64::from(*old))).round() as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_cover_a_part_of_what_is_below() {
        let mut canvas = Canvas::new(2, 2, [200; 3]);
        canvas.set(1, 1, [100; 3]);
        canvas.set(7, 1, [0; 3]);
        let lines = LineLayer { width: 2, height: 1, coverage: vec![0.0, 1.0] };
        canvas.cover(&lines, 1, [0; 3], 0.5);
        let red: Vec<u8> = canvas.pixels.chunks(3).map(|pixel| pixel[0]).collect();
        assert_eq!(red, [200, 200, 200, 50]);
    }
}
