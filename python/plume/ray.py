"""Datasets and large caves on a Ray cluster.

    import plume.ray

    drive = plume.ray.dataset("samples/datasets/drive.toml", "drive", address="auto")
    cave = plume.ray.generate("large.toml", folder="large", address="auto")

Ray schedules the tasks, repeats those whose worker died, and carries what they made, so that no shared file system is needed. All
machines need the same version of Plume. The bytes are those that one process makes.

If `ray.init` was called, that cluster is used; otherwise the one at `address`; without either, one of this machine alone, which is
stopped at the end. Needs Ray: `pip install plume-caves[ray]`.
"""

import io
import itertools
import logging
import shutil
import sys
import tarfile
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import plume
from plume import _plume
from plume.errors import MissingPartError, PlumeError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

__all__ = ["dataset", "generate"]

ATTEMPTS = 3
"""How often a task is run if workers die of it; as with processes."""
POLL_S = 0.05
"""How long work that was stopped goes on."""
PARTIAL = "partial"
"""The part that is being unpacked."""
TASKS_PER_CPU = 2
"""Tasks that are submitted before others are done: enough to keep all workers busy."""
MOST_CHUNKS_PER_TASK = 64
"""Chunks of the grid, most of which have no wall; a task should take minutes at most."""

Progress = Callable[[str, int, int], object]


def dataset(
    spec: str | PathLike[str],
    folder: str | PathLike[str] | None = None,
    *,
    address: str | None = None,
    progress: Progress | None = None,
    allow_run: bool = False,
    allow_outside: bool = False,
) -> plume.Dataset:
    """Makes a dataset with a task for each cave: `plume.dataset(engine="ray")`.

    The specification and the recipes that it names travel with the tasks. Files that those recipes name in turn, such as surveys and
    models, must have the same path on all machines. The packages of a cave pass through memory, at most two per core at a time.
    """
    return plume.dataset(
        spec,
        folder,
        engine="ray",
        address=address,
        progress=progress,
        allow_run=allow_run,
        allow_outside=allow_outside,
    )


def generate(
    recipe: Any = None,
    seed: int | None = None,
    *,
    folder: str | PathLike[str],
    address: str | None = None,
    pieces: bool = False,
    chunks_per_task: int | None = None,
    progress: Progress | None = None,
    allow_run: bool = False,
    allow_outside: bool = False,
) -> plume.Cave:
    """Makes a large cave with a task for each range of chunks.

    The graph and the shapes of things are made here; first the walls of all chunks by tasks, then their things and textures, which
    also follow from the walls of neighbours. What tasks made is kept beside `folder`, in a folder whose name ends in "-parts", until
    the cave is finished, so that the same call resumes after an interruption.

    Args:
        recipe: As for `plume.generate`.
        seed: Takes precedence over the seed of the recipe.
        folder: The cave folder to write.
        address: The cluster, as `ray.init` takes it.
        pieces: Also make the convex pieces that some targets need.
        chunks_per_task: Chunks of the grid per task; by default about eight tasks per core.
        progress: Called as `progress(stage, done, total)`, where the numbers count chunks of the grid for the stages "mesh" and
            "texture", and later as by `plume.generate`.
        allow_run: Allow the recipe to run a program.
        allow_outside: Allow surveys to include files from outside their own folder.
    """
    folder = Path(folder)
    home = folder.with_name(folder.name + "-parts")
    base = _base(home, recipe, seed, allow_run, allow_outside)
    grid = plume.chunk_grid(base)
    with _cluster(address) as ray:
        count = grid[0] * grid[1] * grid[2]
        size = chunks_per_task or _chunks_per_task(count, _cpus(ray))
        ranges = [range(first, min(first + size, count)) for first in range(0, count, size)]
        packed_base, make_chunks = ray.put(_packed(base)), _remote(ray, _make_chunks)

        walls: dict[int, Any] = {}

        def mesh(task: int) -> Any:
            return make_chunks.remote(packed_base, ranges[task], ["mesh"])

        for task, reference in _made(ray, home, "mesh", ranges, range(len(ranges)), mesh, progress):
            walls[task] = reference

        stages = ["things", "texture", *(["pieces"] if pieces else [])]
        with_wall = [task for task in walls if any((home / _name("mesh", ranges[task]) / "chunks").glob("*"))]

        def finish(task: int) -> Any:
            around = [walls[other] for other in sorted(_around(ranges[task], grid, size))]
            return make_chunks.remote(packed_base, ranges[task], stages, *around)

        for _ in _made(ray, home, "texture", ranges, with_wall, finish, progress):
            pass
    cave = plume.generate(base, folder=folder, parts=[base, *_parts(home)], progress=progress)
    for own in [base, home / PARTIAL, *_parts(home)]:
        shutil.rmtree(own, ignore_errors=True)
    if not any(home.iterdir()):
        home.rmdir()
    return cave


