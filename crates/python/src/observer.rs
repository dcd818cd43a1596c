//! Reports of a run to Python, and requests to stop it.

use crate::slab::Slab;
use pyo3::prelude::*;
use simulation::{NextStep, Observer, RunState, WarningSink};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// A run for Python: slabs go to `on_slab`, messages to the logger `stsolve`.
#[derive(Default)]
pub struct Listener {
    on_slab: Option<Py<PyAny>>,
    is_stopped: AtomicBool,
    error: Mutex<Option<PyErr>>,
    progress: Mutex<Option<Progress>>,
}

/// How far a run is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// The time at which this call of the run has begun, and its end.
    interval: [f64; 2],
    /// Slabs done and the time reached.
    reached: (usize, f64),
    /// When the slabs began.
    begun: Instant,
}

impl Progress {
    fn new(start: f64, end: f64) -> Self {
        Progress { interval: [start, end], reached: (0, start), begun: Instant::now() }
    }

    /// Number of the last slab; the time reached, and the end; the part that is done; seconds since the slabs began.
    pub fn numbers(&self) -> (usize, f64, f64, f64, f64) {
        let ([start, end], (slab, time)) = (self.interval, self.reached);
        let part = if end > start { ((time - start) / (end - start)).clamp(0.0, 1.0) } else { 1.0 };
        (slab, time, end, part, self.begun.elapsed().as_secs_f64())
    }
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

    /// How far the run is, once it has begun.
    pub fn progress(&self) -> Option<Progress> {
        *self.progress.lock().ok()?
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

    fn change_progress(&self, change: impl FnOnce(&mut Progress)) {
        if let Ok(mut progress) = self.progress.lock()
            && let Some(progress) = progress.as_mut()
        {
            change(progress);
        }
    }

    /// Reports a slab to Python; returns whether the run continues.
    fn tell(&self, py: Python<'_>, now: &RunState<'_>) -> PyResult<bool> {
        let Some(on_slab) = &self.on_slab else { return Ok(true) };
        let answer = on_slab.bind(py).call1((Slab::new(now),))?;
        // Only False stops, also that of NumPy: a callback may end in any expression, such as a count or an array.
        Ok(answer.extract().unwrap_or(true))
    }
}

/// Hands a message to the logger `stsolve`.
fn log(level: &str, message: &str) -> PyResult<()> {
    Python::attach(|py| {
        let logger = py.import("logging")?.call_method1("getLogger", ("stsolve",))?;
        logger.call_method1(level, (message,)).map(drop)
    })
}

impl Observer for Listener {
    fn begin(&self, start: f64, end: f64) {
        if let Ok(mut progress) = self.progress.lock() {
            *progress = Some(Progress::new(start, end));
        }
    }

    fn begin_slabs(&self) {
        self.change_progress(|progress| progress.begun = Instant::now());
    }

    fn state(&self, now: &RunState<'_>) {
        self.change_progress(|progress| progress.reached = (now.state.slab, now.state.time));
        if self.on_slab.is_some() {
            Python::attach(|py| self.follow(self.tell(py, now)));
        }
    }

    fn say(&self, message: &str) {
        self.follow(log("info", message).map(|()| true));
    }

    fn warnings(&self) -> Option<WarningSink> {
        // A logger that fails does not stop a run for a warning.
        Some(Box::new(|message| _ = log("warning", message)))
    }

    fn is_stop_requested(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    fn advice(&self, step: NextStep, directory: &Path) -> String {
        match step {
            NextStep::Resume => format!("`Case.run(output={directory:?}, existing=\"resume\")` continues it"),
            NextStep::Replace => format!("`Case.run(output={directory:?}, existing=\"replace\")` replaces it"),
            NextStep::WriteElsewhere => "another `output` keeps it".to_owned(),
            NextStep::Report => {
                let directory = directory.display();
                format!("`stsolve.Result` reads it, and the command `stsolve report {directory}` makes a page of it")
            }
        }
    }
}
