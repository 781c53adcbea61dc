"""The checks of recordings: a good one passes, and each fault is noticed."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from messages import in_messages
from PIL import Image
from scipy.spatial.transform import Rotation

CHECKS = Path(__file__).parents[1] / "interop/record"
sys.path.append(str(CHECKS))

import check_recording  # noqa: E402 - the check itself

SMALL = ["--set", "graph.nodes=4", "--set", "texture.size_px=256"]


def path_from(pose):
    """Eight poses in 1.4 s from half a metre over a start pose: ahead, with a bend, and a nod that wheels do not feel."""
    place, turn = np.array(pose["position"]), Rotation.from_quat(np.roll(pose["orientation_wxyz"], -1))
    lines = []
    for number in range(8):
        s = number * 0.2
        at = place + turn.apply([0.5 * s, 0.05 * s * s, 0.5])
        i, j, k, w = (turn * Rotation.from_euler("ZYX", [0.2 * s, 0.03 * np.sin(4 * s), 0])).as_quat()
        lines.append(f"{1000 + s:.6f} {at[0]} {at[1]} {at[2]} {i} {j} {k} {w}\n")
    return "".join(lines)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A recording in all layouts, and the package `ply` of the same small cave."""
    folder = tmp_path_factory.mktemp("record")
    cave, ply, poses = folder / "cave", folder / "ply", folder / "path.tum"

    def plume(*arguments):
        subprocess.run([sys.executable, "-m", "plume", *map(str, arguments), "--quiet"], check=True)

    plume("export", "--target", "ply", "--output", ply, "--keep", cave, *SMALL)
    manifest = json.loads((ply / "manifest.json").read_text(encoding="utf-8"))
    poses.write_text(path_from(manifest["spawns"][0]), encoding="utf-8")
    rig, layouts = CHECKS / "rig.toml", "tum,euroc,kitti,mcap"
    plume("record", cave, "--path", poses, "--rig", rig, "--layout", layouts, "--output", folder / "recording")
    return folder


@pytest.fixture(scope="module")
def world(folder):
    return check_recording.World(folder / "ply")


def test_a_good_recording_passes(folder, world):
    assert "recording" in check_recording.verify(folder / "recording", world)


def in_images(pattern, change):
    """A change of all images that a pattern finds."""

    def edited(recording):
        for path in recording.glob(pattern):
            pixels = np.asarray(Image.open(path))
            Image.fromarray(change(pixels).astype(pixels.dtype)).save(path)

    return edited


def in_rows(path, change, separator=" "):
    """A change of the numbers in the lines of a text that do not begin with a comment."""

    def edited(recording):
        lines = (recording / path).read_text(encoding="utf-8").splitlines()
        rows = np.array([line.split(separator) for line in lines if line[0] != "#"])
        numbers = change(rows.astype(float))
        texts = [
            separator.join([row[0], *map(repr, map(float, told[1:]))]) for row, told in zip(rows, numbers, strict=True)
        ]
        (recording / path).write_text(
            "\n".join([*(line for line in lines if line[0] == "#"), *texts]), encoding="utf-8"
        )

    return edited


def in_text(path, old, new):
    def edited(recording):
        text = (recording / path).read_text(encoding="utf-8")
        assert old in text
        (recording / path).write_text(text.replace(old, new), encoding="utf-8")

    return edited


def swap(path, *others):
    """Each file has the content of the next."""

    def edited(recording):
        paths = [recording / name for name in (path, *others)]
        contents = [path.read_bytes() for path in paths]
        for path_, content in zip(paths, contents[1:] + contents[:1], strict=True):
            path_.write_bytes(content)

    return edited


def still(recording):
    """A lidar that tells the same time for all points."""
    for path in recording.glob("tum/lidar0/*.pcd"):
        head, body = path.read_bytes().split(b"DATA binary\n", 1)
        rows = np.frombuffer(body, np.uint8).reshape(-1, 22).copy()
        rows[:, 18:] = 0
        path.write_bytes(head + b"DATA binary\n" + rows.tobytes())


