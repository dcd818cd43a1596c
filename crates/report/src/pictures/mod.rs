//! Pictures of the fields at some of the steps of a result file, drawn from the exact coefficients.

mod animation;
mod average;
mod bounds;
mod budget;
mod canvas;
mod choice;
mod colour;
mod cuts;
mod drawn;
mod encode;
mod error;
mod indexed;
mod lettering;
mod lines;
mod medium;
mod movie;
mod near_walls;
mod patch;
mod plane;
mod quantity;
mod raster;
mod scheme;
mod shot;
mod snapshot;
mod space;
mod surface;
mod track;
mod view;
mod wall;
mod window;

pub use animation::MovieFormat;
pub use choice::first_field;
pub use colour::{ColourMap, css};
pub use cuts::Cut;
pub use error::PictureError;
pub use movie::{Movie, movie, picture};
pub use quantity::{PictureQuantity, Range, Scales};
pub use shot::Scenario;
pub use window::Window;

use budget::{chosen, fitting};
use medium::PictureMedium;
use output::ResultReader;
use rayon::prelude::*;
use scheme::Scheme;
use snapshot::Snapshot;
use view::View;

/// The largest number of steps with pictures.
const MOST_STEPS: usize = 40;

/// Pixels of the pictures from which the ranges of colours are taken.
const PREVIEW_PIXELS: f64 = 12e3;

/// The pictures of a run.
pub struct Pictures {
    /// 2 or 3.
    pub dimension: usize,
    /// The quantities, and the ranges of their colours.
    pub quantities: Vec<(PictureQuantity, Range)>,
    /// The displayed parts of the plane.
    pub windows: Vec<Window>,
    /// The displayed steps, in the order of time.
    pub frames: Vec<Frame>,
    /// In three dimensions: cuts at the last of the times.
    pub cuts: Vec<Cut>,
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
    let scheme = Scheme::<D>::new(reader, PictureMedium::simple(reader)?).ok_or(PictureError::NoMesh)?;
    let steps = chosen(reader.times.len(), MOST_STEPS);
    let snapshots = steps.iter().map(|&step| scheme.at(reader, step)).collect::<Result<Vec<_>, _>>()?;
    let view = View::<D>::new::<M>(reader, &snapshots, q_level);
    let quantities = ranges::<D, M>(scheme.quantities(), (&view, &view.windows[0]), &snapshots);
    let draw = |snapshot: &Snapshot<D>| {
        let drawn = view.draw::<M>(snapshot, &view.windows, &quantities);
        drawn.iter().map(|(drawn, shift)| drawn.encode(&quantities, *shift)).collect()
    };
    let views = snapshots.par_iter().map(draw).collect::<Result<Vec<Vec<Encoded>>, _>>()?;
    let frame = |(&step, views)| Frame { step, time: reader.times[step], views };
    let frames = steps.iter().zip(views).map(frame).collect();
    let cuts = snapshots.last().map_or(Ok(Vec::new()), |last| cuts::cuts::<D, M>(&view, last, &quantities))?;
    let (frames, cuts) = fitting(frames, cuts);
    Ok(Pictures { dimension: D, quantities, windows: view.windows, frames, cuts })
}

/// The ranges of colours in a window, the same at all times.
fn ranges<const D: usize, const M: usize>(
    quantities: &[PictureQuantity],
    (view, window): (&View<D>, &Window),
    snapshots: &[Snapshot<D>],
) -> Vec<(PictureQuantity, Range)> {
    let window = window.with_pixels(PREVIEW_PIXELS);
    let preview = |snapshot: &Snapshot<D>| view.raster::<M>(snapshot, &window, quantities.len());
    let previews: Vec<_> = snapshots.par_iter().map(preview).collect();
    let values = |q: usize| previews.iter().flat_map(|preview| preview.of(q)).collect();
    let speed = snapshots.iter().map(Snapshot::fastest_wave::<M>).fold(0.0, f64::max);
    let scales = Scales { length: view.mesh.length(), speed };
    quantities.iter().enumerate().map(|(q, quantity)| (*quantity, quantity.range(values(q), scales))).collect()
}
