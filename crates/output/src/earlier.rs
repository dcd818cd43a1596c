//! The files of an earlier run in a directory.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::directory::RunDirectory;
use crate::error::OutputError;
use crate::files::{file_error, remove};
use crate::history::{HISTORY_FILE, HistoryTable};
use crate::reader::ResultReader;
use crate::result_file::RESULT_FILE;
use crate::summary::SUMMARY_FILE;

/// An earlier run, as described by its files.
///
/// A run has no `summary.json` until it ends, so a directory without one holds a run that was killed. A run killed before its first
/// checkpoint has no result, and leaves the rows of its history; killed before its first slab it leaves nothing, and is ignored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EarlierRun {
    /// Whether it reached its end.
    pub completed: bool,
    /// Why it stopped before its end, if known.
    pub reason: Option<String>,
    /// The time that it reached, if known.
    pub time: Option<f64>,
    /// Whether there is a result file, and with it a checkpoint.
    pub has_checkpoint: bool,
    /// Whether the run moved the mesh only, without a flow.
    pub is_mesh_alone: bool,
}

impl EarlierRun {
    /// The run whose files are in `directory`, if there is one.
    pub fn find(directory: &Path) -> Option<Self> {
        let has_checkpoint = is_there(&directory.join(RESULT_FILE));
        let (summary, last_time) = (summary(directory), last_time(directory));
        if !has_checkpoint && summary.is_null() && last_time.is_none() {
            return None;
        }
        Some(EarlierRun {
            completed: summary["completed"] == true,
            reason: summary["reason"].as_str().map(str::to_owned),
            time: summary["time"].as_f64().or(last_time),
            has_checkpoint,
            is_mesh_alone: match summary {
                Value::Null => holds_mesh_alone(&directory.join(RESULT_FILE)),
                summary => {
                    summary["mesh"].is_object()
                        && summary["unknowns"]["flow"].is_null()
                        && summary["structure"].is_null()
                }
            },
        })
    }
}

/// Whether the result at `path` has neither the coefficients of a flow nor the stress that every structure writes. False if it cannot be
/// read.
fn holds_mesh_alone(path: &Path) -> bool {
    let Ok(ResultReader { layout, .. }) = ResultReader::open(path) else { return false };
    layout.exact.iter().all(|array| array.name != "flow") && layout.fields.iter().all(|field| field.name != "von_mises")
}

/// Whether there is something at `path`, including a dangling link.
fn is_there(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// The summary of a run in `directory`. It is null if the file is missing, cannot be read, or is of another program.
fn summary(directory: &Path) -> Value {
    let text = fs::read_to_string(directory.join(SUMMARY_FILE)).unwrap_or_default();
    serde_json::from_str(&text).ok().filter(is_of_run).unwrap_or_default()
}

/// Whether a run wrote this summary.
fn is_of_run(summary: &Value) -> bool {
    summary["completed"].is_boolean()
}

/// The time of the last row of the history of a run.
fn last_time(directory: &Path) -> Option<f64> {
    if !starts_as_history(&fs::read(directory.join(HISTORY_FILE)).ok()?) {
        return None;
    }
    HistoryTable::read(directory).ok()?.column("t")?.last().copied()
}

/// Whether `text` starts as the history of a run, or is empty.
fn starts_as_history(text: &[u8]) -> bool {
    text.is_empty() || text.starts_with(b"t,dt,")
}

impl RunDirectory {
    /// A file in the directory with the name of a run's file, or of one of the `others` made from it, that another program has written; a run would
    /// destroy it. Where there is a history of a run, files of lines, slices and surfaces are those of that run.
    pub fn foreign_file(path: &Path, others: &[&str]) -> Option<PathBuf> {
        let (history, summary) = (path.join(HISTORY_FILE), path.join(SUMMARY_FILE));
        let is_summary = |text: Vec<u8>| serde_json::from_slice(&text).is_ok_and(|summary| is_of_run(&summary));
        if fs::read(&history).is_ok_and(|text| !starts_as_history(&text)) {
            return Some(history);
        }
        if fs::read(&summary).is_ok_and(|text| !is_summary(text)) {
            return Some(summary);
        }
        if is_there(&history) || is_there(&path.join(RESULT_FILE)) {
            return None;
        }
        let is_other = |path: &Path| path.file_name().is_some_and(|name| others.iter().any(|other| name == *other));
        let mut taken: Vec<PathBuf> =
            fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
        taken.retain(|path| is_of_series(path) || is_other(path));
        taken.into_iter().min()
    }

    /// Removes files that would be mistaken for the work of the new run. Of a resumed run that is the old summary. Of others it is the result and
    /// the history, too, with lines, slices and surfaces, and the `others` made from it.
    ///
    /// # Errors
    /// [`OutputError::File`] if the system refuses.
    pub fn clear(&self, resumed: bool, others: &[&str]) -> Result<(), OutputError> {
        remove(&self.path().join(SUMMARY_FILE))?;
        if resumed {
            return Ok(());
        }
        [&[RESULT_FILE, HISTORY_FILE], others].concat().iter().try_for_each(|name| remove(&self.path().join(name)))?;
        self.clear_series()
    }

    /// Removes lines, slices and surfaces.
    fn clear_series(&self) -> Result<(), OutputError> {
        let failed = |source| file_error(self.path(), source);
        for entry in fs::read_dir(self.path()).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if !is_of_series(&path) {
                continue;
            }
            remove(&path)?;
            let slabs = path.with_extension("");
            if path.extension().is_some_and(|extension| extension == "pvd") && slabs.is_dir() {
                clear_slabs(&slabs)?;
            }
        }
        Ok(())
    }
}

