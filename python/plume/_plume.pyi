# Types of the extension module. Their docstrings are written in Rust; `python python/document_stub.py` puts them here.

from collections.abc import Callable, Iterator, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import disjoint_base

__all__ = [
    "Cave",
    "Chunk",
    "ChunkIterator",
    "Chunks",
    "Dataset",
    "Graph",
    "Light",
    "Lod",
    "Mesh",
    "Package",
    "Recipe",
    "Textures",
    "VisualMesh",
    "__version__",
    "chunk_grid",
    "dataset",
    "generate",
    "generators",
    "main",
    "make_chunks",
    "make_item",
    "materials",
    "open",
    "presets",
    "register_generator",
    "targets",
]

__version__: str

def main(arguments: Sequence[str | PathLike[str]]) -> int:
    """Runs a command line, `plume` first, and returns its exit code. Takes over Ctrl-C, SIGTERM and SIGHUP, so it is
    meant for the process of the command.
    """

def generate(
    recipe: Recipe | Mapping[str, Any] | str | PathLike[str] | None = None,
    seed: int | None = None,
    *,
    folder: str | PathLike[str] | None = None,
    force: bool = False,
    parts: Sequence[str | PathLike[str]] | None = None,
    threads: int | None = None,
    progress: Callable[[str, int, int], object] | None = None,
    allow_run: bool = False,
    allow_outside: bool = False,
) -> Cave:
    """Makes a cave: graph, meshes and textures.

    The same recipe, seed and version of Plume give the same bytes, on any machine and for any number of threads. Other
    Python threads keep running. Ctrl-C raises KeyboardInterrupt once the current chunks are done, if this is the main
    thread; the same call with the same `folder` then resumes where it stopped.

    Args:
        recipe: A Recipe, a mapping as Recipe takes it, or the path of a recipe (TOML), a graph (JSON, also of the
            original PLUME) or a cave folder. None is the default cave.
        seed: Takes precedence over the seed of the recipe.
        folder: The cave folder to write. By default the cave folder named by `recipe`, otherwise a temporary one, which
            is removed when the Cave is closed or garbage-collected.
        force: Replace another cave in the folder.
        parts: Cave folders made by `make_chunks` for the same recipe, whose chunks are taken.
        threads: Number of threads; one per core by default.
        progress: Called from time to time as `progress(stage, done, total)`, where `stage` is "graph", "preview",
            "mesh" or "texture" and the numbers count chunks, except that the first two stages count as 1. An
            exception that it raises stops the work.
        allow_run: Allow the recipe to run a program, as the generator "external" does.
        allow_outside: Allow surveys to include files from outside their own folder.

    Raises:
        RecipeError: The recipe is faulty.
        InputError: Such a cave is impossible.
        MissingFileError: There is no file of this name.
        StorageError: The folder contains something else, or the disk fails.

    >>> seen = []
    >>> tiny = {"graph": {"nodes": 3}, "mesh": {"voxel_m": 0.5}, "texture": {"size_px": 256}}
    >>> with plume.generate(tiny, seed=7, progress=lambda *now: seen.append(now)) as cave:
    ...     len(cave.graph.positions), cave.chunks[0].positions.dtype, seen[-1][0]
    (3, dtype('float32'), 'texture')
    """

def chunk_grid(
    recipe: Recipe | Mapping[str, Any] | str | PathLike[str] | None = None,
    seed: int | None = None,
    *,
    allow_run: bool = False,
    allow_outside: bool = False,
) -> tuple[int, int, int]:
    """The numbers of chunks along x, y and z in the grid of a cave, for `make_chunks`. Most chunks have no wall.

    Args:
        recipe: As for `generate`.
        seed: Takes precedence over the seed of the recipe.
        allow_run: Allow the recipe to run a program, as the generator "external" does.
        allow_outside: Allow surveys to include files from outside their own folder.

    >>> plume.chunk_grid({"graph": {"nodes": 3}}, seed=7)
    (1, 1, 1)
    """

