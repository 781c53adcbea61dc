"""A URDF world as Bullet sees it."""

import contextlib

import numpy as np
import pybullet as p
from package import Failure, require, urdf_of

FAR_M = 100.0
GRAVITY_M_S2 = 9.81
RAYS_AT_ONCE = p.MAX_RAY_INTERSECTION_BATCH_SIZE - 1


@contextlib.contextmanager
def loaded(package):
    """A physics client with the world in it, loaded as a user would, without telling Bullet that it is fixed."""
    client = p.connect(p.DIRECT)
    try:
        p.setGravity(0, 0, -GRAVITY_M_S2)
        urdf = urdf_of(package)
        try:
            world = p.loadURDF(str(urdf))
        except p.error as reason:
            raise Failure(f"Bullet cannot load {urdf.name}: {reason}") from reason
        yield world
    finally:
        p.disconnect(client)


def start_poses(world):
    """Position and rotation of each start frame."""
    joints = range(p.getNumJoints(world))
    frames = [joint for joint in joints if "_spawn_" in p.getJointInfo(world, joint)[12].decode()]
    require(frames, "the world has no frame for a start pose")
    return [tuple(np.array(part) for part in p.getLinkState(world, frame)[4:6]) for frame in frames]


def hits(points, directions):
    """Where rays of 100 m meet rock, shape (ray, xyz); NaN where they leave the world."""
    return strikes(points, directions)[0]


def strikes(points, directions):
    """Where rays of 100 m meet rock and the normals there, each of shape (ray, xyz); NaN where they leave the world."""
    points, directions = np.broadcast_arrays(np.asarray(points, float), np.asarray(directions, float))
    found = []
    for start in range(0, len(points), RAYS_AT_ONCE):
        some = slice(start, start + RAYS_AT_ONCE)
        found += p.rayTestBatch(points[some].tolist(), (points[some] + FAR_M * directions[some]).tolist())
    nowhere = [np.nan] * 3
    struck = np.array([hit[3:5] if hit[0] >= 0 else (nowhere, nowhere) for hit in found])
    return struck[:, 0], struck[:, 1]
