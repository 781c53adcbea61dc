//! Conversion of settings between Python and JSON.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use serde_json::Value;

/// A value as a Python object: dict, list, str, int, float, bool or None.
pub fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (value.to_string(),))
}

/// The JSON of a mapping; NumPy scalars and arrays become numbers and lists, paths become strings.
///
/// # Errors
/// `TypeError` or `ValueError` for values that JSON cannot represent.
pub fn from_python(mapping: &Bound<'_, PyMapping>) -> PyResult<Value> {
    let py = mapping.py();
    let options = PyDict::new(py);
    options.set_item("allow_nan", false)?;
    options.set_item("default", wrap_pyfunction!(plain, py)?)?;
    let dict = py.get_type::<PyDict>().call1((mapping,))?;
    let text: String = py.import("json")?.call_method("dumps", (dict,), Some(&options))?.extract()?;
    serde_json::from_str(&text).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The plain value of a type that JSON does not know.
#[pyfunction]
fn plain<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if value.hasattr("tolist")? {
        return value.call_method0("tolist");
    }
    value.py().import("os")?.call_method1("fspath", (value,))
}

/// `key=value` pairs as on the command line. Keys may be dotted or nested; those set to None are omitted.
pub fn pairs(prefix: &str, value: &Value) -> Vec<String> {
    match value {
        Value::Object(map) => map.iter().flat_map(|(key, value)| pairs(&join(prefix, key), value)).collect(),
        Value::Null => Vec::new(),
        value => vec![format!("{prefix}={value}")],
    }
}

fn join(prefix: &str, key: &str) -> String {
    if prefix.is_empty() { key.to_owned() } else { format!("{prefix}.{key}") }
}
