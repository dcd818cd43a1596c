//! Destinations of log records: all go to `log.jsonl`, for machines; the requested ones go to stderr. Of several ranks, those other than the
//! first one log nothing, or to files of their own.

use crate::cli::Verbosity;
use crate::terminal::Terminal;
use simulation::LOG_FILE;
use simulation::clock::CostClock;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use tracing::level_filters::LevelFilter;
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::filter::filter_fn;
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields, format, layer};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt;
use tracing_subscriber::{Layer, Registry};

/// Starts logging into `directory`. With `append` the log continues, otherwise it starts anew. The spans of the numerics drive `clock`.
///
/// # Errors
/// If logging has been started before.
pub fn start(
    directory: &Path,
    append: bool,
    verbosity: Verbosity,
    terminal: &Terminal,
    clock: &CostClock,
) -> io::Result<()> {
    let writer = terminal.clone();
    let human = layer().event_format(ForReaders).with_ansi(terminal.is_interactive());
    let human = human.with_writer(move || writer.clone()).with_filter(level(verbosity));
    let file = LogFile::new(directory, LOG_FILE, append);
    let clock = clock.clone().with_filter(filter_fn(CostClock::counts));
    Registry::default().with(machine(file)).with(human).with(clock).try_init().map_err(io::Error::other)
}

/// Starts logging into the file of `rank` in `directory`, see [`start`], and nowhere else. Records get lost until the first rank has made the
/// directory.
///
/// # Errors
/// If logging has been started before.
pub fn start_of_rank(directory: &Path, rank: usize, append: bool) -> io::Result<()> {
    let file = LogFile::new(directory, &log_file_of(rank), append);
    Registry::default().with(machine(file)).try_init().map_err(io::Error::other)
}

/// Writes records as lines of JSON into `file`. The modules that they come from say nothing to a reader.
fn machine(file: LogFile) -> impl Layer<Registry> {
    layer().json().with_target(false).with_writer(Mutex::new(file)).with_filter(LevelFilter::DEBUG)
}

/// Writes a record as a line for readers: "warning: " before a warning, and its fields after the message.
struct ForReaders;

impl<S, N> FormatEvent<S, N> for ForReaders
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(
        &self,
        context: &FmtContext<'_, S, N>,
        mut writer: format::Writer<'_>,
        event: &Event<'_>,
    ) -> std::fmt::Result {
        let level = event.metadata().level();
        match *level {
            Level::WARN => write!(writer, "warning: ")?,
            Level::INFO => {}
            _ => write!(writer, "{}: ", level.as_str().to_lowercase())?,
        }
        context.format_fields(writer.by_ref(), event)?;
        writeln!(writer)
    }
}

/// The name of the log of a rank other than the first one.
fn log_file_of(rank: usize) -> String {
    format!("log_{rank}.jsonl")
}

/// A file that is opened when the first record is written, so that a refused run leaves no trace.
#[derive(Debug)]
struct LogFile {
    path: PathBuf,
    append: bool,
    file: Option<File>,
}

impl LogFile {
    fn new(directory: &Path, name: &str, append: bool) -> Self {
        LogFile { path: directory.join(name), append, file: None }
    }

    fn open(&mut self) -> io::Result<&mut File> {
        let mut options = OpenOptions::new();
        options.create(true).write(true).append(self.append).truncate(!self.append);
        match &mut self.file {
            Some(file) => Ok(file),
            closed => Ok(closed.insert(options.open(&self.path)?)),
        }
    }
}

impl Write for LogFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.open()?.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.file.as_mut().map_or(Ok(()), File::flush)
    }
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
        let clock = CostClock::new(std::time::Instant::now());
        start(directory.path(), false, quiet, &Terminal::default(), &clock).unwrap();
        tracing::debug!(slab = 3, residual = 0.5, "newton step");
        let log = std::fs::read_to_string(directory.path().join(LOG_FILE)).unwrap();
        let record: serde_json::Value =
            log.lines().map(|line| serde_json::from_str(line).unwrap()).next_back().unwrap();
        assert_eq!(record["level"], "DEBUG");
        assert_eq!((&record["fields"]["message"], &record["fields"]["slab"]), (&"newton step".into(), &3.into()));
    }

    #[test]
    fn a_resumed_run_keeps_the_log_and_one_that_is_refused_makes_none() {
        let directory = tempfile::tempdir().unwrap();
        let text = || std::fs::read_to_string(directory.path().join(LOG_FILE)).unwrap();
        let file = |append| LogFile::new(directory.path(), LOG_FILE, append);
        drop(file(false));
        assert!(!directory.path().join(LOG_FILE).exists());
        let write = |append| writeln!(file(append), "line").unwrap();
        [false, true].into_iter().for_each(write);
        assert_eq!(text(), "line\nline\n");
        write(false);
        assert_eq!(text(), "line\n");
    }

    #[test]
    fn a_rank_waits_for_the_directory_of_its_log() {
        let directory = tempfile::tempdir().unwrap();
        let run = directory.path().join("run");
        let mut file = LogFile::new(&run, &log_file_of(2), false);
        assert!(writeln!(file, "early").is_err());
        std::fs::create_dir(&run).unwrap();
        writeln!(file, "line").unwrap();
        assert_eq!(std::fs::read_to_string(run.join("log_2.jsonl")).unwrap(), "line\n");
    }
}
