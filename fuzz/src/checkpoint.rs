//! Any bytes as a result file.

use output::{RESULT_FILE, inspect, read_checkpoint};

/// Reads a result file; true if it is valid. Must return for any bytes.
pub fn read(bytes: &[u8]) -> bool {
    let Ok(directory) = tempfile::tempdir() else { return false };
    let path = directory.path().join(RESULT_FILE);
    if std::fs::write(&path, bytes).is_err() {
        return false;
    }
    let (checkpoint, information) = (read_checkpoint(&path), inspect(&path));
    // The error must have a message for any input.
    let told = |error: output::OutputError| error.to_string();
    checkpoint.map_err(told).is_ok() && information.map_err(told).is_ok()
}
