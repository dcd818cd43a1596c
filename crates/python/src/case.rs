//! A case, and how it runs.

use crate::observer::Listener;
use crate::values::{to_python, to_toml};
use crate::{CaseError, SolveError, message, not_pickled};
use ::case::AnyCase;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use rayon::{ThreadPool, ThreadPoolBuilder};
use simulation::{Destination, Existing, Failure};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often a run looks for an interrupt.
const WATCH: Duration = Duration::from_millis(20);

/// The number of checks for an interrupt between two displays of the progress.
const LOOKS: usize = 10;

/// A case: `Case("case.toml", {"flow.order": 4})`. Settings are written over the file, as `--set` of the command does.
///
/// Raises CaseError with the place and the remedy if the case is wrong.
#[pyclass(frozen)]
pub struct Case {
    case: AnyCase,
    /// Whether a run is changing the controls of the case.
    is_held: AtomicBool,
}

/// Releases the controls of a case when its run ends.
struct Held<'a>(&'a AtomicBool);

impl Drop for Held<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Release);
    }
}

#[pymethods]
impl Case {
    #[new]
    #[pyo3(signature = (path, settings=None))]
    fn new(py: Python<'_>, path: PathBuf, settings: Option<&Bound<'_, PyMapping>>) -> PyResult<Self> {
        let option = |item: Bound<'_, PyAny>| {
            let (key, value): (String, Bound<'_, PyAny>) = item.extract()?;
            Ok(format!("{key}={}", to_toml(&value)?))
        };
        let items = settings.map(|settings| settings.items()).transpose()?;
        let options = items.iter().flat_map(|items| items.iter().map(option)).collect::<PyResult<Vec<_>>>()?;
        let case =
            py.detach(|| AnyCase::read(&path, &options)).map_err(|error| CaseError::new_err(message(&*error)))?;
        Ok(Case { case, is_held: AtomicBool::new(false) })
    }

    /// The name of the case.
    #[getter]
    fn name(&self) -> &str {
        &self.case.about().name
    }

    /// The title of the case.
    #[getter]
    fn title(&self) -> &str {
        &self.case.about().title
    }

    /// The resolved case with all defaults, as TOML.
    #[getter]
    fn text(&self) -> &str {
        &self.case.about().resolved
    }

    /// Runs the case and returns the contents of summary.json as a dictionary.
    ///
    /// `output` is the directory; default that of the case, or runs/<name>.
    ///
    /// `existing` is the treatment of a run there: "keep" refuses to write, "resume" continues from its checkpoint, "replace" replaces it.
    ///
    /// `on_slab` is called after every slab with a `Slab`: its numbers and fields. The run stops with a checkpoint if it returns False.
    ///
    /// `progress` shows a line with the time that is left, on a terminal or in a notebook.
    ///
    /// `threads` is the number of threads; default all cores. The results have the same bits for any number.
    ///
    /// A case with controls cannot run twice at the same time: load it again for each run.
    #[pyo3(signature = (output=None, existing="keep", on_slab=None, progress=false, threads=None))]
    #[expect(clippy::too_many_arguments, reason = "they are the named parameters of Python")]
    fn run<'py>(
        &self,
        py: Python<'py>,
        output: Option<PathBuf>,
        existing: &str,
        on_slab: Option<Py<PyAny>>,
        progress: bool,
        threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if let Some(given) = on_slab.as_ref().filter(|given| !given.bind(py).is_callable()) {
            return Err(PyTypeError::new_err(format!("on_slab = {} cannot be called", given.bind(py).repr()?)));
        }
        // A run inside of `on_slab` is on a thread of the pool of the outer one, for which it must not wait.
        let inner = rayon::current_thread_index().map(|_| rayon::current_num_threads() as i64);
        let pool = threads.or(inner).map(pool).transpose()?;
        let destination = self.destination(output, existing)?;
        let _held = self.hold_controls()?;
        let line = progress.then(|| py.import("stsolve._progress")?.call_method0("Progress")).transpose()?;
        let listener = Listener::new(on_slab);
        let run = || simulation::run(&self.case, &destination, &listener);
        let done = watched(py, || pool.as_ref().map_or_else(run, |pool| pool.install(run)), &listener, line.as_ref());
        if let Some(error) = listener.error() {
            return Err(error);
        }
        match done {
            Ok(summary) => to_python(py, &summary),
            Err(Failure::Stopped) => read_summary(py, &destination.directory),
            Err(Failure::BadInput(error)) => Err(CaseError::new_err(message(error.as_ref()))),
            Err(Failure::Solve(error)) => Err(SolveError::new_err(message(error.as_ref()))),
        }
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(not_pickled("Case", "the path and the settings of the case"))
    }

    fn __repr__(&self) -> String {
        format!("stsolve.Case({:?})", self.name())
    }
}

