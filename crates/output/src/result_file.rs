//! `result.vtkhdf`: written step by step, published whole.

use std::fs;
use std::path::{Path, PathBuf};

use hdf5::File;

use crate::directory::RunDirectory;
use crate::error::OutputError;
use crate::files::{file_error, partial, publish};
use crate::format::{self, FORMAT_VERSION, Metadata};
use crate::lagrange::vtk_order;
use crate::layout::Layout;
use crate::state::{self, SolverState};
use crate::{hdf, seal, vtkhdf};

/// Name of the result file in the run directory.
pub const RESULT_FILE: &str = "result.vtkhdf";

/// One step: the grid and the solution at one time.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// Time.
    pub time: f64,
    /// Points, [cell][lattice point, lexicographic][3].
    pub points: &'a [f64],
    /// Every field of the layout, in any order: its name and [cell][lattice point, lexicographic][component].
    pub fields: &'a [(&'a str, &'a [f64])],
    /// Every array of coefficients of the layout, in any order: its name and its values, last axis fastest.
    pub exact: &'a [(&'a str, &'a [f64])],
}

/// The result file of a run. What is appended becomes visible with the next checkpoint.
#[derive(Debug)]
pub struct ResultFile {
    published: PathBuf,
    working: PathBuf,
    layout: Layout,
    /// VTK's number of each lattice point of a cell.
    order: Vec<usize>,
    /// The working copy, while there are steps that are not published.
    file: Option<File>,
}

impl ResultFile {
    /// Starts a result file without steps. An earlier result in the directory stays until the first checkpoint.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] if the file cannot be written.
    pub fn create(
        directory: &RunDirectory,
        layout: Layout,
        metadata: &Metadata,
    ) -> Result<Self, OutputError> {
        let mut result = Self::new(directory, layout);
        let create = || {
            let file = hdf::options().create(&result.working)?;
            vtkhdf::create(&file.create_group("VTKHDF")?, &result.layout)?;
            format::create(&file.create_group(format::GROUP)?, &result.layout, metadata)?;
            Ok(file)
        };
        let file = create().map_err(|source| result.write_error(source))?;
        result.file = Some(file);
        Ok(result)
    }

    /// Continues the result file of the directory after its last checkpoint, if its case has the fingerprint `case`.
    ///
    /// # Errors
    /// [`OutputError::NoCheckpoint`], [`OutputError::Damaged`], [`OutputError::Version`] or [`OutputError::OtherCase`].
    pub fn resume(
        directory: &RunDirectory,
        case: &str,
    ) -> Result<(Self, SolverState, Metadata), OutputError> {
        let path = directory.path().join(RESULT_FILE);
        let (metadata, state, layout) = read(&path)?;
        if metadata.case_fingerprint != case {
            return Err(OutputError::OtherCase {
                path,
                expected: case.to_owned(),
                found: metadata.case_fingerprint,
            });
        }
        Ok((Self::new(directory, layout), state, metadata))
    }

    fn new(directory: &RunDirectory, layout: Layout) -> Self {
        let published = directory.path().join(RESULT_FILE);
        Self {
            working: partial(&published),
            published,
            order: vtk_order(&layout.grid),
            layout,
            file: None,
        }
    }

    /// Path of the published file.
    pub fn path(&self) -> &Path {
        &self.published
    }

    /// What is written at each step.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Appends a step. Nothing is written if an array is missing or has a wrong length.
    ///
    /// # Errors
    /// [`OutputError::Absent`] or [`OutputError::Length`] if the step does not fit the layout, [`OutputError::Hdf5`] or
    /// [`OutputError::File`] if it cannot be written.
    pub fn append(&mut self, step: &Step) -> Result<(), OutputError> {
        self.check(step)?;
        self.open_working_copy()?;
        let Some(file) = &self.file else {
            return Ok(());
        };
        self.write_step(file, step)
            .map_err(|source| self.write_error(source))
    }

    fn check(&self, step: &Step) -> Result<(), OutputError> {
        let points = self.layout.grid.points();
        check_length("points", step.points, 3 * points)?;
        for field in &self.layout.fields {
            check_length(
                &field.name,
                find(step.fields, &field.name)?,
                field.components * points,
            )?;
        }
        for array in &self.layout.exact {
            check_length(&array.name, find(step.exact, &array.name)?, array.len())?;
        }
        Ok(())
    }

    fn write_step(&self, file: &File, step: &Step) -> hdf5::Result<()> {
        let (root, group) = (file.group("VTKHDF")?, file.group(format::GROUP)?);
        vtkhdf::append_points(&root, &self.to_vtk(step.points, 3))?;
        for field in &self.layout.fields {
            let values = find(step.fields, &field.name).unwrap_or_default();
            vtkhdf::append_field(&root, field, &self.to_vtk(values, field.components))?;
        }
        for array in &self.layout.exact {
            format::append_array(
                &group,
                &array.name,
                find(step.exact, &array.name).unwrap_or_default(),
            )?;
        }
        vtkhdf::close_step(&root, step.time, &self.layout)
    }

