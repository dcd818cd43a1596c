//! The pictures of one step in one window before and after they are encoded.

use super::encode::{line_layer, picture};
use super::lines::LineLayer;
use super::quantity::{PictureQuantity, Range};
use super::{Encoded, Picture};

/// Edges of cells.
const MESH_COLOUR: [u8; 3] = [0, 0, 0];

/// The pictures of one step in one window.
pub struct Drawn {
    /// Colour numbers of each quantity, `[row][column]`.
    pub numbers: Vec<Vec<u8>>,
    /// The smallest and the largest value of each quantity.
    pub extremes: Vec<Option<[f32; 2]>>,
    /// The edges of the cells.
    pub mesh: LineLayer,
    /// What lies above all pictures: boundaries, or the shadows of surfaces.
    pub outline: LineLayer,
    /// Its colour.
    pub outline_colour: [u8; 3],
    /// Its largest coverage.
    pub strongest: f64,
}

impl Drawn {
    /// The pictures as data URIs.
    ///
    /// # Errors
    /// As [`picture`].
    pub fn encode(
        &self,
        quantities: &[(PictureQuantity, Range)],
        shift: [f64; 2],
    ) -> Result<Encoded, png::EncodingError> {
        let LineLayer { width, height, .. } = self.outline;
        let encode = |(q, (quantity, _)): (usize, &(PictureQuantity, Range))| -> Result<Picture, png::EncodingError> {
            let uri = picture(width, height, &self.numbers[q], quantity.colours())?;
            Ok(Picture { uri, extremes: self.extremes[q] })
        };
        Ok(Encoded {
            pictures: quantities.iter().enumerate().map(encode).collect::<Result<_, _>>()?,
            mesh: line_layer(&self.mesh, MESH_COLOUR, 1.0)?,
            outline: line_layer(&self.outline, self.outline_colour, self.strongest)?,
            shift,
        })
    }
}

/// The smallest and the largest of the numbers among `values`.
pub fn extremes(values: impl Iterator<Item = f32>) -> Option<[f32; 2]> {
    let extend = |range: Option<[f32; 2]>, value: f32| {
        let [lower, upper] = range.unwrap_or([value; 2]);
        Some([lower.min(value), upper.max(value)])
    };
    values.filter(|value| value.is_finite()).fold(None, extend)
}
