//! The Python module `stsolve`: cases, runs and results.
//!
//! | module | holds |
//! |---|---|
//! | `case` | a case, and how it runs |
//! | `observer` | reports of a run to Python, and requests to stop it |
//! | `slab` | a slab of a run that goes on |
//! | `result` | a result file |
//! | `stored` | fields of a result file at points |
//! | `values` | numbers and texts between Python and Rust |

mod case;
mod observer;
mod result;
mod slab;
mod stored;
mod values;

use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::{create_exception, wrap_pyfunction};
use std::error::Error;

create_exception!(stsolve, CaseError, PyValueError, "The input is wrong; nothing was done.");
create_exception!(stsolve, SolveError, PyRuntimeError, "A slab could not be solved; the last good state is written.");

/// Runs the command line `arguments`, the name of the program first; returns the exit code.
#[pyfunction]
fn execute(py: Python<'_>, arguments: Vec<String>) -> PyResult<i32> {
    Ok(py.detach(|| stsolve::run_command(arguments)))
}

/// The message of `error` and of its causes.
fn message(error: &(dyn Error + 'static)) -> String {
    stsolve::failure::chain(error)
}

/// The exception for an object of a `class` that is to be pickled or copied, with the remedy.
fn not_pickled(class: &str, instead: &str) -> PyErr {
    PyTypeError::new_err(format!("a stsolve.{class} cannot be pickled or copied; {instead} can"))
}

/// The native part of the module.
#[pymodule]
fn _stsolve(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("CaseError", module.py().get_type::<CaseError>())?;
    module.add("SolveError", module.py().get_type::<SolveError>())?;
    module.add_class::<case::Case>()?;
    module.add_class::<slab::Slab>()?;
    module.add_class::<result::Result>()?;
    module.add_function(wrap_pyfunction!(execute, module)?)
}
