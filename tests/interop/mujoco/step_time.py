"""Measures how long MuJoCo takes for a step of the rover in a cave, against the same rover on a plane.

    step_time.py PACKAGE_DIR

The cave is cut to the chunks that are nearest to the rover, so that the table shows how the time grows with their number. The
rover goes to and fro at its start pose, in every model for as long; of several rounds the fastest counts. Nothing is checked.
"""

import shutil
import tempfile
import time
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
from package import COLLISION_GROUP, name_of, run
from rover import Rover

CUTS = [1, 2, 4, 8]
ROUNDS = 7
STRETCH_S = 0.5  # to, and as long fro
SPEED_M_S = 0.4
PLANE_M = 0.05  # below the start pose, as the ground


def verify(package):
    name = name_of(package)
    whole = mujoco.MjModel.from_xml_path(str(package / f"{name}_rover.xml"))
    start = whole.key(f"{name}_start").qpos[:3]
    frames = ElementTree.parse(package / f"{name}_world.xml").getroot().iter("frame")
    geoms = {frame.get("name"): next(frame.iter("geom")).get("name") for frame in frames}
    chunks = sorted(geoms, key=lambda chunk: distance_m(whole, geoms[chunk], start))

    print(f"{'':12}{'pieces':>8}{'compile s':>11}{'step µs':>9}{'ratio':>7}{'contacts':>10}")
    plane_us = None
    for count in [0, *(count for count in CUTS if count < len(chunks)), len(chunks)]:
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(package, folder, dirs_exist_ok=True)
            cut(Path(folder) / f"{name}_world.xml", chunks[:count], start)
            pieces, compile_s, step_us, contacts = measure(Path(folder), name)
        plane_us = plane_us or step_us
        title = f"{count} chunks" if count else "plane"
        print(
            f"{title:12}{pieces:8}{compile_s:11.2f}{step_us:9.1f}{step_us / plane_us:7.2f}{contacts:10.1f}", flush=True
        )
    return f"steps of {whole.opt.timestep * 1000:g} ms"


def distance_m(model, chunk, start):
    """How far the middle of a chunk is: of its visual mesh, or its first thing."""
    return np.linalg.norm(model.geom(chunk).pos - start)


def cut(world, kept, start):
    """Takes all other chunks out of the cave; a plane takes their place where none is left."""
    tree = ElementTree.parse(world)
    root = tree.getroot()
    for world_body in root.findall("worldbody"):
        for frame in world_body.findall("frame"):
            if frame.get("name") not in kept:
                world_body.remove(frame)
    drop_meshes(root, {geom.get("mesh") for geom in root.iter("geom")})
    if not kept:
        pos = " ".join(map(str, start - [0, 0, PLANE_M]))
        plane = {
            "type": "plane",
            "size": "0 0 1",
            "pos": pos,
            "condim": "3",
            "priority": "1",
            "friction": "0.8 0.005 0.0001",
        }
        ElementTree.SubElement(root.find("worldbody"), "geom", plane)
    tree.write(world)


def drop_meshes(root, used):
    """Takes out the meshes that no geom is of."""
    for assets in root.findall("asset"):
        for mesh in [mesh for mesh in assets.findall("mesh") if mesh.get("name") not in used]:
            assets.remove(mesh)


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
