"""A small cave, made once."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import plume
import pytest

SMALL = {"graph": {"nodes": 12}, "mesh": {"voxel_m": 0.25, "chunk_m": [12, 12, 12]}, "texture": {"size_px": 256}}
SEED = 7


@pytest.fixture(scope="session")
def cave(tmp_path_factory: pytest.TempPathFactory) -> Iterator[plume.Cave]:
    with plume.generate(SMALL, SEED, folder=tmp_path_factory.mktemp("cave") / "cave") as cave:
        yield cave


@pytest.fixture(scope="session")
def binary():
    """The plain binary of this tree; `cargo xtask` names it."""
    program = Path(os.environ.get("PLUME_BINARY", Path(__file__).parents[2] / "target/release/plume"))
    if not program.exists():
        pytest.fail("build the binary first: cargo build --release")
    return program


@pytest.fixture(scope="session")
def packages(tmp_path_factory):
    """Folder of the packages `isaac`, `usd` and `usdz` of one small cave."""
    folder = tmp_path_factory.mktemp("packages")
    arguments = ["export", "--target", "isaac,usd,usdz", "--output", str(folder), "--quiet"]
    # Every stone costs the validators, too; packages with all of them are opened by the interop checks.
    small = ["--set", "graph.nodes=4", "--set", "texture.size_px=256", "--set", "things.cover=0.005"]
    subprocess.run([sys.executable, "-m", "plume", *arguments, *small], check=True)
    return folder


@pytest.fixture(scope="session")
def pieces(tmp_path_factory):
    """Folder of the package `isaac` of a tiny cave whose collision is convex pieces, and of the `cave` itself."""
    folder = tmp_path_factory.mktemp("pieces")
    places = ["--output", str(folder / "isaac"), "--keep", str(folder / "cave")]
    arguments = ["export", "--target", "isaac", *places, "--option", "isaac.collision=pieces", "--quiet"]
    # Every piece costs the validators some hundredths of a second.
    tiny = [
        "graph.nodes=4",
        "mesh.voxel_m=0.5",
        "mesh.chunk_m=[10, 10, 10]",
        "texture.size_px=256",
        "things.cover=0.01",
    ]
    settings = [word for setting in tiny for word in ("--set", setting)]
    subprocess.run([sys.executable, "-m", "plume", *arguments, *settings], check=True)
    return folder
