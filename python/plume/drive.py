"""An environment of Gymnasium in which a rover drives to a place in a cave, in MuJoCo.

    import plume.gym

    drive = gymnasium.make("plume/Drive-v0", dataset="drive", part="train", difficulty=(0.0, 0.5))
    observation, info = drive.reset(seed=1)

Each episode draws a cave from a dataset made by `plume dataset` with the target `mujoco` and `robot = "rover"`, and a stretch of the
path that the certificate of the cave calls go, so that every episode can be solved. Every other path, around stones or through other
passages, is as good: the reward is progress towards the goal along the certified one.

The rays are cast by MuJoCo on the CPU at the collision geometry, which needs no graphics.
"""

import json
import tempfile
from collections import OrderedDict
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import gymnasium
import mujoco  # type: ignore[import-untyped]
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

import plume
from plume.errors import InputError

__all__ = ["Drive"]

Floats = NDArray[np.float64]
Observation = dict[str, NDArray[np.float32]]

STEP_S = 0.1
SPEED_M_S = 1.0
TURN_RAD_S = 1.5
RANGE_M = 10.0
LIDAR_RAYS = 64
LIDAR_ELEVATIONS_DEG = (-20.0, 0.0)
"""The lower ring meets stones and edges, and clears the rover."""
DEPTH_PX = (24, 32)
DEPTH_FIELD_DEG = (60.0, 80.0)
MAST_M = (0.3, 0.0, 0.72)
"""Where rays start, in the frame of the rover: above its head."""
ARRIVED_M = 0.5
STRAY_M = 3.0
LEAN_DEG = 50.0
LOOK_AHEAD_M = 2.0
"""How far along the path progress is looked for in one step: more than a rover drives, less than a bend takes to come back."""
MOST_MOTION = np.array([5.0, 10.0, 1.0, 1.0], dtype=np.float32)
"""Of speed and turn only bodies that were flung away have more."""
GOAL_REWARD = 5.0
STEP_REWARD = -0.01
COLLISION_GROUP = 3
WHEELS = {"front_left": 1, "front_right": -1, "rear_left": 1, "rear_right": -1}
"""With the side that each is on: 1 is left."""
ABOVE_M = 0.05
SETTLING_S = 0.3
CAVES = 4
"""Caves of the dataset that is made if none is given."""


