//! Frames of a movie in 256 colours: files of a third of the size.

use super::canvas::Canvas;
use super::colour::{Colour, ColourMap};
use std::collections::HashMap;

/// Colours of the map as they are; fewer of them, each with some shades below lines; greys.
const PLAIN: usize = 120;
const SHADED: usize = 40;
const SHADES: [f64; 3] = [0.25, 0.5, 0.75];
const GREYS: usize = 15;

/// A palette.
pub struct IndexedColours {
    colours: Vec<Colour>,
}

impl IndexedColours {
    /// The palette of a colour map on a `ground`.
    pub fn new(map: ColourMap, ground: Colour) -> Self {
        let of_map = |count: usize| (0..count).map(move |k| map.at((k as f64 + 0.5) / count as f64));
        let darker = |part: f64| move |colour: Colour| colour.map(|c| (f64::from(c) * (1.0 - part)).round() as u8);
        let shaded = SHADES.into_iter().flat_map(|part| of_map(SHADED).map(darker(part)));
        let greys = (0..GREYS).map(|k| [(255 * k / (GREYS - 1)) as u8; 3]);
        IndexedColours { colours: of_map(PLAIN).chain(shaded).chain(greys).chain([ground]).collect() }
    }

    /// Red, green and blue of all colours.
    pub fn bytes(&self) -> Vec<u8> {
        self.colours.concat()
    }

    /// The number of the nearest colour for each pixel.
    pub fn numbers(&self, canvas: &Canvas) -> Vec<u8> {
        let mut known: HashMap<Colour, u8> = HashMap::new();
        let number = |pixel: &[u8]| {
            let colour = [pixel[0], pixel[1], pixel[2]];
            *known.entry(colour).or_insert_with(|| self.nearest(colour))
        };
        canvas.pixels.chunks_exact(3).map(number).collect()
    }

    fn nearest(&self, colour: Colour) -> u8 {
        let distance =
            |other: &Colour| (0..3).map(|i| (i32::from(colour[i]) - i32::from(other[i])).pow(2)).sum::<i32>();
        let nearest = (0..self.colours.len()).min_by_key(|&k| distance(&self.colours[k]));
        nearest.unwrap_or_default() as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_the_map_its_shades_and_greys_are_kept() {
        for (map, ground) in [(ColourMap::Sequential, [255; 3]), (ColourMap::Diverging, [0xa9, 0xb1, 0xb8])] {
            let palette = IndexedColours::new(map, ground);
            assert_eq!(palette.bytes().len(), 3 * 256);
            let farthest = |colours: &[Colour]| {
                let canvas = Canvas { width: colours.len(), height: 1, pixels: colours.concat() };
                let found = palette.numbers(&canvas).into_iter().map(|number| palette.colours[usize::from(number)]);
                let apart = |(a, b): (&Colour, Colour)| (0..3).map(|i| a[i].abs_diff(b[i])).max().unwrap_or(0);
                colours.iter().zip(found).map(apart).max().unwrap_or(0)
            };
            assert_eq!(farthest(&[[0; 3], [255; 3], ground]), 0, "{map:?}");
            let of_map: Vec<Colour> = (0..=1000).map(|k| map.at(f64::from(k) / 1000.0)).collect();
            assert!(farthest(&of_map) <= 4, "{map:?}: {}", farthest(&of_map));
            let under_a_line: Vec<Colour> =
                of_map.iter().map(|c| c.map(|c| (f64::from(c) * 0.6).round() as u8)).collect();
            assert!(farthest(&under_a_line) <= 40, "{map:?}: {}", farthest(&under_a_line));
        }
    }
}
