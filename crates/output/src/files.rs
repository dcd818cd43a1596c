//! Files that are replaced as a whole: a reader finds the old or the new one, never a part.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::OutputError;

/// The private name under which the next version of `path` is written.
pub(crate) fn partial(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".partial");
    PathBuf::from(name)
}

/// Forces `partial` to the disk and gives it the name `path`.
pub(crate) fn publish(partial: &Path, path: &Path) -> Result<(), OutputError> {
    let replace = || {
        File::open(partial)?.sync_all()?;
        fs::rename(partial, path)?;
        // The new name is safe only after the directory is on the disk too.
        File::open(path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new(".")))?.sync_all()
    };
    replace().map_err(|source| file_error(path, source))
}

/// Replaces the file at `path` by `contents`. A reader sees the old or the new contents, even if the writer dies.
///
/// # Errors
/// [`OutputError::File`] if the system refuses.
pub fn write_atomically(path: &Path, contents: &[u8]) -> Result<(), OutputError> {
    let partial = partial(path);
    File::create(&partial)
        .and_then(|mut file| file.write_all(contents))
        .map_err(|source| file_error(&partial, source))?;
    publish(&partial, path)
}

/// Removes a file, if it is there.
pub(crate) fn remove(path: &Path) -> Result<(), OutputError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(file_error(path, source)),
        _ => Ok(()),
    }
}

pub(crate) fn file_error(path: &Path, source: io::Error) -> OutputError {
    OutputError::File { path: path.to_owned(), source }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_new_contents_replace_the_old() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.txt");
        write_atomically(&path, b"first, longer").unwrap();
        write_atomically(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1, "no partial file is left");
    }

    #[test]
    fn a_refusal_names_the_file() {
        let error = write_atomically(Path::new("/proc/no/such/file"), b"").unwrap_err();
        assert!(error.to_string().contains("/proc/no/such/file"), "{error}");
    }
}
