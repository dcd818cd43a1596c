//! The directory of one run, held by one process at a time.

use std::fmt;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use crate::error::OutputError;

const LOCK_FILE: &str = "run.lock";

/// The process that holds a run directory.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LockOwner {
    /// Process number.
    pub pid: u32,
    /// Name of the machine.
    pub host: String,
    /// Seconds since 1970 at which the run started.
    pub started: u64,
}

impl LockOwner {
    fn this_process() -> Self {
        let host = fs::read_to_string("/proc/sys/kernel/hostname").or_else(|_| fs::read_to_string("/etc/hostname"));
        Self {
            pid: std::process::id(),
            host: host.map_or_else(|_| "this machine".to_owned(), |name| name.trim().to_owned()),
            started: seconds_since_1970(),
        }
    }
}

impl fmt::Display for LockOwner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = seconds_since_1970().saturating_sub(self.started);
        write!(f, "process {} on {}, started {seconds} s ago", self.pid, self.host)
    }
}

fn seconds_since_1970() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

/// The output directory of a run, created if need be and locked until this value is dropped.
///
/// The operating system locks the file `run.lock` and unlocks it when the process ends in any way, so there are no
/// stale locks. The file only names the owner. Directories created here that are empty at the end are removed again.
#[derive(Debug)]
pub struct RunDirectory {
    path: PathBuf,
    /// Directories created here, innermost first.
    made: Vec<PathBuf>,
    lock: Option<File>,
}

impl RunDirectory {
    /// Creates the directory if need be and locks it.
    ///
    /// # Errors
    /// [`OutputError::Directory`] if it cannot be created or written, [`OutputError::Busy`] if another run holds it.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        let absent = path.ancestors().filter(|ancestor| !ancestor.as_os_str().is_empty() && !ancestor.exists());
        let mut directory = Self { path: path.to_owned(), made: absent.map(Path::to_owned).collect(), lock: None };
        fs::create_dir_all(path).map_err(|source| directory.error(source))?;
        while !directory.try_lock()? {}
        Ok(directory)
    }

    /// Whether a run holds the directory at `path` now.
    pub fn is_held(path: &Path) -> bool {
        let lock = File::open(path.join(LOCK_FILE));
        lock.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }

    /// Path of the directory.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Takes the lock; false if its last owner removed the file between our opening and locking it.
    fn try_lock(&mut self) -> Result<bool, OutputError> {
        let path = self.path.join(LOCK_FILE);
        let open = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let file = open.map_err(|source| self.error(source))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(self.busy(&path)),
            // A file system without locks: the run is allowed, and a second run is not detected.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(source)) => return Err(self.error(source)),
        }
        // From here on the file belongs to this process and is removed at the end, even if the disk is full.
        let file = self.lock.insert(file);
        let owner = format!("{}\n", serde_json::json!(LockOwner::this_process()));
        let written = file.set_len(0).and_then(|()| file.write_all(owner.as_bytes()));
        written.map_err(|source| self.error(source))?;
        let ours = fs::read_to_string(&path).is_ok_and(|found| found == owner);
        self.lock = self.lock.take().filter(|_| ours);
        Ok(ours)
    }

    fn busy(&self, lock: &Path) -> OutputError {
        OutputError::Busy { path: self.path.clone(), owner: owner_of(lock) }
    }

    fn error(&self, source: io::Error) -> OutputError {
        OutputError::Directory { path: self.path.clone(), source }
    }
}

/// The owner named in a lock file. The file is locked before it is written, so the owner is given a moment.
fn owner_of(lock: &Path) -> Option<LockOwner> {
    for _ in 0..100 {
        match fs::read(lock).map(|bytes| serde_json::from_slice(&bytes)) {
            Ok(Ok(owner)) => return Some(owner),
            Ok(Err(_)) => std::thread::sleep(Duration::from_millis(2)),
            Err(_) => return None,
        }
    }
    None
}

impl Drop for RunDirectory {
    /// Errors cannot be reported from here and do no harm: an unlocked lock file is ignored.
    fn drop(&mut self) {
        if self.lock.is_some() {
            let _ = fs::remove_file(self.path.join(LOCK_FILE));
        }
        for made in &self.made {
            let _ = fs::remove_dir(made);
        }
    }
}