class Drive(gymnasium.Env[Observation, NDArray[np.float32]]):
    """A rover that is to drive to a goal.

    Action: speed ahead and turn to the left, from -1 to 1, of 1 m/s and 1.5 rad/s.

    Observation: a dict.
        `lidar`: (2, 64) ranges from above the rover, at -20° and 0° elevation, from straight ahead to the left; or
        `depth`: (24, 32) ranges ahead, 60° × 80°, the first row at the top; as shares of 10 m, 1 if there is nothing nearer.
        `goal`: its distance as a share of 10 m, at most 1, and the cosine and sine of its bearing.
        `motion`: speed ahead (m/s), turn to the left (rad/s), sines of climb and of lean to the right.

    Reward: metres of progress along the path, -0.01 each step, 5 at the goal, -5 where it tips over.

    An episode ends at the goal (`info["is_success"]`), where the rover tips over, or 3 m from the path; Gymnasium cuts it off after a
    minute. The same seed draws the same episodes.

    Args:
        dataset: The folder of a dataset. Without one, a few caves are made into a temporary folder, which takes a minute or so.
        part: The part of the dataset that caves are drawn from.
        difficulty: Of the caves: one number or a range, if the dataset varies it; by default all. Without a dataset, that of its caves.
        sensor: What is observed of the cave.
        distance_m: The least and the most distance along the path from start to goal, m.
        models: How many compiled models are kept in memory.
    """

    metadata = {"render_modes": []}

    def __init__(
        self,
        dataset: str | PathLike[str] | None = None,
        *,
        part: Literal["train", "validation", "test"] = "train",
        difficulty: float | tuple[float, float] | None = None,
        sensor: Literal["lidar", "depth"] = "lidar",
        distance_m: tuple[float, float] = (3.0, 15.0),
        models: int = 4,
    ) -> None:
        self._temporary: tempfile.TemporaryDirectory[str] | None = None
        if dataset is None:
            dataset = self._made(difficulty)
        self._caves = _caves(Path(dataset), part, difficulty)
        self._models: OrderedDict[Path, tuple[Rover, Floats]] = OrderedDict()
        self._most_models, self._distance_m, self._sensor = models, distance_m, sensor
        self._rays = _lidar() if sensor == "lidar" else _depth()
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        self._shape = (len(LIDAR_ELEVATIONS_DEG), LIDAR_RAYS) if sensor == "lidar" else DEPTH_PX
        observed: Any = spaces.Dict(
            {
                sensor: spaces.Box(0.0, 1.0, self._shape, np.float32),
                "goal": spaces.Box(-1.0, 1.0, (3,), np.float32),
                "motion": spaces.Box(-MOST_MOTION, MOST_MOTION, dtype=np.float32),
            }
        )
        self.observation_space = observed

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Draws a cave and a stretch of its path, and puts the rover down at the start.

        Options: `cave`, the number of a cave in the dataset.
        """
        super().reset(seed=seed)
        numbers = list(self._caves)
        number = (options or {}).get("cave", numbers[self.np_random.integers(len(numbers))])
        if number not in self._caves:
            raise InputError(f"there is no cave {number} in this part of the dataset", f"its caves are {numbers}")
        folder = self._caves[number]
        self._cave = number
        self._rover, poses = self._loaded(folder)
        self._path, heading_rad = self._stretch(poses)
        self._rover.put_down(self._path.corners[0], heading_rad)
        self._passed_m = self._path.along_m(self._rover.position, 0.0)
        return self._observation(), self._info(is_success=False)

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drives for a tenth of a second."""
        speed, turn = np.clip(np.asarray(action, dtype=np.float64), -1.0, 1.0)
        self._rover.drive(speed * SPEED_M_S, turn * TURN_RAD_S, STEP_S)
        before_m, self._passed_m = self._passed_m, self._path.along_m(self._rover.position, self._passed_m)
        is_success = bool(self._goal_m() < ARRIVED_M)
        has_tipped = bool(self._rover.axes[2, 2] < np.cos(np.radians(LEAN_DEG)))
        has_strayed = bool(np.linalg.norm(self._path.at(self._passed_m) - self._rover.position) > STRAY_M)
        reward = float(self._passed_m - before_m) + STEP_REWARD + GOAL_REWARD * (is_success - has_tipped)
        is_over = is_success or has_tipped or has_strayed
        return self._observation(), reward, is_over, False, self._info(is_success)

    def close(self) -> None:
        """Removes the caves that were made for it."""
        self._models.clear()
        if self._temporary:
            self._temporary.cleanup()

    def _made(self, difficulty: float | tuple[float, float] | None) -> Path:
        low, high = _range(difficulty)
        self._temporary = tempfile.TemporaryDirectory(prefix="plume-drive-")
        home = Path(self._temporary.name)
        spec = home / "drive.toml"
        vary = f'[[vary]]\nkey = "difficulty"\ndraw = "uniform"\nvalues = [{float(low)}, {float(high)}]\n'
        shares = "[split]\ntrain = 1\nvalidation = 0\ntest = 0\n"
        settings = 'sheet = 0\ntargets = ["mujoco"]\nrobot = "rover"\n'
        spec.write_text(f"seeds = [1, {CAVES}]\n{settings}{shares}{vary}", encoding="utf-8")
        return plume.dataset(spec, home / "drive").path

    def _loaded(self, folder: Path) -> tuple["Rover", Floats]:
        """The rover in a cave, and the path there."""
        if folder not in self._models:
            self._models[folder] = (Rover(folder / "mujoco"), _path(folder))
        self._models.move_to_end(folder)
        while len(self._models) > self._most_models:
            self._models.popitem(last=False)
        return self._models[folder]

    def _stretch(self, poses: Floats) -> tuple["Line", float]:
        """A part of a path, and where it heads at its start."""
        whole = Line(poses[:, :3])
        length_m = min(self.np_random.uniform(*self._distance_m), whole.length_m)
        start_m = self.np_random.uniform(0.0, whole.length_m - length_m)
        first = int(np.searchsorted(whole.passed_m, start_m, side="right")) - 1
        last = int(np.searchsorted(whole.passed_m, whole.passed_m[first] + length_m))
        stretch = poses[first : max(last, first + 1) + 1]
        return Line(stretch[:, :3]), float(np.radians(stretch[0, 3]))

    def _goal_m(self) -> float:
        return float(np.linalg.norm(self._path.corners[-1] - self._rover.position))

    def _observation(self) -> Observation:
        rover = self._rover
        ranges_m = rover.ranges_m(self._rays).reshape(self._shape)
        away = (self._path.corners[-1] - rover.position) @ rover.axes
        bearing_rad = np.arctan2(away[1], away[0])
        goal = [min(self._goal_m() / RANGE_M, 1.0), np.cos(bearing_rad), np.sin(bearing_rad)]
        motion = [rover.speed_m_s, rover.turn_rad_s, rover.axes[2, 0], rover.axes[2, 1]]
        return {
            self._sensor: (ranges_m / RANGE_M).astype(np.float32),
            "goal": np.array(goal, dtype=np.float32),
            "motion": np.clip(motion, -MOST_MOTION, MOST_MOTION).astype(np.float32),
        }

    def _info(self, is_success: bool) -> dict[str, Any]:
        return {
            "cave": self._cave,
            "remaining_m": self._path.length_m - self._passed_m,
            "is_success": is_success,
        }


