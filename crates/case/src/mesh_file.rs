//! Whether a mesh file and its mesh fit into memory.

use crate::{input_file, memory};
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

/// A lower bound of the bytes in memory per byte of the file: the file, its lists and the mesh.
const PER_BYTE: u64 = 4;

/// Refuses a file at `path` that is no regular file or whose mesh does not fit into memory.
///
/// # Errors
/// The reason.
pub fn check(path: &Path) -> Result<()> {
    let needed = input_file::require_regular(path)?.len().saturating_mul(PER_BYTE);
    match memory::shortage(needed) {
        Some(shortage) => {
            Err(Error::new(ErrorKind::FileTooLarge, format!("its mesh does not fit into memory: {shortage}")))
        }
        None => Ok(()),
    }
}
