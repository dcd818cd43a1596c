//! What Python hears of a run, and how it stops one.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use simulation::{Observer, SlabDone};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// A run for Python: slabs go to `on_slab`, messages to the logger `stsolve`.
#[derive(Default)]
pub struct Listener {
    on_slab: Option<Py<PyAny>>,
    is_stopped: AtomicBool,
    error: Mutex<Option<PyErr>>,
}

impl Listener {
    /// Calls `on_slab` after every slab.
    pub fn new(on_slab: Option<Py<PyAny>>) -> Self {
        Listener { on_slab, ..Listener::default() }
    }

    /// The exception that stopped the run: that of `on_slab`, or an interrupt.
    pub fn error(&self) -> Option<PyErr> {
        self.error.lock().ok()?.take()
    }

    /// Asks for a stop if `heard` says so or failed.
    pub fn follow(&self, heard: PyResult<bool>) {
        let goes_on = heard.unwrap_or_else(|error| {
            if let Ok(mut first) = self.error.lock() {
                first.get_or_insert(error);
            }
            false
        });
        if !goes_on {
            self.is_stopped.store(true, Ordering::Relaxed);
        }
    }

    /// Tells Python of a slab; returns whether the run goes on.
    fn tell(&self, py: Python<'_>, fields: &[(&str, f64)]) -> PyResult<bool> {
        let Some(on_slab) = &self.on_slab else { return Ok(true) };
        let slab = PyDict::new(py);
        fields.iter().try_for_each(|(name, value)| slab.set_item(name, value))?;
        let answer = on_slab.bind(py).call1((slab,))?;
        Ok(answer.is_none() || answer.is_truthy()?)
    }
}

impl Observer for Listener {
    fn slab(&self, slab: &SlabDone) {
        let SlabDone { number, time, newton, krylov, residual } = *slab;
        let counts = [("number", number), ("newton", newton), ("krylov", krylov)].map(|(name, n)| (name, n as f64));
        let fields = [&counts[..], &[("time", time), ("residual", residual)]].concat();
        Python::attach(|py| self.follow(self.tell(py, &fields)));
    }

    fn mesh_slab(&self, number: usize, time: f64, quality: &coupled::MeshQuality) {
        let fields = [("number", number as f64), ("time", time), ("det_j_lower_bound", quality.lower_bound)];
        Python::attach(|py| self.follow(self.tell(py, &fields)));
    }

    fn structure_slab(&self, report: &coupled::StructureReport) {
        let energies = [("kinetic_energy", report.kinetic_energy), ("strain_energy", report.strain_energy)];
        let fields = [&[("number", report.slab as f64), ("time", report.interval.end)][..], &energies].concat();
        Python::attach(|py| self.follow(self.tell(py, &fields)));
    }

    fn say(&self, message: &str) {
        Python::attach(|py| {
            let log =
                || py.import("logging")?.call_method1("getLogger", ("stsolve",))?.call_method1("info", (message,));
            self.follow(log().map(|_| true));
        });
    }

    fn is_stop_requested(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }
}
