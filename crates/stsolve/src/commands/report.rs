//! `stsolve report`

use super::print;
use report::ReportError;
use simulation::Failure;
use std::path::Path;

/// Writes the page of the run in `directory`, and prints its path.
///
/// # Errors
/// A directory without a run; a page that cannot be written.
pub fn report(directory: &Path) -> Result<(), Failure> {
    let page = report::write(directory).map_err(|error| match error {
        ReportError::Output(error) => error.into(),
        error @ ReportError::NoRun { .. } => Failure::bad_input(error),
    })?;
    let shown = match &page.pictures {
        Ok(steps) => format!("pictures at {steps} of the steps"),
        Err(reason) => format!("no pictures: {reason}"),
    };
    print(&format!("{}: {:.1} MB, {shown}", page.path.display(), page.bytes as f64 / 1e6))
}
