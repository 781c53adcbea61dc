"""The checks that hold certificates to a Husky and a drone: true ones pass, and false ones are noticed."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

DRIVES = Path(__file__).parents[1] / "interop/drives"
SMALL = ["--set", "graph.nodes=5", "--set", "texture.size_px=256"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A Gazebo package, the cave that it was made from, and what is said of both robots."""
    folder = tmp_path_factory.mktemp("drives")
    export = ["export", "--target", "gazebo", "-o", str(folder / "package"), "--keep", str(folder / "cave"), *SMALL]
    plume(*export, "--quiet")
    for robot in ("husky", "drone"):
        plume("certify", str(folder / "cave"), "--robot", robot, "-o", str(folder / f"{robot}.json"), "--quiet")
    return folder


def plume(*arguments):
    subprocess.run([sys.executable, "-m", "plume", *arguments], check=True)


def drive(folder, certificate):
    inputs = [folder / "package", certificate, folder / "cave/graph.json"]
    return said(DRIVES / "drives.py", "--passages", "1", "husky", "sample", *inputs)


def fly(folder, certificate):
    return said(DRIVES / "drone.py", folder / "package", certificate)


def said(*command):
    result = subprocess.run([sys.executable, *map(str, command)], capture_output=True, text=True)
    return result.returncode, result.stdout + result.stderr


def test_true_certificates_pass(folder):
    assert drive(folder, folder / "husky.json")[0] == 0
    assert fly(folder, folder / "drone.json")[0] == 0


def changed(folder, robot, tmp_path, change):
    """A copy of a certificate with every path of it changed, pose by pose."""
    certificate = json.loads((folder / f"{robot}.json").read_text(encoding="utf-8"))
    verdicts = [passage[way] for passage in certificate["passages"] for way in ("there", "back")]
    for one in [certificate["route"], *verdicts]:
        one["path"] = [change(*pose) for pose in one["path"]]
    copy = tmp_path / f"{robot}.json"
    copy.write_text(json.dumps(certificate), encoding="utf-8")
    return copy


def test_a_husky_that_is_sent_into_rock_is_noticed(folder, tmp_path):
    code, words = drive(folder, changed(folder, "husky", tmp_path, lambda x, y, *rest: [3 * x, 3 * y, *rest]))
    assert code == 1 and " after " in words, words


def test_a_drone_that_comes_too_near_is_noticed(folder, tmp_path):
    code, words = fly(folder, changed(folder, "drone", tmp_path, lambda x, y, z, *rest: [x, y, z + 0.4, *rest]))
    assert code == 1 and "nearer to rock" in words, words
