"""Ctrl-C stops the work as Python users expect, and leaves complete outputs."""

import hashlib
import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import plume
import pytest

# Some seconds of work on one thread, in several dozen chunks.
RECIPE = {"graph.nodes": 25, "mesh.voxel_m": 0.12, "mesh.chunk_m": [6, 6, 6], "texture.size_px": 256}
SEED = 7
TIMEOUT_S = 60

GENERATE = f"""
import sys, plume
try:
    plume.generate({RECIPE!r}, {SEED}, folder=sys.argv[1], threads=1)
    print("done")
except KeyboardInterrupt:
    print("interrupted", flush=True)
    small = {{"graph.nodes": 4, "texture.size_px": 256}}
    with plume.generate(small) as cave:
        print(len(cave.chunks) > 0)
"""

EXPORT = """
import sys, plume
cave = plume.open(sys.argv[1])
print("ready", flush=True)
try:
    while True:
        cave.export(sys.argv[3], sys.argv[2], force=True)
except KeyboardInterrupt:
    print("interrupted")
print(len(cave.chunks) > 0)
"""

STOPPED_EXPORT = """
import signal, sys, plume
def stop(*_):
    raise KeyboardInterrupt
signal.signal(signal.SIGALRM, stop)
cave = plume.open(sys.argv[1])
try:
    signal.setitimer(signal.ITIMER_REAL, 0.01)
    cave.export("isaac", sys.argv[2])
    print("done")
except KeyboardInterrupt:
    print("interrupted")
"""


def hashes(folder: Path) -> dict[str, str]:
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def start(program: str, *arguments: object) -> subprocess.Popen[str]:
    words = [sys.executable, "-c", program, *map(str, arguments)]
    pipe = subprocess.PIPE
    return subprocess.Popen(words, stdout=pipe, stderr=pipe, text=True, preexec_fn=heed_ctrl_c)


def heed_ctrl_c() -> None:
    """A shell that starts the tests in the background makes them and their children ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def interrupt(process: subprocess.Popen[str]) -> tuple[str, str]:
    assert process.poll() is None, "it ended before it could be interrupted"
    process.send_signal(signal.SIGINT)
    return process.communicate(timeout=TIMEOUT_S)


def wait_for(happened: Callable[[], bool]) -> None:
    deadline = time.monotonic() + TIMEOUT_S
    while not happened():
        assert time.monotonic() < deadline, "it did not happen"
        time.sleep(0.005)


def wait_for_unit(folder: Path, stage: str) -> None:
    """Waits until the journal of the cave has a unit of this stage."""
    journal = folder / "journal.jsonl"
    wait_for(lambda: journal.exists() and f'"stage":"{stage}"' in journal.read_text())


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> plume.Cave:
    return plume.generate(RECIPE, SEED, folder=tmp_path_factory.mktemp("whole") / "cave")


@pytest.mark.parametrize("stage", ["mesh", "texture"])
def test_ctrl_c_stops_a_cave_that_can_be_resumed(stage: str, whole: plume.Cave, tmp_path: Path) -> None:
    folder = tmp_path / "cave"
    process = start(GENERATE, folder)
    wait_for_unit(folder, stage)
    said, faults = interrupt(process)
    assert said.split() == ["interrupted", "True"], faults
    assert not list(folder.rglob(".plume-*")) and not (folder / "manifest.json").exists()
    journal = (folder / "journal.jsonl").read_text().splitlines()
    units = [json.loads(line)["event"]["done"] for line in journal if line]
    records = [record for unit in units for record in unit["files"]]
    for record in records:
        assert hashlib.sha256((folder / record["path"]).read_bytes()).hexdigest() == record["sha256"]
    unfinished = len(hashes(folder)) - 1
    assert unfinished == len(records) < len(hashes(whole.folder)) - 1
    with pytest.raises(plume.InputError, match="not finished"):
        plume.open(folder)
    plume.generate(RECIPE, SEED, folder=folder)
    assert hashes(folder) == hashes(whole.folder)


@pytest.mark.parametrize("target", ["gltf", "isaac"])
def test_ctrl_c_leaves_a_complete_package_or_none(target: str, whole: plume.Cave, tmp_path: Path) -> None:
    process = start(EXPORT, whole.folder, tmp_path / "package", target)
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    wait_for(lambda: any(tmp_path.glob(".plume-*/package")))
    said, faults = interrupt(process)
    assert said.split() == ["interrupted", "True"], faults
    assert [path.name for path in tmp_path.iterdir() if path.name != "package"] == []
    if (tmp_path / "package").exists():
        listed = json.loads((tmp_path / "package" / "manifest.json").read_text())["files"]
        found = hashes(tmp_path / "package")
        del found["manifest.json"]
        assert {path: entry["sha256"] for path, entry in listed.items()} == found


def test_a_signal_stops_an_export(whole: plume.Cave, tmp_path: Path) -> None:
    # The signal comes while USD is loaded, which takes a good part of a second.
    said, faults = start(STOPPED_EXPORT, whole.folder, tmp_path / "package").communicate(timeout=TIMEOUT_S)
    assert said == "interrupted\n", faults
    assert list(tmp_path.iterdir()) == []
