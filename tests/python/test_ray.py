"""Ray clusters make the bytes that one process makes, also when workers and machines die."""

import os
import signal
import subprocess
import sys
import threading
import time
from hashlib import sha256
from pathlib import Path

import plume
import plume.ray
import pytest

ray = pytest.importorskip("ray")
from ray.cluster_utils import Cluster  # noqa: E402

CAVE = {
    "graph": {"nodes": 8},
    "mesh": {"voxel_m": 0.4, "chunk_m": [12, 12, 12]},
    "texture": {"size_px": 256},
}
SPEC = """
name = "four"
seeds = [1, 4]
targets = ["mujoco"]
recipe = "own.toml"
sheet = 2
"""
RECIPE = """
graph.nodes = 4
mesh.voxel_m = 0.5
texture.size_px = 256
"""


@pytest.fixture(scope="module")
def cluster():
    """Two machines, as far as Ray can tell."""
    quick = {"health_check_initial_delay_ms": 0, "health_check_period_ms": 200, "health_check_failure_threshold": 3}
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "_system_config": quick})
    cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address, log_to_driver=False)
    yield cluster
    ray.shutdown()
    cluster.shutdown()


def test_a_large_cave_is_the_same(cluster, tmp_path):
    recipe = plume.Recipe(CAVE, seed=3)
    with plume.generate(recipe, folder=tmp_path / "alone") as cave:
        assert len(cave.chunks) > 3
        cave.export("mujoco", tmp_path / "alone-mujoco")
    with Killer("ray::_make_chunks") as killer:
        cave = plume.ray.generate(recipe, folder=tmp_path / "shared", pieces=True, chunks_per_task=2)
    assert killer.has_killed
    assert not (tmp_path / "shared-parts").exists()
    assert sums(tmp_path / "shared") == sums(tmp_path / "alone")
    # All of it was made by tasks: what stays is to draw the maps and to put the parts together.
    cave.export("mujoco", tmp_path / "shared-mujoco")
    assert sums(tmp_path / "shared-mujoco") == sums(tmp_path / "alone-mujoco")


def test_what_was_made_is_not_made_again(cluster, tmp_path):
    recipe = plume.Recipe(CAVE, seed=3)

    def interrupt(stage, done, total):
        if stage == "texture" and done > 0:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        plume.ray.generate(recipe, folder=tmp_path / "cave", chunks_per_task=2, progress=interrupt)
    parts = sorted((tmp_path / "cave-parts").glob("mesh-*"))
    made = {part: part.stat().st_mtime_ns for part in parts}
    seen = []

    def watch(stage, done, total):
        seen.append((stage, done))
        if stage == "texture" and done > 0:
            assert made == {part: part.stat().st_mtime_ns for part in parts}

    plume.ray.generate(recipe, folder=tmp_path / "cave", chunks_per_task=2, progress=watch).close()
    assert ("texture", 2) in seen


def test_parts_of_another_cave_are_removed(cluster, tmp_path):
    parts = tmp_path / "cave-parts"
    plume.make_chunks(plume.Recipe(CAVE, seed=4), range(2), parts / "mesh-0-1", stages=["mesh"])
    (parts / "mine").mkdir()
    (parts / "mine/note.txt").write_text("mine")
    with plume.ray.generate(plume.Recipe(CAVE, seed=3), folder=tmp_path / "cave", chunks_per_task=2) as cave:
        assert cave.recipe.seed == 3
    assert [path.name for path in parts.iterdir()] == ["mine"]
    assert (parts / "mine/note.txt").read_text() == "mine"


def test_a_dataset_is_the_same_although_a_machine_dies(cluster, tmp_path):
    (tmp_path / "own.toml").write_text(RECIPE, encoding="utf-8")
    spec = tmp_path / "four.toml"
    spec.write_text(SPEC, encoding="utf-8")
    plume.dataset(spec, tmp_path / "alone", workers=1)
    machine = cluster.add_node(num_cpus=1)
    cluster.wait_for_nodes()

    def pull_the_plug(stage, done, total):
        if done == 1 and machine in cluster.list_all_nodes():
            cluster.remove_node(machine, allow_graceful=False)

    made = plume.ray.dataset(spec, tmp_path / "shared", progress=pull_the_plug)
    assert machine not in cluster.list_all_nodes()
    assert made.failed == {} and len(made.caves) == 4
    assert sums(tmp_path / "shared") == sums(tmp_path / "alone")


def test_a_task_that_keeps_dying_is_told(cluster, tmp_path, monkeypatch):
    monkeypatch.setattr(plume.ray, "ATTEMPTS", 1)
    with Killer("ray::_make_chunks"), pytest.raises(plume.PlumeError, match="mesh of chunks .*: 1 workers died of it"):
        plume.ray.generate(plume.Recipe(CAVE, seed=5), folder=tmp_path / "cave", chunks_per_task=2)


def test_a_faulty_cave_is_left_out(cluster, tmp_path):
    spec = tmp_path / "faulty.toml"
    spec.write_text('seeds = [1, 1]\nsheet = 0\nset = ["output.max_gb=0.001"]', encoding="utf-8")
    alone = plume.dataset(spec, tmp_path / "alone", workers=1)
    assert len(alone.failed) == 1
    assert plume.ray.dataset(spec, tmp_path / "shared").failed == alone.failed


def test_the_command_starts_a_cluster_of_this_machine(tmp_path):
    (tmp_path / "own.toml").write_text(RECIPE, encoding="utf-8")
    (tmp_path / "four.toml").write_text(SPEC.replace("[1, 4]", "[1, 2]"), encoding="utf-8")
    command = [sys.executable, "-m", "plume", "dataset", "four.toml", "--engine", "ray", "--quiet"]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=300)
    subprocess.run([sys.executable, "-m", "plume", "check", "four"], cwd=tmp_path, check=True)


class Killer:
    """Kills the first process with this title."""

    def __init__(self, title: str) -> None:
        self.title = title
        self.has_killed = False
        self.is_over = threading.Event()
        self.thread = threading.Thread(target=self.watch)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.is_over.set()
        self.thread.join()

    def watch(self) -> None:
        while not self.is_over.is_set() and not self.has_killed:
            for process in Path("/proc").glob("[0-9]*"):
                if self.titled(process):
                    os.kill(int(process.name), signal.SIGKILL)
                    self.has_killed = True
                    return
            time.sleep(0.01)

    def titled(self, process: Path) -> bool:
        try:
            return (process / "cmdline").read_bytes().decode(errors="replace").startswith(self.title)
        except OSError:
            return False


def sums(folder: Path) -> dict[str, str]:
    """SHA-256 of all files but those that differ from run to run."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.name not in ("costs.csv", "dataset.lock"))
    return {str(path.relative_to(folder)): sha256(path.read_bytes()).hexdigest() for path in files}
