//! `plume.generate` and `plume.open`.

use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::{Path, PathBuf};

use plume::cave::{self, CaveError, Input};
use plume::pipeline::Disk;
use plume::store::CaveFolder;
use pyo3::prelude::*;
use pyo3::types::{PyMapping, PyRange, PyRangeMethods};
use tempfile::TempDir;

use crate::cave::Cave;
use crate::recipe::{Recipe, seed_pairs};
use crate::{error, work};

/// Makes a cave: graph, meshes and textures.
///
/// The same recipe, seed and version of Plume give the same bytes, on any machine and for any number of threads. Other
/// Python threads keep running. Ctrl-C raises KeyboardInterrupt once the current chunks are done, if this is the main
/// thread; the same call with the same `folder` then resumes where it stopped.
///
/// Args:
///     recipe: A Recipe, a mapping as Recipe takes it, or the path of a recipe (TOML), a graph (JSON, also of the
///         original PLUME) or a cave folder. None is the default cave.
///     seed: Takes precedence over the seed of the recipe.
///     folder: The cave folder to write. By default the cave folder named by `recipe`, otherwise a temporary one, which
///         is removed when the Cave is closed or garbage-collected.
///     force: Replace another cave in the folder.
///     parts: Cave folders made by `make_chunks` for the same recipe, whose chunks are taken.
///     threads: Number of threads; one per core by default.
///     progress: Called from time to time as `progress(stage, done, total)`, where `stage` is "graph", "preview",
///         "mesh" or "texture" and the numbers count chunks, except that the first two stages count as 1. An
///         exception that it raises stops the work.
///     allow_run: Allow the recipe to run a program, as the generator "external" does.
///     allow_outside: Allow surveys to include files from outside their own folder.
///
/// Raises:
///     RecipeError: The recipe is faulty.
///     InputError: Such a cave is impossible.
///     MissingFileError: There is no file of this name.
///     StorageError: The folder contains something else, or the disk fails.
///
/// >>> seen = []
/// >>> tiny = {"graph": {"nodes": 3}, "mesh": {"voxel_m": 0.5}, "texture": {"size_px": 256}}
/// >>> with plume.generate(tiny, seed=7, progress=lambda *now: seen.append(now)) as cave:
/// ...     len(cave.graph.positions), cave.chunks[0].positions.dtype, seen[-1][0]
/// (3, dtype('float32'), 'texture')
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
#[pyfunction]
#[pyo3(signature = (recipe=None, seed=None, *, folder=None, force=false, parts=None, threads=None, progress=None, allow_run=false, allow_outside=false))]
pub fn generate<'py>(
    py: Python<'py>,
    recipe: Option<&Bound<'py, PyAny>>,
    seed: Option<i128>,
    folder: Option<PathBuf>,
    force: bool,
    parts: Option<Vec<PathBuf>>,
    threads: Option<NonZeroUsize>,
    progress: Option<&Bound<'py, PyAny>>,
    allow_run: bool,
    allow_outside: bool,
) -> PyResult<Bound<'py, Cave>> {
    let input = input(py, recipe, seed, Disk { allows_outside_files: allow_outside })?;
    let (path, temporary) = match folder.or_else(|| input.folder.clone()) {
        Some(path) => (path, None),
        None => temporary()?,
    };
    let cave = work::run(py, progress, |watch| {
        let folder = cave::with_parts(CaveFolder::open_or_new(&path)?, &parts.unwrap_or_default())?;
        watch.allow_programs(allow_run);
        watch.allow_outside_files(allow_outside);
        work::on_threads(threads, || cave::Cave::make(input, folder, force, watch, &mut |_, _| ()))
    })?;
    Cave::new(py, cave, temporary.map(TempDir::keep))
}

/// The numbers of chunks along x, y and z in the grid of a cave, for `make_chunks`. Most chunks have no wall.
///
/// Args:
///     recipe: As for `generate`.
///     seed: Takes precedence over the seed of the recipe.
///     allow_run: Allow the recipe to run a program, as the generator "external" does.
///     allow_outside: Allow surveys to include files from outside their own folder.
///
/// >>> plume.chunk_grid({"graph": {"nodes": 3}}, seed=7)
/// (1, 1, 1)
#[pyfunction]
#[pyo3(signature = (recipe=None, seed=None, *, allow_run=false, allow_outside=false))]
pub fn chunk_grid(
    py: Python<'_>,
    recipe: Option<&Bound<'_, PyAny>>,
    seed: Option<i128>,
    allow_run: bool,
    allow_outside: bool,
) -> PyResult<(i32, i32, i32)> {
    let input = input(py, recipe, seed, Disk { allows_outside_files: allow_outside })?;
    let grid = work::run(py, None, |watch| {
        watch.allow_programs(allow_run);
        watch.allow_outside_files(allow_outside);
        cave::chunk_grid(&input, watch)
    })?;
    Ok(grid.into())
}

