//! Where log records go: all to `log.jsonl`, for machines; those that the user asked for to stderr.

use crate::cli::Verbosity;
use crate::terminal::Terminal;
use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;
use std::sync::Mutex;
use tracing::level_filters::LevelFilter;
use tracing_subscriber::fmt::layer;
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;
use tracing_subscriber::{Layer, Registry};

/// Name of the log in the output directory.
pub const LOG_FILE: &str = "log.jsonl";

/// Starts logging into `directory`, behind the log of the run that is resumed or anew.
///
/// # Errors
/// If the log cannot be opened, or logging was started before.
pub fn start(directory: &Path, resume: bool, verbosity: Verbosity, terminal: &Terminal) -> io::Result<()> {
    let log = open(&directory.join(LOG_FILE), resume)?;
    let writer = terminal.clone();
    let human = layer().without_time().with_target(false).with_ansi(terminal.is_interactive());
    let human = human.with_writer(move || writer.clone()).with_filter(level(verbosity));
    let machine = layer().json().with_writer(Mutex::new(log)).with_filter(LevelFilter::DEBUG);
    Registry::default().with(machine).with(human).try_init().map_err(io::Error::other)
}

fn open(path: &Path, resume: bool) -> io::Result<File> {
    OpenOptions::new().create(true).write(true).append(resume).truncate(!resume).open(path)
}

fn level(verbosity: Verbosity) -> LevelFilter {
    match (verbosity.quiet, verbosity.verbose) {
        (true, _) => LevelFilter::ERROR,
        (_, 0) => LevelFilter::WARN,
        (_, 1) => LevelFilter::INFO,
        _ => LevelFilter::DEBUG,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn records_are_lines_of_json_whatever_is_printed() {
        let directory = tempfile::tempdir().unwrap();
        let quiet = Verbosity { quiet: true, verbose: 0 };
        start(directory.path(), false, quiet, &Terminal::default()).unwrap();
        tracing::debug!(slab = 3, residual = 0.5, "newton step");
        let log = std::fs::read_to_string(directory.path().join(LOG_FILE)).unwrap();
        let record: serde_json::Value =
            log.lines().map(|line| serde_json::from_str(line).unwrap()).next_back().unwrap();
        assert_eq!(record["level"], "DEBUG");
        assert_eq!((&record["fields"]["message"], &record["fields"]["slab"]), (&"newton step".into(), &3.into()));
    }

    #[test]
    fn a_resumed_run_keeps_the_log() {
        use std::io::Write;
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join(LOG_FILE);
        let write = |resume| writeln!(open(&path, resume).unwrap(), "line").unwrap();
        [false, true].into_iter().for_each(write);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "line\nline\n");
        write(false);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "line\n");
    }
}
