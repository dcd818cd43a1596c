//! `line_NAME.csv`: the flow along a line, time after time.

use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::OutputError;
use crate::files::{file_error, write_atomically};

/// A table to which the rows of a time are appended. Its first column is the time.
#[derive(Clone, Debug, PartialEq)]
pub struct LineFile {
    path: PathBuf,
}

impl LineFile {
    /// The file `line_NAME.csv` in a directory.
    pub fn of(directory: &Path, name: &str) -> Self {
        LineFile { path: directory.join(format!("line_{name}.csv")) }
    }

    /// Starts the file with the `columns`, or keeps its rows up to the time `reached` of a run that is resumed. A file with other columns is
    /// kept beside it as `line_NAME.earlier.csv`, or `line_NAME.earlier_2.csv` if there is one already, and so on.
    ///
    /// # Errors
    /// [`OutputError::File`] if the system refuses.
    pub fn begin(&self, columns: &[String], reached: Option<f64>) -> Result<(), OutputError> {
        let first = columns.join(",") + "\n";
        let earlier = reached.and_then(|reached| Some((reached, fs::read_to_string(&self.path).ok()?)));
        let kept = match &earlier {
            Some((reached, text)) if text.starts_with(&first) => rows_until(&text[first.len()..], *reached),
            Some(_) => {
                let beside = self.free_name();
                fs::rename(&self.path, &beside).map_err(|source| file_error(&beside, source))?;
                String::new()
            }
            None => String::new(),
        };
        write_atomically(&self.path, (first + &kept).as_bytes())
    }

    /// The first name for earlier rows that is not taken.
    fn free_name(&self) -> PathBuf {
        let (mut beside, mut number) = (self.path.with_extension("earlier.csv"), 1);
        while beside.exists() {
            number += 1;
            beside = self.path.with_extension(format!("earlier_{number}.csv"));
        }
        beside
    }

    /// Appends rows.
    ///
    /// # Errors
    /// [`OutputError::File`] if the system refuses.
    pub fn append(&self, rows: &[Vec<f64>]) -> Result<(), OutputError> {
        let line = |row: &Vec<f64>| row.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(",") + "\n";
        let text: String = rows.iter().map(line).collect();
        let append = || OpenOptions::new().append(true).open(&self.path)?.write_all(text.as_bytes());
        append().map_err(|source| file_error(&self.path, source))
    }
}

/// The whole rows of times up to `reached`.
fn rows_until(text: &str, reached: f64) -> String {
    let time = |row: &str| row.split(',').next().and_then(|t| t.parse::<f64>().ok());
    let rows = text.split_inclusive('\n').filter(|row| row.ends_with('\n'));
    rows.filter(|row| time(row).is_some_and(|t| t <= reached)).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_resumed_file_keeps_the_rows_of_its_checkpoint() {
        let directory = tempfile::tempdir().unwrap();
        let file = LineFile::of(directory.path(), "wake");
        let columns = ["t", "s"].map(str::to_owned);
        file.begin(&columns, None).unwrap();
        file.append(&[vec![0.0, 0.1], vec![0.0, 0.2]]).unwrap();
        file.append(&[vec![0.3, 1e-17], vec![0.30000000000000004, f64::NAN]]).unwrap();
        let read = || fs::read_to_string(directory.path().join("line_wake.csv")).unwrap();
        assert_eq!(read(), "t,s\n0.0,0.1\n0.0,0.2\n0.3,1e-17\n0.30000000000000004,NaN\n");
        fs::write(directory.path().join("line_wake.csv"), read() + "0.3,4").unwrap();
        file.begin(&columns, Some(0.3)).unwrap();
        assert_eq!(read(), "t,s\n0.0,0.1\n0.0,0.2\n0.3,1e-17\n");
        file.begin(&["t", "s", "x"].map(str::to_owned), Some(0.3)).unwrap();
        assert_eq!(read(), "t,s,x\n");
        // Once more: the rows of before were overwritten.
        file.append(&[vec![0.4, 0.1, 0.2]]).unwrap();
        file.begin(&["t", "s", "y"].map(str::to_owned), Some(0.4)).unwrap();
        let kept = |name: &str| fs::read_to_string(directory.path().join(name)).unwrap().lines().count();
        assert_eq!((kept("line_wake.earlier.csv"), kept("line_wake.earlier_2.csv")), (4, 2));
    }
}
