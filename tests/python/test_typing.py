"""The types of `plume` hold: for a user under mypy --strict, and against the module itself."""

import runpy
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

SAMPLE = """
from pathlib import Path

import numpy as np
import plume
from numpy.typing import NDArray

recipe: plume.Recipe = plume.Recipe({"graph": {"nodes": 20}}, seed=3).replace({"rock.kind": "basalt"})
with plume.generate(recipe, folder=Path("cave"), progress=lambda stage, done, total: print(stage.upper())) as cave:
    first: plume.Chunk = cave.chunks[0]
    several: list[plume.Chunk] = cave.chunks[1:]
    names: list[str] = [chunk.name for chunk in cave.chunks]
    positions: NDArray[np.float32] = first.positions
    image: NDArray[np.uint8] = first.textures.base_color
    poses: NDArray[np.float64] = cave.spawns
    errors_m: list[float] = [lod.error_m for lod in first.lods]
    meshes: list[plume.Mesh] = [first, first.collision, *first.lods]
    opened: str = cave.export("isaac", "package", lights=False).open_with
try:
    plume.Recipe.load("nowhere.toml")
except plume.RecipeError as error:
    lines: list[int | None] = [fault.line for fault in error.faults]
except OSError as missing:
    print(missing)
"""


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> str:
    """One cache for all: NumPy's types take seconds to read."""
    return f"--cache-dir={tmp_path_factory.mktemp('mypy')}"


def mypy(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, cwd=ROOT, check=False)


def test_a_user_is_typed(cache: str, tmp_path: Path) -> None:
    sample = tmp_path / "sample.py"
    sample.write_text(SAMPLE)
    checked = mypy("mypy", "--strict", cache, str(sample))
    assert checked.returncode == 0, checked.stdout


def test_a_wrong_use_is_seen(cache: str, tmp_path: Path) -> None:
    sample = tmp_path / "sample.py"
    sample.write_text(SAMPLE + 'plume.generate(recipe, sed=3)\nrecipe.seed = 4\nplume.targets().append("x")\n')
    checked = mypy("mypy", "--strict", cache, str(sample))
    assert "Found 3 errors" in checked.stdout, checked.stdout


def test_the_stub_is_the_module() -> None:
    checked = mypy("mypy.stubtest", "plume")
    assert checked.returncode == 0, checked.stdout


def test_the_stub_says_what_the_module_says() -> None:
    program = runpy.run_path(str(ROOT / "python" / "document_stub.py"))
    stub = program["STUB"].read_text()
    assert program["documented"](stub) == stub, "run python/document_stub.py"
    assert '"""What a cave is made from' in stub


def test_our_python_is_typed(cache: str) -> None:
    sources = ["python/plume", "python/document_stub.py", "examples/python"]
    checked = mypy("mypy", "--strict", cache, *sources)
    assert checked.returncode == 0, checked.stdout
