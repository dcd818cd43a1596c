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

    /// Starts the file with the `columns`, or keeps its rows up to the time `reached` of a run that is resumed. A file with other columns, or of
    /// other `places`, is kept beside it as `line_NAME.earlier.csv`, or `line_NAME.earlier_2.csv` if there is one already, and so on. Behind
    /// the time, the rows of each time begin with the places.
    ///
    /// # Errors
    /// [`OutputError::File`] if the system refuses.
    pub fn begin(&self, columns: &[String], places: &[Vec<f64>], reached: Option<f64>) -> Result<(), OutputError> {
        let first = columns.join(",") + "\n";
        let earlier = reached.and_then(|reached| Some((reached, fs::read_to_string(&self.path).ok()?)));
        let continued = |(reached, text): (f64, String)| {
            let rows = rows_until(text.strip_prefix(&first)?, reached);
            are_at(&rows, places).then_some(rows)
        };
        let kept = match earlier.map(continued) {
            Some(Some(rows)) => rows,
            Some(None) => {
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

/// Whether the rows of the last time are those of a line through these `places`, or there are none.
fn are_at(rows: &str, places: &[Vec<f64>]) -> bool {
    let numbers = |row: &str| row.split(',').map(|number| number.parse().unwrap_or(f64::NAN)).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = rows.lines().map(numbers).collect();
    let Some(last) = rows.last() else { return true };
    let of_last: Vec<&Vec<f64>> = rows.iter().filter(|row| row[0] == last[0]).collect();
    of_last.len() == places.len() && of_last.iter().zip(places).all(|(row, place)| row[1..].starts_with(place))
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
        let at = |places: [f64; 2]| places.map(|s| vec![s]).to_vec();
        file.begin(&columns, &at([0.1, 0.2]), None).unwrap();
        file.append(&[vec![0.0, 0.1], vec![0.0, 0.2]]).unwrap();
        file.append(&[vec![0.3, 1e-17], vec![0.30000000000000004, f64::NAN]]).unwrap();
        let read = || fs::read_to_string(directory.path().join("line_wake.csv")).unwrap();
        assert_eq!(read(), "t,s\n0.0,0.1\n0.0,0.2\n0.3,1e-17\n0.30000000000000004,NaN\n");
        fs::write(directory.path().join("line_wake.csv"), read() + "0.3,4").unwrap();
        file.begin(&columns, &[vec![1e-17]], Some(0.3)).unwrap();
        assert_eq!(read(), "t,s\n0.0,0.1\n0.0,0.2\n0.3,1e-17\n");
        file.begin(&["t", "s", "x"].map(str::to_owned), &[vec![0.1, 0.2]], Some(0.3)).unwrap();
        assert_eq!(read(), "t,s,x\n");
        // Once more: the rows of before were overwritten.
        file.append(&[vec![0.4, 0.1, 0.2]]).unwrap();
        file.begin(&["t", "s", "y"].map(str::to_owned), &[vec![0.1, 0.2]], Some(0.4)).unwrap();
        let kept = |name: &str| fs::read_to_string(directory.path().join(name)).unwrap().lines().count();
        assert_eq!((kept("line_wake.earlier.csv"), kept("line_wake.earlier_2.csv")), (4, 2));
    }

    /// The rows of two lines stood in one file, if their columns were the same.
    #[test]
    fn a_line_through_other_points_begins_a_new_file() {
        let directory = tempfile::tempdir().unwrap();
        let file = LineFile::of(directory.path(), "wake");
        let columns = ["t", "s"].map(str::to_owned);
        let at = |places: &[f64]| places.iter().map(|s| vec![*s]).collect::<Vec<_>>();
        file.begin(&columns, &at(&[0.1, 0.2]), None).unwrap();
        file.append(&[vec![0.0, 0.1], vec![0.0, 0.2]]).unwrap();
        let is_new = |places: &[f64]| {
            file.begin(&columns, &at(places), Some(0.0)).unwrap();
            fs::read_to_string(directory.path().join("line_wake.csv")).unwrap().lines().count() == 1
        };
        assert!(!is_new(&[0.1, 0.2]) && is_new(&[0.1, 0.3]));
        assert!(directory.path().join("line_wake.earlier.csv").exists());
        file.append(&[vec![0.0, 0.1], vec![0.0, 0.3]]).unwrap();
        assert!(is_new(&[0.1]), "fewer points");
    }
}
