//! Letters of thin lines.
//!
//! A letter is a list of strokes, and a stroke a list of points: two digits each, to the right and upward. The line that letters stand on is at 2,
//! capitals end at 8, small letters at 6.

use super::lines::LineLayer;

/// The height of capitals in units of the letters, and the line they stand on.
const CAPITAL: f64 = 6.0;
const GROUND: f64 = 2.0;

/// The space between two letters, and the width of a blank.
const SPACE: f64 = 2.0;
const BLANK: f64 = 2.0;

/// The thickness of a stroke as a fraction of the height of capitals.
const THICKNESS: f64 = 0.13;

/// A letter that is not in the table.
const UNKNOWN: &str = "02 08 48 42 02";

/// The strokes of every letter, separated by `/`.
const LETTERS: [(char, &str); 95] = [
    ('0', "12 03 07 18 38 47 43 32 12"),
    ('O', "12 03 07 18 38 47 43 32 12"),
    ('1', "06 28 22"),
    ('2', "07 18 38 47 46 02 42"),
    ('3', "07 18 38 47 46 35 15/35 44 43 32 12 03"),
    ('4', "32 38 04 44"),
    ('5', "48 08 05 35 44 43 32 12 03"),
    ('6', "47 38 18 07 03 12 32 43 44 35 15 04"),
    ('7', "08 48 12"),
    ('8', "15 06 07 18 38 47 46 35 15 04 03 12 32 43 44 35"),
    ('9', "03 12 32 43 47 38 18 07 06 15 35 46"),
    ('A', "02 28 42/14 34"),
    ('B', "02 08 38 47 46 35 05/35 44 43 32 02"),
    ('C', "47 38 18 07 03 12 32 43"),
    ('D', "02 08 28 46 44 22 02"),
    ('E', "48 08 02 42/05 35"),
    ('F', "48 08 02/05 35"),
    ('G', "47 38 18 07 03 12 32 43 45 25"),
    ('H', "08 02/48 42/05 45"),
    ('I', "08 02"),
    ('l', "08 02"),
    ('|', "08 02"),
    ('J', "38 33 22 12 03"),
    ('K', "08 02/48 04/15 42"),
    ('L', "08 02 42"),
    ('M', "02 08 25 48 42"),
    ('N', "02 08 42 48"),
    ('P', "02 08 38 47 46 35 05"),
    ('Q', "12 03 07 18 38 47 43 32 12/24 42"),
    ('R', "02 08 38 47 46 35 05/25 42"),
    ('S', "47 38 18 07 06 15 35 44 43 32 12 03"),
    ('T', "08 48/28 22"),
    ('U', "08 03 12 32 43 48"),
    ('V', "08 22 48"),
    ('W', "08 12 26 32 48"),
    ('X', "08 42/48 02"),
    ('Y', "08 25 48/25 22"),
    ('Z', "08 48 02 42"),
    ('a', "36 32/35 26 16 05 03 12 22 33"),
    ('b', "08 02/05 16 26 35 33 22 12 03"),
    ('c', "35 26 16 05 03 12 22 33"),
    ('d', "38 32/35 26 16 05 03 12 22 33"),
    ('e', "04 34 35 26 16 05 03 12 22 33"),
    ('f', "28 17 12/06 26"),
    ('g', "36 31 20 10 01/35 26 16 05 03 12 22 33"),
    ('h', "08 02/05 16 26 35 32"),
    ('i', "06 02/08 08"),
    ('j', "16 11 00/18 18"),
    ('k', "08 02/36 04/15 32"),
    ('m', "02 06/05 16 25 22/25 36 45 42"),
    ('n', "02 06/05 16 26 35 32"),
    ('o', "16 05 03 12 22 33 35 26 16"),
    ('p', "06 00/05 16 26 35 33 22 12 03"),
    ('q', "36 30/35 26 16 05 03 12 22 33"),
    ('r', "02 06/05 16 26"),
    ('s', "35 26 16 05 14 24 33 22 12 03"),
    ('t', "18 13 22/06 26"),
    ('u', "06 03 12 22 33/36 32"),
    ('v', "06 22 46"),
    ('w', "06 12 25 32 46"),
    ('x', "06 32/36 02"),
    ('y', "06 22/46 10"),
    ('z', "06 36 02 32"),
    ('.', "02 02"),
    (',', "12 01"),
    (':', "03 03/06 06"),
    ('-', "05 35"),
    ('\u{2212}', "05 35"),
    ('+', "05 45/27 23"),
    ('=', "04 44/06 46"),
    ('/', "02 48"),
    ('(', "18 06 04 12"),
    (')', "08 16 14 02"),
    ('_', "01 41"),
    ('\'', "08 07"),
    ('"', "08 07/18 17"),
    ('!', "08 04/02 02"),
    ('?', "07 18 28 37 36 25 24/22 22"),
    (';', "16 16/12 01"),
    ('&', "42 15 07 18 27 26 04 03 12 22 44"),
    ('%', "08 18 17 07 08/02 48/32 42 43 33 32"),
    ('#', "12 18/32 38/04 44/06 46"),
    ('@', "34 36 25 14 24 34 44 47 38 18 07 03 12 42"),
    ('*', "05 45/14 36/34 16"),
    ('<', "37 05 33"),
    ('>', "07 35 03"),
    ('[', "18 08 02 12"),
    (']', "08 18 12 02"),
    ('{', "28 18 16 05 14 12 22"),
    ('}', "08 18 16 25 14 12 02"),
    ('^', "06 28 46"),
    ('~', "05 16 24 35"),
    ('\\', "08 42"),
    ('\u{b0}', "08 18 17 07 08"),
    ('\u{2080}', "13 02 01 10 21 22 13"),
];

