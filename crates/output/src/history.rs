//! `history.csv`: a row of numbers per slab.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::directory::RunDirectory;
use crate::error::OutputError;
use crate::files::{file_error, write_atomically};

/// Name of the history in the run directory.
pub const HISTORY_FILE: &str = "history.csv";

/// The history of a run. Each row is in the file as soon as it is pushed.
#[derive(Debug)]
pub struct History {
    path: PathBuf,
    file: File,
    columns: usize,
    /// All rows so far, one after the other.
    rows: Vec<f64>,
}

impl History {
    /// Starts a history that begins with `rows` (one after the other): none for a new run, those of the checkpoint for
    /// a resumed one. Rows of the file that were written after the checkpoint are thereby dropped.
    ///
    /// # Errors
    /// [`OutputError::Length`] if `rows` does not consist of whole rows, [`OutputError::File`] if the system refuses.
    pub fn create(directory: &RunDirectory, columns: &[String], rows: &[f64]) -> Result<Self, OutputError> {
        let whole = rows.len() - rows.len() % columns.len().max(1);
        check_length("rows of the history", rows.len(), whole)?;
        let path = directory.path().join(HISTORY_FILE);
        let header = line(columns.iter().map(|name| quoted(name)));
        let body = rows.chunks_exact(columns.len().max(1)).map(|row| line(row.iter().copied().map(number)));
        let text: String = std::iter::once(header).chain(body).collect();
        write_atomically(&path, text.as_bytes())?;
        let file = OpenOptions::new().append(true).open(&path).map_err(|source| file_error(&path, source))?;
        Ok(Self { path, file, columns: columns.len(), rows: rows.to_vec() })
    }

    /// Writes one row.
    ///
    /// # Errors
    /// [`OutputError::Length`] if the row does not fit the columns, [`OutputError::File`] if the system refuses.
    pub fn push(&mut self, row: &[f64]) -> Result<(), OutputError> {
        check_length("row of the history", row.len(), self.columns)?;
        let text = line(row.iter().copied().map(number));
        // One write per row: a reader sees whole rows, and a killed run loses none.
        self.file.write_all(text.as_bytes()).map_err(|source| file_error(&self.path, source))?;
        self.rows.extend_from_slice(row);
        Ok(())
    }

    /// All rows so far, one after the other, to be kept in the checkpoint.
    pub fn rows(&self) -> &[f64] {
        &self.rows
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

fn check_length(name: &str, found: usize, expected: usize) -> Result<(), OutputError> {
    if found == expected { Ok(()) } else { Err(OutputError::Length { name: name.to_owned(), expected, found }) }
}

fn line(cells: impl Iterator<Item = String>) -> String {
    cells.collect::<Vec<_>>().join(",") + "\n"
}

/// The shortest decimal that reads back as the same number; whole numbers without a fraction.
fn number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 { format!("{value}") } else { format!("{value:?}") }
}

/// A name as a CSV cell (RFC 4180).
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}