/// Removes the files of slabs in the folder of a slice, and the folder if nothing else is in it.
fn clear_slabs(folder: &Path) -> Result<(), OutputError> {
    let failed = |source| file_error(folder, source);
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        if entry.file_name().to_string_lossy().starts_with("slab_") {
            remove(&entry.path())?;
        }
    }
    let is_empty = fs::read_dir(folder).map_err(failed)?.next().is_none();
    if is_empty { fs::remove_dir(folder).map_err(failed) } else { Ok(()) }
}

/// Whether a run writes a line, a slice or a surface to a file of this name.
fn is_of_series(path: &Path) -> bool {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return false };
    let kinds = [("line_", ".csv"), ("surface_", ".csv"), ("surface_", ".vtkhdf"), ("slice_", ".pvd")];
    kinds.iter().any(|(prefix, extension)| name.starts_with(prefix) && name.ends_with(extension))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_run_is_told_by_its_files() {
        let directory = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(directory.path().join(name), text).unwrap();
        let find = || EarlierRun::find(directory.path());
        write("notes.txt", "not ours");
        write(HISTORY_FILE, "t,dt,newton\n");
        assert_eq!(find(), None, "killed before its first slab");
        write(HISTORY_FILE, "t,dt,newton\n0.5,0.5,3\n");
        let killed = EarlierRun { time: Some(0.5), ..Default::default() };
        assert_eq!(find(), Some(killed.clone()), "killed before its first checkpoint");
        write(RESULT_FILE, "");
        let killed = EarlierRun { has_checkpoint: true, ..killed };
        assert_eq!(find(), Some(killed.clone()));
        write(SUMMARY_FILE, r#"{"completed": true, "time": 2.0, "mesh": {}, "unknowns": {"flow": 8}}"#);
        assert_eq!(find(), Some(EarlierRun { completed: true, time: Some(2.0), ..killed }));
        write(SUMMARY_FILE, "torn");
        assert!(!find().unwrap().completed);
        let held = RunDirectory::open(directory.path()).unwrap();
        held.clear(true, &["report.html"]).unwrap();
        assert!(find().unwrap().has_checkpoint);
        let series = ["line_a.csv", "surface_b.csv", "surface_b.vtkhdf", "slice_c.pvd"];
        series.iter().for_each(|name| write(name, ""));
        fs::create_dir(directory.path().join("slice_c")).unwrap();
        write("slice_c/slab_000000.vtp", "");
        write("slice_c/notes.txt", "not ours");
        held.clear(false, &["report.html"]).unwrap();
        assert!(
            directory.path().join("slice_c/notes.txt").exists()
                && !directory.path().join("slice_c/slab_000000.vtp").exists()
        );
        fs::remove_dir_all(directory.path().join("slice_c")).unwrap();
        assert_eq!(find(), None);
        // Lines, slices and surfaces of the replaced run lay beside the summary of the new one.
        let left = |name: &&str| directory.path().join(name).exists();
        assert!(!series.iter().chain(&["slice_c"]).any(left));
        assert!(directory.path().join("notes.txt").exists() && !directory.path().join(HISTORY_FILE).exists());
    }

    /// A summary of another program was told as that of a run.
    #[test]
    fn files_of_another_program_are_recognised() {
        let directory = tempfile::tempdir().unwrap();
        let [history, summary] = [HISTORY_FILE, SUMMARY_FILE].map(|name| directory.path().join(name));
        let foreign = || RunDirectory::foreign_file(directory.path(), &["report.html"]);
        assert_eq!(foreign(), None);
        // Tables of the user with such names were deleted without a word.
        for name in ["line_inflow.csv", "slice_photos.pvd", "report.html"] {
            let file = directory.path().join(name);
            fs::write(&file, "x,y\n").unwrap();
            assert_eq!(foreign(), Some(file.clone()));
            fs::remove_file(file).unwrap();
        }
        fs::write(directory.path().join("line_a.csv"), "t,s\n").unwrap();
        fs::write(&history, "t,dt,elasticity_iterations\n").unwrap();
        fs::write(&summary, r#"{"completed": false}"#).unwrap();
        assert_eq!(foreign(), None);
        fs::write(&summary, r#"{"total": 3}"#).unwrap();
        assert_eq!((EarlierRun::find(directory.path()), foreign()), (None, Some(summary)));
        fs::write(&history, "date,t\n1,2\n").unwrap();
        assert_eq!((EarlierRun::find(directory.path()), foreign()), (None, Some(history)));
    }
}
