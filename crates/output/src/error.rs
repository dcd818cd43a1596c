//! Errors of files, each with the path, the cause and the remedy.

use std::io;
use std::path::PathBuf;

use crate::directory::LockOwner;

/// A failure to write or read results.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The output directory cannot be created or written. This is detected before any work; nothing is left behind.
    #[error("cannot write into the output directory `{path}`: {source}; choose another one or make it writable")]
    Directory {
        /// The requested directory.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// Another process runs in the output directory.
    #[error("the output directory `{path}` is in use by {}; stop it or choose another directory", who(.owner))]
    Busy {
        /// The requested directory.
        path: PathBuf,
        /// The process that holds it; absent if it has not been written yet.
        owner: Option<LockOwner>,
    },
    /// There is no result to read.
    #[error(
        "`{path}` does not exist: a run writes its result with its first checkpoint; name the directory of such a run"
    )]
    NoResult {
        /// The missing result file.
        path: PathBuf,
    },
    /// The path of a run is not a directory.
    #[error("`{path}` is no directory; name the directory of a run")]
    NoDirectory {
        /// What was named.
        path: PathBuf,
    },
    /// A file that no run has written.
    #[error(
        "`{path}` is no HDF5 file, and so no result of a run; name the file `result.vtkhdf` of a run, or its directory"
    )]
    NotHdf5 {
        /// The file read.
        path: PathBuf,
    },
    /// There is nothing to resume from.
    #[error(
        "`{path}` does not exist, so there is no checkpoint to resume from; start without resuming, with `--force` if files of a stopped run are left"
    )]
    NoCheckpoint {
        /// The missing result file.
        path: PathBuf,
    },
    /// A result file is truncated or overwritten.
    #[error("`{path}` is damaged: {reason}; restore it from a copy, or run the case anew")]
    Damaged {
        /// The file read.
        path: PathBuf,
        /// The mismatch.
        reason: String,
    },
    /// A whole HDF5 file that no run has sealed.
    #[error(
        "`{path}` has no seal of a run: it is another file for ParaView, of averages, lines or walls, or another program has written to it; name \
         the file `result.vtkhdf` of a run, as the run has left it"
    )]
    NotSealed {
        /// The file read.
        path: PathBuf,
    },
    /// A checkpoint belongs to another case.
    #[error(
        "`{path}` is the checkpoint of another case: {difference}; resume with the case that started the run, or choose another \
         output directory"
    )]
    OtherCase {
        /// The file read.
        path: PathBuf,
        /// The difference.
        difference: String,
    },
    /// A result file has a format that this program does not read.
    #[error(
        "`{path}` has format version {found}, this program reads version {supported}; use the program that wrote it"
    )]
    Version {
        /// The file read.
        path: PathBuf,
        /// Its format version.
        found: i64,
        /// The version that this program reads.
        supported: i64,
    },
    /// An array or a row does not have the declared length.
    #[error("`{name}` has {found} values, {expected} were announced")]
    Length {
        /// Name of the array.
        name: String,
        /// Length that follows from the layout.
        expected: usize,
        /// Length given.
        found: usize,
    },
    /// A declared array was not given.
    #[error("`{name}` was announced and is missing in the step")]
    Absent {
        /// Name of the array.
        name: String,
    },
    /// HDF5 refused to write (a full disk, for instance).
    #[error("cannot write `{path}`: {}", refusal(&.source.to_string()))]
    Hdf5 {
        /// The file written.
        path: PathBuf,
        /// The error of HDF5.
        source: hdf5::Error,
    },
    /// A row of the history is invalid.
    #[error("`{path}`, line {line}: {found} numbers, {expected} were expected; restore it from a copy")]
    Row {
        /// The file read.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// Numbers found.
        found: usize,
        /// Numbers expected: one per column.
        expected: usize,
    },
    /// The system refused to read or write a file.
    #[error("cannot access `{path}`: {}", refusal(&.source.to_string()))]
    File {
        /// The file concerned.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
}

/// The words of the system for a refusal, which HDF5 quotes among addresses of memory, and the remedy for a full disk.
fn refusal(error: &str) -> String {
    let quoted = error.split_once("error message = '").and_then(|(_, rest)| rest.split_once('\''));
    let reason = quoted.map_or(error, |(reason, _)| reason);
    if reason.contains("No space left") || reason.contains("quota exceeded") {
        return format!(
            "{reason}; free some of it, and continue with `--resume` if there is a `result.vtkhdf`, or else begin again: what was written before is whole"
        );
    }
    reason.to_owned()
}

fn who(owner: &Option<LockOwner>) -> String {
    owner.as_ref().map_or_else(|| "another process".to_owned(), LockOwner::to_string)
}

#[cfg(test)]
mod tests {
    use super::refusal;

    #[test]
    fn a_refusal_of_hdf5_is_told_in_the_words_of_the_system() {
        let error = "H5Dwrite(): can't write data: file write failed: time = Tue\n, errno = 28, error message = 'No space left on device', \
                     buf = 0x7f0d4caaa060, offset = 0";
        let told = refusal(error);
        assert!(told.starts_with("No space left on device; free some") && !told.contains("0x7f"), "{told}");
        assert_eq!(refusal("Permission denied (os error 13)"), "Permission denied (os error 13)");
    }
}
