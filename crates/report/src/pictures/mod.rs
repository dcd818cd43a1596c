//! Pictures of the fields at some of the steps of a result file, drawn from the exact coefficients.

mod average;
mod canvas;
mod colour;

mod drawn;
mod encode;
mod lines;
mod movie;
mod near_walls;
mod quantity;
mod raster;
mod snapshot;
mod space;
mod surface;
mod track;
mod view;
mod window;

pub use colour::{ColourMap, css};
pub use movie::{Movie, Scenario, movie};
pub use quantity::{Quantity, Range};
pub use window::Window;

use navier_stokes::{Gas, Viscosity};
use output::ResultReader;
use rayon::prelude::*;
use snapshot::{Scheme, Snapshot};
use view::View;

/// Why there are no pictures.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// A file of an earlier version, which does not hold the mesh at rest.
    #[error("the result file does not hold the mesh at rest; a new run writes it")]
    NoMesh,
    /// No step has been written yet.
    #[error("no step has been written yet")]
    NoStep,
    /// The case in the file does not tell the ratio of specific heats.
    #[error("the case in the result file has no usable `flow.gas.gamma`")]
    Gas,
    /// The file cannot be read.
    #[error(transparent)]
    Output(#[from] output::OutputError),
    /// A field without pictures.
    #[error("there are no pictures of `{name}`; accepted: {}", accepted.join(", "))]
    NoField {
        /// The name.
        name: String,
        /// The names of all fields with pictures.
        accepted: Vec<&'static str>,
    },
    /// A window that the pictures do not have.
    #[error("there is no window `{name}`; accepted: {}", accepted.join(", "))]
    NoWindow {
        /// The name.
        name: String,
        /// The names of all windows.
        accepted: Vec<String>,
    },
    /// A picture cannot be encoded.
    #[error("a picture cannot be encoded: {0}")]
    Png(#[from] png::EncodingError),
}

/// The largest number of steps with pictures.
const MOST_STEPS: usize = 40;

/// The largest size of all pictures in the page, in bytes.
const MOST_BYTES: usize = 9_000_000;

/// Pixels of the pictures from which the ranges of colours are taken.
const PREVIEW_PIXELS: f64 = 12e3;

/// The pictures of a run.
pub struct Pictures {
    /// 2 or 3.
    pub dimension: usize,
    /// The quantities, and the ranges of their colours.
    pub quantities: Vec<(Quantity, Range)>,
    /// The displayed parts of the plane.
    pub windows: Vec<Window>,
    /// The displayed steps, in the order of time.
    pub frames: Vec<Frame>,
}

/// The pictures of one step.
pub struct Frame {
    /// The step of the result file.
    pub step: usize,
    /// The time.
    pub time: f64,
    /// One for each window.
    pub views: Vec<Encoded>,
}

/// The pictures of one step in one window, as data URIs.
pub struct Encoded {
    /// One for each quantity.
    pub pictures: Vec<Picture>,
    /// The edges of the cells.
    pub mesh: String,
    /// The boundaries.
    pub outline: String,
    /// How far the window has moved.
    pub shift: [f64; 2],
}

/// One picture.
pub struct Picture {
    /// The data URI.
    pub uri: String,
    /// The smallest and the largest value in it.
    pub extremes: Option<[f32; 2]>,
}

impl Encoded {
    fn bytes(&self) -> usize {
        self.pictures.iter().map(|picture| picture.uri.len()).sum::<usize>() + self.mesh.len() + self.outline.len()
    }
}

/// Draws the pictures of a result file, with surfaces of the Q criterion at `q_level`, if it is given.
///
/// # Errors
/// A file without the data for pictures.
pub fn draw(reader: &ResultReader, q_level: Option<f64>) -> Result<Pictures, PictureError> {
    if reader.times.is_empty() {
        return Err(PictureError::NoStep);
    }
    match reader.layout.grid.dimension {
        2 => draw_in::<2, 4>(reader, q_level),
        _ => draw_in::<3, 5>(reader, q_level),
    }
}

fn draw_in<const D: usize, const M: usize>(
    reader: &ResultReader,
    q_level: Option<f64>,
) -> Result<Pictures, PictureError> {
    let scheme = Scheme::<D>::new(reader, gas(reader)?).ok_or(PictureError::NoMesh)?;
    let steps = chosen(reader.times.len(), MOST_STEPS);
    let snapshots = steps.iter().map(|&step| scheme.at(reader, step)).collect::<Result<Vec<_>, _>>()?;
    let view = View::<D>::new::<M>(reader, &snapshots, q_level);
    let quantities = ranges::<D, M>(scheme.quantities(), &view, &snapshots);
    let draw = |snapshot: &Snapshot<D>| {
        let drawn = view.draw::<M>(snapshot, &view.windows, &quantities);
        drawn.iter().map(|(drawn, shift)| drawn.encode(&quantities, *shift)).collect()
    };
    let views = snapshots.par_iter().map(draw).collect::<Result<Vec<Vec<Encoded>>, _>>()?;
    let frame = |(&step, views)| Frame { step, time: reader.times[step], views };
    let frames = thinned(steps.iter().zip(views).map(frame).collect());
    Ok(Pictures { dimension: D, quantities, windows: view.windows, frames })
}

/// `most` of `count` steps at equal distances, the first and the last among them.
fn chosen(count: usize, most: usize) -> Vec<usize> {
    let shown = count.min(most);
    (0..shown).map(|i| if shown > 1 { i * (count - 1) / (shown - 1) } else { 0 }).collect()
}

/// As many frames, at equal distances, as fit into the page.
fn thinned(frames: Vec<Frame>) -> Vec<Frame> {
    let bytes: usize = frames.iter().flat_map(|frame| &frame.views).map(Encoded::bytes).sum();
    let fitting = (frames.len() * MOST_BYTES).checked_div(bytes).unwrap_or(usize::MAX).max(2);
    let kept = chosen(frames.len(), fitting);
    frames.into_iter().enumerate().filter(|(i, _)| kept.binary_search(i).is_ok()).map(|(_, frame)| frame).collect()
}

/// The ranges of colours, the same at all times.
fn ranges<const D: usize, const M: usize>(
    quantities: &[Quantity],
    view: &View<D>,
    snapshots: &[Snapshot<D>],
) -> Vec<(Quantity, Range)> {
    let window = view.windows[0].with_pixels(PREVIEW_PIXELS);
    let previews: Vec<_> = snapshots.par_iter().map(|snapshot| view.raster::<M>(snapshot, &window)).collect();
    let values = |q: usize| previews.iter().flat_map(|preview| preview.of(q)).collect();
    quantities.iter().enumerate().map(|(q, quantity)| (*quantity, quantity.range(values(q)))).collect()
}

/// The gas of the case in the file. The pictures need only gamma; without a flow any gas will do.
fn gas(reader: &ResultReader) -> Result<Gas, PictureError> {
    let gamma = case::ratio_of_specific_heats_of(&reader.metadata.case_text).map_err(|_| PictureError::Gas)?;
    Gas::new(gamma.unwrap_or(1.4), 1.0, 1.0, Viscosity::Inviscid).map_err(|_| PictureError::Gas)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_and_the_last_step_are_shown() {
        assert_eq!(chosen(1, 40), [0]);
        assert_eq!(chosen(3, 40), [0, 1, 2]);
        assert_eq!(chosen(5, 3), [0, 2, 4]);
        let many = chosen(1001, 40);
        assert_eq!((many.len(), many[0], many[39]), (40, 0, 1000));
        assert!(many.is_sorted_by(|a, b| a < b));
    }

    #[test]
    fn too_many_pictures_are_thinned_out() {
        let view =
            || Encoded { pictures: vec![], mesh: "x".repeat(2_000_000), outline: String::new(), shift: [0.0; 2] };
        let frame = |step: usize| Frame { step, time: step as f64, views: vec![view()] };
        let steps = |count: usize| thinned((0..count).map(frame).collect()).iter().map(|f| f.step).collect::<Vec<_>>();
        assert_eq!(steps(4), [0, 1, 2, 3]);
        assert_eq!(steps(7), [0, 2, 4, 6]);
        assert_eq!(steps(100), [0, 33, 66, 99]);
    }
}
