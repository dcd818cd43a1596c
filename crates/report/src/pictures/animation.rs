//! Files of the frames of a movie: an animated PNG or a GIF, which play in a loop.

use super::canvas::Canvas;
use super::error::PictureError;
use super::indexed::IndexedColours;
use rayon::prelude::*;
use std::ops::Range;

/// The kind of the file of a movie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MovieFormat {
    /// An animated PNG, of all colours, which browsers play.
    #[default]
    Png,
    /// A GIF, of 256 colours, which nearly every program plays.
    Gif,
}

impl MovieFormat {
    /// The ending of the name of a file.
    pub fn ending(self) -> &'static str {
        match self {
            MovieFormat::Png => "png",
            MovieFormat::Gif => "gif",
        }
    }
}

/// Frames that are drawn at the same time.
const TOGETHER: usize = 16;

/// The length of a movie and the shortest and the longest time of a frame, in milliseconds.
const LENGTH: usize = 10_000;
const DELAYS: [usize; 2] = [40, 150];

/// How often an animated PNG is played.
const FOREVER: u32 = 0;

/// The effort of finding the 256 colours of a frame of a GIF, from 1 (the best colours) to 30 (the fastest).
const SPEED: i32 = 10;

/// Frames of one size, which are drawn when they are written.
pub struct Frames<'a, F> {
    /// The number of frames.
    pub count: usize,
    /// The colours to which the frames are reduced, if they are.
    pub colours: Option<&'a IndexedColours>,
    /// Draws the frame of a number.
    pub draw: F,
}

impl<F: Fn(usize) -> Result<Canvas, PictureError> + Sync> Frames<'_, F> {
    /// The bytes of a file.
    pub fn encode(&self, format: MovieFormat) -> Result<Vec<u8>, PictureError> {
        match format {
            MovieFormat::Png => self.png(),
            MovieFormat::Gif => self.gif(),
        }
    }

    /// An animated PNG; of one frame a PNG.
    fn png(&self) -> Result<Vec<u8>, PictureError> {
        let mut bytes = Vec::new();
        let first = (self.draw)(0)?;
        let mut encoder = png::Encoder::new(&mut bytes, first.width as u32, first.height as u32);
        encoder.set_color(if self.colours.is_some() { png::ColorType::Indexed } else { png::ColorType::Rgb });
        encoder.set_compression(png::Compression::High);
        if let Some(colours) = self.colours {
            encoder.set_palette(colours.bytes());
            encoder.set_filter(png::Filter::NoFilter);
        }
        if self.count > 1 {
            encoder.set_animated(self.count as u32, FOREVER)?;
            encoder.set_frame_delay(self.delay() as u16, 1000)?;
        }
        let mut writer = encoder.write_header()?;
        for frames in self.groups() {
            self.pixels(frames)?.iter().try_for_each(|frame| writer.write_image_data(frame))?;
        }
        writer.finish()?;
        Ok(bytes)
    }

    /// A GIF. Without common colours every frame has its own.
    fn gif(&self) -> Result<Vec<u8>, PictureError> {
        let mut bytes = Vec::new();
        let first = (self.draw)(0)?;
        let (width, height) = (first.width as u16, first.height as u16);
        let palette = self.colours.map(IndexedColours::bytes).unwrap_or_default();
        let mut encoder = gif::Encoder::new(&mut bytes, width, height, &palette)?;
        encoder.set_repeat(gif::Repeat::Infinite)?;
        for frames in self.groups() {
            for pixels in self.pixels(frames)? {
                let frame = match self.colours {
                    Some(_) => gif::Frame { width, height, buffer: pixels.into(), ..gif::Frame::default() },
                    None => gif::Frame::from_rgb_speed(width, height, &pixels, SPEED),
                };
                encoder.write_frame(&gif::Frame { delay: (self.delay() / 10) as u16, ..frame })?;
            }
        }
        drop(encoder);
        Ok(bytes)
    }

    /// The time of a frame in milliseconds.
    fn delay(&self) -> usize {
        (LENGTH / self.count).clamp(DELAYS[0], DELAYS[1])
    }

    /// The numbers of the frames that are drawn together.
    fn groups(&self) -> impl Iterator<Item = Range<usize>> {
        let count = self.count;
        (0..count).step_by(TOGETHER).map(move |start| start..count.min(start + TOGETHER))
    }

    /// The pixels of some frames: numbers of colours, or red, green and blue.
    fn pixels(&self, frames: Range<usize>) -> Result<Vec<Vec<u8>>, PictureError> {
        let of_frame = |frame: usize| -> Result<Vec<u8>, PictureError> {
            let canvas = (self.draw)(frame)?;
            Ok(match self.colours {
                Some(colours) => colours.numbers(&canvas),
                None => canvas.pixels,
            })
        };
        frames.into_par_iter().map(of_frame).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::colour::ColourMap;
    use super::*;

    /// A file of `count` frames of one grey each, the number of the frame times 5.
    fn file(count: usize, colours: Option<&IndexedColours>, format: MovieFormat) -> std::io::Cursor<Vec<u8>> {
        let draw = |step: usize| Ok(Canvas::new(3, 2, [5 * step as u8; 3]));
        std::io::Cursor::new(Frames { count, colours, draw }.encode(format).unwrap())
    }

    fn png(count: usize, colours: Option<&IndexedColours>) -> png::Reader<std::io::Cursor<Vec<u8>>> {
        let mut decoder = png::Decoder::new(file(count, colours, MovieFormat::Png));
        decoder.set_transformations(png::Transformations::EXPAND);
        decoder.read_info().unwrap()
    }

    #[test]
    fn an_animated_png_has_its_frames_and_plays_in_a_loop() {
        let reduced = IndexedColours::new(ColourMap::Sequential, [255; 3]);
        for (colours, tolerance) in [(None, 0), (Some(&reduced), 10)] {
            let mut reader = png(40, colours);
            let control = reader.info().animation_control.unwrap();
            assert_eq!((control.num_frames, control.num_plays), (40, 0));
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            for step in 0..40 {
                reader.next_frame(&mut pixels).unwrap();
                assert!(pixels.iter().all(|byte| byte.abs_diff(5 * step) <= tolerance), "frame {step}: {pixels:?}");
            }
            assert!(reader.next_frame(&mut pixels).is_err());
        }
    }

    #[test]
    fn a_gif_has_its_frames_and_plays_in_a_loop() {
        let reduced = IndexedColours::new(ColourMap::Sequential, [255; 3]);
        for (colours, tolerance) in [(None, 2), (Some(&reduced), 10)] {
            let mut options = gif::DecodeOptions::new();
            options.set_color_output(gif::ColorOutput::RGBA);
            let mut reader = options.read_info(file(40, colours, MovieFormat::Gif)).unwrap();
            assert_eq!((reader.width(), reader.height(), reader.repeat()), (3, 2, gif::Repeat::Infinite));
            for step in 0..40 {
                let frame = reader.read_next_frame().unwrap().unwrap();
                assert_eq!(frame.delay, 15);
                let red = frame.buffer.iter().step_by(4);
                assert!(red.clone().all(|byte| byte.abs_diff(5 * step) <= tolerance), "frame {step}: {red:?}");
            }
            assert!(reader.read_next_frame().unwrap().is_none());
        }
    }

    #[test]
    fn one_frame_is_a_picture() {
        assert!(png(1, None).info().animation_control.is_none());
    }
}
