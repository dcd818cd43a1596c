//! Numbers that a run changes between slabs.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A number in formulas that a run sets between slabs. Clones share it.
#[derive(Clone, Debug)]
pub struct ControlValue(Arc<AtomicU64>);

impl ControlValue {
    /// The number `value`.
    pub fn new(value: f64) -> Self {
        ControlValue(Arc::new(AtomicU64::new(value.to_bits())))
    }

    /// The number as last set.
    pub fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
    }

    /// Whether this is the same number as `other`, now and later.
    pub(super) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Sets the number, for all clones.
    pub fn set(&self, value: f64) {
        self.0.store(value.to_bits(), Ordering::Relaxed);
    }
}

impl PartialEq for ControlValue {
    fn eq(&self, other: &Self) -> bool {
        self.get() == other.get()
    }
}
