//! The contents of a result file.

use std::path::Path;

use serde::Serialize;

use crate::error::OutputError;
use crate::format;
use crate::layout::FileLayout;
use crate::result_file::{damaged, open};
use crate::state;
use crate::vtkhdf;

/// Contents of a result file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResultInfo {
    /// Size of the file in bytes.
    pub bytes: u64,
    /// Version of the format.
    pub format_version: i64,
    /// Name and version of the program that wrote the file.
    pub creator: String,
    /// Name of the case.
    pub case_name: String,
    /// Checksum of the case.
    pub case_fingerprint: String,
    /// Checksum of the mesh.
    pub mesh_id: String,
    /// The layout of each step.
    pub layout: FileLayout,
    /// Number of space nodes per direction.
    pub space_nodes: usize,
    /// Number of time nodes per slab.
    pub time_nodes: usize,
    /// Time of each step.
    pub times: Vec<f64>,
    /// The state from which a run can be resumed.
    pub checkpoint: CheckpointInfo,
}

/// Contents of a checkpoint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckpointInfo {
    /// Names and lengths of the arrays.
    pub arrays: Vec<(String, usize)>,
    /// Counters.
    pub integers: Vec<(String, i64)>,
    /// Texts.
    pub texts: Vec<(String, String)>,
}

/// Reads the contents of the result file at `path`, and checks them.
///
/// # Errors
/// As [`crate::ResultReader::open`].
pub fn inspect(path: &Path) -> Result<ResultInfo, OutputError> {
    let file = open(path)?;
    read(&file).map_err(|error| damaged(path, &error))
}

fn read(file: &hdf5::File) -> hdf5::Result<ResultInfo> {
    let (group, root) = (file.group(format::GROUP)?, file.group("VTKHDF")?);
    let metadata = format::read_metadata(&group)?;
    Ok(ResultInfo {
        bytes: file.size(),
        format_version: format::read_version(&group)?,
        creator: metadata.creator,
        case_name: metadata.case_name,
        case_fingerprint: metadata.case_fingerprint,
        mesh_id: metadata.mesh_id,
        layout: format::read_layout(&group, &root)?,
        space_nodes: metadata.space_nodes.len(),
        time_nodes: metadata.time_nodes.len(),
        times: vtkhdf::times(&root)?,
        checkpoint: state::read(&group, &[])?.0.into(),
    })
}

impl From<state::SolverState> for CheckpointInfo {
    fn from(state: state::SolverState) -> Self {
        Self {
            arrays: state.arrays.into_iter().map(|(name, values)| (name, values.len())).collect(),
            integers: state.integers.into_iter().collect(),
            texts: state.texts.into_iter().collect(),
        }
    }
}
