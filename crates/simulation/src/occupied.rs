//! Decides whether a run may write into its output directory: it replaces another run only on request, and never the run that it starts
//! from.

use crate::destination::{Destination, Existing};
use crate::error::Failure;
use crate::observer::{NextStep, Observer};
use crate::record::made_from_results;
use case::AnyCase;
use case::rounded_time;
use output::{EarlierRun, RESULT_FILE, ResultReader, RunDirectory};
use std::path::{Path, PathBuf};

/// The largest number of characters in a message of the reason why a run stopped.
const LONGEST_REASON: usize = 160;

/// Why a run may not write into its output directory.
#[derive(Debug, thiserror::Error)]
pub enum OccupiedError {
    /// The run to be replaced is the source of the restart.
    #[error(
        "the output directory `{directory}` holds the run from which this one starts, `restart.from`: it would destroy its own \
         source\n  write elsewhere: {elsewhere}"
    )]
    Source {
        /// The output directory.
        directory: PathBuf,
        /// How to write elsewhere.
        elsewhere: String,
    },
    /// There is an earlier run.
    #[error("the output directory `{directory}` holds {found}; it is not replaced unasked{remedies}")]
    Earlier {
        /// The output directory.
        directory: PathBuf,
        /// The run found.
        found: String,
        /// The remedies, one per line.
        remedies: String,
    },
    /// A file of another program has the name of a run's file.
    #[error("`{file}` was not written by stsolve, and a run would replace it; {elsewhere}")]
    Foreign {
        /// The file.
        file: PathBuf,
        /// How to write elsewhere.
        elsewhere: String,
    },
}

/// A run that is about to begin.
#[derive(Clone, Copy)]
pub struct Beginning<'a> {
    /// The result or the directory of the run from which it starts.
    pub source: Option<&'a Path>,
    /// Its resolved case.
    pub case: &'a str,
    /// Whether it moves the mesh alone.
    pub is_mesh_alone: bool,
}

impl<'a> Beginning<'a> {
    /// The run of a case.
    pub fn of_run(case: &'a AnyCase) -> Self {
        let is_mesh_alone = match case {
            AnyCase::Plane(case) => case.flow.is_none() && case.structure.is_none(),
            AnyCase::Space(case) => case.flow.is_none() && case.structure.is_none(),
        };
        Beginning { source: case.restart(), case: &case.about().resolved, is_mesh_alone }
    }
}

/// Checks the output directory before anything is computed. If another run holds it, nothing is checked here, because the lock
/// reports it.
///
/// # Errors
/// As [`check`].
pub fn check_unless_held(
    destination: &Destination,
    observer: &dyn Observer,
    beginning: Beginning<'_>,
) -> Result<(), Failure> {
    if RunDirectory::is_held(&destination.directory) { Ok(()) } else { check(destination, observer, beginning) }
}

/// Checks that a run may write to its `destination`.
///
/// # Errors
/// [`OccupiedError`]
pub fn check(destination: &Destination, observer: &dyn Observer, beginning: Beginning<'_>) -> Result<(), Failure> {
    let Destination { directory, existing } = destination;
    let Beginning { source, case, is_mesh_alone } = beginning;
    if *existing == Existing::Resume {
        return Ok(());
    }
    let elsewhere = observer.advice(NextStep::WriteElsewhere, directory);
    if source.is_some_and(|source| is_result_of(directory, source)) {
        return Err(Failure::bad_input(OccupiedError::Source { directory: directory.clone(), elsewhere }));
    }
    if *existing == Existing::Replace {
        return Ok(());
    }
    if let Some(earlier) = EarlierRun::find(directory) {
        let can_resume =
            earlier.has_checkpoint && earlier.is_mesh_alone == is_mesh_alone && may_continue(directory, case);
        let (found, remedies) = (described(&earlier), remedies(&earlier, can_resume, observer, directory));
        return Err(Failure::bad_input(OccupiedError::Earlier { directory: directory.clone(), found, remedies }));
    }
    match RunDirectory::foreign_file(directory, &made_from_results()) {
        Some(file) => Err(Failure::bad_input(OccupiedError::Foreign { file, elsewhere })),
        None => Ok(()),
    }
}

/// Whether the resolved case `now` may continue the run in `directory`: they differ in nothing that its states depend on.
fn may_continue(directory: &Path, now: &str) -> bool {
    let Ok(reader) = ResultReader::open(&directory.join(RESULT_FILE)) else { return false };
    let reached = reader.times.last().copied().unwrap_or(f64::INFINITY);
    let differences = case::differences_after(&reader.metadata.case_text, now, reached);
    differences.is_ok_and(|differences| differences.lasting.is_empty())
}

/// Whether the result in `directory` is named by `source`, directly or by its directory, through any links.
fn is_result_of(directory: &Path, source: &Path) -> bool {
    let source = if source.is_dir() { source.join(RESULT_FILE) } else { source.to_owned() };
    let real = |path: &Path| path.canonicalize().ok();
    let result = directory.join(RESULT_FILE);
    real(&source).is_some_and(|source| real(&result).is_some_and(|result| result == source))
}

fn described(run: &EarlierRun) -> String {
    let what = if run.is_mesh_alone { "run of the mesh alone" } else { "run" };
    let time = run.time.map_or(String::new(), |time| format!(", t = {}", rounded_time(time)));
    match &run.reason {
        _ if run.completed => format!("a finished {what}{time}"),
        None if !run.has_checkpoint => format!("an unfinished {what}{time}, without a checkpoint"),
        None => format!("an unfinished {what}{time}"),
        Some(reason) => {
            let first = reason.lines().next().unwrap_or_default();
            format!("an unfinished {what}{time} ({})", shortened(first))
        }
    }
}

/// The words of a `reason` that fit into [`LONGEST_REASON`].
fn shortened(reason: &str) -> String {
    let Some((end, _)) = reason.char_indices().nth(LONGEST_REASON) else { return reason.to_owned() };
    let words = reason[..end].rsplit_once(' ').map_or(&reason[..end], |(words, _)| words);
    format!("{} ...", words.trim_end_matches([',', ';', ':']))
}

/// A line for each possible intention of the user. Only a run of the same kind and case can be resumed.
fn remedies(run: &EarlierRun, can_resume: bool, observer: &dyn Observer, directory: &Path) -> String {
    let advice = |step| observer.advice(step, directory);
    let go_on = if run.completed { "go on to a later `time.end`" } else { "go on from its last checkpoint" };
    let mut lines = vec![];
    if can_resume {
        lines.push(format!("{go_on}: {}", advice(NextStep::Resume)));
    }
    lines.push(format!("replace it: {}", advice(NextStep::Replace)));
    lines.push(format!("keep both: {}", advice(NextStep::WriteElsewhere)));
    lines.push(advice(NextStep::Report));
    lines.iter().map(|line| format!("\n  {line}")).collect()
}
