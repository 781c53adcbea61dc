//! Settings between Python and JSON.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;

/// A value as Python has it: dict, list, str, int, float, bool or None.
pub fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (value.to_string(),))
}

/// The JSON of a Python value; NumPy scalars count as numbers.
///
/// # Errors
/// `TypeError` or `ValueError` for what JSON cannot say.
pub fn from_python(value: &Bound<'_, PyAny>) -> PyResult<Value> {
    let py = value.py();
    let options = PyDict::new(py);
    options.set_item("allow_nan", false)?;
    options.set_item("default", py.import("operator")?.call_method1("methodcaller", ("tolist",))?)?;
    let text: String = py.import("json")?.call_method("dumps", (value,), Some(&options))?.extract()?;
    serde_json::from_str(&text).map_err(|error| pyo3::exceptions::PyValueError::new_err(error.to_string()))
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
