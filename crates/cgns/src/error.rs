//! Errors of CGNS files.

use thiserror::Error;

/// Why a CGNS file gives no lists. Places are paths of nodes, `/Base/Zone/..`.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CgnsError {
    /// The operating system cannot read the file.
    #[error("{0}")]
    Read(String),
    /// The file has the old format of CGNS.
    #[error("this is a CGNS file in the old format ADF: convert it by `adf2hdf` or `cgnsconvert -h`")]
    Adf,
    /// The file has another format.
    #[error("this is no HDF5 file: save the mesh as CGNS in HDF5")]
    NotHdf5,
    /// The HDF5 library refuses the file.
    #[error("{place}: the HDF5 library cannot read this part, the file is damaged: {reason}")]
    Damaged {
        /// The node.
        place: String,
        /// The error of the library.
        reason: String,
    },
    /// The file holds something that gives no mesh.
    #[error("{place}: {problem}")]
    At {
        /// The node, perhaps with the number of an element.
        place: String,
        /// The problem, with the remedy.
        problem: String,
    },
}

impl CgnsError {
    pub(crate) fn at(place: impl Into<String>, problem: impl Into<String>) -> CgnsError {
        CgnsError::At { place: place.into(), problem: problem.into() }
    }

    pub(crate) fn damaged(place: &str, error: &hdf5::Error) -> CgnsError {
        CgnsError::Damaged { place: place.to_owned(), reason: error.to_string() }
    }
}