def make_chunks(
    recipe: Recipe | Mapping[str, Any] | str | PathLike[str] | None,
    numbers: range,
    folder: str | PathLike[str],
    *,
    seed: int | None = None,
    stages: Sequence[str] | None = None,
    parts: Sequence[str | PathLike[str]] | None = None,
    threads: int | None = None,
    progress: Callable[[str, int, int], object] | None = None,
    allow_run: bool = False,
    allow_outside: bool = False,
) -> list[str]:
    """Makes some chunks of a cave, so that many machines can share a large one; `generate(parts=…)` puts them together. See also
    plume.ray.

    A chunk follows from the recipe and its number, and is the same wherever it is made. Its things and convex pieces also follow
    from the walls of its neighbours, which are meshed too unless one of the `parts` has them.

    Args:
        recipe: As for `generate`.
        numbers: A range of numbers, in the order of the grid: x fastest, z slowest.
        folder: The cave folder to write.
        seed: Takes precedence over the seed of the recipe.
        stages: What to make of the chunks: "mesh", "things", "texture", "pieces".
        parts: Cave folders for the same recipe, from which finished chunks are taken.
        threads: Number of threads; one per core by default.
        progress: As for `generate`.
        allow_run: Allow the recipe to run a program, as the generator "external" does.
        allow_outside: Allow surveys to include files from outside their own folder.

    Returns:
        The names of the chunks that have a wall.

    >>> tiny = {"graph": {"nodes": 3}, "mesh": {"voxel_m": 0.5}, "texture": {"size_px": 256}}
    >>> plume.make_chunks(tiny, range(0, 1), folder / "part", seed=7)
    ['chunk_0_0_0']
    >>> with plume.generate(tiny, seed=7, parts=[folder / "part"]) as cave:
    ...     len(cave.chunks)
    1
    """

def open(folder: str | PathLike[str]) -> Cave:
    """Opens a finished cave folder without changing it.

    Raises:
        MissingFileError: There is no folder of this name.
        InputError: There is no cave in it, or it is not finished; `generate(folder)` finishes it.
        StorageError: It cannot be read.

    >>> plume.open(cave.folder).recipe == cave.recipe
    True
    """

def dataset(
    spec: str | PathLike[str],
    folder: str | PathLike[str] | None = None,
    *,
    engine: Literal["processes", "ray"] = "processes",
    address: str | None = None,
    workers: int | None = None,
    progress: Callable[[str, int, int], object] | None = None,
    allow_run: bool = False,
    allow_outside: bool = False,
) -> Dataset:
    r"""Makes a dataset: many caves from one specification.

    The same specification and version of Plume give the same bytes, for any number of workers and any engine. Ctrl-C raises
    KeyboardInterrupt, if this is the main thread; the same call then resumes where it stopped.

    Args:
        spec: The path of the specification (TOML); docs/datasets.md lists its keys.
        folder: The folder to write; by default the name of the dataset.
        engine: Who makes the caves: "processes" of this interpreter (`sys.executable`), or tasks of a cluster, "ray"; see plume.ray.
        address: The cluster of the engine "ray", as `ray.init` takes it.
        workers: Number of processes; one per core by default. A cluster has its own.
        progress: Called from time to time as `progress("caves", done, total)`. An exception that it raises stops the work.
        allow_run: Allow recipes to run programs, as the generator "external" does.
        allow_outside: Allow surveys to include files from outside their own folder.

    Raises:
        RecipeError: The specification, or the recipe of a cave, is faulty.
        StorageError: The folder contains something else, another run works in it, or the disk fails.

    >>> spec = folder / "pair.toml"
    >>> _ = spec.write_text('seeds = [1, 2]\nsheet = 0\nset = ["graph.nodes=3", "mesh.voxel_m=0.5", "texture.size_px=256"]')
    >>> pair = plume.dataset(spec, folder / "pair")
    >>> [(cave["seed"], cave["stations"], cave["path"]) for cave in pair.caves]
    [(1, 3, 'items/000000'), (2, 3, 'items/000001')]
    >>> plume.open(pair.path / pair.caves[0]["path"] / "cave").recipe.seed
    1
    """

