//! `stsolve report`

use super::print;
use report::{ReportError, Scenario};
use simulation::Failure;
use std::path::{Path, PathBuf};

const ONE_RUN: &str = "`--q-level` is for the page of one run: the page of several has no pictures; give one directory";

/// Writes the page of the run in a directory, with surfaces of the Q criterion at a level if it is given, or that of the runs in several
/// `directories`, and prints its path.
///
/// # Errors
/// A directory without a run; a page that cannot be written.
pub fn report(directories: &[PathBuf], q_level: Option<f64>) -> Result<(), Failure> {
    let page = match directories {
        [directory] => report::write_at(directory, q_level),
        _ if q_level.is_some() => return Err(Failure::bad_input(anyhow::anyhow!(ONE_RUN))),
        several => report::write_comparison(several),
    };
    let page = page.map_err(failure)?;
    let shown = match &page.pictures {
        Ok(steps) => format!("pictures at {steps} of the steps"),
        Err(_) if directories.len() > 1 => format!("the curves of {} runs", directories.len()),
        Err(reason) => format!("no pictures: {reason}"),
    };
    print(&format!("{}: {:.1} MB, {shown}", page.path.display(), page.bytes as f64 / 1e6))
}

/// Writes a movie into the directory of each run, or a picture if `last_step` alone is wanted, and prints its path.
///
/// # Errors
/// A directory without a run or a result; an unknown field or window; a file that cannot be written.
pub fn movies(directories: &[PathBuf], scenario: &Scenario, last_step: bool) -> Result<(), Failure> {
    directories.iter().try_for_each(|directory| movie(directory, scenario, last_step))
}

fn movie(directory: &Path, scenario: &Scenario, last_step: bool) -> Result<(), Failure> {
    let write = if last_step { report::write_picture } else { report::write_movie };
    let movie = write(directory, scenario).map_err(failure)?;
    let size = movie.bytes as f64 / 1e6;
    let frames = if movie.frames == 1 { "1 frame".to_owned() } else { format!("{} frames", movie.frames) };
    print(&format!("{}: {size:.1} MB, {frames}, {}", movie.path.display(), movie.window))
}

fn failure(error: ReportError) -> Failure {
    match error {
        ReportError::Output(error) => error.into(),
        error @ (ReportError::NoRun { .. } | ReportError::Plane { .. } | ReportError::NoPicture(_)) => {
            Failure::bad_input(error)
        }
    }
}
