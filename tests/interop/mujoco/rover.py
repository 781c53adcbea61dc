"""The rover of a MuJoCo package, steered like a tank."""

import mujoco
import numpy as np
from package import COLLISION_GROUP, name_of, require

WHEELS = ["front_left", "front_right", "rear_left", "rear_right"]
SIDES = np.array([1, -1, 1, -1])  # left is where a turn to the left takes back
AWAY_M = 1e4
DOWN = np.array([0.0, 0.0, -1.0])


class Rover:
    """The rover in its cave, at the start keyframe."""

    def __init__(self, model, name):
        self.model, self.data = model, mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, self.data, model.keyframe(f"{name}_start").id)
        mujoco.mj_forward(model, self.data)
        self.wheels = [self.model.joint(f"rover_wheel_{wheel}").bodyid[0] for wheel in WHEELS]
        self.drives = [self.model.actuator(f"rover_drive_{wheel}").id for wheel in WHEELS]
        self.wheel_radius_m = self.model.geom_size[self.tyre(self.wheels[0])][0]
        self.track_m = np.linalg.norm(self.data.xpos[self.wheels[0]] - self.data.xpos[self.wheels[1]])

    @classmethod
    def of(cls, package):
        """That of a package."""
        name = name_of(package)
        return cls(mujoco.MjModel.from_xml_path(str(package / f"{name}_rover.xml")), name)

    def tyre(self, wheel):
        """The geom by which a wheel touches."""
        geoms = [geom for geom in range(self.model.ngeom) if self.model.geom_bodyid[geom] == wheel]
        tyres = [geom for geom in geoms if self.model.geom_contype[geom] or self.model.geom_conaffinity[geom]]
        require(len(tyres) == 1, f"wheel {self.model.body(wheel).name} has {len(tyres)} tyres")
        return tyres[0]

    def steer(self, speed_m_s, turn_rad_s):
        """Commands the wheels for a speed ahead and a turn to the left, as if no wheel slipped."""
        rims_m_s = speed_m_s - SIDES * turn_rad_s * self.track_m / 2
        self.data.ctrl[self.drives] = rims_m_s / self.wheel_radius_m

    def run(self, duration_s):
        mujoco.mj_step(self.model, self.data, round(duration_s / self.model.opt.timestep))
        require(np.isfinite(self.data.qpos).all(), "the simulation diverged")

    def put_down(self, position, rotation):
        """At rest; the rotation is a quaternion, its scalar last."""
        x, y, z, w = rotation
        address = self.model.jnt_qposadr[self.model.body("rover").jntadr[0]]
        self.data.qvel[:] = 0
        self.data.ctrl[:] = 0
        self.data.qpos[address : address + 7] = [*position, w, x, y, z]
        mujoco.mj_forward(self.model, self.data)

    def floor_m(self, points):
        """Heights of the rock under points; NaN where there is none. The rover is out of the way afterwards."""
        self.put_down([0, 0, AWAY_M], [0, 0, 0, 1])
        groups, hit = np.arange(6, dtype=np.uint8) == COLLISION_GROUP, np.zeros(1, dtype=np.int32)
        down = [mujoco.mj_ray(self.model, self.data, point, DOWN, groups, 1, -1, hit) for point in points]
        return np.where(np.array(down) >= 0, points[:, 2] - down, np.nan)

    @property
    def time_s(self):
        return self.data.time

    @property
    def position(self):
        return self.data.body("rover").xpos.copy()

    @property
    def axes(self):
        """Ahead, left and up, as columns."""
        return self.data.body("rover").xmat.reshape(3, 3).copy()

    def spokes(self, count):
        """Centres of the wheels, repeated, and as many directions round each in its plane."""
        angles = np.arange(count) * 2 * np.pi / count
        ring = np.stack([np.cos(angles), np.zeros(count), np.sin(angles)], axis=1)
        turns = self.data.xmat[self.wheels].reshape(-1, 3, 3)
        return np.repeat(self.data.xpos[self.wheels], count, axis=0), np.concatenate([ring @ turn.T for turn in turns])
