//! Numbers and texts between Python and Rust.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use serde::Serialize;

/// A value of a case file as TOML: the text behind `key =`.
pub fn to_toml(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if value.is_instance_of::<PyBool>() {
        return Ok(value.extract::<bool>()?.to_string());
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(value.str()?.to_string());
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(format!("{:?}", value.extract::<f64>()?));
    }
    if value.is_instance_of::<PyString>() {
        return quoted(&value.extract::<String>()?);
    }
    if let Ok(table) = value.cast::<PyDict>() {
        let entry = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            Ok(format!("{} = {}", quoted(&key.extract::<String>()?)?, to_toml(&value)?))
        };
        return Ok(format!("{{ {} }}", table.iter().map(entry).collect::<PyResult<Vec<_>>>()?.join(", ")));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let entries = value.try_iter()?.map(|entry| to_toml(&entry?)).collect::<PyResult<Vec<_>>>()?;
        return Ok(format!("[{}]", entries.join(", ")));
    }
    // A number of NumPy becomes one of Python.
    match value.call_method0("item") {
        Ok(item) if !item.is(value) => to_toml(&item),
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
