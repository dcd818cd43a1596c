//! `history.csv`: a row of numbers per slab.

use std::fs::{self, File, OpenOptions};
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
    /// Starts a history that begins with `rows` (one after the other): empty for a new run, the rows of the checkpoint
    /// for a resumed one. Rows of the file that were written after the checkpoint are dropped.
    ///
    /// # Errors
    /// [`OutputError::Length`] if `rows` does not consist of whole rows, [`OutputError::File`] if the system refuses.
    pub fn create(directory: &RunDirectory, columns: &[String], rows: &[f64]) -> Result<Self, OutputError> {
        let whole = rows.len() - rows.len() % columns.len().max(1);
        check_length("rows of the history", rows.len(), whole)?;
        let path = directory.path().join(HISTORY_FILE);
        let header = header(columns) + "\n";
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

    /// All rows so far, one after the other, for the checkpoint.
    pub fn rows(&self) -> &[f64] {
        &self.rows
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// The contents of `history.csv`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct HistoryTable {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// All rows, one after the other.
    pub rows: Vec<f64>,
}

impl HistoryTable {
    /// Reads the history of the run in `directory`, which may still be writing. An incomplete last row is left out.
    ///
    /// # Errors
    /// [`OutputError::File`] if the file cannot be read, [`OutputError::Row`] if a row is invalid.
    pub fn read(directory: &Path) -> Result<Self, OutputError> {
        let path = directory.join(HISTORY_FILE);
        let text = fs::read_to_string(&path).map_err(|source| file_error(&path, source))?;
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = whole.lines();
        let columns = lines.next().map(names).unwrap_or_default();
        let mut rows = Vec::new();
        for (index, line) in lines.enumerate() {
            let row: Vec<f64> = line.split(',').filter_map(|cell| cell.parse().ok()).collect();
            if row.len() != columns.len() {
                return Err(OutputError::Row { path, line: index + 2, found: row.len(), expected: columns.len() });
            }
            rows.extend(row);
        }
        Ok(Self { columns, rows })
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len().checked_div(self.columns.len()).unwrap_or(0)
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The column `name`, if there is one.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let position = self.columns.iter().position(|column| column == name)?;
        Some(self.rows.iter().skip(position).step_by(self.columns.len()).copied().collect())
    }
}

/// The first line of `history.csv` with these columns, without its end.
pub fn header(columns: &[String]) -> String {
    columns.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(",")
}

/// The names in a line of CSV, such as a [`header`].
pub fn names(line: &str) -> Vec<String> {
    let (mut names, mut inside, mut characters) = (vec![String::new()], false, line.chars().peekable());
    while let Some(c) = characters.next() {
        let name = names.last_mut().expect("there is at least one name");
        match c {
            '"' if inside && characters.peek() == Some(&'"') => name.extend(characters.next()),
            '"' => inside = !inside,
            ',' if !inside => names.push(String::new()),
            c => name.push(c),
        }
    }
    names
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::fs;

    fn columns() -> Vec<String> {
        ["t", "newton", "drag, \"left\" wall"].map(str::to_owned).to_vec()
    }

    fn row(slab: usize) -> [f64; 3] {
        [0.1 * slab as f64, slab as f64, (-1.0_f64).powi(slab as i32) * 1e-17 / 3.0]
    }

    #[test]
    fn numbers_are_short_and_read_back_bit_by_bit() {
        assert_eq!([0.1 + 0.2, 3.0, 1e-7, -1e300].map(number), ["0.30000000000000004", "3", "1e-7", "-1e300"]);
        for value in [1.0 / 3.0, f64::MIN_POSITIVE, 5e-324, 1e15, 1e15 - 1.0, 123_456.75, -0.0, f64::INFINITY] {
            assert_eq!(number(value).parse::<f64>().unwrap().to_bits(), value.to_bits(), "{value:?}");
        }
        assert_eq!(number(f64::NAN), "NaN");
    }

    #[test]
    fn each_row_is_in_the_file_at_once() {
        let directory = tempfile::tempdir().unwrap();
        let run = RunDirectory::open(directory.path()).unwrap();
        let mut history = History::create(&run, &columns(), &[]).unwrap();
        assert_eq!(fs::read_to_string(history.path()).unwrap(), "t,newton,\"drag, \"\"left\"\" wall\"\n");
        history.push(&[0.5, 3.0, -2.25]).unwrap();
        assert!(fs::read_to_string(history.path()).unwrap().ends_with("\n0.5,3,-2.25\n"));
    }

    #[test]
    fn a_resumed_history_is_the_same_as_an_uninterrupted_one() {
        let (through, resumed) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let run = RunDirectory::open(through.path()).unwrap();
        let mut history = History::create(&run, &columns(), &[]).unwrap();
        (0..6).for_each(|slab| history.push(&row(slab)).unwrap());

        let again = RunDirectory::open(resumed.path()).unwrap();
        let mut first = History::create(&again, &columns(), &[]).unwrap();
        (0..3).for_each(|slab| first.push(&row(slab)).unwrap());
        let checkpoint = first.rows().to_vec();
        // Slab 3 is in the file and not in the checkpoint; it is computed again.
        first.push(&row(3)).unwrap();
        drop(first);
        let mut second = History::create(&again, &columns(), &checkpoint).unwrap();
        (3..6).for_each(|slab| second.push(&row(slab)).unwrap());
        assert_eq!(second.rows(), history.rows());
        assert_eq!(fs::read(second.path()).unwrap(), fs::read(history.path()).unwrap());
    }

    #[test]
    fn a_reader_finds_what_was_written_but_for_a_row_that_is_not_whole() {
        let directory = tempfile::tempdir().unwrap();
        let run = RunDirectory::open(directory.path()).unwrap();
        let mut history = History::create(&run, &columns(), &[]).unwrap();
        (0..3).for_each(|slab| history.push(&row(slab)).unwrap());
        let table = HistoryTable::read(directory.path()).unwrap();
        assert_eq!((&table.columns, &table.rows, table.len()), (&columns(), &history.rows().to_vec(), 3));
        assert_eq!(table.column("newton"), Some(vec![0.0, 1.0, 2.0]));
        assert_eq!(table.column("krylov"), None);

        let text = fs::read_to_string(history.path()).unwrap();
        fs::write(history.path(), text.clone() + "0.4,1").unwrap();
        assert_eq!(HistoryTable::read(directory.path()).unwrap(), table);
        fs::write(history.path(), text + "0.4,1\n").unwrap();
        let error = HistoryTable::read(directory.path()).unwrap_err();
        assert!(matches!(error, OutputError::Row { line: 5, found: 2, expected: 3, .. }), "{error:?}");
    }

    #[test]
    fn rows_that_do_not_fit_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let run = RunDirectory::open(directory.path()).unwrap();
        let error = History::create(&run, &columns(), &[1.0; 4]).unwrap_err();
        assert!(matches!(error, OutputError::Length { expected: 3, found: 4, .. }), "{error:?}");
        let error = History::create(&run, &columns(), &[]).unwrap().push(&[1.0]).unwrap_err();
        assert!(matches!(error, OutputError::Length { expected: 3, found: 1, .. }), "{error:?}");
    }
}
