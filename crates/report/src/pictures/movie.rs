//! Movies and pictures: one field in one window, at all steps as an animated PNG that plays in a loop, or at the last step.

use super::canvas::Canvas;
use super::choice::{self, PictureField};
use super::error::PictureError;
use super::indexed::IndexedColours;
use super::quantity::Range;
use super::scheme::Scheme;
use super::shot::{Scenario, Shot};
use super::view::View;
use super::{MOST_STEPS, chosen, ranges};
use output::ResultReader;
use rayon::prelude::*;

/// A movie, or a picture.
pub struct Movie {
    /// The file.
    pub bytes: Vec<u8>,
    /// The number of its frames.
    pub frames: usize,
    /// The name of its window.
    pub window: String,
}

/// Frames that are drawn at the same time.
const TOGETHER: usize = 16;

/// The length of a movie and the shortest and the longest time of a frame, in milliseconds.
const LENGTH: usize = 10_000;
const DELAYS: [usize; 2] = [40, 150];

/// How often a movie is played.
const FOREVER: u32 = 0;

/// Makes a movie with a frame for every step.
///
/// # Errors
/// A file without the data for pictures; unknown names; an empty range of colours.
pub fn movie(reader: &ResultReader, scenario: &Scenario) -> Result<Movie, PictureError> {
    of_steps(reader, scenario, 0..reader.times.len())
}

/// Makes a picture of the last step.
///
/// # Errors
/// As [`movie`].
pub fn picture(reader: &ResultReader, scenario: &Scenario) -> Result<Movie, PictureError> {
    of_steps(reader, scenario, reader.times.len().saturating_sub(1)..reader.times.len())
}

fn of_steps(reader: &ResultReader, scenario: &Scenario, steps: std::ops::Range<usize>) -> Result<Movie, PictureError> {
    if steps.is_empty() {
        return Err(PictureError::NoStep);
    }
    match reader.layout.grid.dimension {
        2 => Studio::<2>::new::<4>(reader, scenario)?.movie::<4>(steps),
        _ => Studio::<3>::new::<5>(reader, scenario)?.movie::<5>(steps),
    }
}

/// All that is needed to draw frames.
struct Studio<'r, const D: usize> {
    reader: &'r ResultReader,
    scheme: Scheme<D>,
    view: View<D>,
    shot: Shot,
}

impl<'r, const D: usize> Studio<'r, D> {
    fn new<const M: usize>(reader: &'r ResultReader, scenario: &Scenario) -> Result<Self, PictureError> {
        let PictureField { quantity, medium, label } = choice::field(reader, scenario.field)?;
        let scheme = Scheme::<D>::new(reader, medium).ok_or(PictureError::NoMesh)?.showing(vec![quantity]);
        let steps = chosen(reader.times.len(), MOST_STEPS);
        let snapshots = steps.iter().map(|&step| scheme.at(reader, step)).collect::<Result<Vec<_>, _>>()?;
        let view = View::<D>::new::<M>(reader, &snapshots, scenario.q_level);
        let window = choice::window(&view, scenario.window)?;
        let window = scenario.width.map_or_else(|| window.clone(), |width| window.with_width(width));
        let range = match scenario.range {
            Some([lower, upper]) => Range::new(lower, upper).ok_or(PictureError::NoRange { lower, upper })?,
            None => ranges::<D, M>(&[quantity], &view, &snapshots)[0].1,
        };
        drop(snapshots);
        let shot = Shot {
            title: reader.metadata.case_name.clone(),
            quantity: (quantity, range),
            label: label.unwrap_or_else(|| quantity.label(D).to_owned()),
            window,
            without_edges: scenario.without_edges,
        };
        Ok(Studio { reader, scheme, view, shot })
    }

    fn movie<const M: usize>(self, steps: std::ops::Range<usize>) -> Result<Movie, PictureError> {
        let frame = |step: usize| -> Result<Canvas, PictureError> {
            let snapshot = self.scheme.at(self.reader, step)?;
            let windows = std::slice::from_ref(&self.shot.window);
            let drawn = self.view.draw::<M>(&snapshot, windows, &[self.shot.quantity]);
            Ok(self.shot.frame(&drawn[0].0, self.reader.times[step]))
        };
        // Shadows need all colours, and a picture is small anyway.
        let plane = self.shot.window.camera.is_none() && steps.len() > 1;
        let colours = plane.then(|| self.shot.colours());
        let bytes = animation(steps.len(), colours.as_ref(), |k| frame(steps.start + k))?;
        Ok(Movie { bytes, frames: steps.len(), window: self.shot.window.label })
    }
}

/// An animated PNG of `count` frames of one size, which plays in a loop; of one frame a PNG. With `colours` its frames are reduced to these.
fn animation(
    count: usize,
    colours: Option<&IndexedColours>,
    frame: impl Fn(usize) -> Result<Canvas, PictureError> + Sync,
) -> Result<Vec<u8>, PictureError> {
    let mut bytes = Vec::new();
    let first = frame(0)?;
    let mut encoder = png::Encoder::new(&mut bytes, first.width as u32, first.height as u32);
    encoder.set_color(if colours.is_some() { png::ColorType::Indexed } else { png::ColorType::Rgb });
    encoder.set_compression(png::Compression::High);
    if let Some(colours) = colours {
        encoder.set_palette(colours.bytes());
        encoder.set_filter(png::Filter::NoFilter);
    }
    if count > 1 {
        encoder.set_animated(count as u32, FOREVER)?;
        encoder.set_frame_delay((LENGTH / count).clamp(DELAYS[0], DELAYS[1]) as u16, 1000)?;
    }
    let pixels = |step: usize| -> Result<Vec<u8>, PictureError> {
        let frame = frame(step)?;
        Ok(colours.map_or_else(|| frame.pixels.clone(), |colours| colours.numbers(&frame)))
    };
    let mut writer = encoder.write_header()?;
    for start in (0..count).step_by(TOGETHER) {
        let frames: Vec<Vec<u8>> =
            (start..count.min(start + TOGETHER)).into_par_iter().map(pixels).collect::<Result<_, _>>()?;
        frames.iter().try_for_each(|frame| writer.write_image_data(frame))?;
    }
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::colour::ColourMap;
    use super::*;

    /// An animation of `count` frames of one grey each, the number of the frame times 5.
    fn read(count: usize, colours: Option<&IndexedColours>) -> png::Reader<std::io::Cursor<Vec<u8>>> {
        let frame = |step: usize| Ok(Canvas::new(3, 2, [5 * step as u8; 3]));
        let mut decoder = png::Decoder::new(std::io::Cursor::new(animation(count, colours, frame).unwrap()));
        decoder.set_transformations(png::Transformations::EXPAND);
        decoder.read_info().unwrap()
    }

    #[test]
    fn an_animation_has_its_frames_and_plays_in_a_loop() {
        let reduced = IndexedColours::new(ColourMap::Sequential, [255; 3]);
        for (colours, tolerance) in [(None, 0), (Some(&reduced), 10)] {
            let mut reader = read(40, colours);
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
    fn one_frame_is_a_picture() {
        assert!(read(1, None).info().animation_control.is_none());
    }
}
