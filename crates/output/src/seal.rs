//! The last bytes of a result file. They detect damage before the file is used.
//!
//! HDF5 ignores bytes after its own end of file. There the seal lies: 8 bytes of name, then the length of the file
//! before the seal and its checksum, each 64 bits, lowest byte first. HDF5 drops the seal when it writes to the file.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::Path;

use crate::checksum::Checksum;
use crate::error::OutputError;
use crate::files::file_error;

const NAME: &[u8; 8] = b"stsolve\n";
const LENGTH: usize = 24;

/// The first bytes of an HDF5 file.
const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Bytes read at once, whole words.
const BLOCK: u64 = 1 << 16;

/// Seals a file that is complete and not sealed.
pub(crate) fn write(path: &Path) -> Result<(), OutputError> {
    let seal = || {
        let mut file = OpenOptions::new().read(true).append(true).open(path)?;
        let length = file.metadata()?.len();
        let sum = checksum(&file, length)?;
        file.write_all(&seal(length, sum))
    };
    seal().map_err(|source| file_error(path, source))
}

/// Compares a file with its seal.
pub(crate) fn verify(path: &Path) -> Result<(), OutputError> {
    let damaged = |reason: &str| OutputError::Damaged { path: path.to_owned(), reason: reason.to_owned() };
    let read = || {
        let mut file = File::open(path)?;
        let Some(length) = file.metadata()?.len().checked_sub(LENGTH as u64) else {
            return Ok(None);
        };
        let sum = checksum(&file, length)?;
        let mut found = [0; LENGTH];
        file.read_exact(&mut found)?;
        Ok(Some((seal(length, sum), found)))
    };
    match read().map_err(|source: io::Error| file_error(path, source))? {
        Some((expected, found)) if found == expected => Ok(()),
        Some((_, found)) if found.starts_with(NAME) => Err(damaged("its contents do not match its checksum")),
        _ if is_whole_hdf5(path) => Err(OutputError::NotSealed { path: path.to_owned() }),
        _ if begins_otherwise(path) => Err(OutputError::NotHdf5 { path: path.to_owned() }),
        _ => Err(damaged("its end is missing")),
    }
}

/// Whether a file begins otherwise than an HDF5 file.
fn begins_otherwise(path: &Path) -> bool {
    let head = || -> io::Result<Vec<u8>> {
        let mut head = Vec::new();
        File::open(path)?.take(SIGNATURE.len() as u64).read_to_end(&mut head)?;
        Ok(head)
    };
    head().is_ok_and(|head| !SIGNATURE.starts_with(&head))
}

/// Whether a file ends where its HDF5 superblock, of version 2 or 3, says: nothing is missing, and no seal follows. libhdf5 may crash on
/// damaged bytes, so it is not asked.
fn is_whole_hdf5(path: &Path) -> bool {
    // Signature, version, sizes of offsets and lengths, flags, base address, address of the extension, then the end of the file.
    let agrees = || -> io::Result<bool> {
        let (mut file, mut head, mut end) = (File::open(path)?, [0; 28], [0; 8]);
        file.read_exact(&mut head)?;
        file.read_exact(&mut end)?;
        let is_known = head.starts_with(SIGNATURE) && matches!(head[8], 2 | 3) && head[9] == 8;
        Ok(is_known && u64::from_le_bytes(end) == file.metadata()?.len())
    };
    agrees().unwrap_or(false)
}

fn seal(length: u64, sum: Checksum) -> [u8; LENGTH] {
    let mut seal = [0; LENGTH];
    seal[..8].copy_from_slice(NAME);
    seal[8..16].copy_from_slice(&length.to_le_bytes());
    seal[16..].copy_from_slice(&sum.value().to_le_bytes());
    seal
}

/// The checksum of the next `length` bytes, taken as words, the last one filled up with zeros.
fn checksum(file: &File, length: u64) -> io::Result<Checksum> {
    let mut sum = Checksum::default();
    let mut block = Vec::with_capacity(BLOCK as usize);
    let mut left = length;
    while left > 0 {
        block.clear();
        let read = file.take(left.min(BLOCK)).read_to_end(&mut block)?;
        if read == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        block.resize(read.next_multiple_of(8), 0);
        sum = block.as_chunks().0.iter().fold(sum, |sum, &word| sum.word(u64::from_le_bytes(word)));
        left -= read as u64;
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::fs;

    /// The sealed files here are no HDF5 files.
    fn is_refused(path: &Path) -> bool {
        matches!(verify(path), Err(OutputError::Damaged { .. } | OutputError::NotHdf5 { .. }))
    }

    #[test]
    fn every_byte_of_a_sealed_file_counts() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("sealed");
        for length in [0, 1, 7, 8, 9, 100] {
            fs::write(&path, vec![3; length]).unwrap();
            write(&path).unwrap();
            verify(&path).unwrap();
            let whole = fs::read(&path).unwrap();
            for position in 0..whole.len() {
                let mut damaged = whole.clone();
                damaged[position] ^= 1;
                fs::write(&path, damaged).unwrap();
                assert!(is_refused(&path), "byte {position} of {length}");
                fs::write(&path, &whole[..position]).unwrap();
                assert!(is_refused(&path), "cut at {position} of {length}");
            }
        }
    }

    /// Other files were told to be damaged.
    #[test]
    fn a_file_that_begins_otherwise_is_no_hdf5_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("case.toml");
        for (text, is_other) in [(&b"[mesh]"[..], true), (&b"\x89HDF\r"[..], false), (&b""[..], false)] {
            fs::write(&path, text).unwrap();
            assert_eq!(matches!(verify(&path), Err(OutputError::NotHdf5 { .. })), is_other, "{text:?}");
        }
    }

    #[test]
    fn damage_is_found_beyond_the_first_block() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("sealed");
        let mut bytes = vec![7; 2 * BLOCK as usize + 5];
        fs::write(&path, &bytes).unwrap();
        write(&path).unwrap();
        verify(&path).unwrap();
        let sealed = fs::read(&path).unwrap();
        for position in [BLOCK as usize - 1, BLOCK as usize, bytes.len() - 1] {
            bytes.clone_from(&sealed);
            bytes[position] ^= 0x80;
            fs::write(&path, &bytes).unwrap();
            assert!(matches!(verify(&path), Err(OutputError::Damaged { .. })), "byte {position}");
        }
    }
}