def _base(home: Path, recipe: Any, seed: int | None, allow_run: bool, allow_outside: bool) -> Path:
    """A cave folder with the graph and the shapes of things. Removes the parts of another cave."""
    base, new = home / "base", home / "base.new"
    shutil.rmtree(new, ignore_errors=True)
    plume.make_chunks(
        recipe, range(0), new, seed=seed, stages=["things"], allow_run=allow_run, allow_outside=allow_outside
    )
    kept = base / "graph.json"
    if kept.is_file() and kept.read_bytes() == (new / "graph.json").read_bytes():
        shutil.rmtree(new)
        return base
    for other in [base, *_parts(home)]:
        shutil.rmtree(other, ignore_errors=True)
    return new.rename(base)


def _parts(home: Path) -> list[Path]:
    """What tasks have made; whatever else is there is the user's."""
    return [part for stage in ("mesh", "texture") for part in sorted(home.glob(f"{stage}-*-*"))]


def _made(
    ray: Any,
    home: Path,
    stage: str,
    ranges: list[range],
    tasks: Iterable[int],
    start: Callable[[int], Any],
    progress: Progress | None,
) -> Iterator[tuple[int, Any]]:
    """Tasks with references to the packed chunks that they made, which are also unpacked below `home`."""
    missing = []
    done, total = 0, sum(len(ranges[task]) for task in tasks)

    def advance(task: int) -> None:
        nonlocal done
        done += len(ranges[task])
        if progress:
            progress(stage, done, total)

    for task in tasks:
        place = home / _name(stage, ranges[task])
        if place.is_dir():
            advance(task)
            yield task, ray.put(_packed(place))
        else:
            missing.append(task)
    for completed in _as_completed(ray, missing, start):
        if completed is None:
            continue
        task, reference = completed
        place = home / _name(stage, ranges[task])
        partial = home / PARTIAL
        shutil.rmtree(partial, ignore_errors=True)
        try:
            packed = _result(ray, reference)
        except ray.exceptions.RayError as error:
            hint = "lower chunks_per_task, or give the machines more memory"
            raise PlumeError(f"{stage} of chunks {place.name}: {_deaths(error)}", hint) from None
        _unpack(packed, partial)
        partial.rename(place)
        advance(task)
        yield task, reference


def _name(stage: str, numbers: range) -> str:
    return f"{stage}-{numbers.start}-{numbers.stop - 1}"


