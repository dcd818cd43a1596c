//! Output for users: fields at points, and one HTML page of a run, finished or not, that needs no network.
//!
//! This crate reads the files of a run and prints nothing.
//!
//! | module | holds |
//! |---|---|
//! | `fields` | fields for display, in the result file and the pictures |
//! | `simplices` | cells cut into simplices, and these by a surface |
//! | `run_files` | the files of a run so far |
//! | `pictures` | fields, mesh and vortices at some of the steps, from the exact coefficients; movies of all steps |
//! | `groups` | groups of history columns that share a chart |
//! | `charts`, `chart`, `axis` | curves as SVG |
//! | `figures` | tables of all numbers of the summary |
//! | `document` | the frame of all pages: `document.html`, `page.css`, `charts.js` and `pictures.js` |
//! | `page`, `panel`, `why` | the page of a run: `page.html` filled in; its pictures; why a run failed |
//! | `comparison` | several runs on one page: `comparison.html` filled in |
//! | `html` | texts and numbers in HTML |
//!
//! The page of a run that left only its history: curves, but no pictures.
//!
//! ```
//! use output::{History, RunDirectory};
//!
//! let place = tempfile::tempdir()?;
//! let directory = RunDirectory::open(place.path())?;
//! let mut history = History::create(&directory, &["t", "dt", "foil_lift_coefficient"].map(str::to_owned), &[])?;
//! history.push(&[0.5, 0.5, 0.75])?;
//! history.push(&[1.0, 0.5, 1.25])?;
//! drop(directory);
//!
//! let page = report::write(place.path())?;
//! assert_eq!(page.path, place.path().join(report::REPORT_FILE));
//! assert!(page.pictures.is_err(), "without a result file");
//! let html = std::fs::read_to_string(&page.path)?;
//! assert!(html.contains("foil_lift_coefficient") && html.contains("<svg"));
//! assert!(report::write(&place.path().join("elsewhere")).is_err());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axis;
mod chart;
mod charts;
mod comparison;
mod document;
pub mod fields;
mod figures;
mod groups;
pub mod html;
mod page;
mod panel;
pub mod pictures;
mod run_files;
pub mod simplices;
mod why;

use output::{HISTORY_FILE, OutputError, ResultReader};
pub use pictures::{MovieFormat, Scenario};
use run_files::RunFiles;
use std::path::{Path, PathBuf};

/// Name of the page in the directory of the run.
pub const REPORT_FILE: &str = "report.html";

/// Name of the page of several runs, in the directory of the first.
pub const COMPARISON_FILE: &str = "comparison.html";

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A directory that is none of a run.
    #[error(
        "`{directory}` is not the directory of a run: it has no {HISTORY_FILE}; give the directory that `stsolve run` or `stsolve \
         motion` has named"
    )]
    NoRun {
        /// The directory.
        directory: PathBuf,
    },
    /// A level of Q for a run without surfaces of Q.
    #[error(
        "`--q-level` is the level of surfaces in three dimensions, and the run in `{directory}` is plane: leave it out; `--picture q_criterion` \
         shows Q"
    )]
    Plane {
        /// The directory.
        directory: PathBuf,
    },
    /// A movie or a picture that cannot be made.
    #[error("no picture: {0}")]
    NoPicture(String),
    /// A file of the run that cannot be read, or the page that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// A page that was written.
#[derive(Clone, Debug)]
pub struct Page {
    /// The file.
    pub path: PathBuf,
    /// Its size.
    pub bytes: usize,
    /// The number of steps of which it shows pictures, or the reason why it shows none.
    pub pictures: Result<usize, String>,
}

/// Writes the page of the run in `directory`.
///
/// # Errors
/// A directory without a run; a page that cannot be written.
pub fn write(directory: &Path) -> Result<Page, ReportError> {
    write_at(directory, None)
}

/// The same with surfaces of the Q criterion at the level `q_level`, if it is given.
///
/// # Errors
/// As [`write()`].
pub fn write_at(directory: &Path, q_level: Option<f64>) -> Result<Page, ReportError> {
    let run = RunFiles::read(directory)?;
    check_level(&run, directory, q_level)?;
    let pictures = match &run.result {
        Ok(reader) => pictures::draw(reader, q_level).map_err(|error| error.to_string()),
        Err(reason) => Err(reason.clone()),
    };
    let page = page::page(&run, &pictures);
    let path = directory.join(REPORT_FILE);
    output::write_atomically(&path, page.as_bytes())?;
    Ok(Page { path, bytes: page.len(), pictures: pictures.map(|pictures| pictures.frames.len()) })
}

/// Whether the `run` has surfaces of Q, if their level is given.
fn check_level(run: &RunFiles, directory: &Path, q_level: Option<f64>) -> Result<(), ReportError> {
    let is_plane = run.result.as_ref().is_ok_and(|reader| reader.layout.grid.dimension == 2);
    match q_level {
        Some(_) if is_plane => Err(ReportError::Plane { directory: directory.to_owned() }),
        _ => Ok(()),
    }
}

