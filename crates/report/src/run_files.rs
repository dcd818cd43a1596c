//! The files of a run so far.

use super::ReportError;
use output::{HISTORY_FILE, HistoryTable, OutputError, RESULT_FILE, ResultReader, RunDirectory, SUMMARY_FILE};
use serde_json::Value;
use std::path::Path;

/// The progress of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// A program is working on it.
    Running,
    /// The end time has been reached.
    Done,
    /// It ended early, for the given reason.
    Stopped(String),
    /// It was killed.
    Interrupted,
}

/// The files of a run, as far as they exist and belong to it.
pub struct RunFiles {
    /// The name of the directory.
    pub directory: String,
    /// The progress of the run.
    pub status: Status,
    /// history.csv
    pub history: HistoryTable,
    /// summary.json
    pub summary: Option<Value>,
    /// result.vtkhdf, or the reason why it is missing.
    pub result: Result<ResultReader, String>,
    /// The report of a failure.
    pub failure: Option<FailedRun>,
}

/// Why a run failed, from the folder `failure`.
#[derive(Clone, Debug, PartialEq)]
pub struct FailedRun {
    /// failure.json
    pub numbers: Value,
    /// The picture of the worst cell, as SVG.
    pub cell: Option<String>,
}

impl FailedRun {
    fn read(directory: &Path) -> Option<Self> {
        let folder = directory.join("failure");
        let text = std::fs::read_to_string(folder.join("failure.json")).ok()?;
        let cell = std::fs::read_to_string(folder.join("cell.svg")).ok();
        Some(FailedRun { numbers: serde_json::from_str(&text).ok()?, cell })
    }
}

impl RunFiles {
    /// Reads the files in `directory`, to which a run may be writing.
    ///
    /// # Errors
    /// A directory without a run, a history that cannot be read.
    pub fn read(directory: &Path) -> Result<Self, ReportError> {
        if !directory.join(HISTORY_FILE).is_file() {
            return Err(ReportError::NoRun { directory: directory.to_owned() });
        }
        let running = RunDirectory::is_held(directory);
        let history = HistoryTable::read(directory)?;
        let summary =
            if running { None } else { summary(directory, history.column("t").and_then(|t| t.last().copied())) };
        let status = match &summary {
            _ if running => Status::Running,
            None => Status::Interrupted,
            Some(summary) if summary["completed"] == true => Status::Done,
            Some(summary) => Status::Stopped(summary["reason"].as_str().unwrap_or("no reason is given").to_owned()),
        };
        let result = result(directory, &history);
        let failure = if running { None } else { FailedRun::read(directory) };
        Ok(RunFiles { directory: name(directory), status, history, summary, result, failure })
    }

    /// The time from which the flow is solved in a split form, because a slab could not be solved without.
    pub fn split_form_since(&self) -> Option<f64> {
        self.summary.as_ref()?["split_form_since"].as_f64()
    }

    /// The slabs done. The history has a row for each, and one without length for a steady start.
    pub fn slabs(&self) -> usize {
        let lengths = self.history.column("dt").unwrap_or_default();
        lengths.iter().filter(|dt| **dt > 0.0).count()
    }

    /// The name of the case.
    pub fn case_name(&self) -> &str {
        let of_result = || self.result.as_ref().ok().map(|reader| reader.metadata.case_name.as_str());
        let of_summary = || self.summary.as_ref().and_then(|summary| summary["case"].as_str());
        of_result().or_else(of_summary).unwrap_or(&self.directory)
    }

    /// The case in full, if the result is there.
    pub fn case_text(&self) -> Option<&str> {
        self.result.as_ref().ok().map(|reader| reader.metadata.case_text.as_str())
    }

    /// The title of the case, empty if it has none.
    pub fn title(&self) -> String {
        self.case_text().and_then(case::title_of).unwrap_or_default()
    }

    /// The names of the boundaries.
    pub fn boundaries(&self) -> &[String] {
        self.result.as_ref().map_or(&[], |reader| &reader.metadata.mesh.boundary_names)
    }
}

fn name(directory: &Path) -> String {
    let absolute = directory.canonicalize();
    let name = absolute.as_deref().unwrap_or(directory).file_name();
    name.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// summary.json, unless it belongs to an earlier run: its time must be the time of the last row of the history.
fn summary(directory: &Path, reached: Option<f64>) -> Option<Value> {
    let text = std::fs::read_to_string(directory.join(SUMMARY_FILE)).ok()?;
    let summary: Value = serde_json::from_str(&text).ok()?;
    let same = reached.map_or(summary["slabs"] == 0, |reached| summary["time"].as_f64() == Some(reached));
    same.then_some(summary)
}

/// The result, unless it belongs to an earlier run: no step may be later than the last slab of the history.
fn result(directory: &Path, history: &HistoryTable) -> Result<ResultReader, String> {
    let reader = ResultReader::open(&directory.join(RESULT_FILE)).map_err(|error| match error {
        OutputError::NoResult { .. } => format!("{RESULT_FILE} is not there: it appears with the first checkpoint"),
        error => error.to_string(),
    })?;
    let reached = history.column("t").and_then(|t| t.last().copied());
    match (reader.times.as_slice(), reached) {
        ([_, .., last], Some(reached)) if *last <= reached => Ok(reader),
        ([] | [_], _) => Ok(reader),
        _ => Err(format!(
            "{RESULT_FILE} reaches further than the history: it is that of an earlier run, which the first checkpoint replaces, or the \
             history has lost rows, which `--resume` writes again"
        )),
    }
}
