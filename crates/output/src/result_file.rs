//! `result.vtkhdf`: written step by step, published as a whole.

use std::fs;
use std::mem;
use std::path::{Path, PathBuf};

use hdf5::File;

use crate::checkpoint::Checkpoint;
use crate::directory::RunDirectory;
use crate::error::OutputError;
use crate::files::{file_error, partial, publish};
use crate::format::{self, FORMAT_VERSION, Metadata};
use crate::lagrange::vtk_order;
use crate::layout::{ArraySpec, FileLayout};
use crate::reader::ResultReader;
use crate::state::{self, ArrayInParts, SolverState};
use crate::step::{Step, StepInParts, checked};
use crate::{hdf, seal, series, vtkhdf};

/// Name of the result file in the run directory.
pub const RESULT_FILE: &str = "result.vtkhdf";

/// The result file of a run. Appended steps become visible with the next checkpoint.
#[derive(Debug)]
pub struct ResultFile {
    published: PathBuf,
    working: PathBuf,
    pub(crate) layout: FileLayout,
    /// VTK's number of each lattice point of a cell.
    pub(crate) order: Vec<usize>,
    copy: WorkingCopy,
    /// The description of a resumed run with another case, until that has replaced the case in the file.
    now: Option<Metadata>,
}

/// What stays of a former end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    /// The step.
    pub step: bool,
    /// The entries of series.
    pub series: bool,
}

/// The private file to which steps are appended.
#[derive(Debug)]
enum WorkingCopy {
    /// No private file: everything is published.
    None,
    Open(File),
    /// A write has failed. The content of the copy is unknown, so it is never published.
    Failed,
}

impl ResultFile {
    /// Starts a result file without steps. It appears in the directory with the first checkpoint.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] if the file cannot be written.
    pub fn create(directory: &RunDirectory, layout: FileLayout, metadata: &Metadata) -> Result<Self, OutputError> {
        let mut result = Self::new(directory, layout);
        let create = || {
            let file = hdf::options().create(&result.working)?;
            vtkhdf::create(&file.create_group("VTKHDF")?, &result.layout)?;
            format::create(&file.create_group(format::GROUP)?, &result.layout, metadata)?;
            Ok(file)
        };
        let file = create().map_err(|source| result.write_error(source))?;
        result.copy = WorkingCopy::Open(file);
        Ok(result)
    }

    /// Continues the result file of the directory after its last checkpoint, if `accept` finds nothing in its description
    /// and its state that prevents a continuation as `now`. The case of `now` replaces the one in the file. The arrays that stay `in_file`
    /// are not read yet.
    ///
    /// # Errors
    /// [`OutputError::NoCheckpoint`], [`OutputError::Damaged`], [`OutputError::Version`], or [`OutputError::OtherCase`] with the
    /// answer of `accept`.
    pub fn resume(
        directory: &RunDirectory,
        now: &Metadata,
        in_file: &[&str],
        accept: impl FnOnce(&Metadata, &SolverState) -> Result<(), String>,
    ) -> Result<(Self, Checkpoint), OutputError> {
        let path = directory.path().join(RESULT_FILE);
        let earlier = match ResultReader::open(&path) {
            Err(OutputError::NoResult { path }) => return Err(OutputError::NoCheckpoint { path }),
            opened => opened?,
        };
        let checkpoint = earlier.checkpoint(in_file)?;
        let ResultReader { metadata, layout, .. } = earlier;
        accept(&metadata, &checkpoint.state).map_err(|difference| OutputError::OtherCase { path, difference })?;
        let mut result = Self::new(directory, layout);
        result.now = (metadata.case_text != now.case_text).then(|| now.clone());
        Ok((result, checkpoint))
    }

    fn new(directory: &RunDirectory, layout: FileLayout) -> Self {
        let published = directory.path().join(RESULT_FILE);
        let (working, order) = (partial(&published), vtk_order(&layout.grid));
        Self { published, working, layout, order, copy: WorkingCopy::None, now: None }
    }

    /// Path of the published file.
    pub fn path(&self) -> &Path {
        &self.published
    }

    /// The contents of each step.
    pub fn layout(&self) -> &FileLayout {
        &self.layout
    }

