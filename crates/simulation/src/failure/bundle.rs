//! The files of a failure: a report in words, the same as numbers, and a picture.

use super::diagnosis::{Cause, causes};
use super::finding::Finding;
use output::{OutputError, RESULT_FILE, write_atomically};
use serde_json::json;
use std::fmt::Write;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The folder, in the output directory.
pub const FOLDER: &str = "failure";

/// The report in words.
pub const TEXT_FILE: &str = "failure.md";

/// The same as numbers.
pub const NUMBERS_FILE: &str = "failure.json";

/// The worst cell and its neighbours.
pub const PICTURE_FILE: &str = "cell.svg";

/// The context of the report.
pub struct FailureReport<'a> {
    /// The case.
    pub case: &'a str,
    /// The error and its causes.
    pub error: &'a anyhow::Error,
    /// The time of the last good state.
    pub time: f64,
    /// The slabs done before it.
    pub slabs: usize,
    /// The command that continues from there; None if the run has reached its end.
    pub again: Option<&'a str>,
}

/// Removes the files that an earlier run has left in `directory`. Other files in the folder stay.
///
/// # Errors
/// A file that cannot be removed.
pub fn clear(directory: &Path) -> Result<(), OutputError> {
    let folder = directory.join(FOLDER);
    for path in [TEXT_FILE, NUMBERS_FILE, PICTURE_FILE].map(|name| folder.join(name)) {
        match std::fs::remove_file(&path) {
            Err(source) if !matches!(source.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                return Err(OutputError::File { path, source });
            }
            _ => {}
        }
    }
    // If the folder holds other files, it stays.
    let _ = std::fs::remove_dir(folder);
    Ok(())
}

/// Writes the files into a folder of `directory`. Returns the likeliest cause and the path of the report, for the end of a
/// message.
pub fn tell(directory: &Path, finding: &Finding, report: &FailureReport<'_>) -> String {
    match write(directory, finding, report) {
        Ok((path, causes)) => hint(&path, &causes),
        // The earlier failure is more important.
        Err(unwritten) => format!("\n  {unwritten}"),
    }
}

/// The path of the text, and the causes.
fn write(
    directory: &Path,
    finding: &Finding,
    report: &FailureReport<'_>,
) -> Result<(PathBuf, Vec<Cause>), OutputError> {
    let folder = directory.join(FOLDER);
    std::fs::create_dir_all(&folder).map_err(|source| OutputError::File { path: folder.clone(), source })?;
    let causes = causes(&finding.data);
    if let Some(cell) = &finding.cell {
        write_atomically(&folder.join(PICTURE_FILE), cell.svg.as_bytes())?;
    }
    write_atomically(&folder.join(NUMBERS_FILE), numbers(finding, &causes, report).as_bytes())?;
    let path = folder.join(TEXT_FILE);
    write_atomically(&path, text(finding, &causes, report).as_bytes())?;
    Ok((path, causes))
}

fn hint(path: &Path, causes: &[Cause]) -> String {
    let likeliest = causes
        .first()
        .map_or_else(String::new, |cause| format!("\n  likely cause: {}\n  remedy: {}", cause.what, cause.remedy));
    format!("{likeliest}\n  more causes, the worst cell: {}", path.display())
}

fn numbers(finding: &Finding, causes: &[Cause], report: &FailureReport<'_>) -> String {
    let residuals: serde_json::Map<_, _> =
        finding.residuals.iter().map(|(name, norm)| ((*name).to_owned(), json!(norm))).collect();
    let all = json!({
        "case": report.case,
        "error": coupled::chain(report.error.as_ref()),
        "causes": causes,
        "last_good_state": { "file": format!("../{RESULT_FILE}"), "time": report.time, "slabs": report.slabs },
        "worst_cell": finding.cell,
        "residuals": residuals,
        "failure_data": finding.data,
    });
    format!("{all:#}\n")
}

fn text(finding: &Finding, causes: &[Cause], report: &FailureReport<'_>) -> String {
    let FailureReport { case, error, time, slabs, again } = report;
    let ended = if again.is_some() { "stopped at" } else { "is no longer good after" };
    let mut text = format!("# `{case}` {ended} t = {time}, after {slabs} slabs\n\n");
    for message in error.chain() {
        let _ = writeln!(text, "* {message}");
    }
    text += "\n## Likely causes, the likeliest first\n\n";
    for (number, Cause { what, remedy, .. }) in causes.iter().enumerate() {
        let _ = writeln!(text, "{}. {}.\n   Remedy: {remedy}.", number + 1, capitalised(what));
    }
    if causes.is_empty() {
        text += "None is known for this kind of failure.\n";
    }
    text += &worst_cell(finding);
    text += &residuals(finding);
    text += &last_good_state(report);
    text
}

fn last_good_state(FailureReport { time, again, .. }: &FailureReport<'_>) -> String {
    let next = match again {
        Some(again) => format!(
            "The checkpoint in `../{RESULT_FILE}`, at t = {time}. With the settings of this run the next attempt starts from there:\n\n    \
             {again}\n\nWith another solver (`[solver]`) it does so too. With other changes the run must begin anew: `--force`, which removes this folder, or another `--output`."
        ),
        None => format!(
            "`../{RESULT_FILE}` holds it, at t = {time} or before, and what came after: the motion was followed to its end."
        ),
    };
    format!("\n## Last good state\n\n{next}\n")
}

fn worst_cell(finding: &Finding) -> String {
    let Some(cell) = &finding.cell else { return String::new() };
    let boundaries = match &cell.boundaries[..] {
        [] => "inside the domain".to_owned(),
        names => format!("on `{}`", names.join("`, `")),
    };
    format!(
        "\n## Worst cell\n\nCell {}, {boundaries}, with its centre at {:?}: {}.\n\n![the cell and its neighbours]({PICTURE_FILE})\n",
        cell.cell, cell.centre, cell.because
    )
}

/// The residuals of a flow. For a mesh or structure alone Newton's method solves no such equations.
fn residuals(finding: &Finding) -> String {
    if finding.data.gas.is_none() {
        return String::new();
    }
    let mut text = "\n## Residual of each equation at last\n\n".to_owned();
    if finding.residuals.is_empty() {
        text += "There is none: the run stopped before the equations of a slab could be evaluated, or after they were solved.\n";
    }
    for (name, norm) in &finding.residuals {
        let _ = writeln!(text, "* {name}: {norm:.3e}");
    }
    if let Some(newton) = &finding.data.newton {
        let history: Vec<String> = newton.residuals.iter().map(|norm| format!("{norm:.1e}")).collect();
        let _ = writeln!(text, "\nThe whole residual after each Newton step: {}", history.join(", "));
    }
    text
}

/// The sentence with a capital first letter.
pub fn capitalised(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().collect::<String>() + letters.as_str())
}
