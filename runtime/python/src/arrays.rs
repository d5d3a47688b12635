//! Access to the entries of NumPy arrays. This is the only module with `unsafe`.

#![allow(unsafe_code, reason = "entries of arrays that Python owns")]

use numpy::{AsSliceError, PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// Returns the entries of a contiguous Python vector as a slice.
pub fn entries<'a>(array: &'a Bound<'_, PyArray1<f64>>) -> Result<&'a [f64], AsSliceError> {
    // SAFETY: Python code, which could change the entries, does not run while the slice is used: callers hold
    // the lock of the interpreter, and drop the slice before they call it.
    unsafe { array.as_slice() }
}

/// Returns a Python matrix with values that are stored by columns.
pub fn matrix<'py>(
    py: Python<'py>,
    rows: usize,
    columns: usize,
    values: &[f64],
) -> Bound<'py, PyArray2<f64>> {
    assert_eq!(values.len(), rows * columns, "entries of a matrix");
    // SAFETY: all entries of the new contiguous array, which nothing else refers to, are written before it is
    // returned.
    unsafe {
        let array = PyArray2::<f64>::new(py, [rows, columns], true);
        debug_assert_eq!(array.len(), values.len());
        std::ptr::copy_nonoverlapping(values.as_ptr(), array.data(), values.len());
        array
    }
}