impl Case {
    /// Keeps other runs of this case away, which would change its controls, too; None without controls.
    fn hold_controls(&self) -> PyResult<Option<Held<'_>>> {
        if !self.case.has_controls() {
            return Ok(None);
        }
        if self.is_held.swap(true, Ordering::Acquire) {
            let problem = format!(
                "the case {:?} is running, and its run changes its controls: for a run at the same time load it again",
                self.name()
            );
            return Err(PyRuntimeError::new_err(problem));
        }
        Ok(Some(Held(&self.is_held)))
    }

    fn destination(&self, output: Option<PathBuf>, existing: &str) -> PyResult<Destination> {
        let existing = match existing {
            "keep" => Existing::Keep,
            "resume" => Existing::Resume,
            "replace" => Existing::Replace,
            other => {
                let problem = format!("existing = {other:?}; accepted: \"keep\", \"resume\", \"replace\"");
                return Err(CaseError::new_err(problem));
            }
        };
        let of_case = Destination::of(&self.case).directory;
        // The directory of work may change during the run.
        let directory = std::path::absolute(output.unwrap_or(of_case))?;
        Ok(Destination { directory, existing })
    }
}

/// A pool of threads for one run.
fn pool(threads: i64) -> PyResult<ThreadPool> {
    let most = i64::from(simulation::MOST_THREADS);
    if !(1..=most).contains(&threads) {
        return Err(PyValueError::new_err(format!("threads = {threads}; accepted: 1 to {most}")));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads as usize).build();
    pool.map_err(|error| CaseError::new_err(format!("threads = {threads}: {error}")))
}

/// Runs in a thread of its own, while this one, which Python interrupts, watches for interrupts.
fn watched(
    py: Python<'_>,
    run: impl FnOnce() -> Result<output::Summary, Failure> + Send,
    listener: &Listener,
    line: Option<&Bound<'_, PyAny>>,
) -> Result<output::Summary, Failure> {
    std::thread::scope(|scope| {
        let run = scope.spawn(run);
        for look in 1.. {
            py.detach(|| std::thread::sleep(WATCH));
            listener.follow(py.check_signals().map(|()| true));
            let is_finished = run.is_finished();
            if look % LOOKS == 0 || is_finished {
                listener.follow(show(line, listener, is_finished));
            }
            if is_finished {
                break;
            }
        }
        run.join().unwrap_or_else(|_| Err(Failure::solve(std::io::Error::other("the run ended without a result"))))
    })
}

/// Shows the progress of the run, if requested; returns that the run continues.
fn show(line: Option<&Bound<'_, PyAny>>, listener: &Listener, is_finished: bool) -> PyResult<bool> {
    if let Some((line, progress)) = line.zip(listener.progress()) {
        line.call_method1("show", progress.numbers())?;
        if is_finished {
            line.call_method0("close")?;
        }
    }
    Ok(true)
}

/// summary.json of a run that was stopped.
fn read_summary<'py>(py: Python<'py>, directory: &Path) -> PyResult<Bound<'py, PyAny>> {
    let text = std::fs::read_to_string(directory.join("summary.json"))?;
    py.import("json")?.call_method1("loads", (text,))
}
