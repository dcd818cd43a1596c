//! Why there are no pictures.

/// Why there are no pictures.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// A file of an earlier version, which does not hold the mesh at rest.
    #[error("the result file does not hold the mesh at rest; a new run writes it")]
    NoMesh,
    /// No step has been written yet.
    #[error("no step has been written yet")]
    NoStep,
    /// The case in the file has no ratio of specific heats.
    #[error("the case in the result file has no usable `flow.gas.gamma`")]
    Gas,
    /// The case in the file cannot be checked again.
    #[error("this field needs the case in the result file, which cannot be read: {0}")]
    Case(String),
    /// The file cannot be read.
    #[error(transparent)]
    Output(#[from] output::OutputError),
    /// A field without pictures.
    #[error("there are no pictures of `{name}`; accepted: {}", accepted.join(", "))]
    NoField {
        /// The name.
        name: String,
        /// The names of all fields with pictures.
        accepted: Vec<String>,
    },
    /// A window that the pictures do not have.
    #[error("there is no window `{name}`; accepted: {}", accepted.join(", "))]
    NoWindow {
        /// The name.
        name: String,
        /// The names of all windows.
        accepted: Vec<String>,
    },
    /// A window without a part of the mesh.
    #[error("the window `{name}` shows no part of the mesh, which reaches from {lower:?} to {upper:?}")]
    Outside {
        /// The name.
        name: String,
        /// The corner of the mesh with the smallest coordinates.
        lower: Vec<f64>,
        /// The corner with the largest coordinates.
        upper: Vec<f64>,
    },
    /// A range of colours in which there is no number.
    #[error("`{lower},{upper}` is no range of colours: give the lower value first")]
    NoRange {
        /// The first value.
        lower: f64,
        /// The second value.
        upper: f64,
    },
    /// A picture cannot be encoded.
    #[error("a picture cannot be encoded: {0}")]
    Png(#[from] png::EncodingError),
    /// A movie cannot be encoded as a GIF.
    #[error("a GIF cannot be encoded: {0}")]
    Gif(#[from] gif::EncodingError),
}
