//! Generators written in Python.

use std::sync::Arc;

use plume::generators::{GENERATORS, GeneratorRow};
use plume::graph::{GenerateError, Generator, Graph, Outside};
use plume::survey::json as graph_json;
use pyo3::prelude::*;
use pyo3::types::{PyMapping, PyString};
use serde_json::{Value, json};

use crate::{error, json};

/// Registers a generator of your own: from then on recipes can name it, as `graph.generator`.
///
/// It stays registered for as long as the process runs. The same seed and settings have to give the same graph, or caves cannot
/// be made again; take random numbers from `random.Random(seed)`.
///
/// Args:
///     name: What recipes call it: lower-case letters, digits and hyphens.
///     function: Called as `function(seed, settings)`, on another thread. Returns a graph as `Graph.to_dict` does, or its
///         JSON text; of each node, `id`, `coordinates` and `edges` are enough.
///     summary: One line for lists.
///     settings: The keys that recipes may set beside `generator`, each with its JSON Schema. A `default` is needed, ranges
///         are checked, and the `description` is the comment in recipes.
///
/// Raises:
///     InputError: The name is taken or cannot be written in recipes, or a setting has no type or no default.
///
/// >>> def straight(seed, settings):
/// ...     count = settings["stations"]
/// ...     return {"nodes": [{
/// ...         "id": i,
/// ...         "coordinates": {"x": 8.0 * i, "y": 0.0, "z": 0.0},
/// ...         "edges": [i + 1] if i + 1 < count else [],
/// ...     } for i in range(count)]}
/// >>> plume.register_generator("straight", straight, settings={"stations": {"type": "integer", "default": 4}})
/// >>> with plume.generate({"graph.generator": "straight", "mesh.voxel_m": 0.5, "texture.size_px": 256}) as tunnel:
/// ...     len(tunnel.graph.positions)
/// 4
#[pyfunction]
#[pyo3(signature = (name, function, *, summary="", settings=None))]
pub fn register_generator(
    py: Python<'_>,
    name: &str,
    function: Py<PyAny>,
    summary: &str,
    settings: Option<&Bound<'_, PyMapping>>,
) -> PyResult<()> {
    let settings = settings.map_or(Ok(json!({})), json::from_python)?;
    if let Some((message, hint)) = settings_fault(&settings) {
        return Err(error::refused(py, &format!("generator {name:?}: {message}"), hint));
    }
    let schema = json!({"type": "object", "properties": settings});
    let function = Arc::new(function);
    // A row lives as long as the process.
    let row = GeneratorRow {
        name: String::leak(name.to_owned()),
        summary: String::leak(summary.to_owned()),
        source: "",
        sample: "",
        schema: Box::leak(Box::new(move || schema.clone().try_into().unwrap_or_default())),
        read: Box::leak(Box::new(move |settings| {
            let generator = PythonGenerator { function: Arc::clone(&function), settings };
            Ok(Box::new(generator) as Box<dyn Generator>)
        })),
    };
    let hint = "choose another name";
    GENERATORS.register(row).map_err(|fault| error::refused(py, &fault.to_string(), hint))
}

/// What recipes could not make of these settings, and what to do about it.
fn settings_fault(settings: &Value) -> Option<(String, &'static str)> {
    let types = ["integer", "number", "string", "boolean", "array", "object"];
    settings.as_object()?.iter().find_map(|(key, schema)| {
        if key == "generator" {
            return Some(("a setting is called \"generator\"".to_owned(), "call it otherwise"));
        }
        if !schema["type"].as_str().is_some_and(|name| types.contains(&name)) {
            return Some((format!("setting {key:?} has no type"), "give its schema a `type`, such as \"integer\""));
        }
        let hint = "give its schema a `default`";
        schema["default"].is_null().then(|| (format!("setting {key:?} has no default"), hint))
    })
}

/// A function of Python with its settings.
#[derive(Debug)]
struct PythonGenerator {
    function: Arc<Py<PyAny>>,
    settings: Value,
}

impl Generator for PythonGenerator {
    fn generate(&self, seed: u64, _: &dyn Outside) -> Result<Graph, GenerateError> {
        let text = Python::attach(|py| self.call(py, seed).map_err(|raised| fault(py, &raised)))?;
        let wrong = |error: graph_json::ReadError| {
            GenerateError::new(format!("the function returned no graph: {error}"), error.hint())
        };
        Ok(graph_json::read(&text).map_err(wrong)?.graph)
    }
}

impl PythonGenerator {
    fn call(&self, py: Python<'_>, seed: u64) -> PyResult<String> {
        let graph = self.function.bind(py).call1((seed, json::to_python(py, &self.settings)?))?;
        if let Ok(text) = graph.cast::<PyString>() {
            return text.extract();
        }
        Ok(json::from_python(graph.cast::<PyMapping>()?)?.to_string())
    }
}

fn fault(py: Python<'_>, raised: &PyErr) -> GenerateError {
    if let Some(traceback) = raised.traceback(py).and_then(|traceback| traceback.format().ok()) {
        return GenerateError::new(format!("the function raised {raised}"), traceback);
    }
    GenerateError::new(format!("the function failed: {raised}"), "return a graph as `Graph.to_dict` does")
}
