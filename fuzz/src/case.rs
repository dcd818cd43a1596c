//! Any bytes as a case file.

use ::case::{AnyCase, Document};
use std::path::Path;

/// More cells than this along an axis are no error of a reader, but cost time.
const MOST_CELLS: i64 = 64;

/// Checks a case; true if it is valid. Must return for any bytes.
pub fn read(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    if text.parse::<toml::Table>().is_ok_and(|table| is_large(&toml::Value::Table(table))) {
        return false;
    }
    let case = Document::parse(Path::new("case.toml"), text.to_owned(), &[]).and_then(|case| AnyCase::check(&case));
    // The error must have a message for any input.
    case.map_err(|error| error.to_string()).is_ok()
}

fn is_large(value: &toml::Value) -> bool {
    match value {
        toml::Value::Table(table) => table.values().any(is_large),
        toml::Value::Array(entries) => entries.iter().any(is_large),
        toml::Value::Integer(number) => *number > MOST_CELLS,
        _ => false,
    }
}