/// Makes some chunks of a cave, so that many machines can share a large one; `generate(parts=…)` puts them together. See also
/// plume.ray.
///
/// A chunk follows from the recipe and its number, and is the same wherever it is made. Its things and convex pieces also follow
/// from the walls of its neighbours, which are meshed too unless one of the `parts` has them.
///
/// Args:
///     recipe: As for `generate`.
///     numbers: A range of numbers, in the order of the grid: x fastest, z slowest.
///     folder: The cave folder to write.
///     seed: Takes precedence over the seed of the recipe.
///     stages: What to make of the chunks: "mesh", "things", "texture", "pieces".
///     parts: Cave folders for the same recipe, from which finished chunks are taken.
///     threads: Number of threads; one per core by default.
///     progress: As for `generate`.
///     allow_run: Allow the recipe to run a program, as the generator "external" does.
///     allow_outside: Allow surveys to include files from outside their own folder.
///
/// Returns:
///     The names of the chunks that have a wall.
///
/// >>> tiny = {"graph": {"nodes": 3}, "mesh": {"voxel_m": 0.5}, "texture": {"size_px": 256}}
/// >>> plume.make_chunks(tiny, range(0, 1), folder / "part", seed=7)
/// ['chunk_0_0_0']
/// >>> with plume.generate(tiny, seed=7, parts=[folder / "part"]) as cave:
/// ...     len(cave.chunks)
/// 1
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
#[pyfunction]
#[pyo3(signature = (recipe, numbers, folder, *, seed=None, stages=None, parts=None, threads=None, progress=None, allow_run=false, allow_outside=false))]
pub fn make_chunks(
    py: Python<'_>,
    recipe: Option<&Bound<'_, PyAny>>,
    numbers: &Bound<'_, PyRange>,
    folder: PathBuf,
    seed: Option<i128>,
    stages: Option<Vec<String>>,
    parts: Option<Vec<PathBuf>>,
    threads: Option<NonZeroUsize>,
    progress: Option<&Bound<'_, PyAny>>,
    allow_run: bool,
    allow_outside: bool,
) -> PyResult<Vec<String>> {
    let input = input(py, recipe, seed, Disk { allows_outside_files: allow_outside })?;
    let numbers = whole_range(py, numbers)?;
    let walls = work::run(py, progress, |watch| {
        watch.allow_programs(allow_run);
        watch.allow_outside_files(allow_outside);
        let stages = match &stages {
            Some(names) => names.iter().map(|name| cave::chunk_stage(name)).collect::<Result<BTreeSet<_>, _>>()?,
            None => BTreeSet::from(cave::CHUNK_STAGES),
        };
        let folder = cave::with_parts(CaveFolder::open_or_new(&folder)?, &parts.unwrap_or_default())?;
        let make = || Ok(cave::make_part(&input, &folder, numbers, &stages, false, watch)?);
        work::on_threads(threads, make)
    })?;
    Ok(walls.into_iter().map(|wall| wall.name).collect())
}

fn whole_range(py: Python<'_>, numbers: &Bound<'_, PyRange>) -> PyResult<Range<usize>> {
    let (start, stop, step) = (numbers.start()?, numbers.stop()?, numbers.step()?);
    match (usize::try_from(start), usize::try_from(stop), step) {
        (Ok(start), Ok(stop), 1) => Ok(start..stop.max(start)),
        _ => Err(error::refused(py, "the range of chunks must go up by one, from 0 or more", "")),
    }
}

/// Opens a finished cave folder without changing it.
///
/// Raises:
///     MissingFileError: There is no folder of this name.
///     InputError: There is no cave in it, or it is not finished; `generate(folder)` finishes it.
///     StorageError: It cannot be read.
///
/// >>> plume.open(cave.folder).recipe == cave.recipe
/// True
#[pyfunction]
#[pyo3(signature = (folder))]
pub fn open(py: Python<'_>, folder: PathBuf) -> PyResult<Bound<'_, Cave>> {
    let cave = work::run(py, None, |watch| {
        found(&folder)?;
        cave::Cave::open(&folder, watch)
    })?;
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
    work::briefly(py, || {
        found(&path)?;
        Input::read(Some(&path), &seed_pairs, disk)
    })
}

/// Makes sure that something is at `path`, before its name tells what kind of file to expect.
fn found(path: &Path) -> Result<(), CaveError> {
    path.metadata().map(drop).map_err(|source| CaveError::Input { path: path.to_owned(), source })
}

fn temporary() -> PyResult<(PathBuf, Option<TempDir>)> {
    let folder = tempfile::Builder::new().prefix("plume-").tempdir()?;
    Ok((folder.path().to_owned(), Some(folder)))
}
