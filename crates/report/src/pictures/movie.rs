//! Movies: one field in one window at all steps, as an animated PNG that plays in a loop.

use super::canvas::{Canvas, LETTER_HEIGHT, width};
use super::drawn::Drawn;
use super::encode::{COLOURS, palette};
use super::quantity::{Quantity, Range};
use super::snapshot::Scheme;
use super::view::View;
use super::window::Window;
use super::{MOST_STEPS, PictureError, chosen, gas, ranges};
use crate::html::with_digits;
use output::ResultReader;
use rayon::prelude::*;

/// A movie.
pub struct Movie {
    /// The file.
    pub bytes: Vec<u8>,
    /// The number of its frames, one for every step of the result file.
    pub frames: usize,
    /// The name of its window.
    pub window: String,
}

/// The field, its colours and the window of a movie.
struct Shot {
    quantity: (Quantity, Range),
    window: Window,
}

/// Frames that are drawn at the same time.
const TOGETHER: usize = 16;

/// The length of a movie and the shortest and the longest time of a frame, in milliseconds.
const LENGTH: usize = 10_000;
const DELAYS: [usize; 2] = [40, 150];

/// Rows below the picture: colours, and the numbers below them.
const LEGEND: usize = 60;
const BAR: usize = 14;
const GAP: usize = 10;

/// What a movie shows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scenario<'a> {
    /// The name of the field.
    pub field: &'a str,
    /// The name of the window. Without a name the movie shows the first window.
    pub window: Option<&'a str>,
    /// The Q of the surfaces in space, if it is given.
    pub q_level: Option<f64>,
}

/// Makes a movie.
///
/// # Errors
/// A file without the data for pictures; names that are not known.
pub fn movie(reader: &ResultReader, scenario: &Scenario) -> Result<Movie, PictureError> {
    if reader.times.is_empty() {
        return Err(PictureError::NoStep);
    }
    match reader.layout.grid.dimension {
        2 => movie_in::<2, 4>(reader, scenario),
        _ => movie_in::<3, 5>(reader, scenario),
    }
}

fn movie_in<const D: usize, const M: usize>(
    reader: &ResultReader,
    &Scenario { field, window, q_level }: &Scenario,
) -> Result<Movie, PictureError> {
    let scheme = Scheme::<D>::new(reader, gas(reader)?).ok_or(PictureError::NoMesh)?;
    let scheme = scheme.showing(vec![named(reader, field)?]);
    let steps = chosen(reader.times.len(), MOST_STEPS);
    let snapshots = steps.iter().map(|&step| scheme.at(reader, step)).collect::<Result<Vec<_>, _>>()?;
    let view = View::<D>::new::<M>(reader, &snapshots, q_level);
    let quantity = ranges::<D, M>(scheme.quantities(), &view, &snapshots)[0];
    drop(snapshots);
    let shot = Shot { quantity, window: chosen_window(&view.windows, window)? };
    let draw = |step: usize| -> Result<Canvas, PictureError> {
        let drawn = view.draw::<M>(&scheme.at(reader, step)?, std::slice::from_ref(&shot.window), &[quantity]);
        Ok(shot.frame(&drawn[0].0, reader.times[step]))
    };
    let bytes = animation(reader.times.len(), draw)?;
    Ok(Movie { bytes, frames: reader.times.len(), window: shot.window.label })
}

/// The quantity of a name.
fn named(reader: &ResultReader, name: &str) -> Result<Quantity, PictureError> {
    let arrays: Vec<&str> = reader.layout.exact.iter().map(|array| &array.name[..]).collect();
    let known = Quantity::of_movies(arrays.contains(&"flow"), &arrays);
    let accepted = || known.iter().map(|quantity| quantity.name()).collect();
    let found = known.iter().find(|quantity| quantity.name() == name).copied();
    found.ok_or_else(|| PictureError::NoField { name: name.to_owned(), accepted: accepted() })
}

/// The window of a name, or the first one.
fn chosen_window(windows: &[Window], name: Option<&str>) -> Result<Window, PictureError> {
    let accepted = || windows.iter().map(|window| window.label.clone()).collect();
    let found = windows.iter().find(|window| name.is_none_or(|name| window.label == name)).cloned();
    found.ok_or_else(|| PictureError::NoWindow { name: name.unwrap_or_default().to_owned(), accepted: accepted() })
}