    /// Appends a step. Nothing is written if an array is missing or has a wrong length.
    ///
    /// # Errors
    /// [`OutputError::Absent`] or [`OutputError::Length`] if the step does not fit the layout, [`OutputError::Hdf5`] or
    /// [`OutputError::File`] if it cannot be written.
    pub fn append(&mut self, step: &Step) -> Result<(), OutputError> {
        step.check(&self.layout)?;
        let mut parts = self.append_in_parts(step.time)?;
        parts.add(step)?;
        parts.finish()
    }

    /// Begins to append a step at a `time` that is too large to be made at once.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] or [`OutputError::File`] if the file cannot be written.
    pub fn append_in_parts(&mut self, time: f64) -> Result<StepInParts<'_>, OutputError> {
        let file = self.take_working_copy()?;
        Ok(StepInParts::new(self, file, time))
    }

    /// Keeps the working copy: what was written there is complete.
    pub(crate) fn keep(&mut self, file: File) {
        self.copy = WorkingCopy::Open(file);
    }

    /// Appends the `values` at a `time` to the series of `array`, which begins with its first values. A series has times of its own.
    ///
    /// # Errors
    /// [`OutputError::Length`] if the values do not fit the array, [`OutputError::Hdf5`] or [`OutputError::File`] if they cannot be
    /// written.
    pub fn append_to_series(&mut self, array: &ArraySpec, time: f64, values: &[f64]) -> Result<(), OutputError> {
        checked(&array.name, values, array.len())?;
        self.change(|file, _| series::extend(&file.group(format::GROUP)?, array, time, values))
    }

    /// Drops what a former end at `time` has added: the last step, and the last entry of each series. What is `kept` stays. A run whose
    /// only step is there has just begun, and keeps it.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] or [`OutputError::File`] if the file cannot be written.
    pub fn drop_former_end(&mut self, time: f64, kept: Kept) -> Result<(), OutputError> {
        if kept.step && kept.series {
            return Ok(());
        }
        self.change(|file, layout| {
            let (root, group) = (file.group("VTKHDF")?, file.group(format::GROUP)?);
            let times = vtkhdf::times(&root)?;
            if !kept.series {
                series::drop_at(&group, time)?;
            }
            if kept.step || times == [time] || times.last() != Some(&time) {
                return Ok(());
            }
            layout.exact.iter().try_for_each(|array| format::drop_array(&group, &array.name))?;
            vtkhdf::drop_step(&root, layout)
        })
    }

    /// The times of all steps, also of those that no checkpoint has published yet.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] or [`OutputError::File`] if the file cannot be read.
    pub fn step_times(&mut self) -> Result<Vec<f64>, OutputError> {
        let file = self.take_working_copy()?;
        let times = file.group("VTKHDF").and_then(|root| vtkhdf::times(&root));
        self.copy = WorkingCopy::Open(file);
        times.map_err(|source| self.write_error(source))
    }

    /// Changes the working copy by `work`.
    fn change(&mut self, work: impl FnOnce(&File, &FileLayout) -> hdf5::Result<()>) -> Result<(), OutputError> {
        let file = self.take_working_copy()?;
        work(&file, &self.layout).map_err(|source| self.write_error(source))?;
        self.copy = WorkingCopy::Open(file);
        Ok(())
    }

    /// Publishes everything appended so far together with the state to continue from.
    ///
    /// The copy is forced to the disk before it takes the name of the result, so the cost grows with the file. Choose
    /// the checkpoint interval such that this is a small part of the run.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] or [`OutputError::File`]; the last published file is then still in place.
    pub fn checkpoint(&mut self, state: &SolverState) -> Result<(), OutputError> {
        self.checkpoint_with(state, Vec::new())
    }

    /// The same for a state with `long` arrays, which are made while they are written.
    ///
    /// # Errors
    /// As [`Self::checkpoint`].
    pub fn checkpoint_with(&mut self, state: &SolverState, long: Vec<ArrayInParts<'_>>) -> Result<(), OutputError> {
        self.checkpoint_together(state, long, |_| Ok(()))
    }

    /// The same, where all ranks `write` the arrays [`crate::Parts::OfAllRanks`] by a [`crate::SharedFile`] at the path that they receive.
    ///
    /// # Errors
    /// As [`Self::checkpoint`], and those of `write`.
    pub fn checkpoint_together<E: From<OutputError>>(
        &mut self,
        state: &SolverState,
        long: Vec<ArrayInParts<'_>>,
        write_parts: impl FnOnce(&Path) -> Result<(), E>,
    ) -> Result<(), E> {
        let file = self.take_working_copy()?;
        let write = || {
            state::write(&file.group(format::GROUP)?, state, long)?;
            file.close()
        };
        write().map_err(|source| self.write_error(source))?;
        write_parts(&self.working)?;
        seal::write(&self.working)?;
        publish(&self.working, &self.published)?;
        self.copy = WorkingCopy::None;
        Ok(())
    }

    /// The working copy, made from the published file if there is none. It counts as failed until it is returned.
    fn take_working_copy(&mut self) -> Result<File, OutputError> {
        match mem::replace(&mut self.copy, WorkingCopy::Failed) {
            WorkingCopy::Open(file) => Ok(file),
            WorkingCopy::Failed => Err(self.write_error("an earlier step or checkpoint could not be written".into())),
            WorkingCopy::None => {
                fs::copy(&self.published, &self.working).map_err(|source| file_error(&self.working, source))?;
                self.open_copy().map_err(|source| self.write_error(source))
            }
        }
    }

    /// Whether other ranks can write to the arrays. They cannot in a file of an earlier program.
    ///
    /// # Errors
    /// [`OutputError::Hdf5`] or [`OutputError::File`] if the file cannot be written.
    pub fn can_be_shared(&mut self) -> Result<bool, OutputError> {
        let file = self.take_working_copy()?;
        let points = file.dataset("VTKHDF/Points").and_then(|points| hdf::is_allocated_early(&points));
        self.copy = WorkingCopy::Open(file);
        points.map_err(|source| self.write_error(source))
    }

    pub(crate) fn working(&self) -> &Path {
        &self.working
    }

    /// The working copy that was closed, open again.
    pub(crate) fn open_working(&mut self) -> Result<File, OutputError> {
        self.open_copy().map_err(|source| self.write_error(source))
    }

    /// The copy of the published file, with the new case if there is one.
    fn open_copy(&mut self) -> hdf5::Result<File> {
        let file = hdf::options().open_rw(&self.working)?;
        if let Some(now) = self.now.take() {
            format::replace_case(&file.group(format::GROUP)?, &now)?;
        }
        Ok(file)
    }

    pub(crate) fn write_error(&self, source: hdf5::Error) -> OutputError {
        OutputError::Hdf5 { path: self.working.clone(), source }
    }
}