class Rover:
    """The rover of a MuJoCo package in its cave."""

    def __init__(self, package: Path) -> None:
        files = sorted(package.glob("*_rover.xml"))
        if not files:
            raise InputError(f"{package} is no package of target mujoco", 'make the dataset with targets = ["mujoco"]')
        self.model = mujoco.MjModel.from_xml_path(str(files[0]))
        self.data = mujoco.MjData(self.model)
        body = self.model.body("rover")
        self._body = body.id
        self._pose = self.model.jnt_qposadr[body.jntadr[0]]
        wheels = [self.model.joint(f"rover_wheel_{wheel}").bodyid[0] for wheel in WHEELS]
        self._drives = [self.model.actuator(f"rover_drive_{wheel}").id for wheel in WHEELS]
        geoms = np.isin(self.model.geom_bodyid, wheels[0]) & (self.model.geom_contype > 0)
        self._wheel_radius_m = float(self.model.geom_size[geoms][0, 0])
        mujoco.mj_forward(self.model, self.data)
        self._track_m = float(np.linalg.norm(self.data.xpos[wheels[0]] - self.data.xpos[wheels[1]]))

    def put_down(self, position: Floats, heading_rad: float) -> None:
        """At rest, level, and lets it settle."""
        mujoco.mj_resetData(self.model, self.data)
        turn = [np.cos(heading_rad / 2), 0.0, 0.0, np.sin(heading_rad / 2)]
        self.data.qpos[self._pose : self._pose + 7] = [*(position + [0.0, 0.0, ABOVE_M]), *turn]
        mujoco.mj_forward(self.model, self.data)
        self.drive(0.0, 0.0, SETTLING_S)

    def drive(self, speed_m_s: float, turn_rad_s: float, duration_s: float) -> None:
        """Turns the wheels as if none slipped."""
        sides = np.array(list(WHEELS.values()))
        self.data.ctrl[self._drives] = (speed_m_s - sides * turn_rad_s * self._track_m / 2) / self._wheel_radius_m
        mujoco.mj_step(self.model, self.data, round(duration_s / self.model.opt.timestep))

    def ranges_m(self, directions: Floats) -> Floats:
        """How far rays go from the mast, at most 10 m; directions are those of the rover's frame, as rows."""
        origin = self.position + self.axes @ MAST_M
        rays = directions @ self.axes.T
        groups = (np.arange(6) == COLLISION_GROUP).astype(np.uint8)
        geoms, ranges_m = np.zeros(len(rays), dtype=np.int32), np.zeros(len(rays))
        mujoco.mj_multiRay(
            self.model, self.data, origin, rays.ravel(), groups, True, -1, geoms, ranges_m, None, len(rays), RANGE_M
        )
        return np.where(ranges_m < 0.0, RANGE_M, np.minimum(ranges_m, RANGE_M))

    @property
    def position(self) -> Floats:
        return np.array(self.data.xpos[self._body])

    @property
    def axes(self) -> Floats:
        """Ahead, left and up, as columns."""
        return np.array(self.data.xmat[self._body]).reshape(3, 3)

    @property
    def speed_m_s(self) -> float:
        return float(self.data.qvel[:3] @ self.axes[:, 0])

    @property
    def turn_rad_s(self) -> float:
        """MuJoCo has the turns of a free body in its own frame."""
        return float(self.data.qvel[5])


