"""The module `plume`: its bytes against the command line, its errors, its examples."""

import doctest
import errno
import gc
import hashlib
import inspect
import json
import multiprocessing
import os
import pickle
import subprocess
import sys
import threading
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import plume
import pytest

ROOT = Path(__file__).parents[2]
SMALL = {"graph": {"nodes": 12}, "mesh": {"voxel_m": 0.25, "chunk_m": [12, 12, 12]}, "texture": {"size_px": 256}}
SMALL_WORDS = ["graph.nodes=12", "mesh.voxel_m=0.25", "mesh.chunk_m=[12, 12, 12]", "texture.size_px=256"]
SEED = 7


def hashes(folder: Path) -> dict[str, str]:
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def test_recipes() -> None:
    recipe = plume.Recipe({"graph": {"nodes": np.int64(20)}, "rock.kind": "basalt", "texture.size_px": None}, seed=3)
    assert (recipe["graph"]["nodes"], recipe["rock.kind"], recipe.seed, recipe.name) == (20, "basalt", 3, "cave")
    assert recipe == plume.Recipe.parse(recipe.to_toml()) == plume.Recipe(recipe.to_dict())
    assert recipe != recipe.replace(seed=4) and recipe == recipe.replace(seed=4).replace(seed=3)
    assert len({recipe, plume.Recipe(recipe.to_dict()), plume.Recipe()}) == 2
    assert plume.Recipe().replace({"graph.generator": "mine"})["graph"]["generator"] == "mine"
    assert pickle.loads(pickle.dumps(recipe.replace(seed=9))) == recipe.replace(seed=9)
    assert "basalt" in repr(recipe) and recipe != "basalt"
    assert "graph" in recipe and "graph.nodes" in recipe and "graph.node" not in recipe
    with pytest.raises(KeyError, match="graph.node"):
        recipe["graph.node"]
    with pytest.raises(AttributeError):
        recipe.seed = 4  # type: ignore[misc]


@pytest.mark.parametrize("bundle", ["zip", "tar.zst"])
def test_archives_are_those_of_the_command(bundle: str, cave: plume.Cave, tmp_path: Path) -> None:
    package = cave.export("isaac", tmp_path / "ours", bundle=bundle)
    assert package.path == tmp_path / f"ours.{bundle}"
    command(tmp_path, "export", str(cave.folder), "-t", "isaac", "-o", "theirs", "--bundle", bundle)
    assert package.path.read_bytes() == (tmp_path / f"theirs.{bundle}").read_bytes()
    assert "intact: isaac by plume" in command(tmp_path, "check", str(package.path))


