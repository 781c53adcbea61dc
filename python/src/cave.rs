//! Finished caves.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use nalgebra::Isometry3;
use numpy::{AllowTypeChange, PyArray1, PyArray2, PyArray3, PyArrayLikeDyn};
use plume::cave::{self, Journey, Order, Surface};
use plume::pipeline::Observer;
use plume::trajectory::{Ride, Stamp, Trajectory};
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
    /// Read when it is first asked for.
    surface: OnceLock<Surface>,
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
        let (placement, surface, finalizer) = (OnceLock::new(), OnceLock::new(), PyOnceLock::new());
        let cave = Bound::new(
            py,
            Self { cave: Arc::new(cave), placement, surface, closed: AtomicBool::new(false), finalizer },
        )?;
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

    fn surface(&self, py: Python<'_>) -> PyResult<&Surface> {
        let cave = self.open(py)?;
        if let Some(surface) = self.surface.get() {
            return Ok(surface);
        }
        let surface = work::run(py, None, |watch| {
            let chunks = cave.chunks(watch.stop());
            Surface::of(&cave.scene(&chunks))
        })?;
        Ok(self.surface.get_or_init(|| surface))
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

    /// Euclidean signed distance to the triangles that simulators get: walls and things, without gravel.
    ///
    /// Negative in air, positive in rock and in things. Exact but for rounding to float32. The first call reads all chunks, which
    /// takes about a second for each 100 m of passage, and keeps their triangles; then 100,000 points take about a second.
    ///
    /// Args:
    ///     points: Finite points in the cave's frame as an (n, 3) array, m; taken as float32.
    ///
    /// Returns:
    ///     (n,) float32, m.
    ///
    /// Raises:
    ///     InputError: `points` has another shape, or a coordinate is not finite.
    ///     StorageError: A file of the cave is missing or was changed.
    ///
    /// >>> above, below = cave.spawns[0][:3, 3] + [[0, 0, 0.5], [0, 0, -0.5]]
    /// >>> cave.distance([above, below]) < 0
    /// array([ True, False])
    fn distance<'py>(
        &self,
        py: Python<'py>,
        points: PyArrayLikeDyn<'py, f32, AllowTypeChange>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let (surface, points) = (self.surface(py)?, array::points(&points)?);
        let distances = work::briefly(py, || Ok(surface.distances(&points)))?;
        Ok(PyArray1::from_vec(py, distances))
    }

    /// The field that the walls are made from: negative in air, zero on the wall, positive in rock.
    ///
    /// Its sign tells free space without things. It is a distance only near the wall, and only roughly: up to half a metre
    /// away mostly between half and twice the true distance; deeper in the rock it levels off at about 1 m. The triangles omit
    /// detail finer than a voxel or `mesh.simplify_error_m`. A million points take about a second; one call with many points is
    /// faster than many calls.
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
    /// >>> cave.field([above, below]) < 0
    /// array([ True, False])
    fn field<'py>(
        &self,
        py: Python<'py>,
        points: PyArrayLikeDyn<'py, f32, AllowTypeChange>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let (cave, points) = (self.open(py)?, array::points(&points)?);
        let values = work::briefly(py, || Ok(cave.field(&points)))?;
        Ok(PyArray1::from_vec(py, values))
    }

    /// Where a robot gets from the first start pose, and what stops it, as `plume certify` tells.
    ///
    /// Args:
    ///     robot: One of `plume list robots`, or a TOML file.
    ///
    /// Returns:
    ///     The certificate as a dict: `robot`, `floor`, a list of `stations` and of `passages` each way ("go", "marginal",
    ///     "no-go"), what stops the robot and where, and the `route` to the furthest station. Metres and degrees.
    ///
    /// Raises:
    ///     InputError: There is no such robot.
    ///     StorageError: A file of the cave is missing or was changed.
    ///
    /// >>> cave.certify("rover")["passages"][0]["there"]["class"]
    /// 'go'
    #[pyo3(signature = (robot="husky"))]
    fn certify<'py>(&self, py: Python<'py>, robot: &str) -> PyResult<Bound<'py, PyAny>> {
        let cave = self.open(py)?;
        let certificate = work::run(py, None, |watch| {
            let robot = cave::named_robot(robot)?;
            let chunks = cave.chunks(watch.stop());
            Ok(cave.certify(&cave.scene(&chunks), &robot)?.json())
        })?;
        json::to_python(py, &certificate)
    }

    /// A path for a robot, as `plume path` finds it: through the middle, smoothed, and held against the floor in every pose.
    ///
    /// Args:
    ///     kind: "longest" (to the furthest station), "loop", "tour" (through all passages and back), or "A..B" between two
    ///         stations of the graph.
    ///     robot: One of `plume list robots`, or a TOML file.
    ///     height: Height over the floor of a level body, such as a camera, m; None for the robot on its wheels.
    ///     speed: m/s.
    ///
    /// Returns:
    ///     (n, 8) float64: time in s, x, y, z in m, and the orientation as qx, qy, qz, qw; a row of a TUM file each.
    ///
    /// Raises:
    ///     InputError: There is no such robot, kind or station, or the robot does not get there.
    ///     StorageError: A file of the cave is missing or was changed.
    ///
    /// >>> cave.route("longest", robot="rover").shape[1]
    /// 8
    #[pyo3(signature = (kind="longest", *, robot="husky", height=None, speed=0.5))]
    fn route<'py>(
        &self,
        py: Python<'py>,
        kind: &str,
        robot: &str,
        height: Option<f64>,
        speed: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let cave = self.open(py)?;
        if !(speed > 0.0 && speed.is_finite() && height.is_none_or(f64::is_finite)) {
            return Err(error::refused(py, "`speed` or `height` is out of range", "give a speed above 0, in m/s"));
        }
        let trajectory = work::run(py, None, |watch| {
            let (journey, robot) = (kind.parse::<Journey>()?, cave::named_robot(robot)?);
            let chunks = cave.chunks(watch.stop());
            let route = cave.route(&cave.scene(&chunks), &robot, journey)?;
            Ok(Trajectory::of(&route, height.map_or(Ride::OnWheels, Ride::Level), speed))
        })?;
        array::rows(py, trajectory.stamps.iter().map(Stamp::row).collect())
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
            cave::refuse_unfit_images(&[choice.row], cave.recipe())?;
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

    /// Writes the ground truth of the cave: the same as `export("truth", path, ...)`.
    ///
    /// >>> cave.truth(folder / "truth", cell_m=0.1).target
    /// 'truth'
    #[pyo3(signature = (path, *, bundle=None, force=false, **options))]
    fn truth(
        &self,
        py: Python<'_>,
        path: PathBuf,
        bundle: Option<&str>,
        force: bool,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Package> {
        self.export(py, "truth", path, bundle, force, options)
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
