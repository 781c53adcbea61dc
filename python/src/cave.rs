//! Finished caves.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use nalgebra::Isometry3;
use numpy::{AllowTypeChange, PyArray1, PyArray3, PyArrayLikeDyn};
use plume::cave::{self, Order};
use plume::pipeline::Observer;
use plume_exporters::place::Existing;
use plume_exporters::place::Place;
use plume_exporters::scene;
use plume_exporters::stage::Library;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};

use crate::chunk::Chunks;
use crate::graph::Graph;
use crate::light::Light;
use crate::package::Package;
use crate::recipe::Recipe;
use crate::usd::UsdCore;
use crate::{array, error, json, work};

/// A finished cave, returned by `generate` and `open`.
///
/// Metres, right-handed, Z up. A context manager that closes itself. A temporary folder is removed when the cave is
/// closed or garbage-collected; other folders stay.
#[pyclass(module = "plume", frozen, weakref)]
pub struct Cave {
    cave: Arc<cave::Cave>,
    placement: OnceLock<Placement>,
    closed: AtomicBool,
    /// Removes the temporary folder when called, when the cave is garbage-collected, or when the interpreter exits.
    finalizer: PyOnceLock<Py<PyAny>>,
}

/// Start poses and lamps, cached because they take a moment to compute.
#[derive(Clone)]
struct Placement {
    spawns: Vec<Isometry3<f64>>,
    lights: Vec<scene::Light>,
}

impl Cave {
    /// The cave; `temporary` is its folder if that is to be removed with it.
    pub fn new(py: Python<'_>, cave: cave::Cave, temporary: Option<PathBuf>) -> PyResult<Bound<'_, Self>> {
        let (placement, finalizer) = (OnceLock::new(), PyOnceLock::new());
        let cave = Bound::new(py, Self { cave: Arc::new(cave), placement, closed: AtomicBool::new(false), finalizer })?;
        if let Some(folder) = temporary {
            let remove = py.import("shutil")?.getattr("rmtree")?;
            let finalizer = py.import("weakref")?.call_method1("finalize", (&cave, remove, folder, true))?;
            let _ = cave.get().finalizer.set(py, finalizer.unbind());
        }
        Ok(cave)
    }

    /// The cave, until it is closed.
    pub fn open(&self, py: Python<'_>) -> PyResult<&Arc<cave::Cave>> {
        if self.closed.load(Ordering::Relaxed) {
            return Err(error::refused(
                py,
                "the cave is closed",
                "use it inside its `with` block, or before `close()`",
            ));
        }
        Ok(&self.cave)
    }

    fn placement(&self, py: Python<'_>) -> PyResult<&Placement> {
        let cave = self.open(py)?;
        if let Some(placement) = self.placement.get() {
            return Ok(placement);
        }
        let placement = work::run(py, None, |watch| {
            let scene_chunks = cave.chunks(watch.stop());
            let scene = cave.scene(&scene_chunks);
            Ok(Placement { spawns: scene.spawns, lights: scene.lights })
        })?;
        Ok(self.placement.get_or_init(|| placement))
    }
}

#[pymethods]
impl Cave {
    /// The recipe it was made from, with every key.
    #[getter]
    fn recipe(&self, py: Python<'_>) -> PyResult<Recipe> {
        Recipe::of_cave(py, self.open(py)?)
    }

    /// The cave folder.
    #[getter]
    fn folder(&self, py: Python<'_>) -> PyResult<PathBuf> {
        Ok(self.open(py)?.root().to_owned())
    }

    /// The graph of the passages.
    #[getter]
    fn graph(&self, py: Python<'_>) -> PyResult<Graph> {
        Graph::new(py, Arc::clone(self.open(py)?))
    }

    /// The chunks, loaded from the folder one at a time.
    #[getter]
    fn chunks(slf: &Bound<'_, Self>) -> PyResult<Chunks> {
        slf.get().open(slf.py())?;
        Ok(Chunks::of(slf.clone().unbind()))
    }

    /// Start poses for robots as a (k, 4, 4) float64 array, m; each maps the robot's frame to the cave's.
    ///
    /// +X points along the passage, +Z up, the origin is on level ground. The first is the most level one. There is at
    /// least one. Computed on first access; the array is a copy.
    ///
    /// >>> cave.spawns[0][3]
    /// array([0., 0., 0., 1.])
    #[getter]
    fn spawns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let spawns = &self.placement(py)?.spawns;
        // nalgebra is column-major, NumPy row-major.
        let flat = spawns.iter().flat_map(|pose| pose.to_homogeneous().transpose().as_slice().to_vec()).collect();
        array::block(py, flat, [spawns.len(), 4, 4])
    }

    /// The lamps along the passages; none if the recipe says `world.lights = false`.
    #[getter]
    fn lights(&self, py: Python<'_>) -> PyResult<Vec<Light>> {
        Ok(self.placement(py)?.lights.iter().map(Light::of).collect())
    }