def make_item(
    spec: str | PathLike[str],
    number: int,
    folder: str | PathLike[str],
    *,
    fingerprint: str,
    allow_run: bool,
    allow_outside: bool,
) -> tuple[str, str | None]:
    """Makes a cave of a dataset in `folder / path`; for tasks of a cluster.

    Args:
        spec: The path of the specification.
        number: The number of the cave.
        folder: A folder for caves of this dataset.
        fingerprint: That of the run, so that another version of Plume, or other files, are refused.
        allow_run: Allow recipes to run programs.
        allow_outside: Allow surveys to include files from outside their own folder.

    Returns:
        The path of the cave below the folder, and why it could not be made, if it could not.

    Raises:
        PlumeError: No other cave can be made either.
    """

def targets() -> dict[str, str]:
    """Targets for `Cave.export` by name, with what each writes.

    >>> " ".join(sorted(plume.targets()))
    'assimp:<id> fbx gazebo glb gltf isaac mujoco obj ply stl tiles truth unity unreal urdf usd usdz'
    """

def generators() -> dict[str, str]:
    """Values of `graph.generator`, with how each lays out the passages."""

def materials() -> dict[str, str]:
    """Values of `rock.kind`, with a description of each rock."""

def presets() -> dict[str, str]:
    """Names for `Recipe.preset`, with a description of each."""

def register_generator(
    name: str,
    function: Callable[[int, dict[str, Any]], Mapping[str, Any] | str],
    *,
    summary: str = "",
    settings: Mapping[str, Mapping[str, Any]] | None = None,
) -> None:
    """Registers a generator of your own: from then on recipes can name it, as `graph.generator`.

    It stays registered for as long as the process runs. The same seed and settings have to give the same graph, or caves cannot
    be made again; take random numbers from `random.Random(seed)`.

    Args:
        name: What recipes call it: lower-case letters, digits and hyphens.
        function: Called as `function(seed, settings)`, on another thread. Returns a graph as `Graph.to_dict` does, or its
            JSON text; of each node, `id`, `coordinates` and `edges` are enough.
        summary: One line for lists.
        settings: The keys that recipes may set beside `generator`, each with its JSON Schema. A `default` is needed, ranges
            are checked, and the `description` is the comment in recipes.

    Raises:
        InputError: The name is taken or cannot be written in recipes, or a setting has no type or no default.

    >>> def straight(seed, settings):
    ...     count = settings["stations"]
    ...     return {"nodes": [{
    ...         "id": i,
    ...         "coordinates": {"x": 8.0 * i, "y": 0.0, "z": 0.0},
    ...         "edges": [i + 1] if i + 1 < count else [],
    ...     } for i in range(count)]}
    >>> plume.register_generator("straight", straight, settings={"stations": {"type": "integer", "default": 4}})
    >>> with plume.generate({"graph.generator": "straight", "mesh.voxel_m": 0.5, "texture.size_px": 256}) as tunnel:
    ...     len(tunnel.graph.positions)
    4
    """