def _around(numbers: range, grid: tuple[int, int, int], size: int) -> set[int]:
    """The tasks of these chunks and of all that touch them."""
    nx, ny, nz = grid
    tasks = set()
    for number in numbers:
        x, y, z = number % nx, number // nx % ny, number // (nx * ny)
        for dx, dy, dz in itertools.product((-1, 0, 1), repeat=3):
            if 0 <= x + dx < nx and 0 <= y + dy < ny and 0 <= z + dz < nz:
                tasks.add(((z + dz) * ny + y + dy) * nx + x + dx)
    return {number // size for number in tasks}


def _chunks_per_task(count: int, cpus: int) -> int:
    return max(1, min(MOST_CHUNKS_PER_TASK, count // (8 * cpus)))


def _make_chunks(base: bytes, numbers: range, stages: list[str], *parts: bytes) -> bytes:
    """A task: makes chunks, and packs those of their files that no part has."""
    with tempfile.TemporaryDirectory(prefix="plume-") as scratch:
        folders = [_unpack(part, Path(scratch, f"part{place}")) for place, part in enumerate((base, *parts))]
        made = Path(scratch, "made")
        plume.make_chunks(folders[0], numbers, made, stages=stages, parts=folders, threads=1)
        return _packed(made, without=folders)


def _items(
    spec: str,
    numbers: list[int],
    scratch: str,
    address: str | None,
    *,
    fingerprint: str,
    allow_run: bool,
    allow_outside: bool,
) -> Iterator[tuple[int, float, str | None, str | None] | None]:
    """The engine of datasets: numbers of caves, CPU seconds, why a cave could not be made, its folder; None every now and then."""
    with _cluster(address) as ray:
        path, files, make_item = str(Path(spec).absolute()), ray.put(_files(Path(spec))), _remote(ray, _make_item)

        def make(number: int) -> Any:
            return make_item.remote(path, files, number, fingerprint, allow_run, allow_outside)

        for completed in _as_completed(ray, numbers, make):
            if completed is None:
                yield None
                continue
            number, reference = completed
            try:
                cpu_s, fault, packed = _result(ray, reference)
            except ray.exceptions.RayError as error:
                yield number, 0.0, _deaths(error), None
                continue
            if packed is None:
                yield number, cpu_s, fault, None
                continue
            yield number, cpu_s, None, str(_unpack(packed, Path(scratch, f"item{number}")))


def _make_item(
    path: str, files: dict[str, bytes], number: int, fingerprint: str, allow_run: bool, allow_outside: bool
) -> tuple[float, str | None, bytes | None]:
    """A task: makes a cave of a dataset."""
    with tempfile.TemporaryDirectory(prefix="plume-") as scratch:
        spec = _placed(Path(path), files, Path(scratch, "spec"))
        folder = Path(scratch, "dataset")
        started_s = time.process_time()
        below, fault = _plume.make_item(
            spec, number, folder, fingerprint=fingerprint, allow_run=allow_run, allow_outside=allow_outside
        )
        cpu_s = time.process_time() - started_s
        return cpu_s, fault, None if fault else _packed(folder / below)


def _files(spec: Path) -> dict[str, bytes]:
    """The specification and the recipes below its folder that it names; the first is the specification."""
    content = tomllib.loads(spec.read_text(encoding="utf-8"))
    names = [content.get("recipe")]
    for vary in content.get("vary", []):
        if vary.get("key") == "recipe":
            names += vary["values"]
    files = {spec.name: spec.read_bytes()}
    for name in names:
        if isinstance(name, str) and (file := spec.parent / name).is_file() and _is_below(spec.parent, file):
            files[name] = file.read_bytes()
    return files


def _is_below(folder: Path, file: Path) -> bool:
    return file.resolve().is_relative_to(folder.resolve())


def _placed(spec: Path, files: dict[str, bytes], folder: Path) -> Path:
    """The specification where it is, if this machine sees it there with its recipes, otherwise a copy."""
    seen = {name: spec.parent / name for name in files}
    if all(path.is_file() and path.read_bytes() == files[name] for name, path in seen.items()):
        return spec
    for name, content in files.items():
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(content)
    return folder / spec.name


def _remote(ray: Any, function: Callable[..., Any]) -> Any:
    return ray.remote(max_retries=ATTEMPTS - 1)(function)


def _as_completed(ray: Any, tasks: Iterable[int], start: Callable[[int], Any]) -> Iterator[tuple[int, Any] | None]:
    """Tasks with references to their results, as they are done; None every now and then. Few are submitted at once, so that
    results do not pile up."""
    waiting, running = iter(tasks), dict[Any, int]()
    most = TASKS_PER_CPU * _cpus(ray)
    try:
        while True:
            for task in itertools.islice(waiting, most - len(running)):
                running[start(task)] = task
            if not running:
                return
            ready, _ = ray.wait(list(running), timeout=POLL_S)
            if not ready:
                yield None
            for reference in ready:
                yield running.pop(reference), reference
    finally:
        for reference in running:
            ray.cancel(reference, force=True)


def _result(ray: Any, reference: Any) -> Any:
    try:
        return ray.get(reference)
    except ray.exceptions.RayTaskError as error:
        raise error.cause from None


def _deaths(error: Exception) -> str:
    reason = (str(error).strip() or type(error).__name__).splitlines()[0]
    return f"{ATTEMPTS} workers died of it: {reason}"


def _cpus(ray: Any) -> int:
    return max(1, int(ray.cluster_resources().get("CPU", 1)))


@contextmanager
def _cluster(address: str | None) -> Iterator[Any]:
    """The module ray, connected to a cluster."""
    try:
        import ray
    except ImportError as error:
        raise MissingPartError(f"the engine ray cannot be loaded: {error}", "pip install 'plume-caves[ray]'") from None
    if ray.is_initialized():
        yield ray
        return
    ray.init(address=address, log_to_driver=False, logging_level=logging.ERROR)
    try:
        yield ray
    finally:
        ray.shutdown()


def _packed(folder: Path, without: Iterable[Path] = ()) -> bytes:
    """An archive of a folder, without files in its subfolders that one of the others has."""
    archive = io.BytesIO()
    others = list(without)
    with tarfile.open(fileobj=archive, mode="w") as tar:
        for path in sorted(folder.rglob("*")):
            name = path.relative_to(folder)
            is_elsewhere = len(name.parts) > 1 and any((other / name).is_file() for other in others)
            if path.is_file() and not is_elsewhere:
                tar.add(path, arcname=name.as_posix())
    return archive.getvalue()


def _unpack(packed: bytes, folder: Path) -> Path:
    with tarfile.open(fileobj=io.BytesIO(packed)) as tar:
        tar.extractall(folder, filter="data")
    return folder