/// An animated PNG of `count` frames of one size, which plays in a loop.
fn animation(
    count: usize,
    frame: impl Fn(usize) -> Result<Canvas, PictureError> + Sync,
) -> Result<Vec<u8>, PictureError> {
    let mut bytes = Vec::new();
    let first = frame(0)?;
    let mut encoder = png::Encoder::new(&mut bytes, first.width as u32, first.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.set_animated(count as u32, FOREVER)?;
    encoder.set_frame_delay((LENGTH / count).clamp(DELAYS[0], DELAYS[1]) as u16, 1000)?;
    let mut writer = encoder.write_header()?;
    for start in (0..count).step_by(TOGETHER) {
        let frames: Vec<Canvas> =
            (start..count.min(start + TOGETHER)).into_par_iter().map(&frame).collect::<Result<_, _>>()?;
        frames.iter().try_for_each(|frame| writer.write_image_data(&frame.pixels))?;
    }
    writer.finish()?;
    Ok(bytes)
}

/// How often a movie is played.
const FOREVER: u32 = 0;

impl Shot {
    /// A frame: the picture, and below it the colours with their numbers and the time.
    fn frame(&self, drawn: &Drawn, time: f64) -> Canvas {
        let Window { width, height, .. } = self.window;
        let (quantity, _) = self.quantity;
        let colours = palette(quantity.colours());
        let mut canvas = Canvas::new(width, height + LEGEND, [255; 3]);
        let ground = quantity.ground().unwrap_or([255; 3]);
        for (pixel, (&number, &covered)) in drawn.numbers[0].iter().zip(&drawn.outline.coverage).enumerate() {
            let colour = if number == 0 { ground } else { colours[usize::from(number)] };
            canvas.set(pixel % width, pixel / width, colour);
            canvas.mix(pixel, drawn.outline_colour, f64::from(covered));
        }
        self.legend(&mut canvas, time);
        canvas
    }

    fn legend(&self, canvas: &mut Canvas, time: f64) {
        let Window { width: pixels, height, .. } = self.window;
        let (quantity, range) = self.quantity;
        let (colours, left, bar) = (palette(quantity.colours()), pixels / 4, pixels / 2);
        for k in 0..bar * BAR {
            let (column, row) = (k % bar, k / bar);
            canvas.set(left + column, height + GAP + row, colours[1 + column * COLOURS / bar]);
        }
        let below = height + GAP + BAR + LETTER_HEIGHT / 2;
        let [lower, upper] = [range.lower, range.upper].map(|value| with_digits(value, 3));
        let time = format!("t={}", with_digits(time, 4));
        let centred = |text: &str, at: usize| at.saturating_sub(width(text) / 2);
        canvas.write(&lower, centred(&lower, left), below);
        canvas.write(&upper, centred(&upper, left + bar), below);
        canvas.write(&time, centred(&time, pixels / 2), below);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn an_animation_has_its_frames_and_plays_in_a_loop() {
        let frame = |step: usize| Ok(Canvas::new(3, 2, [step as u8; 3]));
        let bytes = animation(40, frame).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let control = reader.info().animation_control.unwrap();
        assert_eq!((control.num_frames, control.num_plays), (40, 0));
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        for step in 0..40 {
            reader.next_frame(&mut pixels).unwrap();
            assert!(pixels.iter().all(|byte| *byte == step), "frame {step}");
        }
        assert!(reader.next_frame(&mut pixels).is_err());
    }

    #[test]
    fn a_window_that_is_not_there_is_refused_with_the_others() {
        let extent = super::super::window::Extent { lower: [0.0; 2], upper: [1.0; 2] };
        let windows = ["near the walls", "whole domain"].map(|label| Window::new(label, extent, 100.0));
        assert_eq!(chosen_window(&windows, None).unwrap().label, "near the walls");
        assert_eq!(chosen_window(&windows, Some("whole domain")).unwrap().label, "whole domain");
        let message = chosen_window(&windows, Some("whole")).unwrap_err().to_string();
        assert_eq!(message, "there is no window `whole`; accepted: near the walls, whole domain");
    }
}
