//! Scratch memory, one piece per thread, allocated once.

use std::sync::{Mutex, PoisonError};

/// A piece of scratch for each thread that computes, and one for a caller outside of them.
pub struct PerThread<T> {
    pieces: Vec<Mutex<T>>,
}

impl<T> PerThread<T> {
    /// One piece per thread from `make`.
    pub fn new(make: impl Fn() -> T) -> Self {
        PerThread { pieces: (0..=rayon::current_num_threads()).map(|_| Mutex::new(make())).collect() }
    }

    /// Runs `work` with this thread's piece.
    pub fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        let index = rayon::current_thread_index().unwrap_or(self.pieces.len() - 1);
        let piece = &self.pieces[index.min(self.pieces.len() - 1)];
        // A piece is overwritten by every use: one left behind by a panic is as good as any.
        work(&mut piece.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