@pytest.mark.parametrize("target", ["usd", "isaac"])
def test_an_image_that_usd_misses_is_told(target: str, cave: plume.Cave, tmp_path: Path) -> None:
    """The layers are usd-core's; which images they name the check reads on its own."""
    package = cave.export(target, tmp_path / "package").path
    image = next(path for path in sorted(package.rglob("*_normal.png")))
    image.rename(image.with_name("other.png"))
    manifest = json.loads((package / "manifest.json").read_text())
    name = image.relative_to(package).as_posix()
    manifest["files"]["chunks/textures/other.png"] = manifest["files"].pop(name)
    for chunk in manifest["chunks"]:
        chunk["textures"] = {role: path for role, path in chunk["textures"].items() if path != name}
    (package / "manifest.json").write_text(sealed(manifest))
    words = [sys.executable, "-m", "plume", "check", "package"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
    layer = f"chunks/{image.name.removesuffix('_normal.png')}.usdc"
    assert (done.returncode, done.stdout) == (
        1,
        f"{layer}: refers to `./textures/{image.name}`, which does not exist\n",
    )


def sealed(manifest: dict[str, Any]) -> str:
    """A manifest as documented: it ends with the hash of everything before."""
    del manifest["seal"]
    before = json.dumps(manifest, indent=2, ensure_ascii=False).removesuffix("\n}") + ',\n  "seal": "'
    return before + hashlib.sha256(before.encode()).hexdigest() + '"\n}\n'


@pytest.mark.parametrize("name", ["cave", "lava-tube", "mine", "layers"])
def test_presets_are_those_of_the_command(name: str, tmp_path: Path) -> None:
    printed = command(tmp_path, "new", "--preset", name)
    _, recipe = printed.split("\n\n", 1)
    assert plume.Recipe.preset(name).to_toml() == recipe and name in plume.presets()
    (tmp_path / "cave.toml").write_text(printed)
    assert plume.Recipe.load(tmp_path / "cave.toml") == plume.Recipe.preset(name)


def test_paths_in_a_recipe_are_beside_it(cave: plume.Cave, tmp_path: Path) -> None:
    (tmp_path / "graph.json").write_text(cave.graph.to_json())
    (tmp_path / "cave.toml").write_text('[graph]\ngenerator = "file"\npath = "graph.json"\n')
    relative = plume.Recipe.load(tmp_path / "cave.toml").replace(SMALL | {"graph": None})
    absolute = plume.Recipe(SMALL | {"graph": {"generator": "file", "path": tmp_path / "graph.json"}})
    for recipe in [relative, pickle.loads(pickle.dumps(relative)), absolute]:
        with plume.generate(recipe) as again:
            assert np.array_equal(again.graph.positions, cave.graph.positions)


def test_tables_are_those_of_the_command(tmp_path: Path) -> None:
    listed = json.loads(command(tmp_path, "list", "--json"))
    for name in ["targets", "generators", "materials", "presets"]:
        # Other tests may have registered more.
        assert getattr(plume, name)().items() >= {row["name"]: row["summary"] for row in listed[name]}.items()


def command(folder: Path, *words: str) -> str:
    # Elsewhere it is another hour, and summer, which must not matter.
    environment = os.environ | {"TZ": "Australia/Sydney"}
    words = (sys.executable, "-m", "plume", *words)
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_cave_has_the_bytes_of_the_command(cave: plume.Cave, tmp_path: Path) -> None:
    sets = [word for pair in SMALL_WORDS for word in ("--set", pair)]
    command(tmp_path, "generate", "--output", "cave", "--seed", str(SEED), *sets)
    assert hashes(cave.folder) == hashes(tmp_path / "cave")


# Those of libassimp have separate tests.
@pytest.mark.parametrize("target", [name for name in plume.targets() if ":" not in name])
def test_a_package_has_the_bytes_of_the_command(target: str, cave: plume.Cave, tmp_path: Path) -> None:
    package = cave.export(target, tmp_path / "ours")
    command(tmp_path, "export", str(cave.folder), "--target", target, "--output", "theirs")
    assert hashes(tmp_path / "ours") == hashes(tmp_path / "theirs")
    assert package.target == target and package.path == tmp_path / "ours"
    assert package.files == len(hashes(package.path))
    assert package.bytes <= sum(path.stat().st_size for path in package.path.rglob("*"))
    # Those of the wall, and those of the things.
    assert package.visual_triangles > sum(len(chunk.indices) for chunk in cave.chunks)


def test_an_archive_holds_no_clock(cave: plume.Cave, tmp_path: Path) -> None:
    cave.export("usdz", tmp_path / "package")
    with zipfile.ZipFile(tmp_path / "package" / "cave.usdz") as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 12, 0, 0)}


def test_options_reach_the_target(cave: plume.Cave, tmp_path: Path) -> None:
    cave.export("isaac", tmp_path / "lit")
    cave.export("isaac", tmp_path / "dark", lights=False)
    words = ["--target", "isaac", "--option", "isaac.lights=false", "--output", "theirs"]
    command(tmp_path, "export", str(cave.folder), *words)
    assert hashes(tmp_path / "dark") == hashes(tmp_path / "theirs") != hashes(tmp_path / "lit")


