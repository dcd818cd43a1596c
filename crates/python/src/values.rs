//! Numbers and texts between Python and Rust.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use serde::Serialize;

/// Values may lie so deep in others. One that contains itself is deeper.
const DEEPEST: usize = 100;

/// A value of a case file as TOML: the text behind `key =`.
pub fn to_toml(value: &Bound<'_, PyAny>) -> PyResult<String> {
    written(value, 0)
}

/// The same at a `depth` inside of other values.
fn written(value: &Bound<'_, PyAny>, depth: usize) -> PyResult<String> {
    if depth > DEEPEST {
        let message = format!("a value of a case file lies more than {DEEPEST} levels deep in others, or in itself");
        return Err(PyTypeError::new_err(message));
    }
    if value.is_instance_of::<PyBool>() {
        return Ok(value.extract::<bool>()?.to_string());
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(value.str()?.to_string());
    }
    if value.is_instance_of::<PyFloat>() {
        // TOML writes inf and nan in small letters.
        return Ok(format!("{:?}", value.extract::<f64>()?).to_lowercase());
    }
    if value.is_instance_of::<PyString>() {
        return quoted(&value.extract::<String>()?);
    }
    if let Ok(table) = value.cast::<PyDict>() {
        let entry = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            Ok(format!("{} = {}", quoted(&key.extract::<String>()?)?, written(&value, depth + 1)?))
        };
        return Ok(format!("{{ {} }}", table.iter().map(entry).collect::<PyResult<Vec<_>>>()?.join(", ")));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let entries = value.try_iter()?.map(|entry| written(&entry?, depth + 1)).collect::<PyResult<Vec<_>>>()?;
        return Ok(format!("[{}]", entries.join(", ")));
    }
    if let Ok(path) = value.call_method0("__fspath__") {
        return written(&path, depth + 1);
    }
    // A number of NumPy becomes one of Python, unless Python has no such number, and an array a list.
    match value.call_method0("tolist") {
        Ok(of_python) if !of_python.get_type().is(value.get_type()) => written(&of_python, depth + 1),
        _ => Err(PyTypeError::new_err(format!("{} is no value of a case file", value.repr()?))),
    }
}

/// Texts of JSON are texts of TOML.
fn quoted(text: &str) -> PyResult<String> {
    serde_json::to_string(text).map_err(|error| PyTypeError::new_err(error.to_string()))
}

/// A value that JSON can hold, as objects of Python.
pub fn to_python<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| PyTypeError::new_err(error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}