/// A movie or a picture that was written.
#[derive(Clone, Debug)]
pub struct MovieFile {
    /// The file.
    pub path: PathBuf,
    /// Its size.
    pub bytes: usize,
    /// The number of its frames: of a movie one for every step of the result file, of a picture 1.
    pub frames: usize,
    /// The window that it shows.
    pub window: String,
}

/// Writes a movie of the run in `directory`, as the animated PNG `FIELD.png` or the GIF `FIELD.gif` there. A named window is
/// part of the name: `FIELD_WINDOW.png`.
///
/// # Errors
/// A directory without a run or without a result, an unknown field or window, a file that cannot be written.
pub fn write_movie(directory: &Path, scenario: &Scenario) -> Result<MovieFile, ReportError> {
    write_frames(directory, scenario, "", pictures::movie)
}

/// Writes a picture of the last step of the run in `directory`, as `FIELD_last.png` or `FIELD_WINDOW_last.png` there.
///
/// # Errors
/// As [`write_movie`].
pub fn write_picture(directory: &Path, scenario: &Scenario) -> Result<MovieFile, ReportError> {
    write_frames(directory, scenario, "_last", pictures::picture)
}

/// Writes what `draw` makes.
fn write_frames(
    directory: &Path,
    scenario: &Scenario,
    ending: &str,
    draw: impl Fn(&ResultReader, &Scenario) -> Result<pictures::Movie, pictures::PictureError>,
) -> Result<MovieFile, ReportError> {
    let run = RunFiles::read(directory)?;
    check_level(&run, directory, scenario.q_level)?;
    let reader = run.result.as_ref().map_err(|reason| ReportError::NoPicture(reason.clone()))?;
    // Without a name, the first field of the page.
    let field = if scenario.field.is_empty() { pictures::first_field(reader) } else { scenario.field };
    let scenario = &Scenario { field, ..*scenario };
    let movie = draw(reader, scenario).map_err(|error| ReportError::NoPicture(error.to_string()))?;
    let path = directory.join(file_name(scenario, ending));
    output::write_atomically(&path, &movie.bytes)?;
    Ok(MovieFile { path, bytes: movie.bytes.len(), frames: movie.frames, window: movie.window })
}

/// The name of the file of a movie or a picture.
fn file_name(&Scenario { field, window, format, .. }: &Scenario, ending: &str) -> String {
    let ending = format!("{ending}.{}", format.ending());
    // Signs and points tell windows apart.
    let parts = |c: char| !c.is_alphanumeric() && !"-.=".contains(c);
    let word = |name: &str| name.split(parts).filter(|w| !w.is_empty()).collect::<Vec<_>>().join("_");
    window.map_or_else(|| format!("{field}{ending}"), |window| format!("{field}_{}{ending}", word(window)))
}

/// Writes one page of the runs in `directories`, with their curves over each other, into the first of them.
///
/// # Errors
/// As [`write()`].
pub fn write_comparison(directories: &[PathBuf]) -> Result<Page, ReportError> {
    let runs = directories.iter().map(|directory| RunFiles::read(directory)).collect::<Result<Vec<_>, _>>()?;
    let page = comparison::page(&runs, &names(directories, &runs));
    let path = directories.first().map_or_else(PathBuf::new, |first| first.join(COMPARISON_FILE));
    output::write_atomically(&path, page.as_bytes())?;
    Ok(Page { path, bytes: page.len(), pictures: Err("only the page of one run has pictures".to_owned()) })
}

/// The names of the directories, or their paths if names are equal.
fn names(directories: &[PathBuf], runs: &[RunFiles]) -> Vec<String> {
    let alike = |run: &RunFiles| runs.iter().filter(|other| other.directory == run.directory).count() > 1;
    let path = |directory: &Path| directory.display().to_string();
    let name =
        |(directory, run): (&PathBuf, &RunFiles)| if alike(run) { path(directory) } else { run.directory.clone() };
    directories.iter().zip(runs).map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_of_a_movie_has_the_name_of_its_field_and_window() {
        let name = |window, ending| file_name(&Scenario { field: "mach", window, ..Scenario::default() }, ending);
        assert_eq!(name(None, ""), "mach.png");
        assert_eq!(name(Some("moving with the walls"), ""), "mach_moving_with_the_walls.png");
        assert_eq!(name(Some("vortices, along y"), "_last"), "mach_vortices_along_y_last.png");
        assert_eq!(name(Some("-2,-1.5,3,1"), ""), "mach_-2_-1.5_3_1.png", "it replaced that of 2,-15,3,1");
        let gif = Scenario { field: "mach", format: MovieFormat::Gif, ..Scenario::default() };
        assert_eq!(file_name(&gif, ""), "mach.gif");
    }
}
