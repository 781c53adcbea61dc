//! Recipes.

use std::fmt::Display;
use std::path::PathBuf;
use std::sync::Arc;

use plume::cave;
use plume::recipe;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use serde_json::Value;

use crate::{error, json, work};

/// What a cave is made from: every key has a value, every value is in range.
///
/// `plume new` prints the default recipe with a comment for every key. A recipe is immutable; `replace` makes a changed
/// copy. Two recipes are equal if all their values are.
///
/// Args:
///     settings: A mapping of keys to values. Keys are nested, `{"graph": {"nodes": 20}}`, or dotted, `{"graph.nodes":
///         20}`. Missing keys and None get their defaults.
///     seed: Takes precedence over the seed of `settings`; 0 to 2**63 - 1.
///
/// Raises:
///     RecipeError: With all faults of the settings.
///
/// >>> recipe = plume.Recipe({"graph": {"nodes": 20}}, seed=3)
/// >>> recipe["graph"]["nodes"], recipe["rock.kind"], recipe.seed
/// (20, 'limestone', 3)
#[pyclass(module = "plume", frozen)]
pub struct Recipe {
    written: Arc<Written>,
    overrides: Vec<String>,
    resolved: recipe::Recipe,
}

/// A recipe as its author wrote it: faults name its lines, and defaults of missing keys can still depend on overrides.
struct Written {
    text: String,
    file: PathBuf,
}

impl Recipe {
    /// An owned copy of the recipe.
    pub fn resolve(&self, py: Python<'_>, overrides: &[String]) -> PyResult<recipe::Recipe> {
        let all: Vec<String> = self.overrides.iter().chain(overrides).cloned().collect();
        self.written.resolve(py, &all)
    }

    /// The recipe in a cave folder.
    pub fn of_cave(py: Python<'_>, cave: &cave::Cave) -> PyResult<Self> {
        let file = cave.root().join(plume::store::RECIPE);
        Self::new(py, Arc::new(Written { text: cave.recipe().to_toml(), file }), Vec::new())
    }

    /// A section or, by its dotted name, a value.
    fn value(&self, key: &str) -> Option<&Value> {
        self.resolved.to_json().pointer(&format!("/{}", key.replace('.', "/")))
    }

    fn new(py: Python<'_>, written: Arc<Written>, overrides: Vec<String>) -> PyResult<Self> {
        let resolved = written.resolve(py, &overrides)?;
        Ok(Self { written, overrides, resolved })
    }
}

impl Written {
    fn resolve(&self, py: Python<'_>, overrides: &[String]) -> PyResult<recipe::Recipe> {
        let recipe = recipe::Recipe::from_toml(&self.text, &self.file, overrides);
        recipe.map_err(|faults| error::raised(py, &faults.into()))
    }
}

#[pymethods]
impl Recipe {
    /// The default recipe with these values.
    #[new]
    #[pyo3(signature = (settings=None, *, seed=None))]
    pub fn of_settings(py: Python<'_>, settings: Option<&Bound<'_, PyMapping>>, seed: Option<i128>) -> PyResult<Self> {
        let written = Written { text: String::new(), file: "recipe".into() };
        Self::new(py, Arc::new(written), overrides(settings, seed)?)
    }

    /// Reads a recipe file (TOML). Paths in it are relative to it.
    ///
    /// Raises:
    ///     RecipeError: With line and key of every fault.
    ///     StorageError: If it cannot be read.
    #[staticmethod]
    #[pyo3(signature = (path, *, seed=None))]
    fn load(py: Python<'_>, path: PathBuf, seed: Option<i128>) -> PyResult<Self> {
        let text = work::briefly(py, || cave::read(&path))?;
        Self::new(py, Arc::new(Written { text, file: path }), seed_pairs(seed))
    }

    /// Reads the text of a recipe (TOML).
    ///
    /// Raises:
    ///     RecipeError: With line and key of every fault.
    ///
    /// >>> plume.Recipe.parse('name = "demo"').name
    /// 'demo'
    /// >>> try:
    /// ...     plume.Recipe.parse("[graph]\nnodes = 1")
    /// ... except plume.RecipeError as error:
    /// ...     print(error.faults[0].line, error.faults[0].message)
    /// 2 graph.nodes must be at least 2, found 1
    #[staticmethod]
    #[pyo3(signature = (text, *, seed=None))]
    fn parse(py: Python<'_>, text: String, seed: Option<i128>) -> PyResult<Self> {
        Self::new(py, Arc::new(Written { text, file: "recipe".into() }), seed_pairs(seed))
    }