def test_the_same_again_has_the_same_bytes(tmp_path: Path) -> None:
    first = plume.generate(plume.Recipe(SMALL), SEED, folder=tmp_path / "first")
    again = plume.generate(plume.Recipe(SMALL), SEED, folder=tmp_path / "again", threads=1)
    assert hashes(again.folder) == hashes(first.folder)
    from_graph = plume.generate(first.folder / "graph.json", folder=tmp_path / "graph")
    assert hashes(from_graph.folder) == hashes(first.folder)


def test_a_folder_opens_as_it_was_made(cave: plume.Cave) -> None:
    before = {path: path.stat().st_mtime_ns for path in cave.folder.rglob("*")}
    again = plume.open(str(cave.folder))
    assert again.recipe == cave.recipe and again.chunks.names == cave.chunks.names
    assert np.array_equal(again.spawns, cave.spawns)
    assert before == {path: path.stat().st_mtime_ns for path in cave.folder.rglob("*")}


def test_an_unfinished_folder_does_not_open(tmp_path: Path) -> None:
    sets = [word for pair in SMALL_WORDS for word in ("--set", pair)]
    command(tmp_path, "mesh", "--output", "cave", *sets)
    with pytest.raises(plume.InputError, match="the cave is not finished"):
        plume.open(tmp_path / "cave")
    assert len(plume.generate(tmp_path / "cave").chunks) == len(plume.open(tmp_path / "cave").chunks)


@pytest.mark.parametrize("end", ["close", "with", "collect"])
def test_a_temporary_folder_goes_with_its_cave(end: str) -> None:
    cave = plume.generate(SMALL, SEED)
    folder = cave.folder
    chunk = cave.chunks[0]
    assert folder.is_dir()
    if end == "close":
        cave.close()
        cave.close()
    elif end == "with":
        with cave:
            pass
    else:
        textures = chunk.textures
        del cave, chunk
        gc.collect()
        assert textures.orm.shape == (256, 256, 3), "a texture keeps its cave"
        del textures
        gc.collect()
    assert not folder.exists()