@final
class Recipe:
    """What a cave is made from: every key has a value, every value is in range.

    `plume new` prints the default recipe with a comment for every key. A recipe is immutable; `replace` makes a changed
    copy. Two recipes are equal if all their values are.

    Args:
        settings: A mapping of keys to values. Keys are nested, `{"graph": {"nodes": 20}}`, or dotted, `{"graph.nodes":
            20}`. Missing keys and None get their defaults.
        seed: Takes precedence over the seed of `settings`; 0 to 2**63 - 1.

    Raises:
        RecipeError: With all faults of the settings.

    >>> recipe = plume.Recipe({"graph": {"nodes": 20}}, seed=3)
    >>> recipe["graph"]["nodes"], recipe["rock.kind"], recipe.seed
    (20, 'limestone', 3)
    """

    def __new__(cls, settings: Mapping[str, Any] | None = None, *, seed: int | None = None) -> Recipe: ...
    @staticmethod
    def load(path: str | PathLike[str], *, seed: int | None = None) -> Recipe:
        """Reads a recipe file (TOML). Paths in it are relative to it.

        Raises:
            RecipeError: With line and key of every fault.
            StorageError: If it cannot be read.
        """

    @staticmethod
    def parse(text: str, *, seed: int | None = None) -> Recipe:
        r"""Reads the text of a recipe (TOML).

        Raises:
            RecipeError: With line and key of every fault.

        >>> plume.Recipe.parse('name = "demo"').name
        'demo'
        >>> try:
        ...     plume.Recipe.parse("[graph]\nnodes = 1")
        ... except plume.RecipeError as error:
        ...     print(error.faults[0].line, error.faults[0].message)
        2 graph.nodes must be at least 2, found 1
        """

    @staticmethod
    def preset(name: str, *, seed: int | None = None) -> Recipe:
        """A recipe included with Plume; `plume.presets()` lists them.

        Raises:
            InputError: If there is no such preset.

        >>> plume.Recipe.preset("mine")["graph.generator"]
        'mine'
        """

    def replace(self, settings: Mapping[str, Any] | None = None, *, seed: int | None = None) -> Recipe:
        """A copy of the recipe with these values.

        Args:
            settings: A mapping as for the constructor. Missing keys and None keep their values.
            seed: Another seed.

        Raises:
            RecipeError: With all faults.

        >>> plume.Recipe().replace({"graph.nodes": 100, "rock.kind": "basalt"}, seed=5)["graph.nodes"]
        100
        """

    @property
    def name(self) -> str:
        """Name of the cave and of what is made from it."""

    @property
    def seed(self) -> int:
        """The seed of everything random."""

    def to_dict(self) -> dict[str, Any]:
        """Every key with its value, as a new dict of dicts; keys without a value are None."""

    def to_toml(self) -> str:
        """The recipe as TOML with a comment for every key; `parse` returns an equal recipe."""

    def __getitem__(self, key: str, /) -> Any: ...
    def __contains__(self, key: str, /) -> bool: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Cave:
    """A finished cave, returned by `generate` and `open`.

    Metres, right-handed, Z up. A context manager that closes itself. A temporary folder is removed when the cave is
    closed or garbage-collected; other folders stay.
    """

    @property
    def recipe(self) -> Recipe:
        """The recipe it was made from, with every key."""

    @property
    def folder(self) -> Path:
        """The cave folder."""

    @property
    def graph(self) -> Graph:
        """The graph of the passages."""

    @property
    def chunks(self) -> Chunks:
        """The chunks, loaded from the folder one at a time."""

    @property
    def spawns(self) -> NDArray[np.float64]:
        """Start poses for robots as a (k, 4, 4) float64 array, m; each maps the robot's frame to the cave's.

        +X points along the passage, +Z up, the origin is on level ground. The first is the most level one. There is at
        least one. Computed on first access; the array is a copy.

        >>> cave.spawns[0][3]
        array([0., 0., 0., 1.])
        """

    @property
    def lights(self) -> list[Light]:
        """The lamps along the passages; none if the recipe says `world.lights = false`."""

    @property
    def things(self) -> list[dict[str, Any]]:
        """The stones and dripstone of the cave, as in the `instances.json` of every package.

        Returns:
            One dict per thing: `id`, `class` (such as "boulder"), `prototype`, `chunk`, `position` (m),
            `orientation_wxyz`, `scale`, `mass_kg`, `embedding_m` and `movable`. None if the recipe says `things.cover = 0`.

        Raises:
            StorageError: A file of the cave is missing or was changed.

        >>> all(thing["mass_kg"] > 0 for thing in cave.things)
        True
        """

    def distance(self, points: ArrayLike) -> NDArray[np.float32]:
        """Euclidean signed distance to the triangles that simulators get: walls and things, without gravel.

        Negative in air, positive in rock and in things. Exact but for rounding to float32. The first call reads all chunks, which
        takes about a second for each 100 m of passage, and keeps their triangles; then 100,000 points take about a second.

        Args:
            points: Finite points in the cave's frame as an (n, 3) array, m; taken as float32.

        Returns:
            (n,) float32, m.

        Raises:
            InputError: `points` has another shape, or a coordinate is not finite.
            StorageError: A file of the cave is missing or was changed.

        >>> above, below = cave.spawns[0][:3, 3] + [[0, 0, 0.5], [0, 0, -0.5]]
        >>> cave.distance([above, below]) < 0
        array([ True, False])
        """
    def field(self, points: ArrayLike) -> NDArray[np.float32]:
        """The field that the walls are made from: negative in air, zero on the wall, positive in rock.

        Its sign tells free space without things. It is a distance only near the wall, and only roughly: up to half a metre
        away mostly between half and twice the true distance; deeper in the rock it levels off at about 1 m. The triangles omit
        detail finer than a voxel or `mesh.simplify_error_m`. A million points take about a second; one call with many points is
        faster than many calls.

        Args:
            points: Finite points in the cave's frame as an (n, 3) array, m; taken as float32.

        Returns:
            (n,) float32, m.

        Raises:
            InputError: `points` has another shape, or a coordinate is not finite.

        >>> above, below = cave.spawns[0][:3, 3] + [[0, 0, 0.5], [0, 0, -0.5]]
        >>> cave.field([above, below]) < 0
        array([ True, False])
        """
    def certify(self, robot: str = "husky") -> dict[str, Any]:
        """Where a robot gets from the first start pose, and what stops it, as `plume certify` tells.

        Args:
            robot: One of `plume list robots`, or a TOML file.

        Returns:
            The certificate as a dict: `robot`, `floor`, a list of `stations` and of `passages` each way ("go", "marginal",
            "no-go"), what stops the robot and where, and the `route` to the furthest station. Metres and degrees.

        Raises:
            InputError: There is no such robot.
            StorageError: A file of the cave is missing or was changed.

        >>> cave.certify("rover")["passages"][0]["there"]["class"]
        'go'
        """
    def route(
        self, kind: str = "longest", *, robot: str = "husky", height: float | None = None, speed: float = 0.5
    ) -> NDArray[np.float64]:
        """A path for a robot, as `plume path` finds it: through the middle, smoothed, and held against the floor in every pose.

        Args:
            kind: "longest" (to the furthest station), "loop", "tour" (through all passages and back), or "A..B" between two
                stations of the graph.
            robot: One of `plume list robots`, or a TOML file.
            height: Height over the floor of a level body, such as a camera, m; None for the robot on its wheels.
            speed: m/s.

        Returns:
            (n, 8) float64: time in s, x, y, z in m, and the orientation as qx, qy, qz, qw; a row of a TUM file each.

        Raises:
            InputError: There is no such robot, kind or station, or the robot does not get there.
            StorageError: A file of the cave is missing or was changed.

        >>> cave.route("longest", robot="rover").shape[1]
        8
        """
    def export(
        self,
        target: str,
        path: str | PathLike[str],
        *,
        bundle: str | None = None,
        force: bool = False,
        **options: Any,
    ) -> Package:
        """Writes the cave as a package for a simulator, as `plume export` does: same cave, same bytes.

        Ctrl-C raises KeyboardInterrupt once the current chunk is done, if this is the main thread. The package appears
        whole or not at all.

        Args:
            target: Name of the target; `plume.targets()` lists them.
            path: The folder or file to write.
            bundle: Write the package as a single file: "zip", "tar.zst", or another kind that the target supports, such as
                "mjz". The extension is added to `path` if it is missing.
            force: Replace an existing package.
            options: Options of the target, such as `lights=False`.

        Raises:
            InputError: There is no such target or bundle.
            RecipeError: An option is faulty.
            MissingPartError: A library that the target needs is missing.
            StorageError: Something else is at `path`, or the disk fails.

        >>> package = cave.export("gltf", folder / "package")
        >>> package.target, package.visual_triangles > 0
        ('gltf', True)
        >>> cave.export("gazebo", folder / "packed", bundle="zip").path.name
        'packed.zip'
        """

    def truth(
        self, path: str | PathLike[str], *, bundle: str | None = None, force: bool = False, **options: Any
    ) -> Package:
        """Writes the ground truth of the cave: the same as `export("truth", path, ...)`.

        >>> cave.truth(folder / "truth", cell_m=0.1).target
        'truth'
        """
    def close(self) -> None:
        """Closes the cave, and removes its folder if it is temporary. Closing twice does no harm."""

    def __enter__(self) -> Cave: ...
    def __exit__(self, *exception: object) -> None: ...

