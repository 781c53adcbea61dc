//! `plume.dataset`.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;

use plume::cave::CaveError;
use plume::pipeline::Disk;
use plume_cli::RayTasks;
use plume_dataset::local::{Processes, Worker};
use plume_dataset::{Engine, Outcome, Plan, is_final, item, run};
use plume_exporters::stage::Library;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;

use crate::ray::Ray;
use crate::usd::UsdCore;
use crate::{error, interpreter, json, work};

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
/// The same specification and version of Plume give the same bytes, for any number of workers and any engine. Ctrl-C raises
/// KeyboardInterrupt, if this is the main thread; the same call then resumes where it stopped.
///
/// Args:
///     spec: The path of the specification (TOML); docs/datasets.md lists its keys.
///     folder: The folder to write; by default the name of the dataset.
///     engine: Who makes the caves: "processes" of this interpreter (`sys.executable`), or tasks of a cluster, "ray"; see plume.ray.
///     address: The cluster of the engine "ray", as `ray.init` takes it.
///     workers: Number of processes; one per core by default. A cluster has its own.
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
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
#[pyfunction]
#[pyo3(signature = (spec, folder=None, *, engine="processes", address=None, workers=None, progress=None, allow_run=false, allow_outside=false))]
pub fn dataset(
    py: Python<'_>,
    spec: PathBuf,
    folder: Option<PathBuf>,
    engine: &str,
    address: Option<String>,
    workers: Option<NonZeroUsize>,
    progress: Option<&Bound<'_, PyAny>>,
    allow_run: bool,
    allow_outside: bool,
) -> PyResult<Dataset> {
    let plan = work::briefly(py, || Plan::read(&spec, Disk { allows_outside_files: allow_outside }))?;
    let path = folder.unwrap_or_else(|| PathBuf::from(&plan.spec().name));
    let engine: Box<dyn Engine> = match engine {
        "processes" => {
            let program = vec![interpreter(py)?.into(), "-m".into(), "plume".into()];
            let worker = Worker { program, spec, allows_programs: allow_run, allows_outside_files: allow_outside };
            let count = workers.or_else(|| thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
            Box::new(Processes { worker, count })
        }
        "ray" => {
            let (allows_programs, allows_outside_files) = (allow_run, allow_outside);
            Box::new(Ray(RayTasks { spec, address, allows_programs, allows_outside_files }))
        }
        other => {
            let unknown = CaveError::unknown("engine", other, ["processes", "ray"].into_iter());
            return Err(error::raised(py, &unknown));
        }
    };
    let Outcome { rows, failures, .. } = work::run(py, progress, |watch| {
        watch.allow_programs(allow_run);
        watch.allow_outside_files(allow_outside);
        run(&plan, &path, &*engine, watch)
    })?;
    let failed = PyDict::new(py);
    for failure in failures {
        failed.set_item(failure.item, failure.fault)?;
    }
    let rows: Value = rows.into_iter().map(Value::Object).collect();
    Ok(Dataset { path, caves: json::to_python(py, &rows)?.unbind(), failed: failed.unbind() })
}

/// Makes a cave of a dataset in `folder / path`; for tasks of a cluster.
///
/// Args:
///     spec: The path of the specification.
///     number: The number of the cave.
///     folder: A folder for caves of this dataset.
///     fingerprint: That of the run, so that another version of Plume, or other files, are refused.
///     allow_run: Allow recipes to run programs.
///     allow_outside: Allow surveys to include files from outside their own folder.
///
/// Returns:
///     The path of the cave below the folder, and why it could not be made, if it could not.
///
/// Raises:
///     PlumeError: No other cave can be made either.
#[pyfunction]
#[pyo3(signature = (spec, number, folder, *, fingerprint, allow_run, allow_outside))]
pub fn make_item(
    py: Python<'_>,
    spec: PathBuf,
    number: usize,
    folder: PathBuf,
    fingerprint: &str,
    allow_run: bool,
    allow_outside: bool,
) -> PyResult<(String, Option<String>)> {
    let fault = work::run(py, None, |watch| {
        watch.allow_programs(allow_run);
        watch.allow_outside_files(allow_outside);
        let plan = Plan::read(&spec, Disk { allows_outside_files: allow_outside })?;
        if plan.fingerprint() != fingerprint {
            return Err(CaveError::Usage {
                message: format!("{}: is not as it was, or plume is of another version", spec.display()),
                hint: "let all machines see the same files, and install the same version on them".into(),
            });
        }
        let library: Arc<dyn Library> = Arc::new(UsdCore::default());
        match work::on_threads(NonZeroUsize::new(1), || item::make(&plan, number, &folder, Some(&library), watch)) {
            Err(error) if !is_final(&error) => Ok(Some(error.to_string())),
            made => made.map(|()| None),
        }
    })?;
    Ok((item::path(number), fault))
}
