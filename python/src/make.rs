//! `plume.generate` and `plume.open`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use plume::cave::{self, Input};
use plume::pipeline::Disk;
use plume::store::CaveFolder;
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use tempfile::TempDir;

use crate::cave::Cave;
use crate::recipe::{Recipe, seed_pairs};
use crate::work;

/// Makes a cave: graph, triangles and images.
///
/// The same recipe, seed and version of Plume give the same bytes, on any machine and for any number of threads. Other
/// Python threads run meanwhile. Ctrl-C raises KeyboardInterrupt when the chunks in work are done, if this is the main
/// thread; the same call with the same `folder` then goes on where it stopped.
///
/// Args:
///     recipe: A Recipe, a mapping as Recipe takes it, or a path: of a recipe (TOML), a graph (JSON, also that of the
///         original PLUME) or a cave folder. None is the default cave.
///     seed: Wins over the seed of the recipe.
///     folder: The cave folder to make. Left out, it is the cave folder that `recipe` names, else a temporary one, which
///         goes when the Cave is closed or collected.
///     force: Replace another cave in the folder.
///     threads: How many threads work; left out, one per core.
///     progress: Called now and then as `progress(stage, done, total)`, where `stage` is "graph", "preview",
///         "mesh" or "texture" and the numbers count chunks, but 1 for the whole cave in the first two. What it raises
///         stops the work.
///     allow_run: Let the recipe run a program, as the generator "external" does.
///     allow_outside: Let surveys include files that do not lie below their own folder.
///
/// Raises:
///     RecipeError: The recipe has faults.
///     InputError: There can be no such cave.
///     StorageError: The folder holds something else, or the disk refuses.
///
/// >>> seen = []
/// >>> tiny = {"graph": {"nodes": 3}, "mesh": {"voxel_m": 0.5}, "texture": {"size_px": 256}}
/// >>> with plume.generate(tiny, seed=7, progress=lambda *now: seen.append(now)) as cave:
/// ...     len(cave.graph.positions), cave.chunks[0].positions.dtype, seen[-1][0]
/// (3, dtype('float32'), 'texture')
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
#[pyfunction]
#[pyo3(signature = (recipe=None, seed=None, *, folder=None, force=false, threads=None, progress=None, allow_run=false, allow_outside=false))]
pub fn generate<'py>(
    py: Python<'py>,
    recipe: Option<&Bound<'py, PyAny>>,
    seed: Option<i128>,
    folder: Option<PathBuf>,
    force: bool,
    threads: Option<NonZeroUsize>,
    progress: Option<&Bound<'py, PyAny>>,
    allow_run: bool,
    allow_outside: bool,
) -> PyResult<Bound<'py, Cave>> {
    let input = input(py, recipe, seed, Disk { allows_strays: allow_outside })?;
    let (path, temporary) = match folder.or_else(|| input.folder.clone()) {
        Some(path) => (path, None),
        None => temporary()?,
    };
    let cave = work::run(py, progress, |watch| {
        let folder = CaveFolder::open_or_new(&path)?;
        watch.allow_programs(allow_run);
        watch.allow_strays(allow_outside);
        work::on_threads(threads, || cave::Cave::make(input, folder, force, watch, &mut |_, _| ()))
    })?;
    Cave::new(py, cave, temporary.map(TempDir::keep))
}

/// Opens a finished cave folder. Nothing in it is changed.
///
/// Raises:
///     InputError: There is no cave, or it is not finished; `generate(folder)` finishes it.
///     StorageError: It cannot be read.
///
/// >>> plume.open(cave.folder).recipe == cave.recipe
/// True
#[pyfunction]
#[pyo3(signature = (folder))]
pub fn open(py: Python<'_>, folder: PathBuf) -> PyResult<Bound<'_, Cave>> {
    let cave = work::run(py, None, |watch| cave::Cave::open(&folder, watch))?;
    Cave::new(py, cave, None)
}

fn input(py: Python<'_>, recipe: Option<&Bound<'_, PyAny>>, seed: Option<i128>, disk: Disk) -> PyResult<Input> {
    let seed_pairs = seed_pairs(seed);
    let Some(recipe) = recipe else {
        return work::briefly(py, || Input::read(None, &seed_pairs, disk));
    };
    if let Ok(recipe) = recipe.cast::<Recipe>() {
        return Ok(Input::of(recipe.get().resolve(py, &seed_pairs)?));
    }
    if let Ok(settings) = recipe.cast::<PyMapping>() {
        let recipe = Recipe::of_settings(py, Some(settings), seed)?;
        return Ok(Input::of(recipe.resolve(py, &[])?));
    }
    let path: PathBuf = recipe.extract()?;
    work::briefly(py, || Input::read(Some(&path), &seed_pairs, disk))
}

fn temporary() -> PyResult<(PathBuf, Option<TempDir>)> {
    let folder = tempfile::Builder::new().prefix("plume-").tempdir()?;
    Ok((folder.path().to_owned(), Some(folder)))
}
