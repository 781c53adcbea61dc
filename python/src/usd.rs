//! usd-core as the library that writes stages, or another program's USD that can be imported.

use std::ffi::CString;
use std::sync::{Mutex, PoisonError};

use numpy::PyArray1;
use plume_exporters::ExportError;
use plume_exporters::stage::{Array, Library, SCRIPT};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use serde_json::Value;

use crate::array;

/// What installs it.
const INSTALL: &str = "pip install 'plume-caves[usd]'";
/// Tested versions: from the first, before the second. The extra `usd` in `pyproject.toml` asks for the same.
const VERSIONS: [(u32, u32); 2] = [(25, 11), (27, 0)];

/// usd-core releases the interpreter lock while it initialises, so that two threads inside it can deadlock: targets are
/// written in parallel, and take turns here.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Runs `call` when no other thread is in usd-core. The caller must not hold the interpreter lock, which that thread may
/// need.
fn alone<T>(call: impl FnOnce(Python<'_>) -> T) -> T {
    let _turn = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    Python::attach(call)
}

/// The Python package usd-core, loaded on first use, which takes a second.
pub struct UsdCore {
    script: PyOnceLock<Py<PyModule>>,
}

impl Default for UsdCore {
    fn default() -> Self {
        Self { script: PyOnceLock::new() }
    }
}

impl Library for UsdCore {
    fn check(&self) -> Result<(), ExportError> {
        alone(|py| {
            let version = version(py).map_err(|error| missing(&format!("cannot be loaded: {error}")))?;
            if version < VERSIONS[0] || version >= VERSIONS[1] {
                return Err(unsupported(&place(py), version));
            }
            self.script(py).map(drop).map_err(|error| missing(&format!("cannot be used: {error}")))
        })
    }

    fn call(&self, function: &'static str, spec: &Value, arrays: Vec<(String, Array)>) -> Result<(), ExportError> {
        alone(|py| self.call_script(py, function, spec, arrays)).map_err(|error| ExportError::Library {
            library: "usd-core",
            path: spec["path"].as_str().unwrap_or_default().to_owned(),
            message: error.to_string(),
        })
    }
}

impl UsdCore {
    fn script<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyModule>> {
        let load = || {
            let code = CString::new(SCRIPT)?;
            Ok(PyModule::from_code(py, &code, c"plume/stage.py", c"plume._stage")?.unbind())
        };
        self.script.get_or_try_init(py, load).map(|script| script.bind(py))
    }

    fn call_script(&self, py: Python<'_>, function: &str, spec: &Value, arrays: Vec<(String, Array)>) -> PyResult<()> {
        let spec = py.import("json")?.call_method1("loads", (spec.to_string(),))?;
        let handed = PyDict::new(py);
        for (name, array) in arrays {
            handed.set_item(name, numpy_array(py, array)?)?;
        }
        self.script(py)?.call_method1(function, (spec, handed)).map(drop)
    }
}

fn version(py: Python<'_>) -> PyResult<(u32, u32)> {
    let version: (u32, u32, u32) = py.import("pxr.Usd")?.call_method0("GetVersion")?.extract()?;
    Ok((version.1, version.2))
}

/// Where this Python has USD from; empty if it does not tell.
fn place(py: Python<'_>) -> String {
    let path = || -> PyResult<String> { py.import("pxr")?.getattr("__path__")?.get_item(0)?.extract() };
    path().map(|path| format!(" in {path}")).unwrap_or_default()
}

fn missing(what: &str) -> ExportError {
    ExportError::MissingPart {
        message: format!("USD is written by the Python package usd-core, which {what}"),
        hint: INSTALL.to_owned(),
    }
}

fn unsupported(place: &str, version: (u32, u32)) -> ExportError {
    let [(year, month), (end, _)] = VERSIONS;
    ExportError::MissingPart {
        message: format!("the USD{place} has the unsupported version {}.{:02}", version.0, version.1),
        hint: format!(
            "{INSTALL}, which needs an environment of its own if that USD belongs to another program; \
             versions from {year}.{month:02} to before {end}.0 are supported"
        ),
    }
}

/// The array as NumPy sees it; the memory is the same.
fn numpy_array(py: Python<'_>, array: Array) -> PyResult<Bound<'_, PyAny>> {
    Ok(match array {
        Array::Float3(rows) => array::rows(py, rows)?.into_any(),
        Array::Float2(rows) => array::rows(py, rows)?.into_any(),
        Array::Index(indices) => PyArray1::from_vec(py, indices).call_method1("view", ("int32",))?,
    })
}
