"""Holds the certificate of a cave to drives along its own paths.

    drives.py [--passages N] [--results FILE] rover|husky NAME PACKAGE_DIR CERTIFICATE.json GRAPH.json

The rover is that of a MuJoCo package, on its convex pieces; the Husky is that of `pybullet_data`, in Bullet, on the triangles of
the rock and the hulls of the things of a Gazebo package. Either is put down at the start of a path, and follows it by pure pursuit:

- the path to the station that is furthest from the start of those that the certificate is sure of;
- the paths through passages that are called go, each way, at most N: the steepest first;
- the paths of at most N that are called marginal, and, since those that are called no-go have none, the straight line over the
  floor between the stations of at most N of these, drawn by lot.

Where it gets no further for three seconds, it backs up and tries again, as navigation stacks do.
It fails where it is stuck for ten seconds, leans more than 50 degrees, strays by more than a metre or falls. What is called go
must be driven to its end, and nowhere on it may the floor rise or fall over half a metre by more than the friction of the cave
holds, less 5 degrees. Appends what came of it to a file of JSON lines, which `table.py` sums up.
"""

import argparse
import json
import sys
from collections import Counter
from pathlib import Path

import numpy as np
from paths import CLASSES, paths_of, some
from scipy.spatial.transform import Rotation

sys.path += [str(Path(__file__).parents[1]), str(Path(__file__).parents[1] / "mujoco")]
from husky import Husky, only_own_words  # noqa: E402
from package import Failure  # noqa: E402
from pursuit import STUCK_S, Pursuit, is_tipped  # noqa: E402
from route import Line  # noqa: E402
from rover import Rover  # noqa: E402

ROBOTS = {"rover": Rover.of, "husky": Husky.of}

LOOK_AHEAD_M = 0.4
ARRIVED_M = 0.3  # from the end
ABOVE_M = 0.02  # a robot is put down from here
STRAY_M = 1.0
BACK_AFTER_S = 3.0  # without getting further
BACK_S = 1.5
BACK_M_S = 0.3
FALL_M = 0.15  # within a command: no slope at the speed of a drive
SLOPE_OVER_M = 0.5
RESERVE_DEG = 5.0
EYE_M = 0.3


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--passages", type=int, default=1000)
    arguments.add_argument("--results", type=Path)
    arguments.add_argument("robot", choices=ROBOTS)
    arguments.add_argument("name")
    arguments.add_argument("package", type=Path)
    arguments.add_argument("certificate", type=Path)
    arguments.add_argument("graph", type=Path)
    given = arguments.parse_args()
    certificate, graph = [json.loads(file.read_text(encoding="utf-8")) for file in (given.certificate, given.graph)]
    with only_own_words() as say:
        try:
            robot = ROBOTS[given.robot](given.package)
            found = judge(robot, *paths_of(certificate, graph), given.passages)
        except Failure as failure:
            sys.exit(f"{given.name}: {failure}")
        if given.results:
            with given.results.open("a", encoding="utf-8") as results:
                results.write(json.dumps({"cave": given.name, "robot": given.robot, **found}) + "\n")
        limit_deg = np.degrees(np.arctan(graph["recipe"]["world"]["friction"])) - RESERVE_DEG
        faults = list(faults_of(found, limit_deg))
        say(f"{given.robot}: {given.name}: {summary(found)}")
    if faults:
        sys.exit("\n".join(f"{given.name}: {fault}" for fault in faults))


def judge(robot, furthest, passages, most):
    """How many passages are called what, and what came of the drives."""
    said = Counter(path.said for path in passages)
    chosen = [*furthest, *some(passages, most)]
    # Before it is in the way of the rays.
    chosen = [path if path.said != "no-go" else path._replace(poses=on_floor(robot, path.poses)) for path in chosen]
    slopes_deg = [slope_deg(robot, path.poses) if path.said == "go" else None for path in chosen]
    drives = []
    for path, steepest_deg in zip(chosen, slopes_deg, strict=True):
        fault, passed_m, length_m = drive(robot, path.poses)
        drives.append(
            {
                "path": path.name,
                "said": path.said,
                "fault": fault,
                "passed_m": round(passed_m, 2),
                "length_m": round(length_m, 2),
                "slope_deg": steepest_deg,
            }
        )
    return {"passages": {name: said[name] for name in CLASSES}, "drives": drives}


def faults_of(found, limit_deg):
    for one in [one for one in found["drives"] if one["said"] == "go"]:
        if one["fault"]:
            yield f"{one['path']} {one['fault']} after {one['passed_m']} of {one['length_m']} m"
        if one["slope_deg"] > limit_deg:
            yield f"{one['path']} is {one['slope_deg']:.1f} degrees steep, more than {limit_deg:.1f}"


def summary(found):
    table = Counter((one["said"], one["fault"] is None) for one in found["drives"])
    return "; ".join(f"{said} {table[said, True]} driven, {table[said, False]} not" for said in CLASSES)


def on_floor(robot, poses):
    """A straight line over the floor below it, where there is any."""
    floor_m = robot.floor_m(poses[:, :3])
    found = poses.copy()
    found[:, 2] = np.where(np.isfinite(floor_m), floor_m, poses[:, 2])
    return found


def slope_deg(robot, poses):
    """How steeply the floor rises or falls along a path, over half a metre at most."""
    line = Line(poses[:, :3])
    along_m = np.arange(0, line.length_m, 0.1)
    floor_m = robot.floor_m(line.at(along_m) + [0, 0, EYE_M])
    apart = round(SLOPE_OVER_M / 0.1)
    rises_m = np.abs(floor_m[apart:] - floor_m[:-apart])
    return round(float(np.degrees(np.arctan(np.nanmax(rises_m, initial=0.0) / SLOPE_OVER_M))), 2)


def drive(robot, poses):
    """What stops the robot, how far it came, and how far it was to go."""
    put_down(robot, poses[0])
    line, pursuit = Line(poses[:, :3]), Pursuit(robot)
    passed_m, passed_at_s, backed_at_s = 0.0, robot.time_s, robot.time_s
    while passed_m < line.length_m - ARRIVED_M:
        before_m, passed_m = passed_m, line.along_m(robot.position, passed_m, LOOK_AHEAD_M)
        passed_at_s = robot.time_s if passed_m > before_m else passed_at_s
        height_m = robot.position[2]
        if robot.time_s > max(passed_at_s, backed_at_s) + BACK_AFTER_S:
            robot.steer(-BACK_M_S, 0)
            robot.run(BACK_S)
            height_m, backed_at_s = robot.position[2], robot.time_s
        pursuit.steer(line.at(min(passed_m + LOOK_AHEAD_M, line.length_m)))
        if is_tipped(robot):
            return "tips over", passed_m, line.length_m
        if height_m - robot.position[2] > FALL_M:
            return "falls", passed_m, line.length_m
        if np.linalg.norm((line.at(passed_m) - robot.position)[:2]) > STRAY_M:
            return "strays", passed_m, line.length_m
        if robot.time_s > passed_at_s + STUCK_S:
            return "is stuck", passed_m, line.length_m
    return None, passed_m, line.length_m


def put_down(robot, pose):
    """At rest, as the pose stands."""
    rotation = Rotation.from_euler("ZYX", pose[3:] * [1, -1, 1], degrees=True)
    robot.put_down(pose[:3] + rotation.apply([0, 0, ABOVE_M]), rotation.as_quat())
    robot.run(0.5)


if __name__ == "__main__":
    main()
