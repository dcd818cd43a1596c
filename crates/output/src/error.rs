//! What can go wrong with files, each with the path, the cause and what to do.

use std::io;
use std::path::PathBuf;

use crate::directory::LockOwner;

/// A failure to write or read results.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The output directory cannot be made or written. Found before any work; nothing is left behind.
    #[error("cannot write into the output directory `{path}`: {source}; choose another one or make it writable")]
    Directory {
        /// The directory asked for.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Another process runs in the output directory.
    #[error("the output directory `{path}` is in use by {}; stop it or choose another directory", who(.owner))]
    Busy {
        /// The directory asked for.
        path: PathBuf,
        /// Who holds it; absent if it has not told yet.
        owner: Option<LockOwner>,
    },
    /// There is nothing to resume from.
    #[error("`{path}` does not exist, so there is no checkpoint to resume from; start without resuming")]
    NoCheckpoint {
        /// The result file looked for.
        path: PathBuf,
    },
    /// A result file is torn: truncated, overwritten, or not a result file at all.
    #[error("`{path}` is damaged: {reason}; restore it from a copy, or remove it and start without resuming")]
    Damaged {
        /// The file read.
        path: PathBuf,
        /// What does not fit.
        reason: String,
    },
    /// A checkpoint belongs to another case.
    #[error(
        "`{path}` is the checkpoint of another case: {difference}; resume with the case that started the run, or choose another \
         output directory"
    )]
    OtherCase {
        /// The file read.
        path: PathBuf,
        /// What differs.
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
        /// The version understood here.
        supported: i64,
    },
    /// An array or a row does not have the length that was announced.
    #[error("`{name}` has {found} values, {expected} were announced")]
    Length {
        /// Name of the array.
        name: String,
        /// Length that follows from the layout.
        expected: usize,
        /// Length given.
        found: usize,
    },
    /// An announced array was not given.
    #[error("`{name}` was announced and is missing in the step")]
    Absent {
        /// Name of the array.
        name: String,
    },
    /// HDF5 refused to write (a full disk, for instance).
    #[error("cannot write `{path}`: {source}")]
    Hdf5 {
        /// The file written.
        path: PathBuf,
        /// What HDF5 said.
        source: hdf5::Error,
    },
    /// A row of the history is none.
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
    #[error("cannot access `{path}`: {source}")]
    File {
        /// The file concerned.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

fn who(owner: &Option<LockOwner>) -> String {
    owner.as_ref().map_or_else(|| "another process".to_owned(), LockOwner::to_string)
}
