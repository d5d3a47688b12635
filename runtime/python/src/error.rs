//! Errors of mechanisms as Python exceptions.

use linkwork_jit::Error;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

/// Returns the Python exception `linkwork.Error` with a message.
pub fn python_error_from_message(py: Python<'_>, message: String) -> PyErr {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    new_exception(py, &CLASS, "Error", message)
}

fn new_exception(
    py: Python<'_>,
    class: &'static PyOnceLock<Py<PyType>>,
    name: &'static str,
    message: String,
) -> PyErr {
    match class.import(py, "linkwork._names", name) {
        Ok(class) => PyErr::from_type(class.clone(), message),
        Err(error) => error,
    }
}

/// Returns the Python exception for an error. `state` is the index of the failed state in a batch.
pub fn python_exception_of_error(py: Python<'_>, error: &Error, state: Option<usize>) -> PyErr {
    static UNKNOWN: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let text = match state {
        Some(state) => format!("state {state}: {error}"),
        None => error.to_string(),
    };
    match error {
        Error::Unknown { .. } => new_exception(py, &UNKNOWN, "UnknownName", text),
        Error::Length { .. } | Error::Arguments { .. } => PyValueError::new_err(text),
        _ => python_error_from_message(py, text),
    }
}
