//! `stsolve report`: one HTML page of a run, finished or not, that needs no network.
//!
//! | module | holds |
//! |---|---|
//! | `run_files` | the files of a run so far |
//! | `pictures` | fields and mesh at some of the steps, from the exact coefficients |
//! | `groups` | groups of history columns that share a chart |
//! | `chart`, `axis` | curves as SVG |
//! | `figures` | tables of all numbers of the summary |
//! | `page` | the page: `page.html`, `page.css`, `page.js` filled in |
//! | `html` | texts and numbers in HTML |

mod axis;
mod chart;
mod figures;
mod groups;
pub(crate) mod html;
mod page;
pub(crate) mod pictures;
mod run_files;

use crate::commands::print;
use crate::failure::Failure;
use run_files::RunFiles;
use std::path::Path;

/// Name of the page in the directory of the run.
pub const REPORT_FILE: &str = "report.html";

/// Writes the page of the run in `directory`, and prints its path.
///
/// # Errors
/// A directory without a run; a page that cannot be written.
pub fn report(directory: &Path) -> Result<(), Failure> {
    let run = RunFiles::read(directory)?;
    let pictures = match &run.result {
        Ok(reader) => pictures::draw(reader).map_err(|error| error.to_string()),
        Err(reason) => Err(reason.clone()),
    };
    let page = page::page(&run, &pictures);
    let path = directory.join(REPORT_FILE);
    output::write_atomically(&path, page.as_bytes())?;
    let shown = match &pictures {
        Ok(pictures) => format!("pictures at {} of the steps", pictures.frames.len()),
        Err(reason) => format!("no pictures: {reason}"),
    };
    print(&format!("{}: {:.1} MB, {shown}", path.display(), page.len() as f64 / 1e6))
}
