//! Any bytes as a result file.

use output::{RESULT_FILE, inspect, read_checkpoint};

/// Reads a result file; true if it is one. Must return, whatever the bytes are.
pub fn read(bytes: &[u8]) -> bool {
    let Ok(directory) = tempfile::tempdir() else { return false };
    let path = directory.path().join(RESULT_FILE);
    if std::fs::write(&path, bytes).is_err() {
        return false;
    }
    let (checkpoint, information) = (read_checkpoint(&path), inspect(&path));
    // An error must be able to say what is wrong, whatever there is to show.
    let told = |error: output::OutputError| error.to_string();
    checkpoint.map_err(told).is_ok() && information.map_err(told).is_ok()
}
