//! From vectors to NumPy arrays without a copy, and back with one.

use numpy::{Element, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error;

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

/// Finite points from an array of shape (n, 3).
pub fn points(array: &PyReadonlyArrayDyn<'_, f32>) -> PyResult<Vec<[f32; 3]>> {
    let refused = |fault: String, hint| Err(error::refused(array.py(), &format!("`points` {fault}"), hint));
    let &[_, 3] = array.shape() else {
        return refused(format!("has the shape {:?}", array.shape()), "pass one row of x, y, z per point: (n, 3)");
    };
    let flat: Vec<f32> = array.as_array().iter().copied().collect();
    match flat.iter().position(|coordinate| !coordinate.is_finite()) {
        Some(at) => refused(format!("has a coordinate in row {} that is not finite", at / 3), "remove such rows"),
        None => Ok(flat.as_chunks().0.to_vec()),
    }
}
