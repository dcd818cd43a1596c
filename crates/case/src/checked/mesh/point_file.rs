//! Text files of points in the plane.

use crate::cause::Cause;
use crate::input_file::{self, LARGEST_TABLE};
use std::path::Path;

/// The points of a text file: x and y in each line, separated by blanks, tabs, commas or semicolons. Where semicolons separate them, a comma
/// may stand for the decimal point. # begins a comment. Lines before the first point may be names: their first entry is not a number.
///
/// # Errors
/// A file that cannot be read, or a line that is neither a point nor empty.
pub(super) fn read(path: &Path) -> Result<Vec<[f64; 2]>, Box<Cause>> {
    let text = input_file::read_text(path, LARGEST_TABLE);
    let text = text.map_err(|error| Box::new(Cause::File { path: path.to_owned(), error }))?;
    let mut points = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let entries = entries(line);
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

/// The entries of a line, with decimal points.
fn entries(line: &str) -> Vec<String> {
    let has_semicolon = line.contains(';');
    let is_separator = |c: char| c == ';' || !has_semicolon && c == ',' || c.is_whitespace();
    let entries = line.split(is_separator).filter(|entry| !entry.is_empty());
    entries.map(|entry| if has_semicolon { entry.replacen(',', ".", 1) } else { entry.to_owned() }).collect()
}
