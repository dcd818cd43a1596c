//! Decides whether a run may write into its output directory: it replaces no other run unasked, and never the run that it
//! starts from.

use crate::cli::RunArguments;
use crate::commands::output_directory;
use crate::failure::Failure;
use crate::progress::rounded;
use output::{EarlierRun, RESULT_FILE, RunDirectory};
use std::path::{Path, PathBuf};

/// The largest number of characters in a message of the reason why a run stopped.
const LONGEST_REASON: usize = 160;

/// Why a run may not write into its output directory.
#[derive(Debug, thiserror::Error)]
pub enum OccupiedError {
    /// The run to be replaced is the source of the restart.
    #[error(
        "the output directory `{directory}` holds the run from which this one starts, `restart.from`: it would destroy its own \
         source\n  write elsewhere: add `--output` and another directory"
    )]
    Source {
        /// The output directory.
        directory: PathBuf,
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
    #[error("`{file}` was not written by stsolve, and a run would replace it; add `--output` and another directory")]
    Foreign {
        /// The file.
        file: PathBuf,
    },
}

/// Checks the output directory before anything is computed. If another run holds it, nothing is checked here, because the lock
/// reports it.
///
/// # Errors
/// As [`check`].
pub fn check_unless_held(
    arguments: &RunArguments,
    command: &str,
    directory: &Path,
    source: Option<&Path>,
) -> Result<(), Failure> {
    if RunDirectory::is_held(directory) { Ok(()) } else { check(arguments, command, directory, source) }
}

/// Checks that `command` may write into `directory`; `source` is the result or the directory of the run from which it starts.
///
/// # Errors
/// [`OccupiedError`]
pub fn check(arguments: &RunArguments, command: &str, directory: &Path, source: Option<&Path>) -> Result<(), Failure> {
    if arguments.resume {
        return Ok(());
    }
    let to_owned = directory.to_owned();
    if source.is_some_and(|source| is_result_of(directory, source)) {
        return Err(Failure::bad_input(OccupiedError::Source { directory: to_owned }));
    }
    if arguments.force {
        return Ok(());
    }
    if let Some(earlier) = EarlierRun::find(directory) {
        let (found, remedies) = (described(&earlier), remedies(&earlier, arguments, command, directory));
        return Err(Failure::bad_input(OccupiedError::Earlier { directory: to_owned, found, remedies }));
    }
    match RunDirectory::foreign_history(directory) {
        Some(file) => Err(Failure::bad_input(OccupiedError::Foreign { file })),
        None => Ok(()),
    }
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
    let time = run.time.map_or(String::new(), |time| format!(", t = {}", rounded(time)));
    match &run.reason {
        _ if run.completed => format!("a finished {what}{time}"),
        None => format!("an unfinished {what}{time}"),
        Some(reason) => {
            let first: String = reason.lines().next().unwrap_or_default().chars().take(LONGEST_REASON).collect();
            format!("an unfinished {what}{time} ({first})")
        }
    }
}

/// A line for each possible intention of the user.
fn remedies(run: &EarlierRun, arguments: &RunArguments, command: &str, directory: &Path) -> String {
    let again = |option| arguments.again(command, directory, option);
    let go_on = if run.completed { "go on to a later `time.end`" } else { "go on from its last checkpoint" };
    let mut lines = vec![];
    if run.has_checkpoint {
        lines.push(format!("{go_on}: {}", again("--resume")));
    }
    lines.push(format!("replace it: {}", again("--force")));
    lines.push("keep both: add `--output` and another directory".to_owned());
    lines.push(RunArguments::to_report(directory));
    lines.iter().map(|line| format!("\n  {line}")).collect()
}

/// Checks the directory of a run early.
///
/// # Errors
/// As [`check`].
pub fn check_case(case: &crate::case::AnyCase, arguments: &RunArguments, command: &str) -> Result<(), Failure> {
    let directory = output_directory(arguments, case.about(), case.output_directory());
    check_unless_held(arguments, command, &directory, case.restart())
}
