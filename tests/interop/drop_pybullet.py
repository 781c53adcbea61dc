"""Drops a ball into an exported Gazebo package under Bullet.

    drop_pybullet.py PACKAGE_DIR

Bullet knows nothing of our exporter: it loads the collision meshes that the model names as exact triangles, and meshes
made of convex pieces once more as a hull of each piece. From each spawn pose of the model the ball must fall onto the
floor and stay, and rays in all directions must hit rock.
The last line of a success gives the heights of the ball and of the floor under it at the first pose.
"""

import contextlib
import math
import os
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pybullet as p

BALL_RADIUS_M = 0.2
INERTIA_KG_M2 = 10.0  # 600 times that of a ball: it slides to a stop instead of rolling down every slope
DROP_M = 0.6  # height of the ball's centre over the spawn pose
DURATION_S = 4.0
STEP_S = 1 / 480  # a 0.2 m ball moves less than a tenth of its radius in a step
REST_SPEED_M_S = 0.05
PENETRATION_M = 0.03
GROUND_M = 0.15
RAYS = 400
RAY_LENGTH_M = 1000.0
AWAY_M = 2.0  # the ball may slide a little, but not leave the place


def main(package):
    world, model = read_world(package)
    collisions = read_collisions(model, package)
    print(f"Bullet: {verify(world, model, collisions, p.GEOM_FORCE_CONCAVE_TRIMESH)}")
    hulls = [count_objects(file) for file, _ in collisions]
    if max(hulls) > 1:
        # Left to itself, Bullet makes a hull of each object of a file.
        print(f"Bullet, on {sum(hulls)} hulls: {verify(world, model, collisions, 0)}")


def verify(world, model, collisions, flags):
    with connected():
        load_collisions(collisions, flags)
        for number, spawn in enumerate(spawn_points(model)):
            check_closed(spawn, number)
            check_grounded(spawn, number)
            floor_z, ball = drop_ball(spawn, number, gravity(world))
            if number == 0:
                first = (floor_z, ball)
    floor_z, ball = first
    return f"{number + 1} spawn poses closed in and firm, ball_z_m {ball[2]:.4f} floor_z_m {floor_z:.4f}"


def read_world(package):
    """The world element and the model element it includes."""
    worlds = sorted((package / "worlds").glob("*.sdf"))
    require(len(worlds) == 1, f"expected one world in {package / 'worlds'}, found {len(worlds)}")
    world = ElementTree.parse(worlds[0]).getroot().find("world")
    uri = world.findtext("include/uri", "")
    model_file = resolve(uri, package) / "model.sdf"
    require(model_file.is_file(), f"{uri} does not lead to a model.sdf")
    return world, ElementTree.parse(model_file).getroot().find("model")


def resolve(uri, package):
    require(uri.startswith("model://"), f"{uri!r} is not a model:// URI")
    return package / "models" / uri.removeprefix("model://")


@contextlib.contextmanager
def connected():
    """A physics client; Bullet's banner on stdout is swallowed."""
    client = p.connect(p.DIRECT)
    try:
        yield client
    finally:
        p.disconnect(client)


def read_collisions(model, package):
    """File and friction of every collision mesh."""
    found = []
    for collision in model.iterfind("link/collision"):
        file = resolve(collision.findtext("geometry/mesh/uri", ""), package)
        require(file.is_file(), f"{file.name} is missing")
        found.append((file, float(collision.findtext("surface/friction/ode/mu", "1"))))
    require(found, "the model has no collision mesh")
    return found


def count_objects(file):
    with file.open() as lines:
        return sum(line.startswith("o ") for line in lines)


def load_collisions(collisions, flags):
    for file, friction in collisions:
        shape = p.createCollisionShape(p.GEOM_MESH, fileName=str(file), flags=flags)
        require(shape >= 0, f"Bullet cannot read {file.name}")
        body = p.createMultiBody(0, shape)
        p.changeDynamics(body, -1, lateralFriction=friction)


def gravity(world):
    return [float(part) for part in world.findtext("gravity").split()]


def spawn_points(model):
    poses = [frame.findtext("pose") for frame in model.iterfind("frame") if frame.get("name").startswith("spawn_")]
    require(poses, "the model has no frame spawn_0")
    return [np.array([float(part) for part in pose.split()[:3]]) for pose in poses]


def check_closed(spawn, number):
    """Rays from above the spawn pose in all directions (a Fibonacci sphere) must all end on rock."""
    turn = np.arange(RAYS) * math.pi * (3 - math.sqrt(5))
    height = 1 - (2 * np.arange(RAYS) + 1) / RAYS
    ring = np.sqrt(1 - height**2)
    directions = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    eye = spawn + [0, 0, DROP_M]
    hits = p.rayTestBatch([eye.tolist()] * RAYS, (eye + RAY_LENGTH_M * directions).tolist())
    lost = sum(hit[0] < 0 for hit in hits)
    require(lost == 0, f"{lost} of {RAYS} rays from spawn_{number} leave the cave: the collision mesh has a hole")


def check_grounded(spawn, number):
    """The start pose must be on the floor, or a robot starts in the air or in the rock."""
    eye = spawn + [0, 0, DROP_M]
    floor_z = p.rayTest(eye.tolist(), (eye - [0, 0, RAY_LENGTH_M]).tolist())[0][3][2]
    height = spawn[2] - floor_z
    require(abs(height) < GROUND_M, f"spawn_{number} is {height:.2f} m above the floor")


def drop_ball(spawn, number, gravity_m_s2):
    """Drops the ball; gives the floor under its rest and its centre there."""
    p.setGravity(*gravity_m_s2)
    p.setTimeStep(STEP_S)
    shape = p.createCollisionShape(p.GEOM_SPHERE, radius=BALL_RADIUS_M)
    ball = p.createMultiBody(1, shape, basePosition=(spawn + [0, 0, DROP_M]).tolist())
    p.changeDynamics(ball, -1, localInertiaDiagonal=[INERTIA_KG_M2] * 3, restitution=0)
    for _ in range(round(DURATION_S / STEP_S)):
        p.stepSimulation()
    centre = np.array(p.getBasePositionAndOrientation(ball)[0])
    speed = np.linalg.norm(p.getBaseVelocity(ball)[0])
    depth = max((-contact[8] for contact in p.getContactPoints(ball)), default=-math.inf)
    p.removeBody(ball)

    where = f"ball dropped at spawn_{number}"
    require(np.linalg.norm(centre - spawn) < AWAY_M, f"{where} is lost: it ended at {centre.round(2)}")
    require(speed < REST_SPEED_M_S, f"{where} still moves at {speed:.2f} m/s")
    require(abs(depth) < PENETRATION_M, f"{where} is not on the triangles: {-depth:.3f} m above them")
    floor = p.rayTest(centre.tolist(), (centre - [0, 0, RAY_LENGTH_M]).tolist())[0]
    require(floor[0] >= 0, f"{where} has no floor below")
    return floor[3][2], centre


def require(condition, message):
    if not condition:
        sys.exit(f"error: {message}")


if __name__ == "__main__":
    require(len(sys.argv) == 2, "usage: drop_pybullet.py PACKAGE_DIR")
    main(Path(os.path.abspath(sys.argv[1])))
