//! Text files of points in the plane.

use crate::error::Cause;
use crate::input_file::{self, LARGEST_TABLE};
use std::path::Path;

/// The points of a text file: x and y in each line, separated by blanks, tabs, commas or semicolons. # begins a comment. Lines
/// before the first point may be names: their first entry is not a number.
///
/// # Errors
/// A file that cannot be read, or a line that is neither a point nor empty.
pub(super) fn read(path: &Path) -> Result<Vec<[f64; 2]>, Box<Cause>> {
    let text = input_file::read_text(path, LARGEST_TABLE);
    let text = text.map_err(|error| Box::new(Cause::File { path: path.to_owned(), error }))?;
    let mut points = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let entries: Vec<&str> = line.split(is_separator).filter(|entry| !entry.is_empty()).collect();
        let numbers: Result<Vec<f64>, _> = entries.iter().map(|entry| entry.parse()).collect();
        match numbers.as_deref() {
            Ok([]) => {}
            Ok(&[x, y]) if x.is_finite() && y.is_finite() => points.push([x, y]),
            _ if points.is_empty() && entries[0].parse::<f64>().is_err() => {}
            _ => {
                let (path, found) = (path.to_owned(), line.trim().to_owned());
                return Err(Box::new(Cause::Coordinates { path, line: index + 1, found }));
            }
        }
    }
    Ok(points)
}

fn is_separator(c: char) -> bool {
    c.is_whitespace() || c == ',' || c == ';'
}
