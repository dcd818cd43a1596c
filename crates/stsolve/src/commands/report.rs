//! `stsolve report`

use super::print;
use report::ReportError;
use simulation::Failure;
use std::path::PathBuf;

/// Writes the page of the run in a directory, or that of the runs in several `directories`, and prints its path.
///
/// # Errors
/// A directory without a run; a page that cannot be written.
pub fn report(directories: &[PathBuf]) -> Result<(), Failure> {
    let page = match directories {
        [directory] => report::write(directory),
        several => report::write_comparison(several),
    };
    let page = page.map_err(|error| match error {
        ReportError::Output(error) => error.into(),
        error @ ReportError::NoRun { .. } => Failure::bad_input(error),
    })?;
    let shown = match &page.pictures {
        Ok(steps) => format!("pictures at {steps} of the steps"),
        Err(_) if directories.len() > 1 => format!("the curves of {} runs", directories.len()),
        Err(reason) => format!("no pictures: {reason}"),
    };
    print(&format!("{}: {:.1} MB, {shown}", page.path.display(), page.bytes as f64 / 1e6))
}
