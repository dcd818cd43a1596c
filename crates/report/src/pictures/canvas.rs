//! Pictures with numbers: letters of 5 x 7 dots.

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
    pub fn new(width: usize, height: usize, ground: [u8; 3]) -> Self {
        Canvas { width, height, pixels: ground.repeat(width * height) }
    }

    /// Sets a pixel, if there is one.
    pub fn set(&mut self, column: usize, row: usize, colour: [u8; 3]) {
        if column < self.width && row < self.height {
            self.pixels[3 * (row * self.width + column)..][..3].copy_from_slice(&colour);
        }
    }

    /// Mixes a part of a colour into a pixel.
    pub fn mix(&mut self, pixel: usize, colour: [u8; 3], part: f64) {
        for (old, new) in self.pixels[3 * pixel..][..3].iter_mut().zip(colour) {
            *old = (f64::from(*old) + part * (f64::from(new) - f64::from(*old))).round() as u8;
        }
    }

    /// Writes a text with its upper left corner at a pixel.
    pub fn write(&mut self, text: &str, column: usize, row: usize) {
        for (place, letter) in text.chars().enumerate() {
            for (line, dots) in dots(letter).into_iter().enumerate() {
                for dot in (0..5).filter(|dot| dots >> (4 - dot) & 1 == 1) {
                    self.dot(column + (6 * place + dot) * DOT, row + line * DOT);
                }
            }
        }
    }

    fn dot(&mut self, column: usize, row: usize) {
        (0..DOT * DOT).for_each(|k| self.set(column + k % DOT, row + k / DOT, INK));
    }
}

/// Pixels per dot.
const DOT: usize = 2;

/// Rows of a letter.
pub const LETTER_HEIGHT: usize = 7 * DOT;

const INK: [u8; 3] = [0; 3];

/// The width of a text.
pub fn width(text: &str) -> usize {
    6 * DOT * text.chars().count()
}

/// The dots of a letter, row by row, the highest of five bits on the left. Letters that numbers do not need are empty.
fn dots(letter: char) -> [u8; 7] {
    match letter {
        '0' => [14, 17, 19, 21, 25, 17, 14],
        '1' => [4, 12, 4, 4, 4, 4, 14],
        '2' => [14, 17, 1, 2, 4, 8, 31],
        '3' => [31, 2, 4, 2, 1, 17, 14],
        '4' => [2, 6, 10, 18, 31, 2, 2],
        '5' => [31, 16, 30, 1, 1, 17, 14],
        '6' => [6, 8, 16, 30, 17, 17, 14],
        '7' => [31, 1, 2, 4, 8, 8, 8],
        '8' => [14, 17, 17, 14, 17, 17, 14],
        '9' => [14, 17, 17, 15, 1, 2, 12],
        '.' => [0, 0, 0, 0, 0, 12, 12],
        '-' | '\u{2212}' => [0, 0, 0, 31, 0, 0, 0],
        '=' => [0, 0, 31, 0, 31, 0, 0],
        'e' => [0, 0, 14, 17, 31, 16, 14],
        't' => [8, 8, 28, 8, 8, 9, 6],
        _ => [0; 7],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_letters_that_differ() {
        let letters: Vec<[u8; 7]> = "0123456789.-=et".chars().map(dots).collect();
        for (i, a) in letters.iter().enumerate() {
            assert!(a.iter().any(|row| *row > 0) && letters[..i].iter().all(|b| a != b), "letter {i}");
        }
    }

    #[test]
    fn a_text_is_as_wide_as_told_and_may_be_cut() {
        let mut canvas = Canvas::new(40, 20, [255; 3]);
        canvas.write("11", 0, 0);
        let inked = |column: usize| (0..20).any(|row| canvas.pixels[3 * (row * 40 + column)] == 0);
        assert!(inked(2) && !inked(11) && inked(14) && (width("11")..40).all(|column| !inked(column)));
        // The digit 1 has ten dots of four pixels.
        let ink = canvas.pixels.iter().filter(|byte| **byte == 0).count();
        assert_eq!(ink, 2 * 10 * 4 * 3);
        canvas.write("8", 35, 15);
    }
}