impl Drop for ResultFile {
    /// Removes the unpublished copy. Nothing is lost if that fails: the next run overwrites it.
    fn drop(&mut self) {
        if let WorkingCopy::Open(file) = mem::replace(&mut self.copy, WorkingCopy::None) {
            let _ = file.close();
        }
        let _ = fs::remove_file(&self.working);
    }
}

/// Reads the checkpoint of a result file, for any case.
///
/// # Errors
/// As [`ResultReader::open`].
pub fn read_checkpoint(path: &Path) -> Result<(Metadata, SolverState), OutputError> {
    let result = ResultReader::open(path)?;
    let checkpoint = result.checkpoint(&[])?;
    Ok((result.metadata, checkpoint.state))
}

/// Opens a result file for reading after a check of its seal and of its format version, because libhdf5 may crash on
/// damaged bytes.
pub(crate) fn open(path: &Path) -> Result<File, OutputError> {
    if !path.exists() {
        return Err(OutputError::NoResult { path: path.to_owned() });
    }
    if !path.is_file() {
        let reason = "it is a directory, a pipe or a device, not a file".to_owned();
        return Err(OutputError::Damaged { path: path.to_owned(), reason });
    }
    seal::verify(path)?;
    let file = hdf::options().open(path).map_err(|error| damaged(path, &error))?;
    let version = file.group(format::GROUP).and_then(|group| format::read_version(&group));
    match version.map_err(|error| damaged(path, &error))? {
        FORMAT_VERSION => Ok(file),
        found => Err(OutputError::Version { path: path.to_owned(), found, supported: FORMAT_VERSION }),
    }
}

pub(crate) fn damaged(path: &Path, error: &hdf5::Error) -> OutputError {
    OutputError::Damaged { path: path.to_owned(), reason: error.to_string() }
}
