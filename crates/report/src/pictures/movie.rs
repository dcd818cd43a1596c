//! Movies and pictures: one field in one window, at all steps or at the last one.

use super::animation::{Frames, MovieFormat};
use super::canvas::Canvas;
use super::choice::{self, PictureField};
use super::error::PictureError;
use super::quantity::Range;
use super::scheme::Scheme;
use super::shot::{Scenario, Shot};
use super::view::View;
use super::{MOST_STEPS, chosen, ranges};
use output::ResultReader;

/// A movie, or a picture.
pub struct Movie {
    /// The file.
    pub bytes: Vec<u8>,
    /// The number of its frames.
    pub frames: usize,
    /// The name of its window.
    pub window: String,
}

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
    format: MovieFormat,
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
            None => ranges::<D, M>(&[quantity], (&view, &window), &snapshots)[0].1,
        };
        drop(snapshots);
        let shot = Shot {
            title: title(reader),
            quantity: (quantity, range),
            label: label.unwrap_or_else(|| quantity.label(D).to_owned()),
            window,
            without_edges: scenario.without_edges,
        };
        Ok(Studio { reader, scheme, view, shot, format: scenario.format })
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
        let draw = |k: usize| frame(steps.start + k);
        let bytes = Frames { count: steps.len(), colours: colours.as_ref(), draw }.encode(self.format)?;
        Ok(Movie { bytes, frames: steps.len(), window: self.shot.window.label })
    }
}
/// The title of the case, or its name.
fn title(reader: &ResultReader) -> String {
    let title = case::title_of(&reader.metadata.case_text).filter(|title| !title.is_empty());
    title.unwrap_or_else(|| reader.metadata.case_name.clone())
}
