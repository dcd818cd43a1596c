//! A result file that all ranks write together, each some of the cells.
//!
//! One rank writes everything else. It makes the room for the numbers of cells, and closes the file. Then all ranks open it, write and close it, and the
//! one rank goes on. The arrays have their room on the disk before they are shared, so no rank changes the structure of the file. Each rank writes whole
//! ranges of cells: large contiguous parts of the arrays, without the other ranks.

use std::path::{Path, PathBuf};

use hdf5::File;
use hdf5::file::FileAccessBuilder;
use ranks::FileSharing;

use crate::error::OutputError;
use crate::lagrange::vtk_order;
use crate::layout::FileLayout;
use crate::step::{Step, write_part};
use crate::{format, hdf, state};

/// A result file, open on all ranks.
#[derive(Debug)]
pub struct SharedFile {
    path: PathBuf,
    file: File,
    layout: FileLayout,
    /// VTK's number of each lattice point of a cell.
    order: Vec<usize>,
}

impl SharedFile {
    /// Opens the file at `path` on all ranks. A collective call.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] if it cannot be opened.
    pub fn open(path: &Path, layout: FileLayout, sharing: FileSharing) -> Result<Self, OutputError> {
        let mut options = hdf::options();
        options.with_fapl(|access| through(access, sharing));
        let file = options.open_rw(path).map_err(|source| OutputError::Hdf5 { path: path.to_owned(), source })?;
        Ok(SharedFile { path: path.to_owned(), file, order: vtk_order(&layout.grid), layout })
    }

    /// Writes a `part` of the step that is not closed yet, from the cell `first` on.
    ///
    /// # Errors
    /// [`OutputError::Absent`] or [`OutputError::Length`] if a field is missing or does not fit the points, [`OutputError::Hdf5`] if the part
    /// cannot be written.
    pub fn write_cells(&self, first: usize, part: &Step) -> Result<(), OutputError> {
        let fields = part.fields_in_order(&self.layout)?;
        let point = first * self.layout.grid.points_per_cell();
        let written = write_part(&self.file, (&self.layout, &self.order), (part, &fields), point, |_| first);
        written.map_err(|source| self.error(source))
    }

    /// Writes `values` to a long array of the state, from the number `first` on.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] if they cannot be written.
    pub fn write_state(&self, name: &str, first: usize, values: &[f64]) -> Result<(), OutputError> {
        let write = || state::write_part(&self.file.group(format::GROUP)?, name, first, values);
        write().map_err(|source| self.error(source))
    }

    /// Closes the file. A collective call.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] if what was written does not reach the disk.
    pub fn close(self) -> Result<(), OutputError> {
        let SharedFile { path, file, .. } = self;
        file.close().map_err(|source| OutputError::Hdf5 { path, source })
    }

    fn error(&self, source: hdf5::Error) -> OutputError {
        OutputError::Hdf5 { path: self.path.clone(), source }
    }
}

/// Threads of one process open the same file several times; processes open it together.
fn through(access: &mut FileAccessBuilder, sharing: FileSharing) -> &mut FileAccessBuilder {
    match sharing {
        FileSharing::Threads => access,
        FileSharing::Mpi => through_mpi(access),
    }
}

#[cfg(feature = "parallel-hdf5")]
fn through_mpi(access: &mut FileAccessBuilder) -> &mut FileAccessBuilder {
    access.mpio(message_passing::handle_of_world(), None)
}

/// No communicator shares files by MPI without the feature.
#[cfg(not(feature = "parallel-hdf5"))]
fn through_mpi(access: &mut FileAccessBuilder) -> &mut FileAccessBuilder {
    access
}