class Line:
    """A line over the floor."""

    def __init__(self, corners: Floats) -> None:
        self.corners = corners
        steps_m = np.linalg.norm(np.diff(corners, axis=0), axis=1)
        self.passed_m = np.concatenate([[0.0], np.cumsum(steps_m)])

    @property
    def length_m(self) -> float:
        return float(self.passed_m[-1])

    def at(self, along_m: float | Floats) -> Floats:
        """The point (or points) this far from the start."""
        return np.stack([np.interp(along_m, self.passed_m, axis) for axis in self.corners.T], axis=-1)

    def along_m(self, point: Floats, passed_m: float) -> float:
        """How far along the line a point is that was at `passed_m`, ahead or back."""
        near = (self.passed_m[1:] >= passed_m - LOOK_AHEAD_M) & (self.passed_m[:-1] <= passed_m + LOOK_AHEAD_M)
        starts, steps = self.corners[:-1][near], np.diff(self.corners, axis=0)[near]
        lengths_m = np.maximum(np.linalg.norm(steps, axis=1), np.finfo(float).tiny)
        ahead_m = np.clip(((point - starts) * steps).sum(axis=1) / lengths_m, 0.0, lengths_m)
        places = starts + (ahead_m / lengths_m)[:, None] * steps
        nearest = np.linalg.norm(places - point, axis=1).argmin()
        return float(self.passed_m[:-1][near][nearest] + ahead_m[nearest])


def _caves(dataset: Path, part: str, difficulty: float | tuple[float, float] | None) -> dict[int, Path]:
    """Folders of the caves of a part, by their numbers: those with a path."""
    index = dataset / "index.json"
    if not index.is_file():
        raise InputError(f"{dataset} is no finished dataset", "make one with `plume.dataset`")
    low, high = _range(difficulty)
    rows = [row for row in json.loads(index.read_text(encoding="utf-8")) if row["part"] == part]
    fitting = [row for row in rows if difficulty is None or low <= row.get("difficulty", -1.0) <= high]
    caves = {row["item"]: dataset / row["path"] for row in fitting}
    found = {number: folder for number, folder in caves.items() if _has_path(_certificate(folder))}
    if not found:
        raise InputError(
            f"{dataset} has no cave of part {part} in which a rover gets along, with difficulty {difficulty}",
            'its specification needs targets = ["mujoco"] and robot = "rover"',
        )
    return found


def _range(difficulty: float | Sequence[float] | None) -> tuple[float, float]:
    match difficulty:
        case None:
            return 0.0, 1.0
        case float() | int():
            return difficulty, difficulty
        case [low, high]:
            return low, high
    raise InputError("difficulty is a number or a range", "")


def _certificate(folder: Path) -> dict[str, Any]:
    file = folder / "certificate.json"
    certificate: dict[str, Any] = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    return certificate


def _has_path(certificate: dict[str, Any]) -> bool:
    return certificate.get("robot", {}).get("name") == "rover" and bool(certificate["route"])


def _path(folder: Path) -> Floats:
    """Poses: x, y, z in metres, heading, climb and lean in degrees."""
    return np.array(_certificate(folder)["route"]["path"])


def _lidar() -> Floats:
    azimuths = np.arange(LIDAR_RAYS) * 2 * np.pi / LIDAR_RAYS
    return np.concatenate([_directions(azimuths, np.radians(elevation)) for elevation in LIDAR_ELEVATIONS_DEG])


def _depth() -> Floats:
    rows, columns = DEPTH_PX
    up, across = np.radians(DEPTH_FIELD_DEG)
    elevations = (0.5 - (np.arange(rows) + 0.5) / rows) * up
    azimuths = (0.5 - (np.arange(columns) + 0.5) / columns) * across
    return np.concatenate([_directions(azimuths, elevation) for elevation in elevations])


def _directions(azimuths: Floats, elevation: float) -> Floats:
    level, up = np.cos(elevation), np.full(len(azimuths), np.sin(elevation))
    return np.stack([level * np.cos(azimuths), level * np.sin(azimuths), up], axis=1)
