//! Reading the steps of a result file.

use std::path::{Path, PathBuf};

use hdf5::{File, Hyperslab, SliceOrIndex};

use crate::checkpoint::Checkpoint;
use crate::error::OutputError;
use crate::format::{self, Metadata};
use crate::layout::FileLayout;
use crate::result_file::{damaged, open};
use crate::series::{self, Series};
use crate::{state, vtkhdf};

/// A published result file, open for reading. It remains readable when a running program publishes a newer one.
#[derive(Debug)]
pub struct ResultReader {
    path: PathBuf,
    file: File,
    /// Creator, case and mesh of the file.
    pub metadata: Metadata,
    /// The contents of each step.
    pub layout: FileLayout,
    /// Time of each step.
    pub times: Vec<f64>,
}

impl ResultReader {
    /// Opens the result file at `path`.
    ///
    /// # Errors
    /// [`OutputError::NoResult`] if there is no file, [`OutputError::Damaged`] if it is damaged, [`OutputError::Version`] if its format is not
    /// supported.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        let file = open(path)?;
        let read = || {
            let (group, root) = (file.group(format::GROUP)?, file.group("VTKHDF")?);
            Ok((format::read_metadata(&group)?, format::read_layout(&group, &root)?, vtkhdf::times(&root)?))
        };
        let (metadata, layout, times) = read().map_err(|error: hdf5::Error| damaged(path, &error))?;
        Ok(Self { path: path.to_owned(), file, metadata, layout, times })
    }

    /// The checkpoint, for any case. The arrays that stay `in_file` are not read yet.
    ///
    /// # Errors
    /// [`OutputError::Damaged`] if it cannot be read.
    pub fn checkpoint(&self, in_file: &[&str]) -> Result<Checkpoint, OutputError> {
        let read = || state::read(&self.file.group(format::GROUP)?, in_file);
        let (state, in_file) = read().map_err(|error| damaged(&self.path, &error))?;
        Ok(Checkpoint::new(state, in_file, self.path.clone()))
    }

    /// The coefficients `name` of a step, last axis fastest; none if the file has no array of this name.
    ///
    /// # Errors
    /// [`OutputError::Damaged`] if they cannot be read, or if there is no such step.
    pub fn exact(&self, name: &str, step: usize) -> Result<Option<Vec<f64>>, OutputError> {
        let Some(array) = self.layout.exact.iter().find(|array| array.name == name) else { return Ok(None) };
        let read = || {
            let dataset = self.file.dataset(&format!("{}/exact/{name}", format::GROUP))?;
            let whole = array.axes.iter().map(|_| SliceOrIndex::from(..));
            let step = std::iter::once(SliceOrIndex::from(step..step + 1));
            let values =
                dataset.read_slice::<f64, _, ndarray::IxDyn>(Hyperslab::from(step.chain(whole).collect::<Vec<_>>()))?;
            Ok(values.into_raw_vec_and_offset().0)
        };
        read().map(Some).map_err(|error: hdf5::Error| damaged(&self.path, &error))
    }

    /// The names of the series: arrays that are written at times of their own.
    ///
    /// # Errors
    /// [`OutputError::Damaged`] if they cannot be read.
    pub fn series_names(&self) -> Result<Vec<String>, OutputError> {
        let read = || series::names(&self.file.group(format::GROUP)?);
        read().map_err(|error: hdf5::Error| damaged(&self.path, &error))
    }

    /// The series `name`; none if the file has no series of this name.
    ///
    /// # Errors
    /// [`OutputError::Damaged`] if it cannot be read.
    pub fn series(&self, name: &str) -> Result<Option<Series>, OutputError> {
        if !self.series_names()?.iter().any(|other| other == name) {
            return Ok(None);
        }
        let read = || series::read(&self.file.group(format::GROUP)?, name);
        read().map(Some).map_err(|error: hdf5::Error| damaged(&self.path, &error))
    }
}
