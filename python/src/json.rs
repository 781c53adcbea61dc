//! Settings between Python and JSON.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use serde_json::Value;

/// A value as Python has it: dict, list, str, int, float, bool or None.
pub fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (value.to_string(),))
}

/// The JSON of a mapping; NumPy scalars and arrays count as numbers and lists, paths as texts.
///
/// # Errors
/// `TypeError` or `ValueError` for what JSON cannot say.
pub fn from_python(mapping: &Bound<'_, PyMapping>) -> PyResult<Value> {
    let py = mapping.py();
    let options = PyDict::new(py);
    options.set_item("allow_nan", false)?;
    options.set_item("default", wrap_pyfunction!(plain, py)?)?;
    let dict = py.get_type::<PyDict>().call1((mapping,))?;
    let text: String = py.import("json")?.call_method("dumps", (dict,), Some(&options))?.extract()?;
    serde_json::from_str(&text).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The plain value of what JSON does not know.
#[pyfunction]
fn plain<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if value.hasattr("tolist")? {
        return value.call_method0("tolist");
    }
    value.py().import("os")?.call_method1("fspath", (value,))
}

/// `key=value` pairs, as the command line takes them. Keys may be dotted or nested; those without a value are left out.
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