/// Letters of western languages with accents.
const ACCENTED: [(char, &str); 16] = [
    ('A', "ÀÁÂÃÄÅ"),
    ('C', "Ç"),
    ('E', "ÈÉÊË"),
    ('I', "ÌÍÎÏ"),
    ('N', "Ñ"),
    ('O', "ÒÓÔÕÖØ"),
    ('U', "ÙÚÛÜ"),
    ('Y', "Ý"),
    ('a', "àáâãäå"),
    ('c', "ç"),
    ('e', "èéêë"),
    ('i', "ìíîï"),
    ('n', "ñ"),
    ('o', "òóôõöø"),
    ('u', "ùúûü"),
    ('y', "ýÿ"),
];

/// The strokes of a letter. One with an accent is drawn without it.
fn strokes(letter: char) -> &'static str {
    let letter = ACCENTED.iter().find(|(_, accented)| accented.contains(letter)).map_or(letter, |(plain, _)| *plain);
    LETTERS.iter().find(|(known, _)| *known == letter).map_or(UNKNOWN, |(_, strokes)| strokes)
}

/// The strokes of a letter as points.
fn points(letter: char) -> impl Iterator<Item = Vec<[f64; 2]>> {
    let digit = |byte: u8| f64::from(byte.saturating_sub(b'0'));
    let point = move |point: &str| match point.as_bytes() {
        [x, y] => [digit(*x), digit(*y) - GROUND],
        _ => [0.0; 2],
    };
    strokes(letter).split('/').map(move |stroke| stroke.split(' ').map(point).collect())
}

/// The width of a letter, in units.
fn letter_width(letter: char) -> f64 {
    match letter {
        ' ' => BLANK,
        // Numbers below each other have the same width.
        '0'..='9' => 4.0,
        _ => points(letter).flatten().map(|[x, _]| x).fold(0.0, f64::max),
    }
}

/// The width of a text with capitals of height `size`, in pixels.
pub fn width(text: &str, size: f64) -> f64 {
    size / CAPITAL * text.chars().map(|letter| letter_width(letter) + SPACE).sum::<f64>()
}

/// Writes a text that stands at `y`, counted downward, and begins at `x`, with capitals of height `size`, all in pixels.
pub fn write(lines: &mut LineLayer, text: &str, [x, y]: [f64; 2], size: f64) {
    let unit = size / CAPITAL;
    let mut at = x;
    for letter in text.chars() {
        let pixel = |[right, up]: &[f64; 2]| [at + unit * right, y - unit * up];
        for stroke in points(letter).filter(|_| letter != ' ') {
            for pair in stroke.windows(2) {
                lines.draw_pixels([pixel(&pair[0]), pixel(&pair[1])], THICKNESS * size, 1.0);
            }
        }
        at += unit * (letter_width(letter) + SPACE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TESTED: &str =
        "0123456789ABCDEFGHIJKLMNPQRSTUVWXYZabcdefghijkmnopqrstuvwxyz.,:-+=/()_'\"!?;&%#@*<>[]{}^~\\\u{b0}\u{2080}";

    #[test]
    fn letters_differ_and_stay_in_their_box() {
        for (i, letter) in TESTED.chars().enumerate() {
            assert!(strokes(letter) != UNKNOWN, "{letter} is missing");
            assert!(TESTED.chars().take(i).all(|other| strokes(other) != strokes(letter)), "{letter} has a twin");
            for [x, y] in points(letter).flatten() {
                assert!((0.0..=4.0).contains(&x) && (-2.0..=6.0).contains(&y), "{letter}: {x}, {y}");
            }
            assert!(points(letter).all(|stroke| stroke.len() > 1), "{letter} has a stroke of one point");
        }
    }

    #[test]
    fn a_text_has_ink_within_its_width() {
        let mut lines = LineLayer { width: 100, height: 30, coverage: vec![0.0; 3000] };
        write(&mut lines, "Ma 1", [5.0, 20.0], 12.0);
        let inked = |column: usize| (0..30).any(|row| lines.coverage[row * 100 + column] > 0.3);
        let (first, last) = ((0..100).find(|&c| inked(c)), (0..100).rfind(|&c| inked(c)));
        let end = 5.0 + width("Ma 1", 12.0);
        assert!(first.is_some_and(|first| (4..7).contains(&first)), "{first:?}");
        assert!(last.is_some_and(|last| (last as f64) < end && last as f64 > end - 12.0), "{last:?}, {end}");
        // Capitals end 12 pixels above their line.
        assert!((0..7).all(|row| lines.coverage[row * 100..][..100].iter().all(|c| *c == 0.0)));
        assert!((0..7).any(|row| lines.coverage[(row + 7) * 100..][..100].iter().any(|c| *c > 0.3)));
    }

    #[test]
    fn accents_are_left_out() {
        assert_eq!(strokes('Ö'), strokes('O'));
        assert_eq!(strokes('é'), strokes('e'));
    }

    #[test]
    fn digits_have_one_width() {
        assert_eq!(width("111", 12.0), width("888", 12.0));
    }
}
