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