@final
class Graph:
    """A graph: stations, and the passages between them.

    The arrays are copies, made when `Cave.graph` is accessed.
    """

    @property
    def positions(self) -> NDArray[np.float64]:
        """The stations, points on the centrelines of passages: (n, 3) float64, m.

        >>> cave.graph.positions.shape, str(cave.graph.positions.dtype)
        ((12, 3), 'float64')
        """

    @property
    def radii(self) -> NDArray[np.float64]:
        """Reach of each station to the next: (n,) float64, m. Passage widths are proportional to it."""

    @property
    def edges(self) -> NDArray[np.uint32]:
        """The passages as pairs of rows of `positions`: (m, 2) uint32, smaller row first, sorted, unique."""

    @property
    def names(self) -> list[str | None]:
        """What a survey calls each station, in the order of `positions`; `None` where it has no name.

        >>> set(cave.graph.names)
        {None}
        """

    @property
    def georeference(self) -> tuple[list[float], str | None] | None:
        """Where the origin of the cave lies in the coordinates of its survey: east, north and up in metres, and the coordinate
        system as the survey names it, such as `EPSG:32633`, if it does. `None` if that is unknown.

        >>> cave.graph.georeference is None
        True
        """

    def to_json(self) -> str:
        """The text of the graph file with its recipe: `graph.json` of the cave folder, from which alone `generate` can make
        the same cave again.
        """

    def to_dict(self) -> dict[str, Any]:
        """The content of the graph file as a new dict.

        >>> sorted(cave.graph.to_dict())
        ['nodes', 'plume', 'recipe']
        """

