"""Lets go of every loose stone of an exported Gazebo package under Bullet.

    rest_pybullet.py PACKAGE_DIR

The walls are the triangles that cameras see; each stone is the convex body in its collision mesh, raised by the depth to which it
was sunk into the ground. After a second of gravity, 95 of 100 stones must have moved by less than a tenth of their width, at most
one of 100 by more than half of it, and none may be lost. The last line of a success tells how many there were.
"""

import json
import sys
from pathlib import Path

import numpy as np
import pybullet as p
from drop_pybullet import connected, require

DURATION_S = 1.0
STEP_S = 1 / 240
FRICTION = 0.8
STILL = 0.1  # of the width
GONE = 0.5
LEAST_STILL = 0.95
MOST_GONE = 0.01
LOST_M = 5.0
LOOSE = {"boulder", "slab", "lining_slab", "ropy_slab", "cobble", "pebble"}
MARGIN_M = 0.0005


def main(package):
    meshes = next((package / "models").glob("*/meshes"))
    if not any(meshes.glob("things_*_collision.obj")):
        print("Bullet: no things, or in convex pieces only")
        return
    listed = json.loads((package / "instances.json").read_text(encoding="utf-8"))["things"]
    # Those that move are models of their own, on the ground instead of in it.
    things = [thing for thing in listed if not thing["movable"]]
    with connected():
        p.setGravity(0, 0, -9.81)
        p.setPhysicsEngineParameter(fixedTimeStep=STEP_S, enableSAT=1)
        for file in sorted(meshes.glob("chunk_*.obj")):
            if not file.stem.endswith("_collision"):
                wall = p.createCollisionShape(p.GEOM_MESH, fileName=str(file), flags=p.GEOM_FORCE_CONCAVE_TRIMESH)
                held(p.createMultiBody(0, wall))
        stones = [stone for chunk in chunks_of(things) for stone in let_go(meshes, chunk, things)]
        for _ in range(round(DURATION_S / STEP_S)):
            p.stepSimulation()
        moved = np.array(
            [np.linalg.norm(np.array(p.getBasePositionAndOrientation(body)[0]) - start) for body, start, _ in stones]
        )
    widths = np.array([width for *_, width in stones])
    still, gone, lost = (moved < STILL * widths).mean(), (moved > GONE * widths).mean(), (moved > LOST_M).sum()
    said = f"{len(stones)} stones: {still:.1%} stay, {gone:.2%} roll, {lost} lost, half move less than {np.median(moved) * 1000:.1f} mm"
    require(
        len(stones) == sum(thing["class"] in LOOSE for thing in things),
        f"{len(stones)} bodies for {len(things)} things",
    )
    require(still >= LEAST_STILL and gone <= MOST_GONE and lost == 0, said)
    print(f"Bullet, {said}")


def chunks_of(things):
    return sorted({thing["chunk"] for thing in things})


def let_go(meshes, chunk, things):
    """A body for each loose stone of a chunk, with where it starts and how wide it is."""
    own = [thing for thing in things if thing["chunk"] == chunk]
    vertices, solids = solids_of(meshes / f"{chunk}_collision.obj")
    require(len(solids) == len(own), f"{chunk} has {len(solids)} solids for {len(own)} things")
    for thing, solid in zip(own, solids, strict=True):
        if thing["class"] not in LOOSE:
            continue
        corners = vertices[solid]
        centre_of_mass = np.array(thing["position"])
        shape = p.createCollisionShape(p.GEOM_MESH, vertices=(corners - centre_of_mass).tolist())
        start = centre_of_mass + [0, 0, thing["embedding_m"]]
        body = p.createMultiBody(thing["mass_kg"], shape, basePosition=start.tolist())
        held(body)
        yield body, start, np.ptp(corners, axis=0)[:2].mean()


def held(body):
    p.changeDynamics(body, -1, lateralFriction=FRICTION, collisionMargin=MARGIN_M)


def solids_of(file):
    """The vertices of a file, and which of them each connected solid has, in the order of the file."""
    lines = file.read_text(encoding="utf-8").splitlines()
    vertices = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], dtype=float)
    faces = [[int(corner.split("/")[0]) - 1 for corner in line.split()[1:]] for line in lines if line.startswith("f ")]
    lowest = list(range(len(vertices)))

    def find(vertex):
        while lowest[vertex] != vertex:
            lowest[vertex] = vertex = lowest[lowest[vertex]]
        return vertex

    for face in faces:
        roots = [find(corner) for corner in face]
        for root in roots:
            lowest[root] = min(roots)
    roots = np.array([find(vertex) for vertex in range(len(vertices))])
    return vertices, [np.flatnonzero(roots == root) for root in np.unique(roots)]


if __name__ == "__main__":
    require(len(sys.argv) == 2, "usage: rest_pybullet.py PACKAGE_DIR")
    main(Path(sys.argv[1]))
