//! From vectors to NumPy arrays; the memory is the same.

use numpy::{Element, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

/// An array of shape (n, `N`).
pub fn rows<T: Element, const N: usize>(py: Python<'_>, rows: Vec<[T; N]>) -> PyResult<Bound<'_, PyArray2<T>>> {
    table(py, rows.into_flattened(), N)
}

/// An array of shape (n, `columns`).
pub fn table<T: Element>(py: Python<'_>, flat: Vec<T>, columns: usize) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = flat.len() / columns;
    PyArray1::from_vec(py, flat).reshape([rows, columns])
}

/// An array of this shape.
pub fn block<T: Element>(py: Python<'_>, flat: Vec<T>, shape: [usize; 3]) -> PyResult<Bound<'_, PyArray3<T>>> {
    PyArray1::from_vec(py, flat).reshape(shape)
}
