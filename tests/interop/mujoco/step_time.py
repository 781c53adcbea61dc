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

CUTS = [1, 2, 4, 8]
ROUNDS = 7
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

    print(f"{'':12}{'pieces':>8}{'compile s':>11}{'step µs':>9}{'ratio':>7}{'contacts':>10}")
    plane_us = None
    for count in [0, *(count for count in CUTS if count < len(chunks)), len(chunks)]:
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(package, folder, dirs_exist_ok=True)
            files = [index["shared"], *(file for chunk in chunks[:count] for file in chunk)]
            plane = "" if count else PLANE.format(*start[:2], start[2] - PLANE_M)
            write_world(Path(folder) / f"{name}_world.xml", files, plane)
            pieces, compile_s, step_us, contacts = measure(Path(folder), name)
        plane_us = plane_us or step_us
        title = f"{count} chunks" if count else "plane"
        print(
            f"{title:12}{pieces:8}{compile_s:11.2f}{step_us:9.1f}{step_us / plane_us:7.2f}{contacts:10.1f}", flush=True
        )
    return f"steps of {whole.opt.timestep * 1000:g} ms"


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


def measure(package, name):
    """Number of pieces, time to compile and to step, mean number of contacts."""
    began_s = time.perf_counter()
    model = mujoco.MjModel.from_xml_path(str(package / f"{name}_rover.xml"))
    compile_s = time.perf_counter() - began_s
    rover = Rover(model, name)
    rover.run(1.0)
    steps, contacts, fastest_s = round(2 * STRETCH_S / model.opt.timestep), [], np.inf
    for _ in range(ROUNDS):
        began_s = time.perf_counter()
        for speed_m_s in [SPEED_M_S, -SPEED_M_S]:
            rover.steer(speed_m_s, 0)
            rover.run(STRETCH_S)
            contacts.append(rover.data.ncon)
        fastest_s = min(fastest_s, time.perf_counter() - began_s)
    # The plane is not a piece.
    pieces = np.sum((model.geom_group == COLLISION_GROUP) & (model.geom_type == mujoco.mjtGeom.mjGEOM_MESH))
    return pieces, compile_s, fastest_s / steps * 1e6, np.mean(contacts)


if __name__ == "__main__":
    run(verify)
