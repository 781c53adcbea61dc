"""The Husky of `pybullet_data` in a world that Bullet has loaded, steered like a tank."""

import contextlib
import os
import tempfile
from pathlib import Path

import numpy as np
import pybullet as p
import pybullet_data
from drop_pybullet import gravity, load_collisions, read_collisions, read_world
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

STEP_S = 1 / 240
WHEEL_RADIUS_M = 0.17775
TRACK_M = 0.5708
TORQUE_N_M = 40.0
AWAY_M = 1e4
FAR_M = 100.0
THINGS = "things_"  # how the names of their meshes begin
RAYS_AT_ONCE = p.MAX_RAY_INTERSECTION_BATCH_SIZE - 1


class Husky:
    """Its origin is on the ground between its wheels; ahead is +X."""

    def __init__(self, position, rotation=(0, 0, 0, 1)):
        p.setTimeStep(STEP_S)
        # Its cone of friction holds wheels sideways that only skid ahead: a Husky rolled on instead of turning on the spot. Without,
        # `drives/limits.py` agrees better with MuJoCo.
        p.setPhysicsEngineParameter(enableConeFriction=0)
        p.setAdditionalSearchPath(pybullet_data.getDataPath())
        self.body = p.loadURDF("husky/husky.urdf", list(position), list(rotation))
        self.joints = {
            p.getJointInfo(self.body, joint)[1].decode(): joint for joint in range(p.getNumJoints(self.body))
        }
        self.sides = [[self.joints[f"{end}_{side}_wheel"] for end in ("front", "rear")] for side in ("left", "right")]
        self.steps = 0

    @classmethod
    def of(cls, package):
        """In a world of its own, on the triangles of the rock and the hulls of the things of a Gazebo package.

        Stones are small: Bullet lets wheels sink into their triangles, which then hold them."""
        world, model = read_world(package)
        p.connect(p.DIRECT)
        p.setGravity(*gravity(world))
        collisions = read_collisions(model, package)
        things = [collision for collision in collisions if collision[0].name.startswith(THINGS)]
        rock = [collision for collision in collisions if collision not in things]
        load_collisions(rock, p.GEOM_FORCE_CONCAVE_TRIMESH)
        with tempfile.TemporaryDirectory() as folder:
            load_collisions([(in_bodies(file, Path(folder)), friction) for file, friction in things], 0)
        return cls([0, 0, AWAY_M])

    def steer(self, speed_m_s, turn_rad_s):
        """Commands the wheels for a speed ahead and a turn to the left, as if no wheel slipped."""
        turn_m_s = turn_rad_s * TRACK_M / 2
        for wheels, rim_m_s in zip(self.sides, (speed_m_s - turn_m_s, speed_m_s + turn_m_s), strict=True):
            speeds = [rim_m_s / WHEEL_RADIUS_M] * len(wheels)
            torques = [TORQUE_N_M] * len(wheels)
            p.setJointMotorControlArray(self.body, wheels, p.VELOCITY_CONTROL, targetVelocities=speeds, forces=torques)

    def run(self, duration_s):
        for _ in range(round(duration_s / STEP_S)):
            p.stepSimulation()
            self.steps += 1

    def put_down(self, position, rotation):
        """At rest; the rotation is a quaternion, its scalar last."""
        p.resetBasePositionAndOrientation(self.body, list(position), list(rotation))
        p.resetBaseVelocity(self.body, [0, 0, 0], [0, 0, 0])
        for wheel in sum(self.sides, []):
            p.resetJointState(self.body, wheel, 0, 0)
        self.steer(0, 0)

    def floor_m(self, points):
        """Heights of the rock under points; NaN where there is none. The Husky is out of the way afterwards."""
        self.put_down([0, 0, AWAY_M], [0, 0, 0, 1])
        hits = []
        for some in (points[start : start + RAYS_AT_ONCE] for start in range(0, len(points), RAYS_AT_ONCE)):
            hits += p.rayTestBatch(some.tolist(), (some - [0, 0, FAR_M]).tolist())
        return np.array([hit[3][2] if hit[0] >= 0 else np.nan for hit in hits])

    @property
    def time_s(self):
        return self.steps * STEP_S

    @property
    def position(self):
        return np.array(p.getBasePositionAndOrientation(self.body)[0])

    @property
    def axes(self):
        """Ahead, left and up, as columns."""
        return np.array(p.getMatrixFromQuaternion(p.getBasePositionAndOrientation(self.body)[1])).reshape(3, 3)


@contextlib.contextmanager
def only_own_words():
    """Bullet prints what it thinks of the Husky."""
    with os.fdopen(os.dup(1), "w") as stdout:
        os.dup2(2, 1)
        yield lambda words: print(words, file=stdout, flush=True)


def in_bodies(file, folder):
    """A copy of an OBJ in which each body is an object: Bullet makes a hull of each."""
    lines = file.read_text(encoding="utf-8").splitlines()
    corners = [line for line in lines if line.startswith("v ")]
    faces = np.array([[int(corner.split("/")[0]) for corner in line.split()[1:]] for line in lines if line[:2] == "f "])
    edges = np.concatenate([faces[:, :2], faces[:, 1:]]) - 1
    joined = coo_matrix((np.ones(len(edges)), edges.T), shape=[len(corners)] * 2)
    body_of = connected_components(joined, directed=False)[1][faces[:, 0] - 1]
    copy = folder / file.name
    with copy.open("w", encoding="utf-8") as out:
        out.write("\n".join(corners) + "\n")
        for body in np.unique(body_of):
            out.write(f"o {body}\n")
            out.writelines("f {} {} {}\n".format(*face) for face in faces[body_of == body])
    return copy