@disjoint_base
class Mesh:
    """Triangles, counter-clockwise as seen from the air. Metres, right-handed, Z up, frame of the cave."""

    @property
    def positions(self) -> NDArray[np.float32]:
        """The vertices: (v, 3) float32, m."""

    @property
    def indices(self) -> NDArray[np.uint32]:
        """The triangles as rows of `positions`: (t, 3) uint32."""

    @property
    def bounds(self) -> NDArray[np.float32]:
        """Minimum and maximum corner of the bounding box: (2, 3) float32, m."""

@disjoint_base
class VisualMesh(Mesh):
    """Triangles with everything needed for rendering; the attributes are per vertex."""

    @property
    def normals(self) -> NDArray[np.float32]:
        """Unit normals, pointing into the air: (v, 3) float32."""

    @property
    def uvs(self) -> NDArray[np.float32]:
        """Texture coordinates, 0 to 1, origin at the lower left of the image: (v, 2) float32."""

    @property
    def tangents(self) -> NDArray[np.float32]:
        """Tangents (MikkTSpace): unit x, y, z along +u, and the handedness ±1 of the bitangent: (v, 4) float32."""

@final
class Lod(VisualMesh):
    """A coarser level of detail of a chunk, with the same textures. Vertices on the border of the chunk are those of the
    full detail, so levels of neighbouring chunks meet without cracks.
    """

    @property
    def error_m(self) -> float:
        """Upper bound of its distance from the full detail, m."""