    /// The stones and dripstone of the cave, as in the `instances.json` of every package.
    ///
    /// Returns:
    ///     One dict per thing: `id`, `class` (such as "boulder"), `prototype`, `chunk`, `position` (m),
    ///     `orientation_wxyz`, `scale`, `mass_kg`, `embedding_m` and `movable`. None if the recipe says `things.cover = 0`.
    ///
    /// Raises:
    ///     StorageError: A file of the cave is missing or was changed.
    ///
    /// >>> all(thing["mass_kg"] > 0 for thing in cave.things)
    /// True
    #[getter]
    fn things<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let cave = self.open(py)?;
        let things = work::run(py, None, |watch| {
            let chunks = cave.chunks(watch.stop());
            Ok(plume_exporters::instances::list(&cave.scene(&chunks))?)
        })?;
        json::to_python(py, &things.into())
    }

    /// Approximate signed distance to the wall, sampled from the field that the walls are made from.
    ///
    /// Negative in air, zero on the wall, positive in rock, so its sign tells free space. It is a distance only near the
    /// wall, and only roughly: up to half a metre away mostly between half and twice the true distance; deeper in the
    /// rock it levels off at about 1 m. The triangles omit detail finer than a voxel or `mesh.simplify_error_m`, so keep
    /// a margin. A million points take about a second; one call with many points is faster than many calls.
    ///
    /// Args:
    ///     points: Finite points in the cave's frame as an (n, 3) array, m; taken as float32.
    ///
    /// Returns:
    ///     (n,) float32, m.
    ///
    /// Raises:
    ///     InputError: `points` has another shape, or a coordinate is not finite.
    ///
    /// >>> above, below = cave.spawns[0][:3, 3] + [[0, 0, 0.5], [0, 0, -0.5]]
    /// >>> cave.distance([above, below]) < 0
    /// array([ True, False])
    fn distance<'py>(
        &self,
        py: Python<'py>,
        points: PyArrayLikeDyn<'py, f32, AllowTypeChange>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let (cave, points) = (self.open(py)?, array::points(&points)?);
        let distances = work::briefly(py, || Ok(cave.distances(&points)))?;
        Ok(PyArray1::from_vec(py, distances))
    }

    /// Writes the cave as a package for a simulator, as `plume export` does: same cave, same bytes.
    ///
    /// Ctrl-C raises KeyboardInterrupt once the current chunk is done, if this is the main thread. The package appears
    /// whole or not at all.
    ///
    /// Args:
    ///     target: Name of the target; `plume.targets()` lists them.
    ///     path: The folder or file to write.
    ///     bundle: Write the package as a single file: "zip", "tar.zst", or another kind that the target supports, such as
    ///         "mjz". The extension is added to `path` if it is missing.
    ///     force: Replace an existing package.
    ///     options: Options of the target, such as `lights=False`.
    ///
    /// Raises:
    ///     InputError: There is no such target or bundle.
    ///     RecipeError: An option is faulty.
    ///     MissingPartError: A library that the target needs is missing.
    ///     StorageError: Something else is at `path`, or the disk fails.
    ///
    /// >>> package = cave.export("gltf", folder / "package")
    /// >>> package.target, package.visual_triangles > 0
    /// ('gltf', True)
    /// >>> cave.export("gazebo", folder / "packed", bundle="zip").path.name
    /// 'packed.zip'
    #[pyo3(signature = (target, path, *, bundle=None, force=false, **options))]
    fn export(
        &self,
        py: Python<'_>,
        target: &str,
        path: PathBuf,
        bundle: Option<&str>,
        force: bool,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Package> {
        let cave = self.open(py)?;
        let row = target.split(':').next().unwrap_or(target);
        let options = match options {
            Some(options) => json::pairs(row, &json::from_python(options.as_mapping())?),
            None => Vec::new(),
        };
        let existing = if force { Existing::Replace } else { Existing::Keep };
        let library: Arc<dyn Library> = Arc::new(UsdCore::default());
        work::run(py, None, |watch| {
            let choice = cave::target(target)?;
            let bundle = bundle.map(|name| cave::bundle(name, std::slice::from_ref(&choice))).transpose()?;
            let path = bundle.map_or(path.clone(), |bundle| bundle.file(&path));
            let wanted = cave::build(vec![choice], &[], &options, Some(&library))?.remove(0);
            let name = wanted.choice.name();
            if wanted.target.wants_pieces() {
                cave.make_pieces(watch, &mut |_, _| ())?;
            }
            let chunks = cave.chunks(watch.stop());
            let order = Order { wanted, place: Place { path: path.clone(), bundle, existing } };
            let (summary, files) = order.write(&cave.scene(&chunks))?;
            Ok(Package::new(&name, path, &summary, &files))
        })
    }

    /// Closes the cave, and removes its folder if it is temporary. Closing twice does no harm.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.closed.store(true, Ordering::Relaxed);
        self.finalizer.get(py).map_or(Ok(()), |finalizer| finalizer.call0(py).map(drop))
    }

    fn __enter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    #[pyo3(signature = (*exception))]
    fn __exit__(&self, py: Python<'_>, exception: &Bound<'_, PyTuple>) -> PyResult<()> {
        let _ = exception;
        self.close(py)
    }

    fn __repr__(&self) -> String {
        let state = if self.closed.load(Ordering::Relaxed) { ", closed" } else { "" };
        let (name, chunks) = (self.cave.recipe().name(), self.cave.chunk_names().count());
        format!("<plume.Cave {name:?}: {} stations, {chunks} chunks{state}>", self.cave.graph().nodes.len())
    }
}
