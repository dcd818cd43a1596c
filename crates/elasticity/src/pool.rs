//! Work space that outlives a call.

use std::sync::{Mutex, PoisonError};

/// Work spaces that are lent out and returned, so that a second call allocates nothing and calls may run in parallel.
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

impl<T> Pool<T> {
    pub(crate) fn new() -> Self {
        Pool(Mutex::new(Vec::new()))
    }
    /// A returned work space, or a new one.
    pub(crate) fn take(&self, make: impl FnOnce() -> T) -> T {
        // The lock is released before `make` runs, and no caller holds it while it works.
        let returned = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        returned.unwrap_or_else(make)
    }
    /// Returns a work space.
    pub(crate) fn give(&self, work: T) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(work);
    }
}
