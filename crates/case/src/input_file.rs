//! Input files, read as a whole: regular files of limited size.
//!
//! A pipe or a device may never end, or never begin, so it is refused by its type before it is opened.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// The largest size of a table or a list of points, in bytes.
pub const LARGEST_TABLE: u64 = 1 << 30;

/// Refuses anything at `path` that is no regular file: a directory, a pipe, a device.
///
/// # Errors
/// The type of the file, or the error of the system.
pub fn require_regular(path: &Path) -> Result<Metadata> {
    let found = std::fs::metadata(path)?;
    let kind = match () {
        () if found.is_file() => return Ok(found),
        () if found.is_dir() => "a directory",
        () => "a pipe or a device",
    };
    Err(Error::new(ErrorKind::InvalidInput, format!("it is {kind}, and a regular file is expected")))
}

/// The bytes of the file at `path`, at most `most`.
///
/// # Errors
/// If it is no regular file, is larger, or cannot be read.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>> {
    let length = require_regular(path)?.len();
    let mut bytes = Vec::new();
    // Some system files report no length.
    if length <= most {
        File::open(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    }
    match length.max(bytes.len() as u64) {
        length if length <= most => Ok(bytes),
        length => Err(Error::new(ErrorKind::FileTooLarge, too_large(length, most))),
    }
}

/// As [`read`], for a text. The mark with which some editors begin a file (U+FEFF) is left out.
///
/// # Errors
/// As [`read`], and if the bytes are not UTF-8.
pub fn read_text(path: &Path, most: u64) -> Result<String> {
    /// The mark that tells the order of bytes.
    const MARK: char = '\u{feff}';
    let problem = "it is no text in UTF-8: save it in this encoding";
    let text = String::from_utf8(read(path, most)?).map_err(|_| Error::new(ErrorKind::InvalidData, problem))?;
    match text.strip_prefix(MARK) {
        Some(rest) => Ok(rest.to_owned()),
        None => Ok(text),
    }
}

fn too_large(length: u64, most: u64) -> String {
    let megabytes = |bytes: u64| bytes as f64 / 1e6;
    format!("it has {:.1} MB or more, and at most {:.1} MB are read", megabytes(length), megabytes(most))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn files_are_read_up_to_a_size() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("file");
        std::fs::write(&path, "12345").unwrap();
        assert_eq!(read_text(&path, 5).unwrap(), "12345");
        std::fs::write(&path, "\u{feff}1").unwrap();
        assert_eq!(read_text(&path, 5).unwrap(), "1", "without the mark");
        std::fs::write(&path, "12345").unwrap();
        assert!(read(&path, 4).unwrap_err().to_string().starts_with("it has 0.0 MB or more"));
        let error = read(directory.path(), 9).unwrap_err().to_string();
        assert_eq!(error, "it is a directory, and a regular file is expected");
        std::fs::write(&path, [0xff]).unwrap();
        assert!(read_text(&path, 5).unwrap_err().to_string().contains("UTF-8"));
        assert_eq!(read(&directory.path().join("nowhere"), 9).unwrap_err().kind(), ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn what_never_ends_is_not_opened() {
        let error = read(Path::new("/dev/zero"), 9).unwrap_err().to_string();
        assert_eq!(error, "it is a pipe or a device, and a regular file is expected");
    }
}