@final
class Chunk(VisualMesh):
    """A box of the cave with its wall in full detail, its coarser levels of detail, collision mesh and textures.

    Its arrays are the loaded data, passed on without a copy. The chunk owns them: they stay valid when the cave is
    closed, and changing them affects nothing else.

    >>> chunk = cave.chunks[0]
    >>> chunk.positions.shape[1], chunk.indices.shape[1], str(chunk.uvs.dtype)
    (3, 3, 'float32')
    >>> bool((chunk.indices < len(chunk.positions)).all())
    True
    """

    @property
    def name(self) -> str:
        """Its name, unique in the cave, for example `chunk_0_2_1`."""

    @property
    def lods(self) -> list[Lod]:
        """Coarser levels of detail, the finest first; may be empty."""

    @property
    def collision(self) -> Mesh:
        """The collision mesh: fewer triangles, at most `mesh.collision_error_m` of the recipe away from the wall."""

    @property
    def textures(self) -> Textures:
        """The textures of the wall."""

@final
class Chunks:
    """The chunks of a cave as a sequence in a fixed order. Each access reads the chunk from the folder again, so memory
    holds only what you keep.

    >>> [chunk.name for chunk in cave.chunks] == cave.chunks.names
    True
    """

    @property
    def names(self) -> list[str]:
        """The names of the chunks; reads no files."""

    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, index: int, /) -> Chunk: ...
    @overload
    def __getitem__(self, index: slice, /) -> list[Chunk]: ...
    def __iter__(self) -> Iterator[Chunk]: ...

@final
class ChunkIterator:
    """Loads the chunks of a cave one by one."""

    def __iter__(self) -> ChunkIterator: ...
    def __next__(self) -> Chunk: ...

@final
class Textures:
    """The textures of a chunk, each (height, width, channels) uint8 with the top row first, and the heights in metres.

    Each access reads and decodes the file again, as long as the cave is open; the array is the decoded image, not a copy.

    >>> textures = cave.chunks[0].textures
    >>> textures.base_color.shape, textures.roughness.shape
    ((256, 256, 3), (256, 256, 1))
    """

    @property
    def base_color(self) -> NDArray[np.uint8]:
        """Base colour: red, green, blue in sRGB."""

    @property
    def normal(self) -> NDArray[np.uint8]:
        """Tangent-space normals, +Y up (OpenGL): x, y, z, where 0 stands for -1 and 255 for 1."""

    @property
    def orm(self) -> NDArray[np.uint8]:
        """Ambient occlusion, roughness and metalness (0); linear."""

    @property
    def roughness(self) -> NDArray[np.uint8]:
        """Roughness alone, one channel; linear."""

    @property
    def height_m(self) -> NDArray[np.float32] | None:
        """Height of the rock above the mesh, in metres along the normal, (height, width) float32; None unless the recipe asks
        for it (`texture.height`).
        """

@final
class Light:
    """A lamp: a point light."""

    @property
    def name(self) -> str:
        """Its name, unique in the cave."""

    @property
    def position(self) -> tuple[float, float, float]:
        """Position: x, y, z in m."""

    @property
    def color(self) -> tuple[float, float, float]:
        """Colour: linear red, green, blue, 0 to 1."""

    @property
    def intensity_cd(self) -> float:
        """Luminous intensity, cd."""

    @property
    def range_m(self) -> float:
        """Distance beyond which it can be ignored, m."""

@final
class Dataset:
    """A finished dataset."""

    @property
    def path(self) -> Path:
        """Its folder."""
    @property
    def caves(self) -> list[dict[str, Any]]:
        """The index: for each cave a dict of its part, seed, path, what was drawn, hashes and measures."""
    @property
    def failed(self) -> dict[int, str]:
        """Why caves could not be made or are left out, by their numbers."""

@final
class Package:
    """A written package."""

    @property
    def target(self) -> str:
        """The target it is for."""

    @property
    def path(self) -> Path:
        """Its folder or file."""

    @property
    def files(self) -> int:
        """Number of files, including the manifest."""

    @property
    def bytes(self) -> int:
        """Total size of the files, before bundling."""

    @property
    def visual_triangles(self) -> int:
        """Number of triangles of the visual mesh, in full detail."""

    @property
    def collision_triangles(self) -> int:
        """Number of triangles of the collision mesh; 0 if the target has none."""

    @property
    def open_with(self) -> str:
        """How to open the package: a shell command to run in its folder, or a sentence."""