def columns(*order):
    return lambda rows: rows[:, order]


RECORDING = "mcap/recording.mcap"
STATES = "euroc/mav0/state_groundtruth_estimate0/data.csv"


def with_other_doubles(topic, change):
    """The last 24 numbers of a message, as doubles."""

    def changed(name, data):
        if name != topic:
            return data
        numbers = np.frombuffer(data[-24 * 8 :]).copy()
        return data[: -24 * 8] + change(numbers).tobytes()

    return in_messages(RECORDING, changed)


FAULTS = {
    "depth in millimetres": in_images("tum/depth/*.png", lambda pixels: pixels // 5),
    "depth of a thousandth more": in_images("tum/depth/*.png", lambda pixels: pixels * 1.001),
    "depth a pixel aside": in_images("tum/depth/*.png", lambda pixels: np.roll(pixels, 1, axis=1)),
    "depth upside down": in_images("tum/depth/*.png", lambda pixels: pixels[::-1]),
    "another depth in KITTI": in_images("kitti/sequences/00/image_2_depth/000003.png", lambda pixels: pixels + 2),
    "floor and wall exchanged": in_images("tum/label/*.png", lambda pixels: np.where(pixels < 3, 3 - pixels, pixels)),
    "dark images": in_images("tum/rgb/*.png", lambda pixels: pixels // 4),
    "another image in EuRoC": in_images("euroc/mav0/cam0/data/*.png", lambda pixels: pixels[:, ::-1]),
    "left and right exchanged": in_text("kitti/sequences/00/calib.txt", "e1 -", "e1 "),
    "normals of another frame": swap("tum/normal/1000.000000.png", "tum/normal/1001.400000.png"),
    "flow that is none": swap("tum/flow/1000.000000.png", "tum/normal/1000.200000.png"),
    "quaternions that begin with w": in_rows("tum/groundtruth.txt", columns(0, 1, 2, 3, 7, 4, 5, 6)),
    "a path an inch beside": in_rows("tum/groundtruth.txt", lambda rows: rows + [0, 0.0254, 0, 0, 0, 0, 0, 0]),
    "a principal point half a pixel aside": in_text("tum/orbslam3.yaml", "Camera1.cx: 79.5", "Camera1.cx: 80.0"),
    "states with w last": in_rows(STATES, columns(0, 1, 2, 3, 5, 6, 7, 4, *range(8, 17)), ","),
    "one image less": in_text(
        "tum/associations.txt", "1001.400000 rgb/1001.400000.png 1001.400000 depth/1001.400000.png", ""
    ),
    "an IMU without gravity": in_rows("euroc/mav0/imu0/data.csv", lambda rows: rows - [0, 0, 0, 0, 0, 0, 9.81], ","),
    "an IMU in degrees": in_rows("euroc/mav0/imu0/data.csv", lambda rows: rows * [1, 57.3, 57.3, 57.3, 1, 1, 1], ","),
    "an IMU message without gravity": with_other_doubles("/imu", lambda numbers: numbers - np.eye(24)[14] * 9.81),
    "an image message that is dark": in_messages(
        RECORDING, lambda topic, data: data[:-30000] + bytes(30000) if topic == "/left/image_raw" else data
    ),
    "a lidar that stands still": still,
    "scans in another order": swap("kitti/sequences/00/velodyne/000000.bin", "kitti/sequences/00/velodyne/000001.bin"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_noticed(folder, world, fault, tmp_path):
    bad = tmp_path / "recording"
    shutil.copytree(folder / "recording", bad)
    FAULTS[fault](bad)
    with pytest.raises(Exception) as raised:
        check_recording.verify(bad, world)
    assert isinstance(raised.value, check_recording.Failure), raised.value
