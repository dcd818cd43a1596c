//! The commands, one file each.

mod check;
mod compare;
mod info;
mod quality;
mod reference;
mod report;
mod run;
mod table;

pub use check::check;
pub use compare::compare;
pub use info::info;
pub use report::{movies, report};
pub use run::{motion, run};

use crate::cli::Arguments;
use clap::CommandFactory;
use clap_complete::Shell;
use simulation::Failure;
use std::io::Write;

/// `stsolve schema`, as JSON or as a page in Markdown.
///
/// # Errors
/// If stdout cannot be written.
pub fn schema(markdown: bool) -> Result<(), Failure> {
    if markdown {
        return print(reference::markdown(case::schema().as_value()).trim_end());
    }
    print(&serde_json::to_string_pretty(&case::editor_schema()).map_err(Failure::bad_input)?)
}

/// `stsolve completions`
///
/// # Errors
/// If stdout cannot be written.
pub fn completions(shell: Shell) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "stsolve", &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// Writes to stdout. A reader that closes the pipe early, as `head` does, is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    match writeln!(std::io::stdout().lock(), "{text}") {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::solve(error)),
        _ => Ok(()),
    }
}
