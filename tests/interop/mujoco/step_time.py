"""Measures how long MuJoCo takes for a step of the rover in a cave, against the same rover on a plane.

    step_time.py PACKAGE_DIR

The cave is cut to the chunks that are nearest to the rover, so that the table shows how the time grows with their number. The
rover goes to and fro at its start pose, in every model for as long; of several rounds the fastest counts. Nothing is checked.
"""

import json
import shutil
import tempfile
import time
from pathlib import Path

import mujoco
import numpy as np
from package import COLLISION_GROUP, name_of, run
from rover import Rover

CUTS = [2, 4, 8]  # one chunk may end below a wheel
ROUNDS = 30
STRETCH_S = 0.5  # to, and as long fro
SPEED_M_S = 0.4
PLANE_M = 0.05  # below the start pose, as the ground
PLANE = """<worldbody>
  <geom type="plane" size="0 0 1" pos="{} {} {}" condim="3" priority="1" friction="0.8 0.005 0.0001"/>
</worldbody>"""


def verify(package):
    name = name_of(package)
    whole = mujoco.MjModel.from_xml_path(str(package / f"{name}_rover.xml"))
    start = whole.key(f"{name}_start").qpos[:3]
    index = json.loads((package / "chunks.json").read_text())
    chunks = by_place(index["chunks"], start)
    counts = [0, *(count for count in CUTS if count < len(chunks)), len(chunks)]
    cuts = [Cut(package, name, index["shared"], chunks[:count], start) for count in counts]
    # In turn, because the speed of a machine that has other work changes.
    for _ in range(ROUNDS):
        for cut in cuts:
            cut.drive()

    print(f"{'':12}{'geoms':>8}{'pieces':>8}{'compile s':>11}{'step µs':>9}{'ratio':>7}{'contacts':>10}")
    for cut, count in zip(cuts, counts, strict=True):
        title = f"{count} chunks" if count else "plane"
        ratio = cut.step_us / cuts[0].step_us
        numbers = (
            f"{cut.model.ngeom:8}{cut.pieces:8}{cut.compile_s:11.2f}{cut.step_us:9.1f}{ratio:7.2f}{cut.contacts:10.1f}"
        )
        print(title.ljust(12) + numbers)
    return f"steps of {whole.opt.timestep * 1000:g} ms"


class Cut:
    """A model of some of the chunks, or of a plane, and how long the rover's steps in it take."""

    def __init__(self, package, name, shared, chunks, start):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(package, folder, dirs_exist_ok=True)
            plane = "" if chunks else PLANE.format(*start[:2], start[2] - PLANE_M)
            write_world(Path(folder) / f"{name}_world.xml", [shared, *sum(chunks, [])], plane)
            began_s = time.perf_counter()
            self.model = mujoco.MjModel.from_xml_path(str(Path(folder) / f"{name}_rover.xml"))
            self.compile_s = time.perf_counter() - began_s
        # The plane is not a piece.
        is_mesh = self.model.geom_type == mujoco.mjtGeom.mjGEOM_MESH
        self.pieces = np.sum((self.model.geom_group == COLLISION_GROUP) & is_mesh)
        self.rover = Rover(self.model, name)
        self.rover.run(1.0)
        self.step_us, self.counted = np.inf, []

    def drive(self):
        began_s = time.perf_counter()
        for speed_m_s in [SPEED_M_S, -SPEED_M_S]:
            self.rover.steer(speed_m_s, 0)
            self.rover.run(STRETCH_S)
            self.counted.append(self.rover.data.ncon)
        steps = round(2 * STRETCH_S / self.model.opt.timestep)
        self.step_us = min(self.step_us, (time.perf_counter() - began_s) / steps * 1e6)

    @property
    def contacts(self):
        return np.mean(self.counted)


def by_place(chunks, point):
    """Files of wall, things and gravel of each place in the grid, by the distance of the wall from a point."""
    places = {}
    for chunk in chunks:
        content, place = Path(chunk["file"]).stem.split("_", 1)
        places.setdefault(place, {})[content] = chunk
    near = sorted(places.values(), key=lambda place: distance_m(place["chunk"]["bounds_m"], point))
    return [[chunk["file"] for chunk in place.values()] for place in near]


def distance_m(bounds_m, point):
    """How far a box is from a point; 0 in it."""
    low, high = np.array(bounds_m)
    return np.linalg.norm(np.maximum(0.0, np.maximum(low - point, point - high)))


def write_world(file, included, elements):
    """A cave of some of the files of a package."""
    includes = "".join(f'<include file="{path}"/>' for path in included)
    file.write_text(f"<mujoco>{includes}{elements}</mujoco>")


if __name__ == "__main__":
    run(verify)