def test_a_temporary_folder_goes_with_the_interpreter() -> None:
    program = f"import plume; cave = plume.generate({SMALL!r}); print(cave.folder)"
    done = subprocess.run([sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=True)
    assert done.stderr == "" and not Path(done.stdout.strip()).exists()


def test_a_closed_cave_says_so() -> None:
    cave = plume.generate(SMALL, SEED)
    chunks, chunk = cave.chunks, cave.chunks[0]
    cave.close()
    for use in [
        lambda: cave.graph,
        lambda: cave.spawns,
        lambda: chunks[0],
        lambda: len(chunks),
        lambda: cave.folder,
        lambda: chunk.textures.orm,
        lambda: cave.export("gltf", "x"),
    ]:
        with pytest.raises(plume.InputError, match="the cave is closed"):
            use()
    assert np.isfinite(chunk.positions).all() and "closed" in repr(cave)


def test_other_threads_run_meanwhile() -> None:
    ticks = 0
    done = threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not done.wait(0.001):
            ticks += 1

    ticker = threading.Thread(target=tick)
    ticker.start()
    with plume.generate(SMALL | {"mesh": {"voxel_m": 0.15}}, SEED):
        made = ticks
    done.set()
    ticker.join()
    assert made > 20, "the interpreter lock was held"


def triangles(seed: int) -> int:
    with plume.generate(SMALL, seed) as cave:
        return sum(len(chunk.indices) for chunk in cave.chunks)


def test_caves_are_made_side_by_side() -> None:
    alone = [triangles(seed) for seed in range(3)]
    with ThreadPoolExecutor(3) as threads:
        assert list(threads.map(triangles, range(3))) == alone
    # No thread of ours outlives its work, so that even a fork is safe; data loaders fork.
    with multiprocessing.get_context("fork").Pool(2) as processes:
        assert processes.map(triangles, range(3)) == alone


def test_progress_is_told_and_may_stop_the_work(tmp_path: Path) -> None:
    told: list[tuple[str, int, int]] = []
    with plume.generate(SMALL | {"mesh": {"voxel_m": 0.15}}, SEED, progress=lambda *now: told.append(now)):
        pass
    assert told and all(0 <= done <= total for _, done, total in told)
    order = ["graph", "preview", "mesh", "things", "texture"]
    assert [order.index(stage) for stage, _, _ in told] == sorted(order.index(stage) for stage, _, _ in told)

    def refuse(stage: str, done: int, total: int) -> None:
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        plume.generate(SMALL | {"mesh": {"voxel_m": 0.15}}, SEED, folder=tmp_path / "cave", progress=refuse)
    assert not list(tmp_path.rglob(".plume-*"))


def test_a_program_lays_out_a_cave_if_it_may(tmp_path: Path) -> None:
    program = tmp_path / "row.py"
    program.write_text(
        "import json, sys\n"
        "count = json.load(sys.stdin)['settings']['count']\n"
        "node = lambda i: {'id': i, 'edges': [i - 1] if i else [], 'coordinates': {'x': 4 * i, 'y': 0, 'z': 0}}\n"
        "print(json.dumps({'nodes': [node(i) for i in range(count)]}))\n"
    )
    graph = {"generator": "external", "command": [sys.executable, str(program)], "settings": {"count": 3}}
    recipe = {**SMALL, "graph": graph}
    with pytest.raises(plume.InputError, match="not allowed"):
        plume.generate(recipe, folder=tmp_path / "refused")
    with plume.generate(recipe, folder=tmp_path / "made", allow_run=True) as cave:
        assert np.ptp(cave.graph.positions[:, 0]) == 8


def test_a_survey_keeps_its_names_and_warns_of_doubtful_readings(tmp_path: Path) -> None:
    survey = tmp_path / "cave.svx"
    survey.write_text("*cs EPSG:32633\n*cs out EPSG:32633\n*fix a 500000 5300000 800\na b 6 090 0\nb c 6 400 0\n")
    recipe = {**SMALL, "graph": {"generator": "file", "path": str(survey)}}
    with pytest.warns(UserWarning, match=r"cave.svx:5: the compass reading 400"), plume.generate(recipe) as cave:
        assert sorted(str(name) for name in cave.graph.names) == ["a", "b", "c"]
        georeference = cave.graph.georeference
        assert georeference is not None
        (east, north, up), system = georeference
        assert (system, up) == ("EPSG:32633", 800.0) and east != 0 and north != 0


def test_a_failed_cave_leaves_no_temporary_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    with pytest.raises(plume.InputError):
        plume.generate({"graph.bounds_x_m": 1.0})
    assert list(tmp_path.iterdir()) == []


def test_faults_of_a_recipe_are_told_by_line_and_key(tmp_path: Path) -> None:
    path = tmp_path / "cave.toml"
    path.write_text('name = "cave"\n\n[graph]\nnods = 20\nnodes = 1\n')
    with pytest.raises(plume.RecipeError) as raised:
        plume.Recipe.load(path)
    first, second = raised.value.faults
    assert (first.origin, first.line, first.message) == (str(path), 4, "graph.nods is not a key")
    assert first.hint.startswith("did you mean `nodes`?")
    assert (second.line, second.message) == (5, "graph.nodes must be at least 2, found 1")
    assert isinstance(raised.value, ValueError) and "hint: did you mean" in str(raised.value)


@pytest.mark.parametrize(
    ("use", "kind", "text"),
    [
        (lambda cave, folder: cave.export("isac", folder / "x"), plume.InputError, "did you mean `isaac`"),
        (
            lambda cave, folder: plume.Recipe().replace({"texture.sizepx": 3}),
            plume.RecipeError,
            "did you mean `size_px`",
        ),
        (lambda cave, folder: cave.export("isaac", folder / "x", light=1), plume.RecipeError, "did you mean `lights`"),
        (lambda cave, folder: cave.export("isaac", folder / "x", lights=3), plume.RecipeError, "true or false"),
        (lambda cave, folder: cave.export("gltf", folder / "x", bundle="zap"), plume.InputError, "did you mean `zip`"),
        (lambda cave, folder: cave.export("gltf", folder / "x", bundle="mjz"), plume.InputError, "mujoco"),
        (lambda cave, folder: cave.export("gltf", cave.folder), plume.StorageError, "not empty"),
        (lambda cave, folder: cave.export("gltf", cave.folder, force=True), plume.StorageError, "is not replaced"),
        (lambda cave, folder: cave.export("gltf", folder / "file" / "x"), plume.StorageError, "file"),
        (lambda cave, folder: plume.generate(SMALL, folder=folder), plume.StorageError, "does not contain a cave"),
        (lambda cave, folder: plume.generate(SMALL, folder=folder / "file" / "x"), plume.StorageError, "file"),
        (lambda cave, folder: plume.generate(SMALL, 8, folder=cave.folder), plume.StorageError, "another cave"),
        (lambda cave, folder: plume.generate(folder / "nowhere.toml"), plume.MissingFileError, "nowhere.toml"),
        (lambda cave, folder: plume.generate(folder / "file"), plume.RecipeError, "file:1"),
        (lambda cave, folder: plume.generate({"graph.bounds_x_m": 1.0}), plume.InputError, "hint: "),
        (lambda cave, folder: plume.generate({"mesh.chunk_m": [1, 1, 1]}), plume.InputError, "hint: "),
        (lambda cave, folder: plume.open(folder), plume.InputError, "does not contain a cave"),
        (lambda cave, folder: plume.open(folder / "nowhere"), plume.MissingFileError, "nowhere"),
        (lambda cave, folder: plume.Recipe.load(folder / "file"), plume.RecipeError, "file:1"),
        (lambda cave, folder: plume.Recipe(seed=-1), plume.RecipeError, "seed must be at least 0"),
        (lambda cave, folder: plume.Recipe({"graph": 3}), plume.RecipeError, "graph must be a section"),
        (lambda cave, folder: plume.Recipe({"name": "a\nb"}), plume.RecipeError, "name"),
        (lambda cave, folder: plume.Recipe({"world.gravity": float("nan")}), ValueError, "JSON"),
        (lambda cave, folder: plume.Recipe({"world.gravity": object()}), TypeError, "object"),
        (lambda cave, folder: plume.Recipe.preset("mines"), plume.InputError, "did you mean `mine`"),
        (lambda cave, folder: plume.Recipe("cave.toml"), TypeError, "Mapping"),
        (lambda cave, folder: plume.generate(3), TypeError, "int"),
    ],
)
def test_errors(use: Any, kind: type[Exception], text: str, cave: plume.Cave, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("dear diary\n")
    before = hashes(cave.folder)
    with pytest.raises(kind, match=text) as raised:
        use(cave, tmp_path)
    assert "--" not in getattr(raised.value, "hint", "")
    assert hashes(cave.folder) == before and sorted(os.listdir(tmp_path)) == ["file"]


@pytest.mark.parametrize("name", ["nowhere.toml", "nowhere.json", "nowhere.3d", "nowhere"])
@pytest.mark.parametrize("use", [plume.generate, plume.open, plume.Recipe.load, plume.dataset])
def test_a_missing_file_is_one_for_python(use: Any, name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    with pytest.raises(FileNotFoundError) as raised:
        use(path)
    for error in (raised.value, pickle.loads(pickle.dumps(raised.value))):
        assert isinstance(error, plume.StorageError)
        assert (error.errno, error.filename) == (errno.ENOENT, str(path))
        assert str(error).startswith(f"{path}: ")


EXTERNAL = {"graph.generator": "external", "graph.command": [sys.executable, "-c", ""]}


@pytest.mark.parametrize(
    ("use", "hint"),
    [
        (lambda cave, folder: plume.generate(SMALL, 8, folder=cave.folder), "`force=True`"),
        (lambda cave, folder: cave.export("gltf", cave.folder), "`force=True`"),
        (lambda cave, folder: plume.generate(EXTERNAL), "`allow_run=True`"),
        (lambda cave, folder: plume.generate(folder / "leads-out.svx"), "`allow_outside=True`"),
        (lambda cave, folder: plume.generate(folder / "parts.csv"), '`{"graph.parts": "join"}`'),
        (lambda cave, folder: plume.open(folder), "`plume.generate(folder=...)`"),
    ],
)
def test_hints_are_those_of_python(use: Any, hint: str, cave: plume.Cave, tmp_path: Path) -> None:
    (tmp_path / "leads-out.svx").write_text("*include ../elsewhere\n")
    (tmp_path / "parts.csv").write_text("x1,y1,z1,x2,y2,z2\n0,0,0,10,0,0\n0,50,0,10,50,0\n")
    with pytest.raises(plume.PlumeError) as raised:
        use(cave, tmp_path)
    assert hint in raised.value.hint and "--" not in raised.value.hint
    assert raised.value.hint in str(raised.value)


def test_a_missing_library_is_told_before_the_work(tmp_path: Path) -> None:
    program = (
        "import sys, plume; sys.modules['pxr'] = None\n"
        f"with plume.generate({SMALL!r}) as cave:\n"
        "    try: cave.export('isaac', 'package')\n"
        "    except ImportError as error: print(type(error).__name__, error)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=tmp_path)
    assert done.stdout.startswith("MissingPartError") and "hint: pip install" in done.stdout


def test_a_damaged_chunk_is_told(tmp_path: Path) -> None:
    cave = plume.generate(SMALL, SEED, folder=tmp_path / "cave")
    name = cave.chunks.names[0]
    (cave.folder / "textures" / f"{name}.ply").write_bytes(b"ply\n")
    (cave.folder / "textures" / f"{name}_orm.png").write_bytes(b"no image")
    for damaged in [cave, plume.open(cave.folder)]:
        with pytest.raises(plume.StorageError, match=name):
            damaged.chunks[0]
    with pytest.raises(plume.StorageError, match=f"{name}_orm.png"):
        plume.generate(cave.folder)
    textures = plume.generate(cave.folder, force=True).chunks[0].textures
    (cave.folder / "textures" / f"{name}_orm.png").write_bytes(b"no image")
    with pytest.raises(plume.StorageError, match=f"{name}_orm.png"):
        _ = textures.orm


def public() -> list[tuple[str, Any]]:
    """Every public object with its members, by name."""
    found: list[tuple[str, Any]] = [("plume", plume)]
    for name in plume.__all__:
        thing = getattr(plume, name)
        found.append((name, thing))
        if inspect.isclass(thing):
            # Sorted, since the order of properties differs between processes, of which each must collect the same tests.
            members = [(member, value) for member, value in sorted(vars(thing).items()) if not member.startswith("_")]
            found += [(f"{name}.{member}", value) for member, value in members]
    return found


def test_everything_public_is_documented() -> None:
    is_data = {"__version__", "Fault.origin", "Fault.line", "Fault.message", "Fault.hint"}
    bare = [name for name, thing in public() if name not in is_data and not inspect.getdoc(thing)]
    assert bare == []


@pytest.mark.parametrize(
    ("name", "thing"), [(name, thing) for name, thing in public() if ">>>" in (thing.__doc__ or "")]
)
def test_examples_run(name: str, thing: Any, cave: plume.Cave, tmp_path: Path) -> None:
    names = {"plume": plume, "np": np, "cave": cave, "folder": tmp_path}
    example = doctest.DocTestParser().get_doctest(inspect.getdoc(thing) or "", names, name, None, None)
    assert doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example).failed == 0


def test_the_example_program_runs() -> None:
    done = subprocess.run([sys.executable, ROOT / "examples/python/dataset.py"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) == 4
