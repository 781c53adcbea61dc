//! `plume.dataset`.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::thread;

use plume::pipeline::Disk;
use plume_dataset::local::Worker;
use plume_dataset::{Outcome, Plan, run};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;

use crate::{interpreter, json, work};

/// A finished dataset.
#[pyclass(module = "plume", frozen, get_all)]
pub struct Dataset {
    /// Its folder.
    path: PathBuf,
    /// The index: for each cave a dict of its part, seed, path, what was drawn, hashes and measures.
    caves: Py<PyAny>,
    /// Why caves could not be made or are left out, by their numbers.
    failed: Py<PyDict>,
}

#[pymethods]
impl Dataset {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (caves, failed) = (self.caves.bind(py).len()?, self.failed.bind(py).len());
        Ok(format!("<plume.Dataset at {:?}: {caves} caves, {failed} left out>", self.path.display()))
    }
}

/// Makes a dataset: many caves from one specification.
///
/// The same specification and version of Plume give the same bytes, for any number of workers. Ctrl-C raises KeyboardInterrupt, if
/// this is the main thread; the same call then resumes where it stopped. Caves are made by processes of this interpreter
/// (`sys.executable`).
///
/// Args:
///     spec: The path of the specification (TOML); docs/datasets.md tells its keys.
///     folder: The folder to write; by default the name of the dataset.
///     workers: Number of processes; one per core by default.
///     progress: Called from time to time as `progress("caves", done, total)`. An exception that it raises stops the work.
///     allow_run: Allow recipes to run programs, as the generator "external" does.
///     allow_outside: Allow surveys to include files from outside their own folder.
///
/// Raises:
///     RecipeError: The specification, or the recipe of a cave, is faulty.
///     StorageError: The folder contains something else, another run works in it, or the disk fails.
///
/// >>> spec = folder / "pair.toml"
/// >>> _ = spec.write_text('seeds = [1, 2]\nsheet = 0\nset = ["graph.nodes=3", "mesh.voxel_m=0.5", "texture.size_px=256"]')
/// >>> pair = plume.dataset(spec, folder / "pair")
/// >>> [(cave["seed"], cave["stations"], cave["path"]) for cave in pair.caves]
/// [(1, 3, 'items/000000'), (2, 3, 'items/000001')]
/// >>> plume.open(pair.path / pair.caves[0]["path"] / "cave").recipe.seed
/// 1
#[pyfunction]
#[pyo3(signature = (spec, folder=None, *, workers=None, progress=None, allow_run=false, allow_outside=false))]
pub fn dataset(
    py: Python<'_>,
    spec: PathBuf,
    folder: Option<PathBuf>,
    workers: Option<NonZeroUsize>,
    progress: Option<&Bound<'_, PyAny>>,
    allow_run: bool,
    allow_outside: bool,
) -> PyResult<Dataset> {
    let plan = work::briefly(py, || Plan::read(&spec, Disk { allows_outside_files: allow_outside }))?;
    let path = folder.unwrap_or_else(|| PathBuf::from(&plan.spec().name));
    let worker = Worker {
        program: vec![interpreter(py)?.into(), "-m".into(), "plume".into()],
        spec,
        root: path.clone(),
        allows_programs: allow_run,
        allows_outside_files: allow_outside,
    };
    let workers = workers.or_else(|| thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let Outcome { rows, failures, .. } = work::run(py, progress, |watch| {
        watch.allow_programs(allow_run);
        watch.allow_outside_files(allow_outside);
        run(&plan, &worker, workers, watch)
    })?;
    let failed = PyDict::new(py);
    for failure in failures {
        failed.set_item(failure.item, failure.fault)?;
    }
    let rows: Value = rows.into_iter().map(Value::Object).collect();
    Ok(Dataset { path, caves: json::to_python(py, &rows)?.unbind(), failed: failed.unbind() })
}