    /// Values in VTK's order of the points of each cell: from and to [cell][point][component].
    fn to_vtk(&self, lexicographic: &[f64], components: usize) -> Vec<f64> {
        let mut values = vec![0.0; lexicographic.len()];
        let cell = self.order.len() * components;
        for (from, to) in lexicographic
            .chunks_exact(cell)
            .zip(values.chunks_exact_mut(cell))
        {
            for (point, &vtk) in from.chunks_exact(components).zip(&self.order) {
                to[vtk * components..][..components].copy_from_slice(point);
            }
        }
        values
    }

    /// Publishes everything appended so far together with the state to continue from.
    ///
    /// The copy is forced to the disk before it takes the name of the result, so the cost grows with the file: space
    /// checkpoints such that this is a small part of the run.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] or [`OutputError::File`]; the last published file is then still in place.
    pub fn checkpoint(&mut self, state: &SolverState) -> Result<(), OutputError> {
        self.open_working_copy()?;
        let Some(file) = self.file.take() else {
            return Ok(());
        };
        let write = || {
            state::write(&file.group(format::GROUP)?, state)?;
            file.close()
        };
        write().map_err(|source| self.write_error(source))?;
        seal::write(&self.working)?;
        publish(&self.working, &self.published)
    }

    /// Opens the working copy, made from the published file if there is none.
    fn open_working_copy(&mut self) -> Result<(), OutputError> {
        if self.file.is_none() {
            fs::copy(&self.published, &self.working)
                .map_err(|source| file_error(&self.working, source))?;
            let file = hdf::options()
                .open_rw(&self.working)
                .map_err(|source| self.write_error(source))?;
            self.file = Some(file);
        }
        Ok(())
    }

    fn write_error(&self, source: hdf5::Error) -> OutputError {
        OutputError::Hdf5 {
            path: self.working.clone(),
            source,
        }
    }
}

impl Drop for ResultFile {
    /// Removes the unpublished copy. Nothing is lost if that fails: the next run overwrites it.
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            let _ = file.close();
        }
        let _ = fs::remove_file(&self.working);
    }
}

fn find<'a>(arrays: &[(&str, &'a [f64])], name: &str) -> Result<&'a [f64], OutputError> {
    let found = arrays.iter().find(|array| array.0 == name);
    found
        .map(|array| array.1)
        .ok_or_else(|| OutputError::Absent {
            name: name.to_owned(),
        })
}

fn check_length(name: &str, values: &[f64], expected: usize) -> Result<(), OutputError> {
    match values.len() {
        found if found == expected => Ok(()),
        found => Err(OutputError::Length {
            name: name.to_owned(),
            expected,
            found,
        }),
    }
}

/// Reads the checkpoint of a result file, of whatever case.
///
/// # Errors
/// [`OutputError::NoCheckpoint`] if there is no file, [`OutputError::Damaged`] if it cannot be trusted,
/// [`OutputError::Version`] if its format is not ours.
pub fn read_checkpoint(path: &Path) -> Result<(Metadata, SolverState), OutputError> {
    read(path).map(|(metadata, state, _)| (metadata, state))
}

fn read(path: &Path) -> Result<(Metadata, SolverState, Layout), OutputError> {
    let file = open(path)?;
    let read = || {
        let (group, vtkhdf) = (file.group(format::GROUP)?, file.group("VTKHDF")?);
        let layout = format::read_layout(&group, &vtkhdf)?;
        Ok((format::read_metadata(&group)?, state::read(&group)?, layout))
    };
    read().map_err(|error: hdf5::Error| damaged(path, &error))
}

/// Opens a result file for reading, once its seal and the version of its format are right: libhdf5 may crash on
/// damaged bytes and is not asked to judge them.
pub(crate) fn open(path: &Path) -> Result<File, OutputError> {
    if !path.exists() {
        return Err(OutputError::NoCheckpoint {
            path: path.to_owned(),
        });
    }
    seal::verify(path)?;
    let file = hdf::options()
        .open(path)
        .map_err(|error| damaged(path, &error))?;
    let version = file
        .group(format::GROUP)
        .and_then(|group| format::read_version(&group));
    match version.map_err(|error| damaged(path, &error))? {
        FORMAT_VERSION => Ok(file),
        found => Err(OutputError::Version {
            path: path.to_owned(),
            found,
            supported: FORMAT_VERSION,
        }),
    }
}

pub(crate) fn damaged(path: &Path, error: &hdf5::Error) -> OutputError {
    OutputError::Damaged {
        path: path.to_owned(),
        reason: error.to_string(),
    }
}