    /// A recipe included with Plume; `plume.presets()` lists them.
    ///
    /// Raises:
    ///     InputError: If there is no such preset.
    ///
    /// >>> plume.Recipe.preset("mine")["graph.generator"]
    /// 'mine'
    #[staticmethod]
    #[pyo3(signature = (name, *, seed=None))]
    fn preset(py: Python<'_>, name: &str, seed: Option<i128>) -> PyResult<Self> {
        let row = work::briefly(py, || cave::preset(name))?;
        let written = Written { text: row.text.to_owned(), file: row.name.into() };
        Self::new(py, Arc::new(written), seed_pairs(seed))
    }

    /// A copy of the recipe with these values.
    ///
    /// Args:
    ///     settings: A mapping as for the constructor. Missing keys and None keep their values.
    ///     seed: Another seed.
    ///
    /// Raises:
    ///     RecipeError: With all faults.
    ///
    /// >>> plume.Recipe().replace({"graph.nodes": 100, "rock.kind": "basalt"}, seed=5)["graph.nodes"]
    /// 100
    #[pyo3(signature = (settings=None, *, seed=None))]
    fn replace(&self, py: Python<'_>, settings: Option<&Bound<'_, PyMapping>>, seed: Option<i128>) -> PyResult<Self> {
        let overrides = [self.overrides.clone(), overrides(settings, seed)?].concat();
        Self::new(py, Arc::clone(&self.written), overrides)
    }

    /// Name of the cave and of what is made from it.
    #[getter]
    fn name(&self) -> &str {
        self.resolved.name()
    }

    /// The seed of everything random.
    #[getter]
    fn seed(&self) -> u64 {
        self.resolved.seed()
    }

    /// Every key with its value, as a new dict of dicts; keys without a value are None.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, self.resolved.to_json())
    }

    /// The recipe as TOML with a comment for every key; `parse` returns an equal recipe.
    fn to_toml(&self) -> String {
        self.resolved.to_toml()
    }

    /// A section (a new dict) or, by its dotted name, a value.
    fn __getitem__<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        self.value(key).map_or_else(|| Err(missing(&key)), |value| json::to_python(py, value))
    }

    /// Whether there is such a section or, by its dotted name, such a key.
    fn __contains__(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().resolved.to_json() == self.resolved.to_json())
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        self.resolved.to_json().to_string().hash(&mut hasher);
        hasher.finish()
    }

    /// Pickling keeps the recipe as written, so that paths stay relative to it.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let Written { text, file } = &*slf.get().written;
        let written = (text, file, &slf.get().overrides);
        (slf.get_type().getattr("_written")?, written).into_bound_py_any(slf.py())
    }

    #[staticmethod]
    fn _written(py: Python<'_>, text: String, file: PathBuf, overrides: Vec<String>) -> PyResult<Self> {
        Self::new(py, Arc::new(Written { text, file }), overrides)
    }

    fn __repr__(&self) -> String {
        let json = self.resolved.to_json();
        let (graph, rock) = (&json["graph"]["generator"], &json["rock"]["kind"]);
        format!("<plume.Recipe {:?}: seed {}, graph {graph}, rock {rock}>", self.resolved.name(), self.resolved.seed())
    }
}

fn missing(key: &impl Display) -> PyErr {
    pyo3::exceptions::PyKeyError::new_err(key.to_string())
}

/// Settings and seed as on the command line.
fn overrides(settings: Option<&Bound<'_, PyMapping>>, seed: Option<i128>) -> PyResult<Vec<String>> {
    let mut pairs = match settings {
        Some(settings) => json::pairs("", &json::from_python(settings)?),
        None => Vec::new(),
    };
    pairs.extend(seed_pairs(seed));
    Ok(pairs)
}

/// The seed as on the command line.
pub fn seed_pairs(seed: Option<i128>) -> Vec<String> {
    seed.map(|seed| format!("seed={seed}")).into_iter().collect()
}
