"""The checks of ground truth: a good package passes, and each fault is noticed."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

sys.path.append(str(Path(__file__).parents[1] / "interop/truth"))

import check  # noqa: E402 - the check itself

SMALL = ["--set", "graph.nodes=4", "--set", "texture.size_px=256", "--option", "truth.cell_m=0.1"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The packages `ply` and `truth` of one small cave."""
    folder = tmp_path_factory.mktemp("truth")
    export = ["export", "--target", "ply,truth", "--output", str(folder), "--quiet", *SMALL]
    subprocess.run([sys.executable, "-m", "plume", *export], check=True)
    return folder


def test_a_good_package_passes(folder):
    assert "ground truth" in check.verify(folder / "truth")


def in_arrays(change):
    """A change of the arrays of the floor."""

    def edited(package):
        arrays = dict(np.load(package / "floor.npz"))
        change(arrays)
        np.savez(package / "floor.npz", **arrays)

    return edited


def raise_floor(arrays):
    arrays["z"] += np.float32(0.01)


def lower_ceiling(arrays):
    arrays["headroom"] *= np.float32(0.9)


def forget_cells(arrays):
    for name in set(arrays) - {"cell_m"}:
        arrays[name] = arrays[name][::2]


def tip(arrays):
    arrays["slope"] += np.float32(0.01)


def roughen(arrays):
    arrays["roughness"] += np.float32(0.01)


def step_up(arrays):
    arrays["step"] += np.float32(0.01)


def fence_off(arrays):
    reached = arrays["storey"] >= 0
    arrays["storey"][reached & (arrays["cell"][:, 0] > np.median(arrays["cell"][reached, 0]))] = -1


def join_storeys(arrays):
    arrays["storey"][:] = 0


def in_image(change):
    def edited(package):
        grey = np.asarray(Image.open(package / "map_0.png")).copy()
        Image.fromarray(np.ascontiguousarray(change(grey))).save(package / "map_0.png")

    return edited


def draw_far_off(grey):
    grey[0, 0] = 0
    return grey


def move_origin(package):
    path = package / "map_0.yaml"
    text = path.read_text(encoding="utf-8")
    origin = check.yaml.safe_load(text)["origin"]
    path.write_text(text.replace(str(origin[0]), str(origin[0] + 0.1)), encoding="utf-8")


def free_the_unknown(package):
    path = package / "map_0.yaml"
    path.write_text(path.read_text(encoding="utf-8").replace("0.196", "0.25"), encoding="utf-8")


def tell_another_height(package):
    path = package / "storeys.json"
    told = json.loads(path.read_text(encoding="utf-8"))
    told["storeys"][0]["floor_m"][0] -= 1
    path.write_text(json.dumps(told), encoding="utf-8")


FAULTS = {
    "a floor too high": (in_arrays(raise_floor), "columns are not what rays meet"),
    "a ceiling too low": (in_arrays(lower_ceiling), "columns are not what rays meet"),
    "every other cell": (in_arrays(forget_cells), "columns are not what rays meet"),
    "another slope": (in_arrays(tip), "the slope at"),
    "another roughness": (in_arrays(roughen), "m rough"),
    "another step": (in_arrays(step_up), "the step at"),
    "a part left out": (in_arrays(fence_off), "can leave a storey"),
    "storeys as one": (in_arrays(join_storeys), "storey 0 is"),
    "an image upside down": (in_image(lambda grey: grey[::-1]), "are free on one side only"),
    "an image in a mirror": (in_image(lambda grey: grey[:, ::-1]), "are free on one side only"),
    "a wall far off": (in_image(draw_far_off), "m from the floor"),
    "no walls": (in_image(lambda grey: np.where(grey == 0, np.uint8(205), grey)), "beside the floor is not occupied"),
    "another origin": (move_origin, "are free on one side only"),
    "a threshold that frees the unknown": (free_the_unknown, "are free on one side only"),
    "another height": (tell_another_height, r"yaml is at "),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_package_fails(fault, folder, tmp_path):
    change, message = FAULTS[fault]
    for target in ("ply", "truth"):
        shutil.copytree(folder / target, tmp_path / target)
    change(tmp_path / "truth")
    with pytest.raises(check.Failure, match=message):
        check.verify(tmp_path / "truth")
