//! A file for viewers only: a VTKHDF grid at some times, without exact coefficients and without a state.

use std::path::{Path, PathBuf};

use hdf5::File;

use crate::error::OutputError;
use crate::files::{partial, publish};
use crate::lagrange::vtk_order;
use crate::layout::FileLayout;
use crate::result_file::damaged;
use crate::step::Step;
use crate::{hdf, vtkhdf};

/// A file that appears with its name when it is complete.
#[derive(Debug)]
pub struct ViewerFile {
    path: PathBuf,
    file: File,
    layout: FileLayout,
    /// VTK's number of each lattice point of a cell.
    order: Vec<usize>,
}

impl ViewerFile {
    /// Starts the file at `path`, with grid and fields of `layout`.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] if the file cannot be written.
    pub fn create(path: &Path, layout: FileLayout) -> Result<Self, OutputError> {
        let create = || {
            let file = hdf::options().create(partial(path))?;
            vtkhdf::create(&file.create_group("VTKHDF")?, &layout)?;
            Ok(file)
        };
        let file = create().map_err(|source| write_error(path, source))?;
        Ok(Self { path: path.to_owned(), file, order: vtk_order(&layout.grid), layout })
    }

    /// Appends a step.
    ///
    /// # Errors
    /// [`OutputError::Absent`] or [`OutputError::Length`] if it does not fit the layout, [`OutputError::Hdf5`] if it cannot be written.
    pub fn append(&self, step: &Step) -> Result<(), OutputError> {
        step.check(&self.layout)?;
        let fields = step.fields_in_order(&self.layout)?;
        let write = || {
            let root = self.file.group("VTKHDF")?;
            let first = vtkhdf::times(&root)?.len() * self.layout.grid.points();
            vtkhdf::write_cells(&root, &self.layout, &self.order, first, (step.points, &fields))?;
            vtkhdf::close_step(&root, step.time, &self.layout)
        };
        write().map_err(|source| write_error(&self.path, source))
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] or [`OutputError::File`] if the system refuses.
    pub fn publish(self) -> Result<(), OutputError> {
        self.file.close().map_err(|source| write_error(&self.path, source))?;
        publish(&partial(&self.path), &self.path)
    }
}

/// The times of the steps of such a file, and the values of a field, or of the `Points`, at all these times. Points are in VTK's order.
///
/// # Errors
/// [`OutputError::Damaged`] if the file cannot be read or has no such field.
pub fn read_viewer_file(path: &Path, field: &str) -> Result<(Vec<f64>, Vec<f64>), OutputError> {
    let read = || {
        let root = hdf::options().open(path)?.group("VTKHDF")?;
        let name = if field == "Points" { field.to_owned() } else { format!("PointData/{field}") };
        Ok((vtkhdf::times(&root)?, root.dataset(&name)?.read_raw()?))
    };
    read().map_err(|error: hdf5::Error| damaged(path, &error))
}

fn write_error(path: &Path, source: hdf5::Error) -> OutputError {
    OutputError::Hdf5 { path: partial(path), source }
}
