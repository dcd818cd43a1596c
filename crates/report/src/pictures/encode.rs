//! Pictures as PNG in data URIs.

use super::colour::{Colour, ColourMap};
use super::lines::LineLayer;
use super::quantity::Range;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;

/// Number of colours. A step is below what the eye can distinguish, and the files are small.
pub const COLOURS: usize = 240;

/// The number of the colour of walls in pictures of surfaces in space, and of structures beside the flow.
pub const WALL: u8 = COLOURS as u8 + 1;

/// The colour of walls.
const WALL_COLOUR: Colour = [176, 176, 176];

/// Colour numbers of values, `[row][column]`. 0 is transparent; 1 ..= [`COLOURS`] go from the low to the high end of the
/// range. Values beyond the range are clamped; infinite ones have the colour of walls.
pub fn colour_numbers(values: impl Iterator<Item = f32>, range: Range) -> Vec<u8> {
    let number = |value: f32| {
        if !value.is_finite() {
            return if value.is_nan() { 0 } else { WALL };
        }
        let part = (f64::from(value) - range.lower) / (range.upper - range.lower);
        1 + ((part * COLOURS as f64).floor().clamp(0.0, COLOURS as f64 - 1.0)) as u8
    };
    values.map(number).collect()
}

/// The colours by their numbers. The first one is transparent.
pub fn palette(map: ColourMap) -> Vec<Colour> {
    let colour = |number: usize| map.at((number as f64 + 0.5) / COLOURS as f64);
    [[0; 3]].into_iter().chain((0..COLOURS).map(colour)).chain([WALL_COLOUR]).collect()
}

/// A picture of colour numbers.
///
/// # Errors
/// Errors of the encoder; none is known to occur in memory.
pub fn picture(width: usize, height: usize, numbers: &[u8], map: ColourMap) -> Result<String, png::EncodingError> {
    uri(width, height, png::BitDepth::Eight, palette(map).concat(), vec![0], numbers)
}

/// Lines of one colour; thin lines are more transparent. `strongest` is the largest coverage.
///
/// # Errors
/// As [`picture`].
pub fn line_layer(lines: &LineLayer, colour: Colour, strongest: f64) -> Result<String, png::EncodingError> {
    let level = |coverage: &f32| (f64::from(*coverage) / strongest * 15.0).round() as u8;
    // Two pixels per byte, the left one in the upper half; a row begins with a new byte.
    let row =
        |row: &[f32]| row.chunks(2).map(|two| level(&two[0]) << 4 | two.get(1).map_or(0, level)).collect::<Vec<_>>();
    let packed: Vec<u8> = lines.coverage.chunks_exact(lines.width).flat_map(row).collect();
    let transparency = (0..16).map(|level| (17.0 * f64::from(level) * strongest).round() as u8).collect();
    uri(lines.width, lines.height, png::BitDepth::Four, colour.repeat(16), transparency, &packed)
}

fn uri(
    width: usize,
    height: usize,
    depth: png::BitDepth,
    palette: Vec<u8>,
    transparency: Vec<u8>,
    data: &[u8],
) -> Result<String, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(depth);
    encoder.set_palette(palette);
    encoder.set_trns(transparency);
    encoder.set_compression(png::Compression::Balanced);
    // Colour numbers are in the order of the values, so the differences of neighbours are small.
    encoder.set_filter(if depth == png::BitDepth::Eight { png::Filter::Adaptive } else { png::Filter::NoFilter });
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()?;
    Ok(format!("data:image/png;base64,{}", BASE64_STANDARD.encode(bytes)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn decoded(uri: &str) -> (png::OutputInfo, Vec<u8>) {
        let bytes = BASE64_STANDARD.decode(uri.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        (reader.next_frame(&mut pixels).unwrap(), pixels)
    }

    #[test]
    fn a_picture_has_the_colours_of_its_values() {
        assert_eq!(colour_numbers([f32::INFINITY].into_iter(), Range { lower: 0.0, upper: 1.0 }), [WALL]);
        let values = [0.0, 1.0, 0.5, f32::NAN, -3.0, 7.0];
        let numbers = colour_numbers(values.into_iter(), Range { lower: 0.0, upper: 1.0 });
        assert_eq!(numbers, [1, 240, 121, 0, 1, 240]);
        let (info, pixels) = decoded(&picture(3, 2, &numbers, ColourMap::Sequential).unwrap());
        assert_eq!((info.width, info.height, pixels.len()), (3, 2, 24));
        let colour = |pixel: usize| &pixels[4 * pixel..4 * pixel + 4];
        assert_eq!([colour(0)[3], colour(3)[3]], [255, 0]);
        assert_eq!(colour(1)[..3], ColourMap::Sequential.at(239.5 / 240.0));
        assert_eq!((colour(4), colour(5)), (colour(0), colour(1)));
    }

    #[test]
    fn a_layer_is_transparent_where_no_line_is() {
        let lines = LineLayer { width: 3, height: 1, coverage: vec![0.0, 1.0, 0.2] };
        let (_, pixels) = decoded(&line_layer(&lines, [1, 2, 3], 1.0).unwrap());
        assert_eq!(pixels, [1, 2, 3, 0, 1, 2, 3, 255, 1, 2, 3, 51]);
        let shadows = LineLayer { coverage: vec![0.0, 0.6, 0.12], ..lines };
        let (_, pixels) = decoded(&line_layer(&shadows, [1, 2, 3], 0.6).unwrap());
        assert_eq!(pixels, [1, 2, 3, 0, 1, 2, 3, 153, 1, 2, 3, 31]);
    }
}
