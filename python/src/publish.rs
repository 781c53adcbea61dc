//! `plume publish`, by `plume.publish`.

use plume::cave::CaveError;
use plume_cli::Publish;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::from_python;

/// Publishes a dataset and returns how many files it wrote.
pub fn publish(request: &Publish) -> Result<usize, CaveError> {
    Python::attach(|py| call(py, request).map_err(|error| from_python(py, &error)))
}

fn call(py: Python<'_>, request: &Publish) -> PyResult<usize> {
    let Publish { dataset, url, shards } = request;
    let module = py.import("plume.publish")?;
    let Some(caves) = shards else {
        return module.call_method1("copy", (dataset, url))?.extract();
    };
    let keywords = PyDict::new(py);
    keywords.set_item("caves", caves.get())?;
    module.call_method("shards", (dataset, url), Some(&keywords))?.len()
}
